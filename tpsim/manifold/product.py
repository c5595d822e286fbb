"""Products and means of Gaussians on a manifold: Gauss-Newton to the common mean."""

import warnings

import numpy as np

from tpsim.covariance import inverse_of_scaled, scales, symmetric
from tpsim.errors import DataWarning
from tpsim.manifold.manifold import Manifold
from tpsim.manifold.unit import identity

TOTAL = "sum of precisions"
"""What messages call it."""

ROUNDS = 30
"""Steps to a common mean, at most."""

STILL = 1e-4
"""Step [rad] that is worth while no more."""

EXACT = 1e-9
"""The same [rad] where nothing waits."""

QUICK = 0.1
"""Share to which steps shrink that needs no help."""

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
    work, dim = manifold.work, manifold.dim
    x = _most_precise(manifold, means, precisions) if near is None else near
    before, length, unit = None, np.inf, identity(1)
    for turn in range(ROUNDS):
        seen = work.linearised(x, means)
        # Normal equations and, beside them, what they are solved for.
        both = np.add.reduce(seen[..., :dim].mT @ (precisions @ seen))
        if turn == 0:
            _say_if_opposite(manifold, seen[..., dim])
            unit = scales(both[..., :dim], TOTAL)
        inverse = inverse_of_scaled(both[..., :dim] * unit, TOTAL)
        step = (inverse * unit @ both[..., dim:])[..., 0]
        last, length = length, float(np.maximum.reduce(np.abs(step), None, initial=0.0))
        if before is not None and turn % 2 and length > max(still, QUICK * last):
            # Far apart, steps shrink slowly, each by one share: all that would follow at once.
            share = np.vecdot(step, before) / np.maximum(np.vecdot(before, before), 1e-300)
            share = np.minimum(np.maximum(share, 0.0), SLOWEST)
            step = step / (1 - share)[..., None]
        before = step
        x = work.stepped(x, step)
        # Another step would be shorter by as much as this one was.
        if work.flat or length * (min(1.0, length / last) if turn else 1.0) <= still:
            break
    return x, symmetric(inverse) * unit


def _most_precise(manifold: Manifold, means: np.ndarray, precisions: np.ndarray) -> np.ndarray:
    """For every index of the leading axes, the mean that is most precise in curved factors."""
    rows = manifold.work.curved_rows
    if not len(rows):
        return means[0]
    best = np.add.reduce(precisions.diagonal(0, -2, -1)[..., rows], -1).argmax(0)
    if best.ndim < 2:
        return means[best] if best.ndim == 0 else means[best, np.arange(len(best))]
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
    manifold: Manifold,
    weights: np.ndarray,
    means: np.ndarray,
    covariances: np.ndarray,
    brought: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Mean and covariance of a mixture, Eqs (17-19), with weights (..., K) that sum to one.

    The mean is the point at which weighted tangent vectors sum to zero, sought from near the
    heaviest component. Where covariances (..., K, dim, dim) are seen from elsewhere, ``brought``
    carries them to the means.
    """
    work = manifold.work
    h = weights[..., None, :]
    x = work.near_mean(weights, means)
    for _ in range(ROUNDS):
        e, carry = work.carrying(x[..., None, :], means)
        step = np.matmul(h, e)
        x = work.stepped(x, step[..., 0, :])
        if not np.maximum.reduce(np.abs(step), None, initial=0.0) > STILL:
            break
    # So short a step is a difference.
    e = e - step
    if work.curved:
        if brought is not None:
            carry = carry @ brought
        covariances = carry @ covariances @ carry.mT
    within = np.matmul(h, covariances.reshape(*covariances.shape[:-2], -1))
    within = within.reshape(*within.shape[:-2], manifold.dim, manifold.dim)
    between = np.swapaxes(weights[..., None] * e, -1, -2) @ e
    return x, symmetric(within + between)
