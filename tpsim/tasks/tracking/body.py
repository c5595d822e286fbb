"""How a trunk with two arms may lean so that its hands come near two points, and who decides.

The arms grow from one point at the end of the trunk, so a point is in reach from an interval of
trunk angles. Where the intervals of two points do not meet, one hand or both stay away: how far is
the choice of the teacher.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.robot.robot import Robot

SIDES = ("left", "right")
"""The hands; the left object is the one farther to the left."""

Teaching = Literal["left", "right", "compromise"]
"""Whose object counts more: the left hand's, the right hand's, or both alike."""

TEACHINGS: tuple[Teaching, ...] = get_args(Teaching)

ELBOWS = {"left": -1.0, "right": 1.0}
"""To which side each elbow bends."""

STEPS = 60
"""Of the search for the best compromise: each leaves three quarters of the trunk's angles."""


@dataclass(frozen=True)
class Body:
    """A trunk with two arms of two equal links.

    Parameters
    ----------
    trunk, link : float
        Lengths [m].
    """

    trunk: float
    link: float

    @classmethod
    def of(cls, robot: Robot) -> "Body":
        """The body of a robot with sites ``left_shoulder``, ``left_elbow``."""
        shoulder, elbow = (
            robot.at_home.pose(name).position for name in ("left_shoulder", "left_elbow")
        )
        return cls(float(np.linalg.norm(shoulder)), float(np.linalg.norm(elbow - shoulder)))

    def shoulders(self, angle: float | np.ndarray) -> np.ndarray:
        """Where the arms begin (..., 2) [m] at trunk angles (...) [rad]."""
        return self.trunk * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    def missing(self, angle: float | np.ndarray, point: np.ndarray) -> np.ndarray:
        """How far (...) [m] a hand stays from points (..., 2) at trunk angles (...)."""
        away = np.linalg.norm(point - self.shoulders(angle), axis=-1)
        return np.maximum(away - 2 * self.link, 0.0)

    def half_width(self, distance: np.ndarray) -> np.ndarray:
        """How far (...) [rad] the trunk may turn from a point at a distance from its foot [m]."""
        reach = 2 * self.link
        cosine = (self.trunk**2 + distance**2 - reach**2) / (2 * self.trunk * distance)
        return np.arccos(np.clip(cosine, -1.0, 1.0))

    def span(self, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and last trunk angle (...) [rad] from which points (..., 2) are in reach."""
        # Counted from straight ahead, so that no object that we draw crosses the cut.
        bearing = np.pi / 2 + np.arctan2(-point[..., 0], point[..., 1])
        width = self.half_width(np.linalg.norm(point, axis=-1))
        return bearing - width, bearing + width

    def lean(
        self, left: np.ndarray, right: np.ndarray, teaching: str
    ) -> tuple[np.ndarray, np.ndarray]:
        """Trunk angles (T,) [rad] that a teacher chooses, and whether (T,) a hand must stay away.

        Parameters
        ----------
        left, right : (T, 2)
            Points for the two hands [m].
        teaching : str
            One of ``TEACHINGS``. A priority brings that hand to its point and the other one as
            near as it can get; a compromise has the least sum of squared distances.
        """
        if teaching not in TEACHINGS:
            raise ArgumentError(
                f"there is no teaching '{teaching}'; choose one of {', '.join(TEACHINGS)}"
            )
        spans = {"left": self.span(left), "right": self.span(right)}
        first = np.maximum(spans["left"][0], spans["right"][0])
        last = np.minimum(spans["left"][1], spans["right"][1])
        apart = first > last
        if teaching == "compromise":
            low, high = np.minimum(first, last), np.maximum(first, last)
            chosen = self._least_squares(low, high, left, right)
        else:
            # The end of the hand's own interval that is nearer to the other one.
            own, other = spans[teaching], spans["right" if teaching == "left" else "left"]
            chosen = np.where(own[0] > other[1], own[0], own[1])
        return np.where(apart, chosen, (first + last) / 2), apart

    def _least_squares(
        self, low: np.ndarray, high: np.ndarray, left: np.ndarray, right: np.ndarray
    ) -> np.ndarray:
        """Trunk angle of the least sum of squared distances, by ever closer comparison."""
        for _ in range(STEPS):
            quarter = (high - low) / 4
            a, b = low + quarter, high - quarter
            cost = [self.missing(x, left) ** 2 + self.missing(x, right) ** 2 for x in (a, b)]
            high, low = np.where(cost[0] < cost[1], b, high), np.where(cost[0] < cost[1], low, a)
        return (low + high) / 2

    def led(self, angle: np.ndarray, point: np.ndarray, short: float, smooth: float) -> np.ndarray:
        """Where a teacher leads a hand (..., 2) [m]: to its point, or as near as the arm comes.

        Parameters
        ----------
        angle, point : (...), (..., 2)
            Trunk angle [rad] and the hand's point [m].
        short, smooth : float
            How much the arm is kept from being stretched, and how softly [m].
        """
        way = point - self.shoulders(angle)
        away = np.linalg.norm(way, axis=-1, keepdims=True)
        beyond = smooth * np.logaddexp(0.0, (away - 2 * self.link + short) / smooth)
        return point - way / away * beyond

    def posture(self, angle: float, left: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Joint angles (5,) [rad] with both hands at points (2,) in reach."""
        q = [angle]
        for side, point in (("left", left), ("right", right)):
            way = point - self.shoulders(angle)
            bend = (
                ELBOWS[side] * 2 * np.arccos(min(float(np.linalg.norm(way)) / (2 * self.link), 1.0))
            )
            turn = np.arctan2(way[1], way[0]) - bend / 2 - angle
            q += [(turn + np.pi) % (2 * np.pi) - np.pi, bend]
        return np.array(q)
