"""Dynamic time warping: demonstrations that differ in timing, brought onto one time line."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from tpsim.agreement import agreed_with_warning
from tpsim.checks import (
    array_of,
    choice,
    column_or_matrix,
    frozen,
    instance,
    number,
    several,
    whole,
)
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.manifold.manifold import Manifold

# Steps back from a cell (i, j), in the order in which a tie is decided: the diagonal first,
# so that the path is as short as possible.
_STEPS = ((1, 1), (0, 1), (1, 0))


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

    def __post_init__(self) -> None:
        path = frozen(np.array(array_of("path", self.path)))
        if path.dtype.kind not in "iu" or path.ndim != 2 or path.shape[1] != 2 or not len(path):
            raise ArgumentError(
                f"path has shape {path.shape} of {path.dtype}; give (L, 2) indices, L >= 1"
            )
        object.__setattr__(self, "path", path)
        object.__setattr__(self, "cost", number("cost", self.cost, least=0))

    def timing(self) -> np.ndarray:
        """For every sample of the reference, the matched (fractional) index of the other.

        Returns
        -------
        (T,) array, never falling: the mean of the matched indices.
        """
        i, j = self.path.T
        return np.bincount(i, weights=j) / np.bincount(i)


def dtw(
    reference: ArrayLike,
    other: ArrayLike,
    *,
    band: float | None = None,
    manifold: Manifold | None = None,
) -> Warp:
    """Match two sequences in time by dynamic programming (Section 5.2, [Sakoe and Chiba 1978]).

    Parameters
    ----------
    reference : (T, D) or (T,) array
        The sequence on whose time line :meth:`Warp.timing` is given.
    other : (T', D) or (T',) array
        The sequence to be matched with it.
    band : float, optional
        Matched indices differ by ``max(band, |T - T'|)`` samples at most. Without it, any.
        Memory and time are those of the cells inside the band.
    manifold : Manifold, optional
        On which the sequences live; distances are then the lengths of the shortest ways.

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
    x, y = column_or_matrix("reference", reference), column_or_matrix("other", other)
    if x.shape[1] != y.shape[1]:
        raise ArgumentError(
            f"reference has {x.shape[1]} variables and other has {y.shape[1]}; "
            "give both the same columns"
        )
    if manifold is not None:
        kind = instance("manifold", manifold, Manifold, "such as R(3) * S3")
        x, y = kind.points("reference", x), kind.points("other", y)
    longest = max(len(x), len(y))
    if band is not None:
        band = min(int(number("band", band, least=0)), longest)
    width = longest if band is None else max(band, abs(len(x) - len(y)))
    diagonals, cost = _accumulate(x, y, width, manifold)
    return Warp(_trace_back(diagonals), cost)


def align(
    demonstrations: Sequence[Demonstration],
    *,
    reference: int | None = None,
    band: float | None = None,
    by: str = "data",
    rounds: int = 3,
    manifold: Sequence[Manifold] | None = None,
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
    manifold : sequence of P Manifold, optional
        On which each frame's observations live, with ``by="frames"``: compared are the tangent
        vectors at the mean of all samples. By default R^n.

    Returns
    -------
    list of Demonstration
        In the given order, all with the ``time`` of the reference.

    Raises
    ------
    ArgumentError
        No demonstrations, different dimensions, or an argument out of its range.
    """
    demonstrations = several("demonstrations", demonstrations, Demonstration)
    rounds = whole("rounds", rounds, least=1, most=1000)
    if not demonstrations:
        raise ArgumentError("no demonstrations were given; give at least one")
    demonstrations = agreed_with_warning(demonstrations)
    if reference is None:
        durations = [d.time[-1] - d.time[0] for d in demonstrations]
        reference = int(np.argsort(durations, kind="stable")[len(durations) // 2])
    elif whole("reference", reference, least=-len(demonstrations)) >= len(demonstrations):
        raise ArgumentError(f"reference is {reference}, of {len(demonstrations)} demonstrations")
    features = _features(demonstrations, by, manifold)
    time = demonstrations[reference].time
    target = features[reference]
    for _ in range(rounds):
        timings = [dtw(target, feature, band=band).timing() for feature in features]
        warped = [_at(feature, timing) for feature, timing in zip(features, timings, strict=True)]
        target = np.mean(warped, axis=0)
    return [_warped(d, timing, time) for d, timing in zip(demonstrations, timings, strict=True)]


def _features(
    demonstrations: list[Demonstration], by: str, manifolds: Sequence[Manifold] | None
) -> list[np.ndarray]:
    choice("by", by, ("data", "frames"))
    if manifolds is not None and by != "frames":
        raise ArgumentError("manifold is of what frames see; give by='frames' with it")
    if by == "data":
        features = [d.data for d in demonstrations]
    elif all(d.observations for d in demonstrations):
        seen = [d.observations for d in demonstrations]
        if manifolds is not None:
            seen = _tangents(seen, several("manifold", manifolds, Manifold, "R(3) or S3"))
        features = [np.hstack(views) for views in seen]
    else:
        raise ArgumentError("by is 'frames', but a demonstration has none; give by='data'")
    columns = {feature.shape[1] for feature in features}
    if len(columns) > 1:
        raise ArgumentError(f"demonstrations have {sorted(columns)} variables; give equally many")
    if by == "frames":
        scale = np.vstack(features).std(0)
        features = [feature / np.where(scale > 0, scale, 1.0) for feature in features]
    return features


def _tangents(
    seen: Sequence[Sequence[np.ndarray]], manifolds: Sequence[Manifold]
) -> list[tuple[np.ndarray, ...]]:
    """Observations of every demonstration in the tangent spaces at the means of all of them."""
    if any(len(views) != len(manifolds) for views in seen):
        raise ArgumentError(f"{len(manifolds)} manifolds for {len(seen[0])} frames; give one each")
    columns = []
    for j, one in enumerate(manifolds):
        points = [one.points(f"observations[{j}]", views[j]) for views in seen]
        middle = one.work.centre(np.vstack(points), np.ones(sum(map(len, points))))
        columns.append([one.work.log(middle, view) for view in points])
    return list(zip(*columns, strict=True))


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


Diagonal = tuple[int, np.ndarray]
"""First row i of the cells on an antidiagonal i + j = k, and the step taken into each of them."""


def _accumulate(
    x: np.ndarray, y: np.ndarray, width: int, manifold: Manifold | None = None
) -> tuple[list[Diagonal], float]:
    """Steps taken into every cell and total cost; one antidiagonal i + j = k at a time.

    Only cells with |i - j| <= width are touched, and only two antidiagonals of costs are kept.
    """
    n, m = len(x), len(y)
    diagonals: list[Diagonal] = []
    # Cost by row i on the diagonals k - 2, k - 1 and k; entry 0 is the border i = -1.
    before, last, now = (np.full(n + 2, np.inf) for _ in range(3))
    before[0] = 0.0
    for k in range(n + m - 1):
        low = max(0, k - m + 1, -((width - k) // 2))
        high = min(n - 1, k, (k + width) // 2)
        i = slice(low, high + 1)
        # Back by (1, 1), (0, 1), (1, 0) from row i: rows i - 1, i and i - 1, shifted by the border.
        ways = np.stack([before[i], last[low + 1 : high + 2], last[i]])
        best = ways.argmin(0).astype(np.int8)
        matched = y[k - high : k - low + 1][::-1]
        apart = x[i] - matched if manifold is None else manifold.work.log(x[i], matched)
        now[low] = now[high + 2] = np.inf
        now[low + 1 : high + 2] = np.sqrt(np.einsum("nd,nd->n", apart, apart)) + ways.min(0)
        diagonals.append((low, best))
        before, last, now = last, now, before
    return diagonals, float(last[n])


def _trace_back(diagonals: list[Diagonal]) -> np.ndarray:
    k = len(diagonals) - 1
    i = diagonals[-1][0]
    path = [(i, k - i)]
    while k > 0:
        low, best = diagonals[k]
        up, across = _STEPS[best[i - low]]
        i, k = i - up, k - up - across
        path.append((i, k - i))
    return np.array(path[::-1])
