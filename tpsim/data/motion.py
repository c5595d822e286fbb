"""How fast a demonstration moves, on stamps of any spacing, and parts of it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tpsim.checks import dimensions
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError


def part(demonstration: Demonstration, start: int, stop: int) -> Demonstration:
    """Samples ``start`` to ``stop - 1``, with moving frames and observations cut alike."""
    rows = slice(start, stop)
    return replace(
        demonstration,
        time=demonstration.time[rows],
        data=demonstration.data[rows],
        frames=tuple(frame[rows] if frame.shape else frame for frame in demonstration.frames),
        observations=tuple(o[rows] for o in demonstration.observations),
    )


def step_of(demonstration: Demonstration) -> float:
    """Median time between samples [s].

    Raises
    ------
    ArgumentError
        A single sample.
    """
    if len(demonstration) < 2:
        raise ArgumentError(f"{demonstration.name or 'the demonstration'} has only one sample")
    return float(np.median(np.diff(demonstration.time)))


def is_even(demonstration: Demonstration) -> bool:
    """Whether all stamps are equally far apart, to a millionth of their distance."""
    steps = np.diff(demonstration.time)
    return len(steps) < 2 or bool(np.ptp(steps) < 1e-6 * steps.mean())


def speed(
    demonstration: Demonstration, window: float, columns: Sequence[int] | None = None
) -> np.ndarray:
    """Speed (T,): length of the slope of a straight line through each window of samples.

    Parameters
    ----------
    demonstration : Demonstration
        At least two samples.
    window : float
        Width of the window [s]; at least the two neighbours count.
    columns : sequence of int, optional
        Of the data that count; default all. Choose those of one unit.
    """
    step_of(demonstration)
    time = demonstration.time - demonstration.time.mean()
    dims = (
        slice(None)
        if columns is None
        else dimensions("columns", columns, demonstration.data.shape[1])
    )
    chosen = demonstration.data[:, dims]
    x = (chosen - chosen.mean(0)).astype(np.longdouble)
    rows = np.arange(len(time))
    low = np.minimum(np.searchsorted(time, time - window / 2), np.maximum(rows - 1, 0))
    high = np.maximum(
        np.searchsorted(time, time + window / 2, side="right"), np.minimum(rows + 2, len(time))
    )
    count = (high - low)[:, None]

    def sums(values: np.ndarray) -> np.ndarray:
        # A long recording's sums are large beside those of a window.
        total = np.zeros((len(values) + 1, values.shape[1]), np.longdouble)
        np.cumsum(values, axis=0, out=total[1:])
        return total[high] - total[low]

    t = time[:, None].astype(np.longdouble)
    mean_t, mean_x = sums(t) / count, sums(x) / count
    spread = sums(t**2) - count * mean_t**2
    slope = (sums(t * x) - count * mean_t * mean_x) / spread
    return np.linalg.norm(slope.astype(float), axis=1)


def is_moving(
    demonstration: Demonstration, still: float, window: float, columns: Sequence[int] | None
) -> np.ndarray:
    """Where the speed is above the share ``still`` of the top speed (its 98 % quantile), (T,)."""
    if not 0 < still < 1:
        raise ArgumentError(f"still is {still}; give a share of the top speed between 0 and 1")
    v = speed(demonstration, window, columns)
    top = np.quantile(v, 0.98)
    return (v > still * top) & (v > 0)
