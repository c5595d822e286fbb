"""Carry from one dock into another along a learned approach (U-shaped frames of Figs 1, 2, 12).

Every dock sees the gripper's position and orientation over time (Eq. 20), each as a frame of its
own; the arm's posture is one more frame. What a frame saw consistently is precise there: near the
docks the way of leaving and entering them. The movement is retrieved by GMR in each frame, and
tracked by the LQT of all frames at once over the finite horizon (Eq. 38), wherever the docks go.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import ClassVar, Literal

import numpy as np

from tpsim.border import Positive
from tpsim.catalogue.robots import find
from tpsim.control.poses import SeenMovement
from tpsim.controllers.finite_horizon import FiniteHorizon, effort_of
from tpsim.controllers.minimal_intervention import bandwidth_for
from tpsim.demonstration import Demonstration
from tpsim.errors import SimulationError
from tpsim.gaussian import Gaussian
from tpsim.learning.dtw import align
from tpsim.learning.gmm import GMM
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.pose import Pose
from tpsim.retrieval.gmr import gmr
from tpsim.robot.indices import Chain
from tpsim.robot.robot import Robot
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Object, Site
from tpsim.scene.compose import Held, Placed
from tpsim.task.task import Behaviour, Goal, Models, Situation, Task
from tpsim.tasks.one_hand import furnished
from tpsim.tasks.transfer import docks
from tpsim.tasks.workplace import DEFAULT, size_for, size_of
from tpsim.world.object_path import put_objects
from tpsim.world.people.demonstrator import CUTOFF, TeacherName
from tpsim.world.perception import Perception
from tpsim.world.rehearsal import hindrance
from tpsim.world.teaching import Lesson
from tpsim.world.trial import Trial
from tpsim.world.world import World

MOVEMENT = sum(docks.SECONDS) / 2 + 2 * docks.REST
"""Time of the movement [s], as it was taught on average; its end then lasts."""

DT = MOVEMENT / round(MOVEMENT * 2 * np.pi * bandwidth_for())
"""Time step of the plan [s]. No gain of it is faster than 1/DT: the natural frequency that the
control loop can bear."""

ARRIVED = {"position": 0.005, "orientation": float(np.radians(3.0))}
"""Distance [m] and angle [rad] from the place in the second dock at which the hand is there."""

MISSED = 10.0
"""How many times farther than that the hand counts as unable to reach it."""

# Apart, since a few demonstrations do not show how position and orientation depend on each other.
SEEN = {
    (name, part): view
    for name in docks.NAMES
    for part, view in (
        ("position", Site(docks.GRIPPER).seen_from(Object(name)).position),
        (
            "orientation",
            Site(docks.GRIPPER).seen_from(Object(name)).orientation.about(docks.HELD[name]),
        ),
    )
}
"""Parts of the hand's pose as each dock sees them, Eq. (41)."""

VIEWS = {f"{part} from {name}": view for (name, part), view in SEEN.items()} | {
    "posture": Joints(Chain(docks.GRIPPER))
}
"""Candidate frames: position and orientation from each dock, and the arm's posture."""


GOALS = {
    "position in the second dock": Goal(SEEN["end", "position"], 0.01, since=-0.3),
    "orientation in the second dock": Goal(SEEN["end", "orientation"], np.radians(5), since=-0.3),
}
"""What the teacher keeps to: the hand ends at its place in the second dock [m], [rad]."""


@dataclass(frozen=True)
class Transfer(Task):
    """Carry a sugar cube from the first dock into the second, with a left arm.

    Parameters
    ----------
    robot : str
        One of the catalogue (``tpsim robots``), or of a file of yours.
    effort : float
        Cost of torque, over that with which a usual deviation is worth all that springs may pull
        (:func:`~tpsim.controllers.finite_horizon.effort_of`): with 4 the arm is half as stiff.
    components : int
        Gaussians of the movement.
    samples : int
        Samples of a demonstration from which the model is learned.
    warp : float
        Share of the movement by which demonstrations may be out of step before they are aligned.
    progress : str
        Whether the movement goes by the ``"clock"``, or by the hand's own ``"state"``: who holds
        it stops the movement, who pushes it on speeds it up (docs/progress.md).
    teacher : str
        Whose hands show it: ``"human"``, as measured in people, or ``"firm"``, firmer and finer.
    perception : Perception
        How the docks are seen in the trials that are not told where they are.
    """

    robot: str = DEFAULT
    effort: Positive = 1.0
    components: int = 10
    samples: int = 150
    warp: float = 0.1
    progress: Literal["clock", "state"] = "clock"
    teacher: TeacherName = "firm"
    perception: Perception = Perception()  # noqa: RUF009 - a frozen value

    duration: ClassVar[float] = MOVEMENT + 1.5
    demonstrations: ClassVar[int] = 12

    @property
    def size(self) -> float:
        """Of the arm, beside the default robot's."""
        return size_for(self.robot, lambda: self.stage)

    def world(self) -> World:
        """The robot with a sugar cube in its left hand, and two docks."""
        return _world(self.robot)

    def sites(self) -> dict[str, str]:
        """The hand that carries, and its elbow."""
        return {"left_hand": docks.GRIPPER, "left_elbow": "left_elbow"}

    def behaviours(self) -> Mapping[str, Behaviour]:
        """One movement, seen from both docks."""
        shown = partial(lesson, teacher=self.teacher)
        return {"transfer": Behaviour(VIEWS, shown, self._fit, GOALS, CUTOFF[self.teacher])}

    def _fit(self, seen: Sequence[Demonstration]) -> TPGMM:
        """A TP-GMM over time and all frames, of demonstrations brought onto one time."""
        clock = np.linspace(0.0, MOVEMENT, self.samples)
        views = [demonstration.resampled(self.samples) for demonstration in seen]
        aligned = align(views, by="frames", band=self.warp * self.samples)
        timed = [view.with_time(clock) for view in aligned]
        return fit_tp_gmm(timed, self.components, start="time")

    def situation(self, world: World, rng: np.random.Generator, far: bool = False) -> Situation:
        """Draw docks, and a posture with the hand in the first one; ``far`` beyond the taught.

        Far away not every draw can be carried out by anybody: one that the teacher's hand could
        lead the arm through is asked for.
        """
        placed = docks.draw(world.robot, rng, far)
        start = docks.start_posture(world, placed, rng)
        if far:
            why = hindrance(world, lesson_between(world, placed, start, rng, self.teacher))
            if why:
                raise SimulationError(f"the teacher cannot carry between these docks: {why}")
        return Situation(tuple(start), docks.at_rest(placed))

    def controller(self, world: World, models: Models, situation: Situation) -> FiniteHorizon:
        """GMR over time in every frame, then LQT of all of them."""
        model, joints = models["transfer"], arm(world.robot, docks.GRIPPER)
        times = np.linspace(0.0, MOVEMENT, round(MOVEMENT / DT) + 1)
        *seen, posture = (gmr(GMM(model.priors, frame), times) for frame in model.frames)
        movements = []
        for name, *parts in zip(docks.NAMES, seen[::2], seen[1::2], strict=True):
            precision = np.zeros((len(times), 6, 6))
            precision[:, :3, :3], precision[:, 3:, 3:] = (part.precision for part in parts)
            mean = np.hstack([gaussian.mean for gaussian in parts])
            movements.append(SeenMovement(mean, precision, docks.HELD[name]))
        return FiniteHorizon(
            world.robot,
            docks.NAMES,
            movements,
            # Too few demonstrations to tell how seven joints depend on each other.
            Gaussian(posture.mean, posture.covariance * np.eye(posture.dim)),
            joints=joints,
            site=docks.GRIPPER,
            dt=DT,
            effort=self.effort * effort_of(world.robot, joints),
            chain=stays(model, times) if self.progress == "state" else None,
        )

    def goals(self) -> dict[str, Goal]:
        """The hand at its place in the second dock."""
        return {part: Goal(SEEN["end", part], enough) for part, enough in ARRIVED.items()}

    def outcome(self, trial: Trial) -> str:
        """``"unreachable"`` where the hand ends far from the second dock."""
        if trial.outcome == "diverged" or trial.outcome.startswith("unseen"):
            return trial.outcome
        last = {name: Pose(R[-1], p[-1]) for name in docks.NAMES for R, p in [trial.pose(name)]}
        state = self.stage.robot.at(trial["q"][-1], objects=last)
        missed = any(
            np.linalg.norm(SEEN["end", part](state).value) > MISSED * enough
            for part, enough in ARRIVED.items()
        )
        return "unreachable" if missed else trial.outcome


def stays(model: TPGMM, times: np.ndarray) -> SemiMarkovChain:
    """Which of a model's components are passed in turn at times (T,), and for how many of them."""
    component = GMM(model.priors, model.frames[0].marginal([0])).responsibilities(times[:, None])
    return SemiMarkovChain.along(component.argmax(1))


def lesson(world: World, rng: np.random.Generator, teacher: TeacherName = "firm") -> Lesson:
    """Draw docks within the taught range, and how a person carries between them."""
    placed = docks.draw(world.robot, rng)
    return lesson_between(world, placed, docks.start_posture(world, placed, rng), rng, teacher)


def lesson_between(
    world: World,
    placed: docks.Docks,
    start: np.ndarray,
    rng: np.random.Generator,
    teacher: TeacherName = "firm",
) -> Lesson:
    """How a person carries between given docks."""
    pace = docks.PACE[teacher]
    seconds = pace * rng.uniform(*docks.SECONDS)
    guide = docks.guide(world, placed, seconds, rng, teacher)
    carries = arm(world.robot, docks.GRIPPER)
    held = tuple(joint for joint in world.robot.joints if joint not in carries)
    return Lesson(start, (guide,), seconds + 2 * pace * docks.REST, held, docks.at_rest(placed))


def arm(robot: Robot, site: str) -> tuple[str, ...]:
    """Joints of the arm of a hand."""
    return tuple(robot.joints[i] for i in robot.chain(site))


@lru_cache(maxsize=4)
def _world(name: str) -> World:
    """The world of a robot with its docks: solid, unless its hand is too wide for them."""
    robot = find(name)
    held = {"sugar": Held("sugar", docks.GRIPPER, (0, 0, 0.006))}
    size = size_of(robot)
    for solid in (True, False):
        objects = {
            dock: Placed("dock", tuple(pose.position.tolist()), size=size, solid=solid)
            for dock, pose in docks.home(robot).items()
        }
        found = furnished(robot, name, objects, held)
        if _fits(found):
            break
    return found


def _fits(world: World) -> bool:
    """Whether the hand is in the first dock without touching it."""
    simulation, placed = world.simulation(), docks.home(world.robot)
    try:
        simulation.reset(docks.start_posture(world, placed, np.random.default_rng(0)))
    except SimulationError:
        return True  # so far away nothing is said about its size
    put_objects(docks.at_rest(placed), simulation)
    return not simulation.touches
