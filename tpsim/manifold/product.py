"""Products and means of Gaussians on a manifold: Gauss-Newton to the common mean."""

import warnings

import numpy as np

from tpsim.errors import DataWarning
from tpsim.gaussian import inverse_spd, symmetric
from tpsim.manifold.manifold import Manifold

ROUNDS = 30
"""Steps to a common mean, at most."""

STILL = 1e-4
"""Step [rad] after which no other is worth while: what is left is of third order."""

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
    x = _most_precise(manifold, means, precisions) if near is None else near
    before = np.zeros((*x.shape[:-1], manifold.dim))
    for turn in range(ROUNDS):
        e = manifold.work.log(x, means)
        seen = precisions
        if manifold.work.curved:
            slope = manifold.work.slope(x, means, e)
            seen = slope.mT @ precisions @ slope
        information, total = (seen @ e[..., None]).sum(0), seen.sum(0)
        step = np.linalg.solve(total, information)[..., 0]
        if turn % 2:
            # Far apart, steps shrink slowly, each by one share: all that would follow at once.
            share = np.vecdot(step, before) / np.maximum(np.vecdot(before, before), 1e-300)
            step = step / (1 - np.clip(share, 0.0, SLOWEST))[..., None]
        before = step
        x = manifold.work.exp(x, step)
        if turn == 0:
            _say_if_opposite(manifold, e)
        if manifold.flat or not np.abs(step).max(initial=0.0) > still:
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
    if manifold.work.curved or not manifold.flat:
        heaviest = weights.argmax(-1)[..., None, None]
        x = np.take_along_axis(means, heaviest, -2)[..., 0, :]
    else:
        x = means[..., 0, :]
    h = weights[..., None, :]
    for _ in range(ROUNDS):
        e = manifold.work.log(x[..., None, :], means)
        step = np.matmul(h, e)[..., 0, :]
        x = manifold.work.exp(x, step)
        if manifold.flat or not np.abs(step).max(initial=0.0) > STILL:
            break
    at = x[..., None, :]
    e = manifold.work.log(at, means)
    if manifold.work.curved:
        back = np.linalg.inv(manifold.work.slope(at, means, e))
        covariances = back @ covariances @ back.mT
    within = np.matmul(h, covariances.reshape(*covariances.shape[:-2], -1))
    within = within.reshape(*within.shape[:-2], manifold.dim, manifold.dim)
    between = np.swapaxes(weights[..., None] * e, -1, -2) @ e
    return x, symmetric(within + between)
