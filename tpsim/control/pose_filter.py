"""Where an object is between two sightings, and how surely: a Kalman filter on its pose."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tpsim import rotation
from tpsim.border import NotNegative, Positive, border
from tpsim.errors import ArgumentError
from tpsim.pose import Pose

GLANCE = 0.25
"""Time [s] since the last sighting up to which an object counts as watched."""

WATCHED = 0.04
"""Share of its wander that an object may do while it is watched: what no test finds."""

MEMORY = np.array([0.0, 0.6, 0.9])
"""Shares of what went before in three running means of the innovations, from fast to slow."""

SAME = 1e-9
"""Times [s] that are nearer to each other are one."""

MOVED = 30.7
"""Squared mean innovation over its variance, in three dimensions, which one in a million exceeds
by chance."""


class PoseEstimate(NamedTuple):
    """A pose, and how surely it is known.

    Parameters
    ----------
    pose : Pose
    covariance : (6, 6)
        Of position [m] over a turn about the world's axes [rad].
    """

    pose: Pose
    covariance: np.ndarray


def smoothed(
    sightings: Sequence[tuple[float, Pose]],
    times: np.ndarray,
    noise: tuple[float, float],
    wander: tuple[float, float],
) -> list[PoseEstimate]:
    """Where an object was at times (T,) [s], from all sightings, before and after each time.

    One filter runs forwards and one backwards in time; what they say of a moment is one Gaussian
    each, and the product of both is the estimate (two-filter smoothing). No sighting counts twice.

    Parameters
    ----------
    sightings : sequence of (float, Pose)
        At least one, in the order of their times.
    times : (T,)
        Increasing [s].
    noise, wander : (float, float)
        Of :class:`PoseFilter`.
    """
    past = _filtered(sightings, times, noise, wander, after=False)
    turned = [(-time, pose) for time, pose in reversed(sightings)]
    future = _filtered(turned, -times[::-1], noise, wander, after=True)[::-1]
    return [_both(one, other) for one, other in zip(past, future, strict=True)]


def _filtered(
    sightings: Sequence[tuple[float, Pose]],
    times: np.ndarray,
    noise: tuple[float, float],
    wander: tuple[float, float],
    after: bool,
) -> list[PoseEstimate | None]:
    """Estimates of one filter at times (T,), with or without a sighting of the same moment."""
    running, found, k = PoseFilter(noise, wander), [], 0
    for time in times:
        while k < len(sightings) and (
            sightings[k][0] < time - SAME or (not after and sightings[k][0] <= time + SAME)
        ):
            running.see(sightings[k][1], sightings[k][0])
            k += 1
        found.append(running.at(float(time)))
    return found


def _both(one: PoseEstimate | None, other: PoseEstimate | None) -> PoseEstimate:
    """Product of two estimates of one pose."""
    if one is None or other is None:
        found = one or other
        assert found is not None
        return found
    (R, p), (R_other, p_other) = one.pose, other.pose
    mine, its = one.covariance.diagonal()[[0, 3]], other.covariance.diagonal()[[0, 3]]
    share = mine / (mine + its)
    turn = rotation.exp(share[1] * rotation.log(R_other @ R.T))
    pose = Pose(turn @ R, p + share[0] * (p_other - p))
    return PoseEstimate(pose, np.diag(np.repeat(mine * its / (mine + its), 3)))


class PoseFilter:
    """Kalman filter of the pose of an object that rests, unless it is seen or may have been moved.

    A sighting with the variance ``noise^2`` makes that of the estimate smaller: many are averaged.
    Whether the object still rests is tested with every sighting, on the innovations of the last
    one and of the last few; where they exceed what happens once in a million, the object was
    moved, and the variance becomes as large as they are. While the object is hidden nothing can
    be tested, and the variance grows by ``wander^2`` a second, without end. Orientation is
    estimated as a rotation, with its error as a small turn about the world's axes.

    Parameters
    ----------
    noise : (float, float)
        Standard deviation of a sighting along each axis [m], and about it [rad].
    wander : (float, float)
        Standard deviation of what an object moves and turns in one second, if nobody looks
        [m/s^0.5], [rad/s^0.5].
    """

    @border
    def __init__(
        self,
        noise: tuple[Positive, Positive] = (0.005, 0.035),
        wander: tuple[NotNegative, NotNegative] = (0.005, 0.02),
    ):
        self._noise, self._wander = np.square(noise), np.square(wander)
        self._pose: Pose | None = None
        self._variance, self._time = np.zeros(2), 0.0
        self._mean = np.zeros((len(MEMORY), 2, 3))

    @border
    def see(self, pose: Pose, time: float) -> None:
        """Take a sighting (R, p) of a time [s] into account.

        Raises
        ------
        ArgumentError
            A time before that of the last sighting.
        """
        pose = pose.checked("pose")
        if self._pose is None:
            self._pose, self._variance, self._time = pose, self._noise, time
            return
        if time < self._time:
            raise ArgumentError(f"time is {time:g} s, before the last sighting at {self._time:g} s")
        (R, p), before = self._pose, self._grown(time)
        off = np.array([pose.position - p, rotation.log(pose.rotation @ R.T)])
        before = self._tested(off, before)
        gain = before / (before + self._noise)
        self._pose = Pose(rotation.exp(gain[1] * off[1]) @ R, p + gain[0] * off[0])
        self._variance, self._time = (1 - gain) * before, time

    @border
    def at(self, time: float) -> PoseEstimate | None:
        """Where the object is at a time [s]; None before it was seen for the first time."""
        if self._pose is None:
            return None
        return PoseEstimate(self._pose, np.diag(np.repeat(self._grown(time), 3)))

    def _tested(self, off: np.ndarray, variance: np.ndarray) -> np.ndarray:
        """Variances (2,) of the estimate, larger where innovations (2, 3) say that it was moved."""
        keep = MEMORY[:, None]
        self._mean = keep[..., None] * self._mean + (1 - keep[..., None]) * off
        size = (self._mean**2).sum(-1)
        expected = (1 - keep) / (1 + keep) * self._noise + variance
        moved = (size > MOVED * expected).any(0)
        self._mean[:, moved] = 0.0
        return np.where(moved, np.maximum(size.max(0), variance), variance)

    def _grown(self, time: float) -> np.ndarray:
        """Variances (2,) at a time."""
        unseen = max(time - self._time, 0.0)
        hidden = max(unseen - GLANCE, 0.0)
        grown: np.ndarray = self._variance + self._wander * (WATCHED**2 * unseen + hidden)
        return grown
