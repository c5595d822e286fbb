"""Products and means of Gaussians on a manifold: Gauss-Newton to the common mean."""

import warnings

import numpy as np

from tpsim.errors import DataWarning
from tpsim.gaussian import inverse_spd, symmetric
from tpsim.manifold.manifold import Manifold

ROUNDS = 30
"""Steps to a common mean, at most."""

STILL = 1e-4
"""Step [rad] that is worth while no more."""

EXACT = 1e-9
"""The same [rad] where nothing waits."""

SLOWEST = 0.5
"""Share by which steps shrink that is believed, at most."""

OPPOSITE = np.pi - 1e-3
"""Angle [rad] from which on means count as opposite: small errors turn the way round."""


def fused(
    manifold: Manifold,
    means: np.ndarray,
    precisions: np.ndarray,
    near: np.ndarray | None = None,
    still: float = STILL,
) -> tuple[np.ndarray, np.ndarray]:
    """Mean and covariance of a product over the first axis, Eq. (6).

    Of means (P, ..., width) with precisions (P, ..., dim, dim).
    ``near`` (..., width) is where Gauss-Newton begins, by default at the most precise factor; after
    a step of ``still`` [rad] it ends. Means that are half a turn apart meet on one of the two ways
    round, with a DataWarning.
    """
    work = manifold.work
    x = _most_precise(manifold, means, precisions) if near is None else near
    before, length = None, np.inf
    for turn in range(ROUNDS):
        if work.curved:
            e, slope = work.seen(x, means)
            seen = slope.mT @ precisions @ slope
        else:
            e, seen = work.log(x, means), precisions
        information, total = np.add.reduce(seen @ e[..., None]), np.add.reduce(seen)
        step = np.linalg.solve(total, information)[..., 0]
        last, length = length, float(np.abs(step).max(initial=0.0))
        if before is not None and turn % 2 and length > still:
            # Far apart, steps shrink slowly, each by one share: all that would follow at once.
            share = np.vecdot(step, before) / np.maximum(np.vecdot(before, before), 1e-300)
            share = np.minimum(np.maximum(share, 0.0), SLOWEST)
            step = step / (1 - share)[..., None]
        before = step
        x = work.exp(x, step)
        if turn == 0:
            _say_if_opposite(manifold, e)
        # Another step would be shorter by as much as this one was.
        if work.flat or length * (min(1.0, length / last) if turn else 1.0) <= still:
            break
    return x, inverse_spd(total, "sum of precisions")


def _most_precise(manifold: Manifold, means: np.ndarray, precisions: np.ndarray) -> np.ndarray:
    """For every index of the leading axes, the mean that is most precise in curved factors."""
    if not manifold.work.curved:
        return means[0]
    rows = np.concatenate([np.arange(b.rows.start, b.rows.stop) for b in manifold.work.curved])
    best = precisions[..., rows, rows].sum(-1).argmax(0)
    if best.ndim == 0:
        return means[best]
    return np.take_along_axis(means, best[None, ..., None], 0)[0]


def _say_if_opposite(manifold: Manifold, e: np.ndarray) -> None:
    """Give a DataWarning where tangent vectors (..., dim) lead half way round."""
    for block in manifold.work.blocks:
        if not block.space.flat:
            v = e[..., block.rows]
            if np.vecdot(v, v).max(initial=0.0) > OPPOSITE**2:
                warnings.warn(
                    f"two means on {block.space} are half a turn apart: either way round is as "
                    "good, and one was taken; observe one more frame, or a precise prior",
                    DataWarning,
                    stacklevel=4,
                )


def mixed(
    manifold: Manifold, weights: np.ndarray, means: np.ndarray, covariances: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Mean and covariance of a mixture, Eqs (17-19), with weights (..., K) that sum to one.

    The mean is the point at which weighted tangent vectors sum to zero, sought from the heaviest
    component.
    """
    work = manifold.work
    x = _heaviest(weights, means)
    h = weights[..., None, :]
    for _ in range(ROUNDS):
        e = work.log(x[..., None, :], means)
        step = np.matmul(h, e)[..., 0, :]
        x = work.exp(x, step)
        if work.flat or not np.abs(step).max(initial=0.0) > STILL:
            break
    at = x[..., None, :]
    e, slope = work.seen(at, means)
    if work.curved:
        back = np.linalg.inv(slope)
        covariances = back @ covariances @ back.mT
    within = np.matmul(h, covariances.reshape(*covariances.shape[:-2], -1))
    within = within.reshape(*within.shape[:-2], manifold.dim, manifold.dim)
    between = np.swapaxes(weights[..., None] * e, -1, -2) @ e
    return x, symmetric(within + between)


def _heaviest(weights: np.ndarray, means: np.ndarray) -> np.ndarray:
    """Means (..., width) of the components of the largest weight."""
    if weights.ndim == 1 and means.ndim == 2:
        return means[weights.argmax()]
    found = np.take_along_axis(means, weights.argmax(-1)[..., None, None], -2)
    return found[..., 0, :]
