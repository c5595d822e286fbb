"""Scripted paths of a person's hand: minimum jerk through via poses, with human variation."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import make_interp_spline
from scipy.signal import lfilter

from tpsim import rotation, timeline
from tpsim.border import Duration, Moment, NotNegative, Point, Positive, Share, border, checked
from tpsim.checks import finite_array
from tpsim.errors import ArgumentError
from tpsim.world.people.guide import HandPath

MOST = 10**7
"""Time steps in the path of a hand, at most."""


@dataclass(frozen=True)
class Variation:
    """How a person's hand differs from its intention. All are standard deviations or ranges.

    Parameters
    ----------
    drift, tremor : float
        Slow and fast wandering of the position [m].
    angular_drift, angular_tremor : float
        The same of the orientation [rad].
    drift_time, tremor_time : float
        Correlation times [s].
    pace : float
        Each segment's share of time is scaled by a factor within 1 -+ pace.
    warp : float
        Smooth time-warp of the phase, as a fraction of one period; monotone below 1.
    """

    drift: NotNegative = 0.002
    tremor: NotNegative = 0.0006
    angular_drift: NotNegative = 0.01
    angular_tremor: NotNegative = 0.003
    drift_time: Positive = 0.7
    tremor_time: Positive = 0.1
    pace: Share = 0.2
    warp: Share = 0.3

    def __post_init__(self) -> None:
        checked(self)


@border
def script(
    rotations: ArrayLike,
    positions: ArrayLike,
    seconds: Duration,
    timestep: Positive,
    rng: np.random.Generator,
    variation: Variation | None = None,
) -> HandPath:
    """Path of a hand through via poses, as a person would move.

    The intended movement is the minimum-jerk curve through all via poses (a quintic spline, at
    rest at both ends); pace and warp change its timing, drift and tremor are added on top and
    fade in and out over the first and last tenth.

    Parameters
    ----------
    rotations, positions : (V, 3, 3), (V, 3) m
        Via poses, V >= 2.
    seconds : float
        Time from the first to the last [s].
    timestep : float
        Of the samples [s].
    rng : numpy.random.Generator
    variation : Variation, optional

    Returns
    -------
    HandPath
    """
    rotations, positions = (
        finite_array("rotations", rotations),
        finite_array("positions", positions),
    )
    variation = Variation() if variation is None else variation
    if positions.ndim != 2 or len(positions) < 2 or rotations.shape != (*positions.shape, 3):
        raise ArgumentError(
            f"via poses have shapes {rotations.shape} and {positions.shape}; "
            "give rotations (V, 3, 3) and positions (V, 3) with V of at least 2"
        )
    shares = 1 + variation.pace * rng.uniform(-1, 1, len(positions) - 1)
    via_times = np.concatenate([[0], np.cumsum(shares) / shares.sum()])
    steps = steps_in("seconds", seconds, timestep)
    phase, rate = _warped_phase(steps, seconds, variation.warp * rng.uniform(-1, 1))
    turns = rotation.log(rotations @ rotations[0].T)
    curve = minimum_jerk(via_times, np.hstack([positions, turns]))
    pose, velocity = curve(phase), curve(phase, 1) * rate[:, None]
    # omega = left Jacobian of the rotation vector times its rate.
    omega = np.linalg.solve(rotation.left_jacobian_inverse(pose[:, 3:]), velocity[:, 3:, None])
    fade = np.clip(10 * np.minimum(phase, 1 - phase), 0, 1)[:, None]
    moved, turned = wandering(steps, timestep, rng, variation)
    return HandPath(
        pose[:, :3] + fade * moved,
        rotation.exp(fade * turned) @ rotation.exp(pose[:, 3:]) @ rotations[0],
        velocity[:, :3],
        omega[..., 0],
    )


def steps_in(name: str, seconds: float, timestep: float, least: int = 1) -> int:
    """Time steps in a time [s], as many as memory has room for."""
    steps = seconds / timestep
    if not least <= round(min(steps, MOST)) < MOST:
        raise ArgumentError(
            f"{name} is {seconds:g} s in steps of {timestep:g} s; give {least} to {MOST - 1} steps"
        )
    return round(steps)


def minimum_jerk(times, points):
    """Curve of least integrated squared jerk through points (V, d), at rest at both ends.

    Its optimum is the quintic spline with continuous fourth derivative.

    Returns
    -------
    callable
        ``curve(t, k)``: k-th derivative at times t.
    """
    times, points = np.asarray(times, float), np.asarray(points, float)
    if (np.diff(times) <= 0).any():
        raise ArgumentError(f"via times {times} must increase")
    rest = [(1, np.zeros(points.shape[1])), (2, np.zeros(points.shape[1]))]
    return make_interp_spline(times, points, k=5, bc_type=(rest, rest))


def _warped_phase(steps, seconds, warp):
    t = (np.arange(steps) + 1) / steps
    phase = t + warp * np.sin(2 * np.pi * t) / (2 * np.pi)
    rate = (1 + warp * np.cos(2 * np.pi * t)) / seconds
    return phase, rate


def wandering(steps: int, timestep: float, rng, variation: Variation):
    """How a hand strays from its intention: displacements (T, 3) [m] and turns (T, 3) [rad]."""
    moved = _wander(rng, steps, timestep, variation.drift, variation.drift_time)
    moved += _wander(rng, steps, timestep, variation.tremor, variation.tremor_time)
    turned = _wander(rng, steps, timestep, variation.angular_drift, variation.drift_time)
    turned += _wander(rng, steps, timestep, variation.angular_tremor, variation.tremor_time)
    return moved, turned


def _wander(rng, steps, timestep, deviation, time):
    """Stationary wandering (steps, 3): white noise through two equal first-order lags."""
    pole = np.exp(-timestep / time)
    noise = rng.standard_normal((steps, 3))
    for _ in range(2):
        noise = lfilter([1 - pole], [1, -pole], noise, axis=0)
    # Variance of that cascade, for white noise of unit variance.
    gain = (1 - pole) ** 4 * (1 + pole**2) / (1 - pole**2) ** 3
    return deviation / np.sqrt(gain) * noise


@border
def straight(
    origin: Point, travel: Point, seconds: Duration, rest: Moment, timestep: Positive
) -> HandPath:
    """Straight minimum-jerk path from a point (3,) by a displacement (3,), then at rest.

    The orientation is left to itself (identity): for hands that lead without turning.
    """
    steps, still = steps_in("seconds", seconds, timestep), steps_in("rest", rest, timestep, 0)
    s = (np.arange(steps) + 1) / steps
    way = np.concatenate([timeline.rest_to_rest(s), np.ones(still)])
    speed = np.concatenate([30 * s**2 * (1 - s) ** 2 / seconds, np.zeros(still)])
    return HandPath(
        np.array(origin) + way[:, None] * np.array(travel),
        np.broadcast_to(np.eye(3), (len(way), 3, 3)),
        speed[:, None] * np.array(travel),
        np.zeros((len(way), 3)),
    )
