"""What matters in a frame, direction by direction: variation against that of free movement.

Section 9 asks which candidate frames matter. A small covariance alone does not say so: a hand that
wanders freely has a covariance too, and its precision would pull the arm to the middle of where
it wandered. A frame counts here for what it says beyond free movement: with the densities p of the
demonstrations in a frame and p0 of free movement in it, the product of Eqs (5-6) is taken over the
ratios p / p0, whose precision is Sigma^-1 - Sigma_0^-1 in the directions that matter and zero in
all others.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg.lapack import dpotrf, dsyevd, dtrtrs

from tpsim.archive import Part
from tpsim.checks import frozen_array
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian

SPREAD = float(np.log(3.0))
"""A priori, free directions differ among each other by a factor of three (one deviation of the
logarithm): a workspace is that much longer than it is high. Chosen with cup-and-sugar in view."""

DECADES = float(np.log(1e3))
"""A priori, a direction that matters may be up to a thousand times more precise than free movement,
each size as likely as any other."""


BOUNDARY = float(np.exp(-SPREAD * np.sqrt(2 * np.log(DECADES / (np.sqrt(2 * np.pi) * SPREAD)))))
"""Deviation over that of free movement, 0.23, at which both hypotheses are as probable."""


SHARP = 4
"""Exponent with which a direction of a product turns from free to precise at the boundary: as
sharp as a decision, but no jump as directions change with the posture."""


LOST = 1e-13
"""Share of the largest precision, or of all, below which rounding leaves nothing of it."""


@dataclass(frozen=True, eq=False)
class Relevance(Part):
    """What one frame says beyond free movement.

    Parameters
    ----------
    precision : (K, d, d)
        Of the ratio p / p0 in the directions that matter; zero in all others.
    free : (d, d)
        Covariance that free movement would have in this frame, Sigma_0.
    directions : (K, d, d)
        The directions that were looked at, in the rows, each within one kind of quantity.
    ratio : (K, d)
        Standard deviation in each, over that of free movement.
    chance : (K, d)
        Probability that the direction matters.
    """

    precision: np.ndarray
    free: np.ndarray
    directions: np.ndarray
    ratio: np.ndarray
    chance: np.ndarray

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            object.__setattr__(self, name, frozen_array(name, value))
        _check_positive(self.free)

    @property
    def matters(self) -> np.ndarray:
        """Which directions matter, (K, d) bool: those more likely to matter than not."""
        return (self.chance > 0.5) & (self.ratio < 1.0)


def relevance(
    gaussian: Gaussian, free: ArrayLike, kinds: Sequence[str], samples: float = np.inf
) -> Relevance:
    """Compare the covariances in a frame with free movement, direction by direction.

    Within each kind of quantity the directions are the eigenvectors of Sigma relative to Sigma_0;
    lambda is the variance over that of free movement. Two hypotheses are compared for each
    (Bayesian model comparison with equal prior odds). Free: log sqrt(lambda) is normal about zero
    with deviation :data:`SPREAD`, to which the sampling error of a standard deviation,
    1 / (2 n), is added in variance. It matters: log sqrt(lambda) is uniform over
    :data:`DECADES`. The more probable one is believed, with the boundary near a quarter of free
    movement.

    With fewer independent samples than twice the dimensions of a kind, the smallest variance may
    be small by chance: all directions then count as they are.

    Parameters
    ----------
    gaussian : Gaussian (K, d)
        The components as the frame sees them.
    free : (d, d)
        Sigma_0, positive definite.
    kinds : sequence of d str
        Kind of quantity of each dimension, such as ``"position"``: directions do not mix them,
        since metres and radians have no common measure.
    samples : float
        Number n of independent samples behind each covariance.

    Raises
    ------
    ArgumentError
        If shapes do not fit, or ``free`` is not positive definite.
    """
    d = gaussian.dim
    free = frozen_array("free", free)
    if not samples > 0:
        raise ArgumentError(f"samples is {samples}; give a positive number, or inf")
    if free.shape != (d, d) or len(kinds) != d:
        raise ArgumentError(
            f"free has shape {free.shape} and there are {len(kinds)} kinds; the frame has {d} "
            f"dimensions, so give ({d}, {d}) and {d}"
        )
    _check_positive(free)
    found = [_relevance(c, free, kinds, samples) for c in gaussian.covariance]
    parts = [np.array(part) for part in zip(*found, strict=True)]
    return Relevance(parts[0], free, *parts[1:])


def _check_positive(free: np.ndarray) -> None:
    """Refuse what is no covariance: controllers take its root, too."""
    try:
        np.linalg.cholesky(free)
        positive = np.linalg.eigvalsh(free)[0] > 0
    except np.linalg.LinAlgError:
        positive = False
    if not positive:
        raise ArgumentError(
            f"free has shape {free.shape} and is not positive definite: give the covariance of "
            "free movement (d, d)"
        )


def _relevance(
    covariance: np.ndarray, free: np.ndarray, kinds: Sequence[str], samples: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    d = len(free)
    directions, ratio, chance = np.zeros((d, d)), np.ones(d), np.zeros(d)
    for kind in dict.fromkeys(kinds):
        own = np.flatnonzero([k == kind for k in kinds])
        block = np.ix_(own, own)
        L = np.linalg.cholesky(free[block])
        white = np.linalg.solve(L, np.linalg.solve(L, covariance[block]).T)
        values, V = np.linalg.eigh(white)
        directions[np.ix_(own, own)] = np.linalg.solve(L.T, V).T
        ratio[own] = np.sqrt(np.maximum(values, 1e-300))
        few = samples < 2 * len(own)
        chance[own] = 1.0 if few else chance_of(ratio[own], samples)
    keep = (chance > 0.5) & (ratio < 1.0)
    R = directions[keep]
    # The marginals over the directions that matter.
    inner = np.linalg.inv(R @ covariance @ R.T) - np.linalg.inv(R @ free @ R.T)
    return R.T @ inner @ R, directions, ratio, chance


def chance_of(ratio: ArrayLike, samples: float = np.inf) -> np.ndarray:
    """Probability that directions matter, from their deviation over that of free movement."""
    z = np.log(np.asarray(ratio, float))
    variance = SPREAD**2 + 0.5 / samples
    free = np.exp(-0.5 * z**2 / variance) / np.sqrt(2 * np.pi * variance)
    return (1 / DECADES) / (free + 1 / DECADES)


def against_free(precision: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions of a product of frames, the columns of X (n, n), and their duals Y = X^-T.

    They are the eigenvectors of the product's precision relative to that of free movement, as the
    directions within one frame are (:func:`relevance`). Along them both are diagonal,
    Lambda = Y p Y^T and Lambda_0 = Y p_0 Y^T, so that a direction that matters has no part in one
    that does not: whether it matters is asked of the marginal of free movement. A hand that an arm
    moves aside and turns as it does is not free because turning is. They are the same in all
    coordinates, however heavy what moves is.

    Parameters
    ----------
    precision, free : (n, n)
        Lambda and Lambda_0, positive semi-definite.
    """
    both = BOUNDARY**2 * precision + free
    # Where neither knows anything.
    both.flat[:: len(both) + 1] += max(LOST * both.trace(), np.finfo(float).tiny)
    R = dpotrf(both, lower=1)[0]
    white = dtrtrs(R, dtrtrs(R, free, lower=1)[0].T, lower=1)[0]
    U = dsyevd(white)[1]
    X: np.ndarray = dtrtrs(R, U, lower=1, trans=1)[0]
    return X, R.dot(U)


def free_share(precision: ArrayLike, free: ArrayLike) -> np.ndarray:
    """Share in which directions of a product of frames are free: 1 as free movement, 0 precise.

    Two frames that ask for nearly the same differ by the error of their estimates, and so their
    product is weakly precise in a direction in which neither of them is: with n samples by
    about 1/n of the precision of free movement. A direction therefore matters in the product, too,
    only where its deviation is below :data:`BOUNDARY` of free movement.

    Parameters
    ----------
    precision : (n,)
        Of the product in each direction.
    free : (n,)
        That it would have if movement was free in the frame that sees it best.
    """
    beyond = (np.asarray(precision, float) * BOUNDARY**2) ** SHARP
    least = np.asarray(free, float) ** SHARP
    # Where neither is known nothing is free.
    return least / np.maximum(beyond + least, 1e-300)
