"""Where EM starts: an equal split in time, or k-means on the stacked frames (App. A)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import finite_array
from tpsim.errors import ArgumentError
from tpsim.timeline import progress

RESOLUTION = 1e-10  # of the size of a column: a spread below this is rounding


def split_in_time(time: np.ndarray, components: int) -> np.ndarray:
    """Labels (N,) of K equal spans of ``time``; of equal counts where a span would be empty."""
    edges = np.linspace(time.min(), time.max(), components + 1)
    labels = np.searchsorted(edges[1:-1], time, side="right")
    if len(np.unique(labels)) < components:
        order = np.argsort(time, kind="stable")
        labels = np.empty(len(time), int)
        labels[order] = np.arange(len(time)) * components // len(time)
    return labels


def time_of(
    views: Sequence[np.ndarray],
    lengths: Sequence[int],
    time: ArrayLike | None = None,
    stamps: Sequence[np.ndarray] | None = None,
) -> np.ndarray:
    """Time of every sample, 0 to 1: as given, by the stamps, a first column, or the rows."""
    if time is not None:
        time = finite_array("time", time)
        if time.shape != (len(views[0]),):
            raise ArgumentError(
                f"time has shape {time.shape}; it needs one number per sample, N = {len(views[0])}"
            )
        return _unit_range(time)
    if stamps is not None:
        return np.concatenate([progress(one) for one in stamps])
    if len(lengths) == 1:
        column = views[0][:, 0]
        steady = abs(np.sign(np.diff(column)).mean()) > 0.8
        if steady and all(np.array_equal(view[:, 0], column) for view in views[1:]):
            return _unit_range(column)
    return np.concatenate([np.linspace(0.0, 1.0, length) for length in lengths])


def _unit_range(time: np.ndarray) -> np.ndarray:
    first, last = time.min(), time.max()
    return (time - first) / (last - first) if last > first else np.zeros_like(time)


def standardised(views: Sequence[np.ndarray]) -> np.ndarray:
    """Views of all frames side by side, (N, sum d_j), every column with unit variance."""
    stacked = np.hstack(views)
    deviation = stacked - stacked.mean(0)
    size = np.abs(deviation).max(0)
    deviation /= np.where(size > RESOLUTION * np.abs(stacked).max(0), size, np.inf)
    scale = deviation.std(0)
    return deviation / np.where(scale > 0, scale, 1.0)


def clusters(
    views: Sequence[np.ndarray],
    components: int,
    rng: np.random.Generator,
    max_iterations: int = 100,
) -> np.ndarray:
    """Labels (N,) of k-means on the standardised views of all frames, from k-means++ seeds."""
    points = standardised(views)
    return kmeans(points, spread_centres(points, components, rng), max_iterations)[0]


def kmeans(
    points: np.ndarray, centres: np.ndarray, max_iterations: int = 100
) -> tuple[np.ndarray, np.ndarray]:
    """Lloyd's algorithm from given centres (K, D): labels (N,) and final centres.

    A cluster that loses all its points restarts at the point farthest from its own centre.
    """
    squares = np.einsum("nd,nd->n", points, points)
    previous = np.inf
    for _ in range(max_iterations):
        distances = _squared_distances(points, squares, centres)
        labels = distances.argmin(1)
        nearest = distances[np.arange(len(points)), labels]
        for k in np.setdiff1d(np.arange(len(centres)), labels):
            farthest = nearest.argmax()
            labels[farthest], nearest[farthest] = k, 0.0
        counts = np.bincount(labels, minlength=len(centres))
        one_hot = labels == np.arange(len(centres))[:, None]
        centres = (one_hot @ points) / np.maximum(counts, 1)[:, None]
        total = nearest.sum()
        if abs(previous - total) <= 1e-10 * total:
            break
        previous = total
    return labels, centres


def spread_centres(points: np.ndarray, components: int, rng: np.random.Generator) -> np.ndarray:
    """Starting centres (K, D) far from each other: k-means++ seeding."""
    squares = np.einsum("nd,nd->n", points, points)
    centres = points[rng.integers(len(points))][None]
    nearest = _squared_distances(points, squares, centres)[:, 0]
    while len(centres) < components:
        total = nearest.sum()
        chosen = rng.choice(len(points), p=nearest / total if total > 0 else None)
        centres = np.vstack([centres, points[chosen]])
        newest = _squared_distances(points, squares, centres[-1:])[:, 0]
        nearest = np.minimum(nearest, newest)
    return centres


def _squared_distances(points, squares, centres) -> np.ndarray:
    cross = points @ centres.T
    distances = squares[:, None] - 2 * cross + np.einsum("kd,kd->k", centres, centres)
    return np.maximum(distances, 0.0)
