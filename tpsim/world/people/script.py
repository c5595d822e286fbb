"""Scripted paths of a person's hand: minimum jerk through via poses, with human variation."""

from dataclasses import dataclass
from functools import cache
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from tpsim import rotation, timeline
from tpsim.border import (
    Duration,
    Moment,
    NotNegative,
    Point,
    Positive,
    Range,
    Share,
    border,
    checked,
)
from tpsim.checks import finite_array
from tpsim.errors import ArgumentError
from tpsim.world.people.care import Care
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
    tremor_band : (float, float), optional
        Frequencies [Hz] of the tremor, instead of a correlation time.
    speed_noise, angular_speed_noise : float
        Wandering that comes with movement: deviation of the position per speed [s], and of the
        orientation per angular speed [s], over the drift's correlation time.
    attention : float
        Factor on drift and speed noise where it matters; 1 for a hand equally steady everywhere.
    """

    drift: NotNegative = 0.002
    tremor: NotNegative = 0.0006
    angular_drift: NotNegative = 0.01
    angular_tremor: NotNegative = 0.003
    drift_time: Positive = 0.7
    tremor_time: Positive = 0.1
    pace: Share = 0.2
    warp: Share = 0.3
    tremor_band: tuple[Positive, Positive] | None = None
    speed_noise: NotNegative = 0.0
    angular_speed_noise: NotNegative = 0.0
    attention: Annotated[float, Range(least=0, most=1)] = 1.0

    def __post_init__(self) -> None:
        checked(self)
        if self.tremor_band is not None and not self.tremor_band[0] < self.tremor_band[1]:
            raise ArgumentError(
                f"variation tremor_band is {self.tremor_band} Hz; give two rising frequencies"
            )


@border
def script(
    rotations: ArrayLike,
    positions: ArrayLike,
    seconds: Duration,
    timestep: Positive,
    rng: np.random.Generator,
    variation: Variation | None = None,
    care: Care | None = None,
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
    care : Care, optional
        What matters, where attention makes the hand steadier; nothing by default.

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
    if not np.allclose(rotations @ rotations.mT, np.eye(3), atol=1e-6):
        raise ArgumentError("rotations are no rotation matrices (V, 3, 3)")
    shares = 1 + variation.pace * rng.uniform(-1, 1, len(positions) - 1)
    via_times = np.concatenate([[0], np.cumsum(shares) / shares.sum()])
    steps = steps_in("seconds", seconds, timestep)
    phase, rate = _warped_phase(steps, seconds, variation.warp * rng.uniform(-1, 1))
    turns = rotation.log(rotations @ rotations[0].T)
    curve = minimum_jerk(via_times, np.hstack([positions, turns]))
    pose, velocity = curve(phase), curve(phase, 1) * rate[:, None]
    omega = rotation.angular_velocity(pose[:, 3:], velocity[:, 3:])
    fade = np.clip(10 * np.minimum(phase, 1 - phase), 0, 1)[:, None]
    twist = np.hstack([velocity[:, :3], omega])
    moved, turned = wandering(twist, timestep, rng, variation, care)
    # As one product of two matrices: of many small ones it takes ten times as long.
    intended = (rotation.exp(pose[:, 3:]).reshape(-1, 3) @ rotations[0]).reshape(-1, 3, 3)
    return HandPath(
        pose[:, :3] + fade * moved,
        rotation.exp(fade * turned) @ intended,
        twist[:, :3],
        twist[:, 3:],
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
    from scipy.interpolate import make_interp_spline  # slow to import: only teachers need it

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


def wandering(
    twist: np.ndarray, timestep: float, rng, variation: Variation, care: Care | None = None
):
    """How a hand strays from its intention: displacements (T, 3) [m] and turns (T, 3) [rad].

    Parameters
    ----------
    twist : (T, 6)
        Velocity of the intended movement [m/s], [rad/s].
    timestep : float
        [s]
    rng : numpy.random.Generator
    variation : Variation
    care : Care, optional
        Where attention makes the hand steadier; nowhere by default.
    """
    v, steps, care = variation, len(twist), care or Care()
    moved = _wander(rng, steps, timestep, v.drift, v.drift_time)
    tremor = _tremor(rng, steps, timestep, v.tremor, v)
    turned = _wander(rng, steps, timestep, v.angular_drift, v.drift_time)
    shaken = _tremor(rng, steps, timestep, v.angular_tremor, v)
    for strayed, part, noise in (
        (moved, twist[:, :3], v.speed_noise),
        (turned, twist[:, 3:], v.angular_speed_noise),
    ):
        if noise:
            speed = np.linalg.norm(part, axis=1, keepdims=True)
            strayed += speed * _wander(rng, steps, timestep, noise, v.drift_time)
    lost = 1 - v.attention
    moved *= 1 - lost * np.asarray(care.position)
    turned *= 1 - lost * np.asarray(care.rotation)
    return moved + tremor, turned + shaken


def _wander(rng, steps, timestep, deviation, time):
    """Stationary wandering (steps, 3): white noise through two equal first-order lags."""
    from scipy.signal import lfilter  # slower yet

    pole = np.exp(-timestep / time)
    noise = rng.standard_normal((steps, 3))
    for _ in range(2):
        noise = lfilter([1 - pole], [1, -pole], noise, axis=0)
    # Variance of that cascade, for white noise of unit variance.
    gain = (1 - pole) ** 4 * (1 + pole**2) / (1 - pole**2) ** 3
    return deviation / np.sqrt(gain) * noise


def _tremor(rng, steps, timestep, deviation, variation):
    """Tremor (steps, 3): in its band of frequencies where it has one, else fast wandering."""
    if variation.tremor_band is None:
        return _wander(rng, steps, timestep, deviation, variation.tremor_time)
    from scipy.signal import sosfilt

    # Two seconds ahead, so that the filter has settled.
    ahead = round(2 / timestep)
    band, gain = _band(variation.tremor_band, timestep, ahead)
    noise = sosfilt(band, rng.standard_normal((steps + ahead, 3)), axis=0)[ahead:]
    return deviation / gain * noise


@cache
def _band(limits, timestep, settled):
    """Bandpass filter in second-order sections, and its deviation for white noise of one."""
    from scipy.signal import butter, sosfilt

    band = butter(2, limits, "bandpass", fs=1 / timestep, output="sos")
    impulse = np.zeros(settled)
    impulse[0] = 1.0
    return band, np.linalg.norm(sosfilt(band, impulse))


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
    speed = np.concatenate([timeline.rest_to_rest_rate(s) / seconds, np.zeros(still)])
    return HandPath(
        np.array(origin) + way[:, None] * np.array(travel),
        np.broadcast_to(np.eye(3), (len(way), 3, 3)),
        speed[:, None] * np.array(travel),
        np.zeros((len(way), 3)),
    )
