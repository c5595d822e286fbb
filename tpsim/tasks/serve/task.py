"""Take the cup, let sugar fall in, pour it out into the bowl, put the cup back: a whole scene.

What hands see of objects and of each other over time (Eq. 20) is learned as one mixture over all
phases: full covariances, K > 1 in every frame. Which frame matters in which phase is what it saw
consistently then: the dock where the cup is taken and put, the base where it is carried level, the
other hand where sugar falls, the bowl where the cup is tilted. Regression over time and the product
of all frames at every moment is one impedance of both arms, which changes from phase to phase.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar, Literal

import numpy as np

from tpsim.border import Count, Positive, Share
from tpsim.controllers.product import Skill
from tpsim.controllers.timed_intervention import PERIOD, TimedIntervention
from tpsim.controllers.torque_cost import acceleration_effort
from tpsim.demonstration import Demonstration
from tpsim.gaussian import Gaussian
from tpsim.learning.dtw import align
from tpsim.learning.subspace import FULL, HDDC, MFA, Structure
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.robot.indices import Chain
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Object, Site
from tpsim.robot.views.view import View
from tpsim.task.task import Behaviour, Goal, Models, Situation, Task
from tpsim.tasks.serve import scene, teacher
from tpsim.tasks.serve.progress import HandsProgress
from tpsim.tasks.serve.teacher import MOVEMENT
from tpsim.tasks.serve.things import Thing
from tpsim.world.people.demonstrator import CUTOFF, TeacherName
from tpsim.world.world import World

LEFT, RIGHT = Site(scene.LEFT), Site(scene.RIGHT)

UPRIGHT = scene.CUP.in_hand.inverse.rotation
"""Rotation of the left hand while it holds the cup upright, as seen from what has its heading."""

DOWN = scene.SUGAR.in_hand.inverse.rotation
"""The same of the right hand, which points down."""


def _upright_in_base(hand: np.ndarray, heading: float) -> np.ndarray:
    """A hand's rotation in the base, where what it holds has a heading: the chart's middle."""
    c, s = np.cos(heading), np.sin(heading)
    turned: np.ndarray = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ hand
    return turned


VIEWS: Mapping[str, View] = {
    "cup hand from dock": LEFT.seen_from(Object("dock")).position,
    "cup hand turned from dock": LEFT.seen_from(Object("dock")).orientation.about(UPRIGHT),
    "cup hand from bowl": LEFT.seen_from(Object("bowl")).position,
    "cup hand turned from bowl": LEFT.seen_from(Object("bowl")).orientation.about(UPRIGHT),
    "cup hand in base": LEFT.position,
    "cup hand turned in base": LEFT.orientation.about(_upright_in_base(UPRIGHT, teacher.HEADING)),
    "sugar hand from its dock": RIGHT.seen_from(Object("sugar_dock")).position,
    "sugar hand turned from its dock": RIGHT.seen_from(Object("sugar_dock")).orientation.about(
        DOWN
    ),
    "sugar hand from cup hand": RIGHT.seen_from(LEFT).position,
    "sugar hand in base": RIGHT.position,
    "sugar hand turned in base": RIGHT.orientation.about(
        _upright_in_base(DOWN, scene.HOME["sugar_dock"][1])
    ),
    "left posture": Joints(Chain(scene.LEFT)).spare(LEFT.pose),
    "right posture": Joints(Chain(scene.RIGHT)).spare(RIGHT.pose),
}
"""Candidate frames: hands from objects and in the base, one from the other, spare joints."""

_CUP_SEEN: list[tuple[str | None, int, int, np.ndarray]] = [
    ("dock", 0, 1, UPRIGHT),
    ("bowl", 2, 3, UPRIGHT),
    (None, 4, 5, _upright_in_base(UPRIGHT, teacher.HEADING)),
]
"""Frames that see the hand with the cup, for progress."""

_SUGAR_SEEN: list[tuple[str | None, int]] = [("sugar_dock", 6), (None, 9)]
"""Frames that see where the other hand is."""

_BETWEEN = 8
"""Frame in which the hand with the cup sees the other one."""

STRUCTURES: Mapping[str, Structure] = {"full": FULL, "mfa": MFA(1), "hddc": HDDC(1)}
"""Covariances that can be learned, by name."""

Covariance = Literal["full", "mfa", "hddc"]

FINEST = {"position": 0.0015, "angle": 0.01, "posture": 0.05}
"""Standard deviations [m], [rad] below which no hand can lead: a rest that happened to be the same
in a few demonstrations is no more precise than that."""

GOALS = {
    "sugar in the bowl": Goal(Thing("sugar", "bowl"), 0.09, since=-0.2),
    "cup in the dock": Goal(Thing("cup", "dock", scene.STANDS), 0.008, since=-0.2),
}
"""What the teacher keeps to, at the end [m]."""


@dataclass(frozen=True)
class Serve(Task):
    """Take the cup, have sugar fall in, pour it out into the bowl and put the cup back.

    Parameters
    ----------
    effort : float
        Cost of acceleration, beside that with which a usual deviation is worth what springs may
        pull (:func:`~tpsim.controllers.torque_cost.acceleration_effort`).
    components : int
        Gaussians of the movement.
    covariance : str
        ``"full"``, or learned factors: ``"mfa"``, ``"hddc"``.
    samples : int
        Samples of a demonstration from which the model is learned.
    warp : float
        Share of the movement by which demonstrations may be out of step before they are aligned.
    progress : str
        Whether the movement goes by the hands' own ``"state"``, so that who holds one stops it, or
        by the ``"clock"`` (docs/serve.md).
    teacher : str
        Whose hands show it: ``"human"``, as measured in people, or ``"firm"``, firmer and finer.
    """

    effort: Positive = 1.0
    components: Count = 32
    covariance: Covariance = "full"
    samples: Count = 360
    warp: Share = 0.05
    progress: Literal["state", "clock"] = "state"
    teacher: TeacherName = "firm"

    duration: ClassVar[float] = MOVEMENT + 1.0
    demonstrations: ClassVar[int] = 8

    def world(self) -> World:
        """Baxter at a table with dock, sugar and bowl; cup and sugar can be taken."""
        return scene.stage()

    def sites(self) -> dict[str, str]:
        """Both hands and elbows."""
        return self.stage.robot.hands | {
            f"{side}_elbow": f"{side}_elbow" for side in ("left", "right")
        }

    def behaviours(self) -> Mapping[str, Behaviour]:
        """One movement of both hands, seen from all objects."""
        shown = partial(teacher.lesson, teacher=self.teacher)
        return {"serve": Behaviour(VIEWS, shown, self._fit, GOALS, CUTOFF[self.teacher])}

    def _fit(self, seen: Sequence[Demonstration]) -> TPGMM:
        """A TP-GMM over time and all frames, of demonstrations brought onto one time."""
        clock = np.linspace(0.0, MOVEMENT, self.samples)
        views = [demonstration.resampled(self.samples) for demonstration in seen]
        aligned = align(views, by="frames", band=self.warp * self.samples)
        timed = [view.with_time(clock) for view in aligned]
        structure = STRUCTURES[self.covariance]
        found = fit_tp_gmm(timed, self.components, covariance=structure, start="time")
        frames = [
            Gaussian(frame.mean, frame.covariance + np.diag([0.0, *self._floor(view)]))
            for view, frame in zip(VIEWS.values(), found.frames, strict=True)
        ]
        return replace(found, frames=tuple(frames))

    def _floor(self, view: View) -> list[float]:
        """Variance of a view that no hand can do without."""
        return [FINEST[kind] ** 2 for kind in view.kinds(self.stage.robot)]

    def situation(self, world: World, rng: np.random.Generator) -> Situation:
        """Draw objects within the taught range, and a posture with both hands ready."""
        placed = scene.draw(rng)
        start = teacher.posture(world, *teacher.ways(placed, rng), rng)
        return Situation(tuple(start), scene.at_rest(placed))

    def controller(self, world: World, models: Models, situation: Situation) -> TimedIntervention:
        """Regression over time in every frame, then the product of all of them."""
        model = models["serve"]
        hands, by_state = (scene.LEFT, scene.RIGHT), self.progress == "state"
        seen = _CUP_SEEN, _SUGAR_SEEN, _BETWEEN
        return TimedIntervention(
            Skill(VIEWS, model),
            effort=self.effort * acceleration_effort(world.robot),
            until=MOVEMENT,
            progress=HandsProgress(model, *seen, hands, MOVEMENT, PERIOD) if by_state else None,
        )

    def goals(self) -> dict[str, Goal]:
        """Sugar in the bowl, and the cup in its dock."""
        return dict(GOALS)
