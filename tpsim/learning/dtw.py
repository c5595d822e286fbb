"""Dynamic time warping: demonstrations that differ in timing, brought onto one time line."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError

# Steps back from a cell (i, j), in the order in which a tie is decided: the diagonal first,
# so that the path is as short as possible.
_STEPS = np.array([(1, 1), (0, 1), (1, 0)])


@dataclass(frozen=True)
class Warp:
    """The cheapest monotone matching of two sequences.

    Attributes
    ----------
    path : (L, 2) int array
        Matched samples (i of the reference, j of the other), from (0, 0) to the last of both.
    cost : float
        Sum of the distances along the path, in the unit of the sequences.
    """

    path: np.ndarray
    cost: float

    def timing(self) -> np.ndarray:
        """For every sample of the reference, the matched (fractional) index of the other.

        Returns
        -------
        (T,) array, never falling: the mean of the matched indices.
        """
        i, j = self.path.T
        return np.bincount(i, weights=j) / np.bincount(i)


def dtw(reference: ArrayLike, other: ArrayLike, *, band: float | None = None) -> Warp:
    """Match two sequences in time by dynamic programming (Section 5.2, [Sakoe and Chiba 1978]).

    Parameters
    ----------
    reference : (T, D) or (T,) array
        The sequence on whose time line :meth:`Warp.timing` is given.
    other : (T', D) or (T',) array
        The sequence to be matched with it.
    band : float, optional
        Matched indices differ by ``max(band, |T - T'|)`` samples at most. Without it, any.

    Returns
    -------
    Warp
        Distances are Euclidean; steps are (1, 1), (1, 0), (0, 1) of equal weight. Where the
        tutorial's MATLAB code drops the last matched pair, ours keeps it; where two paths cost
        the same, ours prefers the diagonal.

    Raises
    ------
    ArgumentError
        The sequences are empty, not finite, of different dimensions, or the band is negative.
    """
    x, y = _sequence(reference, "reference"), _sequence(other, "other")
    if x.shape[1] != y.shape[1]:
        raise ArgumentError(
            f"reference has {x.shape[1]} variables and other has {y.shape[1]}; "
            "give both the same columns"
        )
    if band is not None and not band >= 0:
        raise ArgumentError(f"band is {band}; give a number of samples >= 0, or None")
    from scipy.spatial.distance import cdist

    width = np.inf if band is None else max(band, abs(len(x) - len(y)))
    steps, cost = _accumulate(cdist(x, y), width)
    return Warp(_trace_back(steps), cost)


def align(
    demonstrations: Sequence[Demonstration],
    *,
    reference: int | None = None,
    band: float | None = None,
    by: str = "data",
    rounds: int = 3,
) -> list[Demonstration]:
    """Bring several demonstrations onto one time line by DTW (Section 5.2).

    Every demonstration is warped to a reference movement, which is then replaced by the mean of
    the warped ones, ``rounds`` times; data, moving frames and observations are warped together.

    Parameters
    ----------
    demonstrations : sequence of Demonstration
        Of any lengths.
    reference : int, optional
        The one whose time line all get and from which the mean starts; default the one of
        median duration.
    band : float, optional
        As in :func:`dtw` [samples].
    by : "data" or "frames"
        What is compared: the common coordinates, or what the frames saw, every column divided
        by its standard deviation. Movements in different situations differ less in the latter.
    rounds : int
        At least 1; with 1 the reference is the demonstration itself.

    Returns
    -------
    list of Demonstration
        In the given order, all with the ``time`` of the reference.

    Raises
    ------
    ArgumentError
        No demonstrations, different dimensions, or an argument out of its range.
    """
    demonstrations = list(demonstrations)
    if not demonstrations or rounds < 1:
        raise ArgumentError(
            f"{len(demonstrations)} demonstrations and {rounds} rounds; give at least one of both"
        )
    if reference is None:
        durations = [d.time[-1] - d.time[0] for d in demonstrations]
        reference = int(np.argsort(durations, kind="stable")[len(durations) // 2])
    elif not -len(demonstrations) <= reference < len(demonstrations):
        raise ArgumentError(f"reference is {reference}, of {len(demonstrations)} demonstrations")
    features = _features(demonstrations, by)
    time = demonstrations[reference].time
    target = features[reference]
    for _ in range(rounds):
        timings = [dtw(target, feature, band=band).timing() for feature in features]
        warped = [_at(feature, timing) for feature, timing in zip(features, timings, strict=True)]
        target = np.mean(warped, axis=0)
    return [_warped(d, timing, time) for d, timing in zip(demonstrations, timings, strict=True)]


def _features(demonstrations: list[Demonstration], by: str) -> list[np.ndarray]:
    if by == "data":
        features = [d.data for d in demonstrations]
    elif by == "frames" and all(d.observations for d in demonstrations):
        features = [np.hstack(d.observations) for d in demonstrations]
    else:
        raise ArgumentError(
            f"by is {by!r}; give 'data', or 'frames' for demonstrations with frames"
        )
    columns = {feature.shape[1] for feature in features}
    if len(columns) > 1:
        raise ArgumentError(f"demonstrations have {sorted(columns)} variables; give equally many")
    if by == "frames":
        scale = np.vstack(features).std(0)
        features = [feature / np.where(scale > 0, scale, 1.0) for feature in features]
    return features


def _at(values: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Rows at fractional indices, linear in between."""
    rows = np.arange(len(values))
    return np.column_stack([np.interp(index, rows, column) for column in values.T])


def _warped(demonstration: Demonstration, timing: np.ndarray, time: np.ndarray) -> Demonstration:
    # A millionth of even progress: a Demonstration's time must increase where DTW stands still.
    even = np.linspace(0.0, len(demonstration) - 1.0, len(timing))
    timing = timing + 1e-6 * (even - timing)
    moments = np.interp(timing, np.arange(len(demonstration)), demonstration.time)
    return replace(demonstration.resampled(moments), time=time)


def _sequence(values: ArrayLike, name: str) -> np.ndarray:
    values = np.asarray(values, dtype=float)
    values = values[:, None] if values.ndim == 1 else values
    if values.ndim != 2 or 0 in values.shape or not np.isfinite(values).all():
        raise ArgumentError(
            f"{name} has shape {values.shape}; give finite numbers of shape (T,) or (T, D), T >= 1"
        )
    return values


def _accumulate(distance: np.ndarray, width: float) -> tuple[np.ndarray, float]:
    """Step taken into every cell and total cost; one antidiagonal i + j = k at a time."""
    n, m = distance.shape
    steps = np.zeros((n, m), dtype=np.int8)
    # Cost by row i on the diagonals k - 2 and k - 1; entry 0 is the border i = -1.
    before = np.full(n + 1, np.inf)
    last = np.full(n + 1, np.inf)
    before[0] = 0.0
    for k in range(n + m - 1):
        low = max(0, k - m + 1, int(np.ceil((k - width) / 2)) if np.isfinite(width) else 0)
        high = min(n - 1, k, int((k + width) // 2) if np.isfinite(width) else k)
        i = np.arange(low, high + 1)
        candidates = np.stack([before[i], last[i + 1], last[i]])
        steps[i, k - i] = best = candidates.argmin(0)
        cost = np.full(n + 1, np.inf)
        cost[i + 1] = distance[i, k - i] + candidates[best, np.arange(len(i))]
        before, last = last, cost
    return steps, float(last[n])


def _trace_back(steps: np.ndarray) -> np.ndarray:
    cell = np.array(steps.shape) - 1
    path = [cell]
    while cell.any():
        cell = cell - _STEPS[steps[tuple(cell)]]
        path.append(cell)
    return np.array(path[::-1])
