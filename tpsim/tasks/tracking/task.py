"""Tracking two moving objects with two hands that share a trunk (Section 7, Fig. 11).

At times the objects are too far apart. A teacher leads the hands through three behaviours, each
taught apart: the left object counts more, the right one does, or both alike. The candidate frames
are each hand seen from its object, Eq. (41), and each hand in the nullspace of the other,
Eq. (44): how precise the demonstrations are in these four decides in reproduction who has priority.
A fifth frame, the arms' posture in the nullspace of both hands (Eq. 42), bends what is left.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from tpsim.border import Count, NotNegative, Positive
from tpsim.catalogue.ours import planar5
from tpsim.controllers.product import Skill
from tpsim.controllers.pursuit import Pursuit
from tpsim.controllers.torque_cost import acceleration_effort
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.learning.shrinkage import shrink_directions
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Object, Site
from tpsim.robot.views.view import View
from tpsim.task.task import Behaviour, Goal, Models, Situation, Task
from tpsim.tasks.planar import on_the_floor
from tpsim.tasks.tracking.body import SIDES, TEACHINGS, Body, Teaching
from tpsim.tasks.tracking.carousel import PERIOD, SECONDS, Carousel, paths, points
from tpsim.tasks.tracking.teacher import TrackingTeacher
from tpsim.world.people.demonstrator import CUTOFF, TeacherName
from tpsim.world.world import World

HANDS: Mapping[str, View] = {
    side: Site(f"{side}_hand").seen_from(Object(f"{side}_object")).position[:2] for side in SIDES
}
"""Each hand as its object sees it, in the plane, Eq. (41): zero while the hand is there."""

ARMS = ("left_shoulder", "left_elbow", "right_shoulder", "right_elbow")
"""Joints that are not the trunk's."""

REACHED = 0.01
"""Distance [m] up to which a hand is at its object."""


SHOWN = 0.03
"""Distance [m] from its object up to which the teacher keeps the hand that comes first."""


@dataclass(frozen=True)
class Tracking(Task):
    """Follow two objects with two hands, as one of the behaviours was taught.

    Parameters
    ----------
    taught : tuple of str
        Teachings: ``"left"``, ``"right"``, ``"compromise"``. Each is a behaviour by itself; the
        learned controller performs the first one.
    effort : float
        Cost of acceleration, beside that with which a usual deviation is worth what springs may
        pull (:func:`~tpsim.controllers.torque_cost.acceleration_effort`).
    components : int
        Gaussians of each behaviour.
    structure : str
        Of the covariances. ``"spherical"``: one precision for each frame, alike in all
        directions. ``"learned"``: of full covariances as much of the shape as so many
        demonstrations support (:func:`tpsim.shrink_directions`); with two components it keeps
        who comes first, but not the split of a compromise (docs/priorities.md).
    bend : float
        Curvature of a hand's way as its arm stretches [m/rad^2]: the length of one link.
    carousel : Carousel
        How the objects move.
    teacher : str
        Whose hands show it: ``"human"``, as measured in people, or ``"firm"``, firmer and finer.
    """

    taught: tuple[Teaching, ...] = TEACHINGS
    effort: Positive = 1.0
    components: Count = 1
    structure: Literal["spherical", "diagonal", "full", "learned"] = "spherical"
    bend: NotNegative = 0.3
    carousel: Carousel = Carousel()  # noqa: RUF009 - a frozen value
    teacher: TeacherName = "firm"

    duration: ClassVar[float] = SECONDS

    @property
    def name(self) -> str:
        """``tracking``, or the name of some of its behaviours."""
        return "tracking" if self.taught == TEACHINGS else "-".join(("tracking", *self.taught))

    def world(self) -> World:
        """The trunk with two arms, and two objects."""
        return on_the_floor(planar5(), [f"{side}_object" for side in SIDES], fovy=30)

    def views(self) -> Mapping[str, View]:
        """Both hands from their objects, each beneath the other, and the posture beneath both."""
        left, right = HANDS.values()
        return {
            "left hand": left,
            "right beneath left": right.beneath(left, bend=self.bend),
            "left beneath right": left.beneath(right, bend=self.bend),
            "right hand": right,
            "posture": Joints(ARMS).beneath(left, right),
        }

    def behaviours(self) -> Mapping[str, Behaviour]:
        """The same candidate frames of every teaching."""
        return {
            behaviour(teaching): Behaviour(
                self.views(),
                TrackingTeacher(teaching, self.carousel, self.teacher),
                self._fit,
                # Nobody keeps both hands at objects that are too far apart.
                {side: Goal(view, SHOWN) for side, view in HANDS.items() if side == teaching},
                CUTOFF[self.teacher],
                "Keep a hand at its object, which moves.",
            )
            for teaching in self.taught
        }

    def _fit(self, seen: Sequence[Demonstration]) -> TPGMM:
        """A TP-GMM of the structure that is asked for."""
        if self.structure != "learned":
            return fit_tp_gmm(seen, self.components, covariance=self.structure)
        return shrink_directions(fit_tp_gmm(seen, self.components), len(seen), given=())

    def situation(self, world: World, rng: np.random.Generator) -> Situation:
        """Draw paths of the objects; the hands start at them."""
        body = Body.of(world.robot)
        places = points(
            self.carousel.vias(body, rng), PERIOD * np.arange(round(SECONDS / PERIOD) + 1)
        )
        left, right = places[:, :1]
        angle, _ = body.lean(left, right, "compromise")
        start = body.posture(angle[0], left[0], right[0])
        return Situation(tuple(start.tolist()), paths(places))

    def controller(self, world: World, models: Models, situation: Situation) -> Pursuit:
        """Follow the objects as the first behaviour was taught."""
        return self.follow(self.taught[0], world, models, situation)

    def follow(
        self, teaching: Teaching, world: World, models: Models, situation: Situation
    ) -> Pursuit:
        """Follow the objects as one of the behaviours was taught.

        Raises
        ------
        ArgumentError
            If there is no model of it.
        """
        name = behaviour(teaching)
        if name not in models:
            raise ArgumentError(f"there is no model of '{name}'; there are {', '.join(models)}")
        skill = Skill(self.views(), models[name])
        return Pursuit(
            [skill], effort=self.effort * acceleration_effort(world.robot, Pursuit.strength)
        )

    def goals(self) -> Mapping[str, Goal]:
        """Each hand at its object."""
        return {f"{side} hand": Goal(view, REACHED) for side, view in HANDS.items()}


def behaviour(teaching: str) -> str:
    """Name of the behaviour that a teaching makes."""
    return f"tracking-{teaching}"
