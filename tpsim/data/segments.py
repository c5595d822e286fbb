"""Cut a long recording in its parts: where it stops, or where it changes direction."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import Count, NotNegative, Share, border
from tpsim.data.motion import is_moving, part
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.gaussian import finite_array

MOST_SAMPLES = 400
"""Samples among which changes are looked for; longer recordings are thinned out for it."""

MOST_PIECES = 10


@border
def segmented(
    demonstration: Demonstration,
    at: Literal["stops", "changes"] | ArrayLike = "stops",
    *,
    pieces: Count | None = None,
    pause: NotNegative = 0.2,
    still: Share = 0.05,
    window: NotNegative = 0.1,
    columns: Sequence[int] | None = None,
) -> list[Demonstration]:
    """Cut a demonstration in parts, each with its own stamps, frames and observations.

    Parameters
    ----------
    demonstration : Demonstration
    at : "stops", "changes" or times
        Between pauses; where the best description by straight pieces changes (change points by
        dynamic programming); or at given times [s].
    pieces : int, optional
        How many parts ``"changes"`` makes; default the number of least BIC, up to 10.
    pause : float
        Shorter stillness does not count as a stop [s].
    still, window : float
        As in :func:`tpsim.data.trimmed`.
    columns : sequence of int, optional
        Of the data that count; default all.

    Returns
    -------
    list of Demonstration
        Named ``name-0``, ``name-1``, ...; between stops the pauses are left out, otherwise
        neighbours share the sample of the cut.

    Raises
    ------
    ArgumentError
        A movement that never moves, or an argument out of its range.
    """
    if isinstance(at, str):
        if at == "stops":
            spans = _between_stops(demonstration, pause, still, window, columns)
        else:
            spans = _between_changes(demonstration, pieces, columns)
    else:
        spans = _between(demonstration, np.searchsorted(demonstration.time, finite_array("at", at)))
    return [
        replace(part(demonstration, start, stop), name=f"{demonstration.name}-{i}".strip("-"))
        for i, (start, stop) in enumerate(spans)
    ]


def _between_stops(
    demonstration: Demonstration,
    pause: float,
    still: float,
    window: float,
    columns: Sequence[int] | None,
) -> list[tuple[int, int]]:
    if not pause >= 0:
        raise ArgumentError(f"pause is {pause}; give seconds >= 0")
    moving = is_moving(demonstration, still, window, columns)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], moving.astype(int), [0]])))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        raise ArgumentError(f"{demonstration.name or 'the demonstration'} never moves")
    time, spans = demonstration.time, [list(runs[0])]
    for start, stop in runs[1:]:
        if time[start] - time[spans[-1][1] - 1] < pause:
            spans[-1][1] = stop
        else:
            spans.append([start, stop])
    # A blip shorter than the window is noise, not a movement.
    long = [(int(a), int(b)) for a, b in spans if time[b - 1] - time[a] > window]
    return long or [(int(a), int(b)) for a, b in spans]


def _between_changes(
    demonstration: Demonstration, pieces: int | None, columns: Sequence[int] | None
) -> list[tuple[int, int]]:
    T = len(demonstration)
    every = -(-T // MOST_SAMPLES)
    x = demonstration.data if columns is None else demonstration.data[:, list(columns)]
    time, x = demonstration.time[::every], x[::every]
    most = min(MOST_PIECES, len(time) // 4)
    if pieces is not None and not 1 <= pieces <= max(most, 1):
        raise ArgumentError(
            f"pieces is {pieces}; {T} samples can be cut in 1 to {max(most, 1)} straight pieces"
        )
    cuts = _best_cuts(time, x, pieces, most) if most > 1 else []
    return _between(demonstration, np.array(cuts, int) * every)


def _between(demonstration: Demonstration, cuts: np.ndarray) -> list[tuple[int, int]]:
    inside = np.unique(cuts[(cuts > 0) & (cuts < len(demonstration) - 1)])
    edges = [0, *(int(cut) for cut in inside), len(demonstration) - 1]
    return [(a, b + 1) for a, b in pairwise(edges)]


def _best_cuts(time: np.ndarray, x: np.ndarray, pieces: int | None, most: int) -> list[int]:
    """Cuts that leave the least squared distance from straight pieces, one more at a time."""
    cost = _straight_cost(time, x)
    n, D = x.shape
    best, backs = cost[0, :].copy(), []
    scores, floor = [], 1e-12 * max(float(cost[0, n]), 1e-300)
    for count in range(1, (pieces or most) + 1):
        if count > 1:
            through = best[:, None] + cost  # last cut (rows) by end (columns)
            backs.append(through.argmin(0))
            best = through.min(0)
        residual = max(float(best[n]), floor)
        scores.append(n * D * np.log(residual / (n * D)) + count * (2 * D + 1) * np.log(n * D))
    count = pieces or int(np.argmin(scores)) + 1
    end, cuts = n, []
    for back in reversed(backs[: count - 1]):
        end = int(back[end])
        cuts.append(end)
    return cuts[::-1]


def _straight_cost(time: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Squared distance of samples a to b - 1 from their straight line, (n + 1, n + 1)."""
    n = len(time)
    t = (time - time.mean()) / np.ptp(time)
    x = x - x.mean(0)

    def sums(values: np.ndarray) -> np.ndarray:
        total = np.concatenate([np.zeros((1, values.shape[1])), values.cumsum(0)])
        return total[None] - total[:, None]

    count = np.maximum(np.arange(n + 1)[None] - np.arange(n + 1)[:, None], 1)[..., None]
    spread = np.maximum(sums(t[:, None] ** 2) - sums(t[:, None]) ** 2 / count, 1e-12)
    cross = sums(t[:, None] * x) - sums(t[:, None]) * sums(x) / count
    square = sums(x**2) - sums(x) ** 2 / count
    cost = np.maximum(square - cross**2 / spread, 0.0).sum(-1)
    cost[count[..., 0] < 3] = np.inf  # a line through two points tells nothing
    cost[np.tril_indices(n + 1)] = np.inf
    return cost
