"""Two behaviours taught apart: hold a cup level, hold a sugar cube above it (Section 6, Fig. 9).

``cup-and-sugar`` performs the product of the two learned controllers.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import ClassVar, Literal

import numpy as np

from tpsim.border import Count, NotNegative, Positive
from tpsim.catalogue.robots import find
from tpsim.controllers.minimal_intervention import MinimalIntervention
from tpsim.controllers.product import Skill
from tpsim.controllers.torque_cost import acceleration_effort
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import fit_tp_gmm
from tpsim.scene.compose import world
from tpsim.task.task import Behaviour, Goal, Models, Situation, Task
from tpsim.tasks.cup_and_sugar import cup, sugar
from tpsim.tasks.cup_and_sugar.hands import Hands
from tpsim.tasks.cup_and_sugar.home import home
from tpsim.tasks.workplace import (
    DEFAULT,
    Workplace,
    between,
    size_for,
    two_hands,
    with_spare_joints,
)
from tpsim.world.people.demonstrator import CUTOFF, TeacherName
from tpsim.world.rehearsal import Rehearsed
from tpsim.world.world import World

PARTS = ("gripper", "elbow")
"""Parts of arms that are above the table."""

ASKS = {
    "cup": "Lead the left hand anywhere, and keep its cup level.",
    "sugar": "Lead the left hand anywhere: the sugar follows above its cup.",
}
"""What a person is asked to show."""

_ROOMS = {"cup": cup, "sugar": sugar}


@dataclass(frozen=True)
class CupAndSugar(Task):
    """One or both of the behaviours.

    Parameters
    ----------
    taught : tuple of str
        Behaviours: ``"cup"``, ``"sugar"`` or both.
    robot : str
        Two arms of the catalogue (``tpsim robots``), or of a file of yours.
    room : float
        Share of the workspace that is taught and tried: 1 for what arms of this length usually
        reach.
    effort : float
        Cost of acceleration, beside that with which a usual deviation is worth what springs may
        pull (:func:`~tpsim.controllers.torque_cost.acceleration_effort`).
    bandwidth : float, optional
        Natural frequency [Hz] that no direction exceeds; by default as fast as the control loop
        allows.
    friction : float
        What a person feels who leads a hand where it is free [Ns/m].
    components : int
        Gaussians of each behaviour.
    hold : float
        Standard deviation [rad] with which joints that no behaviour was taught hold their start.
    teacher : str
        Whose hands show it: ``"human"``, as measured in people, or ``"firm"``, firmer and finer.
    """

    taught: tuple[Literal["cup", "sugar"], ...] = ("cup", "sugar")
    robot: str = DEFAULT
    room: Positive = 1.0
    effort: Positive = 1.0
    bandwidth: Positive | None = None
    friction: NotNegative = 180.0
    components: Count = 1
    hold: Positive = 0.1
    teacher: TeacherName = "human"

    duration: ClassVar[float] = 6.0

    @property
    def name(self) -> str:
        """``cup``, ``sugar`` or ``cup-and-sugar``."""
        return "-and-".join(self.taught)

    @property
    def size(self) -> float:
        """Of the arms, beside the default robot's."""
        return size_for(self.robot, lambda: self.stage)

    def world(self) -> World:
        """The robot with a cup in its left hand and a sugar cube in its right one."""
        return _world(self.robot, self.room, self.name)

    def sites(self) -> dict[str, str]:
        """Hands, what they hold, and elbows."""
        return self.stage.robot.hands | {
            name: name for name in ("cup", "sugar", "left_elbow", "right_elbow")
        }

    def behaviours(self) -> Mapping[str, Behaviour]:
        """Candidate frames and teachers."""
        fit = partial(fit_tp_gmm, components=self.components)
        goals = {"cup": cup.GOALS, "sugar": sugar.goals(Hands(self.stage).above.position)}
        shown = {"teacher": self.teacher, "room": self.room}
        return {
            name: Behaviour(
                with_spare_joints(_ROOMS[name].VIEWS, self.stage.robot),
                Rehearsed(partial(_ROOMS[name].lesson, **shown)),
                fit,
                goals[name],
                CUTOFF[self.teacher],
                ASKS[name],
                others="following",
            )
            for name in self.taught
        }

    def situation(self, world: World, rng: np.random.Generator) -> Situation:
        """Draw a start posture: level cup, and sugar above it where that was taught."""
        return Situation(tuple(_ROOMS[self.taught[-1]].start(Hands(world, room=self.room), rng)))

    def controller(self, world: World, models: Models, situation: Situation) -> MinimalIntervention:
        """The product of all frames of the behaviours."""
        skills = [Skill(b.views, models[name]) for name, b in self.behaviours().items()]
        prior = None
        if self.taught == ("cup",):
            # The right arm was not taught: it holds still. 10 rad say nothing about the left one.
            deviation = np.full(world.robot.n, 10.0)
            deviation[world.robot.chain(sugar.RIGHT.name)] = self.hold
            prior = Gaussian(np.array(situation.start), np.diag(deviation**2))
        return MinimalIntervention(
            skills,
            effort=self.effort * acceleration_effort(world.robot),
            bandwidth=self.bandwidth,
            friction=self.friction,
            prior=prior,
        )

    def goals(self) -> dict[str, Goal]:
        """A level cup, and the sugar at its place above it."""
        return {
            name: goal
            for name, behaviour in self.behaviours().items()
            for goal in behaviour.goals.values()
        }


@lru_cache(maxsize=4)
def _world(name: str, room: float, task: str) -> World:
    """The world of a robot: home is looked for, once, and then the table is put below it."""
    robot = two_hands(find(name), task)
    place = Workplace.of(robot)
    held, there = home(robot, name, room)
    arms = [there.at_home.pose(f"{side}_{part}") for side in ("left", "right") for part in PARTS]
    lowest = min(float(pose.position[2]) for pose in arms)
    furnished = world(
        robot,
        objects=place.furniture(lowest),
        held=held,
        floor=place.floor,
        cameras=place.cameras(between(there), np.array([pose.position for pose in arms])),
    )
    return furnished.with_home(there.home)
