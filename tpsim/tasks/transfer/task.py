"""Carry from one dock into another along a learned approach (U-shaped frames of Figs 1, 2, 12).

Every dock sees the gripper's position and orientation over time (Eq. 20), each as a frame of its
own; the arm's posture is one more frame. What a frame saw consistently is precise there: near the
docks the way of leaving and entering them. The movement is retrieved by GMR in each frame, and
tracked by the LQT of all frames at once over the finite horizon (Eq. 38), wherever the docks go.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated, ClassVar, Literal

import numpy as np

from tpsim.agreement import agree
from tpsim.border import Count, Positive, Range, Share
from tpsim.controllers.finite_horizon import FiniteHorizon
from tpsim.controllers.optimal import bandwidth_for
from tpsim.controllers.seen_poses import POSE
from tpsim.controllers.torque_cost import effort_of
from tpsim.demonstration import Demonstration
from tpsim.errors import SimulationError
from tpsim.gaussian import Gaussian
from tpsim.learning.dtw import align
from tpsim.learning.gmm import GMM
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import R
from tpsim.pose import Pose
from tpsim.retrieval.gmr import gmr
from tpsim.robot.indices import Chain
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Object, Site
from tpsim.robot.views.view import View
from tpsim.task.task import Behaviour, Goal, Models, Situation, Task
from tpsim.tasks.transfer import docks
from tpsim.tasks.transfer.arrangement import arranged, furnished_with_docks
from tpsim.tasks.transfer.teacher import arm, lesson, lesson_between
from tpsim.tasks.workplace import DEFAULT, size_for
from tpsim.world.people.demonstrator import CUTOFF, TeacherName
from tpsim.world.perception import Perception
from tpsim.world.rehearsal import hindrance
from tpsim.world.trial import Trial
from tpsim.world.world import World

LASTS = 1.5
"""Time [s] for which a trial goes on when the movement is over."""

DT = 1 / (2 * np.pi * bandwidth_for())
"""Time step of the plan [s], about. No gain of it is faster than 1/DT: the natural frequency that
the control loop can bear."""

TICKS = 2
"""Steps of the plan between two looks at how far the hand has come: in some 0.03 s it moves."""

ARRIVED = {"position": 0.005, "orientation": float(np.radians(3.0))}
"""Distance [m] and angle [rad] from the place in the second dock at which the hand is there."""

UNHURRIED = 1.5
"""How much longer a teacher takes where the hand must turn far."""

Apart = Annotated[float, Range(least=0, below=180)]
"""Angle [deg]; at half a turn either way round is as good."""

MISSED = 10.0
"""How many times farther than that the hand counts as unable to reach it."""

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
"""How far the hand is from its place in each dock, Eq. (41): zero where it is in it."""

# Apart, since a few demonstrations do not show how position and orientation depend on each other.
VIEWS: dict[str, View] = {
    f"{part} from {name}": view
    for name in docks.NAMES
    for part, view in (
        ("position", SEEN[name, "position"]),
        ("orientation", Site(docks.GRIPPER).seen_from(Object(name)).quaternion),
    )
} | {"posture": Joints(Chain(docks.GRIPPER))}
"""Candidate frames: position (R3) and orientation (S3) from each dock, and the arm's posture."""


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
        (:func:`~tpsim.controllers.torque_cost.effort_of`): with 4 the arm is half as stiff.
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
    apart : float
        Angle [deg] up to which the hand must turn between the docks in further situations of the
        study, from half of it on; by default there are none of these.
    """

    robot: str = DEFAULT
    effort: Positive = 1.0
    components: Count = 10
    samples: Count = 150
    warp: Share = 0.1
    progress: Literal["clock", "state"] = "clock"
    teacher: TeacherName = "firm"
    perception: Perception = Perception()  # noqa: RUF009 - a frozen value
    apart: Apart = 0.0

    demonstrations: ClassVar[int] = 12

    @property
    def size(self) -> float:
        """Of the arm, beside the default robot's."""
        return size_for(self.robot, lambda: self.stage)

    @property
    def layout(self) -> docks.Layout:
        """Where the docks are for this arm, and how fast it is led."""
        return arranged(self.robot).layout

    @property
    def duration(self) -> float:  # type: ignore[override]  # slow arms take longer
        """Of the movement, and a while in which its end lasts [s]."""
        return self.layout.movement + LASTS

    def world(self) -> World:
        """The robot with a sugar cube in its left hand, and two docks."""
        return furnished_with_docks(self.robot)

    def sites(self) -> dict[str, str]:
        """The hand that carries, and its elbow."""
        return {"left_hand": docks.GRIPPER, "left_elbow": "left_elbow"}

    def behaviours(self) -> Mapping[str, Behaviour]:
        """One movement, seen from both docks."""
        shown = partial(lesson, teacher=self.teacher, layout=self.layout)
        return {"transfer": Behaviour(VIEWS, shown, self._fit, GOALS, CUTOFF[self.teacher])}

    def _fit(self, seen: Sequence[Demonstration]) -> TPGMM:
        """A TP-GMM over time and all frames, of demonstrations brought onto one time."""
        clock = np.linspace(0.0, self.layout.movement, self.samples)
        views = [demonstration.resampled(self.samples) for demonstration in seen]
        own = [view.manifold(self.stage.robot) for view in VIEWS.values()]
        # Neither q nor -q is the better one; which of them a camera or a script says is no news.
        aligned = align(agree(views), by="frames", band=self.warp * self.samples, manifold=own)
        timed = [view.with_time(clock) for view in aligned]
        seen_in_time = [R(1, "inputs") * one for one in own]
        return fit_tp_gmm(timed, self.components, start="time", manifold=seen_in_time)

    def situation(
        self,
        world: World,
        rng: np.random.Generator,
        far: bool = False,
        apart: float = 0.0,
    ) -> Situation:
        """Draw docks, and a posture with the hand in the first one.

        They are ``far`` beyond the taught, or ``apart`` [deg] as the field says. Not every such
        draw can be carried out by anybody: one that the teacher's hand could lead the arm through
        is asked for.
        """
        pace = self.layout.pace
        if apart:
            placed = docks.draw_turned(world.robot, rng, np.radians(apart), self.layout)
            pace *= UNHURRIED
        else:
            placed = docks.draw(world.robot, rng, far, self.layout)
        start = docks.start_posture(world, placed, rng)
        if far or apart:
            led = lesson_between(world, placed, start, rng, self.teacher, pace)
            # Between docks that stand in each other's way the straight way leads through walls.
            why = hindrance(world, led, stride=1)
            if why:
                raise SimulationError(f"the teacher cannot carry between these docks: {why}")
        return Situation(tuple(start), docks.at_rest(placed))

    def controller(self, world: World, models: Models, situation: Situation) -> FiniteHorizon:
        """GMR over time in every frame, then LQT of all of them.

        A few demonstrations tell how far a hand spreads along and about the axes of a dock, and
        joints of the arm, but not how these depend on each other: by chance some oblique turn is
        seen to keep still that nobody cared for, and a product over docks believes it.
        """
        model, joints = models["transfer"], arm(world.robot, docks.GRIPPER)
        movement = self.layout.movement
        times = np.linspace(0.0, movement, round(movement / DT) + 1)
        *seen, posture = (gmr(GMM(model.priors, frame), times) for frame in model.frames)
        movements = []
        for parts in zip(seen[::2], seen[1::2], strict=True):
            covariance = np.zeros((len(times), 6, 6))
            covariance[:, :3, :3], covariance[:, 3:, 3:] = (
                part.covariance * np.eye(3) for part in parts
            )
            mean = np.hstack([gaussian.mean for gaussian in parts])
            movements.append(RiemannianGaussian.trusted_on(POSE, mean, covariance))
        return FiniteHorizon(
            world.robot,
            docks.NAMES,
            movements,
            Gaussian(posture.mean, posture.covariance * np.eye(posture.dim)),
            joints=joints,
            site=docks.GRIPPER,
            dt=float(times[1]),
            effort=self.effort * effort_of(world.robot, joints),
            chain=stays(model, times[::TICKS]) if self.progress == "state" else None,
            shown=round(model.samples / self.samples) or None,
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
