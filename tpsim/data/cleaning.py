"""Clean demonstrations, with frames and observations in step: functions from values to values."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import NotNegative, Positive, Range, Share, border
from tpsim.checks import affordable
from tpsim.data.motion import is_even, is_moving, part, step_of
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame, as_before
from tpsim.learning.dtw import align

Rate = Annotated[float, Range(above=0)]
"""[Hz]"""

Order = Annotated[int, Range(least=0, most=100)]
"""Of polynomials."""


@border
def resampled(
    demonstration: Demonstration,
    times: int | ArrayLike | None = None,
    *,
    rate: Rate | None = None,
    smooth: bool = False,
) -> Demonstration:
    """Movement at other times: a number of samples, the times themselves [s], or a rate [Hz].

    Parameters
    ----------
    demonstration : Demonstration
    times : int or (S,), optional
        As in :meth:`tpsim.Demonstration.resampled`.
    rate : float, optional
        Samples per second, from the first sample on; default as many as the median step gives,
        evenly.
    smooth : bool
        Cubic spline instead of straight lines.

    Raises
    ------
    ArgumentError
        Both or a rate that is not positive.
    """
    if times is not None and rate is not None:
        raise ArgumentError(f"times and rate ({rate} Hz) are both given; give one of them")
    if times is None:
        step = step_of(demonstration) if rate is None else _step(rate)
        first, last = demonstration.time[[0, -1]]
        # A last step that is short by rounding counts as a whole one.
        count = affordable("rate", int(min((last - first) / step + 1e-6, 1e9)), 1, 0)
        times = np.minimum(first + step * np.arange(count + 1), last)
    return demonstration.resampled(times, smooth=smooth)


@border
def trimmed(
    demonstration: Demonstration,
    *,
    still: Share = 0.05,
    margin: NotNegative = 0.1,
    window: NotNegative = 0.1,
    columns: Sequence[int] | None = None,
) -> Demonstration:
    """Cut off stillness at both ends.

    Parameters
    ----------
    demonstration : Demonstration
    still : float
        Share of the top speed below which it counts as still.
    margin : float
        How much of the stillness stays at each end [s].
    window : float
        Over which the speed is measured [s]; wider for noisier recordings.
    columns : sequence of int, optional
        Of the data that must be still; default all.

    Raises
    ------
    ArgumentError
        A movement that never moves, or an argument out of its range.
    """
    if not margin >= 0:
        raise ArgumentError(f"margin is {margin}; give seconds >= 0")
    rows = np.flatnonzero(is_moving(demonstration, still, window, columns))
    if not len(rows):
        raise ArgumentError(f"{demonstration.name or 'the demonstration'} never moves")
    time = demonstration.time
    start = int(np.searchsorted(time, time[rows[0]] - margin))
    stop = int(np.searchsorted(time, time[rows[-1]] + margin, side="right"))
    return part(demonstration, start, stop)


@border
def smoothed(
    demonstration: Demonstration, window: Positive = 0.1, *, order: Order = 3
) -> Demonstration:
    """Smooth by local polynomials (Savitzky and Golay), at the demonstration's own stamps.

    Parameters
    ----------
    demonstration : Demonstration
    window : float
        Width of the polynomials [s]; at least ``order + 2`` samples are taken.
    order : int
        Of the polynomials: movements of this order pass unchanged.

    Returns
    -------
    Demonstration
        Uneven stamps are brought to even ones by a cubic spline, smoothed, and brought back.
        Moving frames are smoothed as well, and stay rotations where they were.

    Raises
    ------
    ArgumentError
        Too few samples for the order, or an argument out of its range.
    """
    if len(demonstration) < order + 2:
        raise ArgumentError(
            f"order {order} needs {order + 2} samples, {len(demonstration)} were given"
        )
    even = demonstration if is_even(demonstration) else _on_even_stamps(demonstration)
    width = max(round(window / step_of(even)) | 1, (order + 2) | 1)
    width = min(width, len(even) - 1 + len(even) % 2)
    smooth = _filtered(even, width, order)
    if even is demonstration:
        return replace(smooth, observations=_observations(demonstration, smooth))
    back = smooth.resampled(demonstration.time, smooth=True)
    return replace(back, observations=_observations(demonstration, back))


@border
def aligned(
    demonstrations: Sequence[Demonstration], *, band: NotNegative | None = None, by: str = "data"
) -> list[Demonstration]:
    """Bring demonstrations onto one time line by dynamic time warping (Section 5.2).

    Parameters
    ----------
    demonstrations : sequence of Demonstration
        With any stamps: they are first brought to the median step of all.
    band : float, optional
        Matched samples differ by this much time at most [s], or by the difference of durations.
    by : "data" or "frames"
        As in :func:`tpsim.align`.
    """
    if not demonstrations:
        raise ArgumentError("no demonstrations were given; give at least one")
    step = float(np.median([step_of(d) for d in demonstrations]))
    even = [resampled(d, rate=1 / step) for d in demonstrations]
    return align(even, band=None if band is None else round(band / step), by=by)


def _step(rate: float) -> float:
    return 1 / rate


def _on_even_stamps(demonstration: Demonstration) -> Demonstration:
    first, last = demonstration.time[[0, -1]]
    count = max(round((last - first) / step_of(demonstration)) + 1, len(demonstration))
    return demonstration.resampled(np.linspace(first, last, count), smooth=True)


def _filtered(demonstration: Demonstration, width: int, order: int) -> Demonstration:
    from scipy.signal import savgol_filter

    def smooth(values: np.ndarray) -> np.ndarray:
        return savgol_filter(values, width, order, axis=0)

    frames = [
        Frame(as_before(smooth(frame.A), frame.A), smooth(frame.b)) if frame.shape else frame
        for frame in demonstration.frames
    ]
    observations = tuple(smooth(o) for o in demonstration.observations)
    return Demonstration(
        demonstration.time,
        smooth(demonstration.data),
        tuple(frames),
        observations,
        demonstration.name,
    )


def _observations(before: Demonstration, after: Demonstration) -> tuple[np.ndarray, ...]:
    """What frames see of the smoothed movement, by Eq. (4) where they saw the movement by it."""
    views = zip(before.frames, before.observations, after.frames, strict=True)
    return tuple(
        frame.to_local(after.data)
        if np.allclose(seen, old.to_local(before.data), rtol=1e-9, atol=1e-12)
        else after.observations[j]
        for j, (old, seen, frame) in enumerate(views)
    )
