"""Pointing at two objects in turn, and back to rest (Section 7, Fig. 10).

The frames are candidate projections of Table 3: the arm's posture in the nullspace of its
direction (Eq. 42), its direction in the robot's frame (Eq. 40), and its direction towards each
object, which may move (Eq. 41); all are functions of time (Eq. 20).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from tpsim.border import Count, NotNegative, Positive
from tpsim.controllers.product import Skill
from tpsim.controllers.timed_intervention import TimedIntervention
from tpsim.controllers.torque_cost import acceleration_effort
from tpsim.demonstration import Demonstration
from tpsim.errors import SimulationError
from tpsim.gaussian import Gaussian
from tpsim.learning.subspace import MFA
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.retrieval.tp_gmr import Order
from tpsim.robot.views.joints import Joints
from tpsim.task.task import Behaviour, Goal, Models, Situation, Task
from tpsim.tasks.pointing.pointers import (
    OBJECTS,
    PLANAR,
    Pointer,
    planar_world,
    spatial,
    spatial_world,
)
from tpsim.tasks.pointing.teacher import PHASES, SCHEDULE, PointingTeacher
from tpsim.world.people.demonstrator import CUTOFF, TeacherName
from tpsim.world.world import World

POINTED, RESTED = float(np.radians(1.5)), 0.1
"""Angles [rad] up to which the arm points at an object, and up to which it is at rest."""

SHOWN, HELD = float(np.radians(4.0)), 0.25
"""Angle [rad] up to which the teacher points well, and how long after and before the phases [s]:
its timing varies."""

DRAWS = 200
"""Pairs of places that are drawn for the objects, at most."""

FLAT = "planar3"
"""The arm that points in the plane."""


@dataclass(frozen=True)
class Pointing(Task):
    """Point at two objects in turn.

    Parameters
    ----------
    robot : str
        ``"planar3"``, an arm of three links in the plane, or one of the catalogue (``tpsim
        robots``), or of a file of yours, whose left gripper points in space.
    effort : float
        Cost of acceleration, beside that with which a usual deviation is worth what springs may
        pull (:func:`~tpsim.controllers.torque_cost.acceleration_effort`).
    components : int
        Gaussians over time.
    factors : int
        Factors of their covariances: time moves everything, what remains is each dimension's own.
        Six demonstrations are too few to say how five joints depend on each other (Section 4.2).
    order : str
        Of regression over time and product over frames
        (:func:`~tpsim.retrieval.tp_gmr.tp_gmr`).
    hold : float
        Standard deviation [rad] with which joints that were not taught hold their start.
    restless : float
        Standard deviation of the posture that the teacher prefers at rest [rad].
    bent : float
        Standard deviation of the posture that the teacher prefers while pointing [rad].
    hurry : float
        Standard deviation of the teacher's timing [s].
    teacher : str
        Whose hands show it: ``"human"``, as measured in people, or ``"firm"``, firmer and finer.
    """

    robot: str = FLAT
    effort: Positive = 1.0
    components: Count = 6
    factors: Count = 1
    order: Order = "pooled"
    hold: Positive = 0.1
    restless: NotNegative = 0.02
    bent: NotNegative = 0.06
    hurry: NotNegative = 0.05
    teacher: TeacherName = "firm"

    duration: ClassVar[float] = SCHEDULE[-1]

    @property
    def name(self) -> str:
        """``pointing``."""
        return "pointing"

    @property
    def pointer(self) -> Pointer:
        """The arm that points."""
        return PLANAR if self.robot == FLAT else spatial(self.stage.robot)

    @property
    def shown_by(self) -> PointingTeacher:
        """Who shows it."""
        return PointingTeacher(self.pointer, self.restless, self.bent, self.hurry, self.teacher)

    def world(self) -> World:
        """The robot and its two objects."""
        return planar_world() if self.robot == FLAT else spatial_world(self.robot)

    def sites(self) -> Mapping[str, str]:
        """What points, and how the arm is bent."""
        return self.pointer.sites

    def behaviours(self) -> Mapping[str, Behaviour]:
        """Candidate frames over time, and the teacher."""
        fit = partial(fit_over_time, components=self.components, factors=self.factors)
        goals = {
            f"bearing of {name}": Goal(
                self.pointer.bearing(name), SHOWN, since + HELD, until - HELD
            )
            for name, (since, until) in PHASES.items()
        }
        return {
            self.name: Behaviour(
                self.pointer.views,
                self.shown_by,
                fit,
                goals,
                CUTOFF[self.teacher],
                "Point the arm at one object, hold, then at the other, hold, and go back to rest.",
            )
        }

    def situation(self, world: World, rng: np.random.Generator) -> Situation:
        """Draw a start near rest, and objects that the teacher could point at."""
        teacher = self.shown_by
        for _ in range(DRAWS):
            start, objects = teacher.rest(world, rng), teacher.objects(world, rng)
            if all(teacher.can_aim(world, path, rng) for path in objects):
                return Situation(tuple(start.tolist()), objects)
        raise SimulationError(
            f"the arm of robot '{self.robot}' cannot point at objects on the table before it: of "
            f"{DRAWS} pairs of places none is within its reach, off its joint limits; give a robot "
            "with another home"
        )

    def controller(self, world: World, models: Models, situation: Situation) -> TimedIntervention:
        """Point at the objects, wherever they move; joints that were not taught hold the start."""
        deviation = np.full(world.robot.n, self.hold)
        # 10 rad say nothing about the arm.
        deviation[world.robot.index(self.pointer.joints)] = 10.0
        return TimedIntervention(
            Skill(self.pointer.views, models[self.name]),
            effort=self.effort * acceleration_effort(world.robot),
            until=self.duration,
            prior=Gaussian(np.array(situation.start), np.diag(deviation**2)),
            order=self.order,
        )

    def goals(self) -> Mapping[str, Goal]:
        """Point at each object while it is time to; be at rest in the end."""
        pointer, robot = self.pointer, self.stage.robot
        pointing = {name: Goal(pointer.bearing(name), POINTED, *PHASES[name]) for name in OBJECTS}
        resting = Joints(pointer.joints).minus(robot.home[robot.index(pointer.joints)])
        return pointing | {"rest": Goal(resting, RESTED, since=SCHEDULE[-2])}


def fit_over_time(demonstrations: Sequence[Demonstration], components: int, factors: int) -> TPGMM:
    """TP-GMM over time and all frames, Eq. (20), by mixtures of factor analysers."""
    timed = [demonstration.with_time() for demonstration in demonstrations]
    return fit_tp_gmm(timed, components, covariance=MFA(factors), start="time")
