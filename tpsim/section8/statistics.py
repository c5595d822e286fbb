"""Means with bootstrap intervals, and ranks, over situations that all methods share."""

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

RESAMPLES = 1000


@dataclass(frozen=True, eq=False)
class Estimate:
    """Means (m,) of m methods with the limits (m,) of their 95 % intervals."""

    mean: NDArray
    low: NDArray
    high: NDArray


def bootstrap(values: NDArray, *, median: bool = False, seed: int = 0) -> Estimate:
    """Mean over situations with a bootstrap interval, resampled alike for all methods.

    Parameters
    ----------
    values : (m, n)
        A figure of m methods in n situations; a method with NaN in one of them has no mean.
    median : bool
        The median instead of the mean.
    seed : int
        Draws the resamples.

    Returns
    -------
    Estimate
        Percentile intervals: 2.5 and 97.5 % of the resampled means.
    """
    rng = np.random.default_rng(seed)
    chosen = rng.integers(values.shape[1], size=(RESAMPLES, values.shape[1]))
    middle = np.median if median else np.mean
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        resampled = np.array([middle(row[chosen], axis=1) for row in values])
        low, high = np.percentile(resampled, [2.5, 97.5], axis=1)
        return Estimate(middle(values, axis=1), low, high)


def ratio_to_best(values: NDArray, seed: int = 0) -> tuple[int | None, Estimate]:
    """Best method, and the mean of every other relative to its own, with paired intervals.

    None where every method failed.

    Parameters
    ----------
    values : (m, n)
        A figure of m methods in n situations, lower is better.
    """
    means = values.mean(1)
    if not np.isfinite(means).any():
        return None, Estimate(means, means, means)
    best = int(np.nanargmin(means))
    rng = np.random.default_rng(seed)
    chosen = rng.integers(values.shape[1], size=(RESAMPLES, values.shape[1]))
    resampled = np.array([row[chosen].mean(1) for row in values])
    with np.errstate(invalid="ignore", divide="ignore"):
        low, high = np.percentile(resampled / resampled[best], [2.5, 97.5], axis=1)
        return best, Estimate(means / means[best], low, high)


def ranks(values: NDArray) -> tuple[NDArray, NDArray]:
    """Mean rank (m,) and share of situations won (m,) of m methods; 1 is the best rank.

    Parameters
    ----------
    values : (m, n)
        Lower is better; NaN, a failure, shares the last ranks and wins nothing.
    """
    filled = np.where(np.isfinite(values), values, np.inf)
    below = (filled[:, None] > filled[None]).sum(1)
    equal = (filled[:, None] == filled[None]).sum(1)
    rank = below + (equal + 1) / 2
    best = (filled == filled.min(0)) & np.isfinite(filled)
    return rank.mean(1), (best / np.maximum(best.sum(0), 1)).mean(1)
