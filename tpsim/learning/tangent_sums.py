"""Sums over samples in tangent spaces: densities, and weighted moments."""

from collections.abc import Sequence

import numpy as np

from tpsim.gaussian import LOG_2PI, cholesky
from tpsim.learning.moments import Moments
from tpsim.manifold.manifold import Manifold


class Sums:
    """Weighted sums over blocks of samples, per group of frames."""

    def __init__(self, bases: Sequence[np.ndarray], manifolds: Sequence[Manifold]):
        K = bases[0].shape[1]
        self.weight = np.zeros(K)
        self.first = [np.zeros((len(b), K, m.dim)) for b, m in zip(bases, manifolds, strict=True)]
        self.second = [
            np.zeros((len(b), K, m.dim, m.dim)) for b, m in zip(bases, manifolds, strict=True)
        ]

    def add(self, h: np.ndarray, tangents: Sequence[np.ndarray]) -> None:
        """Add a block with responsibilities (K, n) and tangent vectors (G, K, dim, n)."""
        self.weight += h.sum(1)
        for first, second, x in zip(self.first, self.second, tangents, strict=True):
            weighted = x * h[:, None, :]
            first += weighted.sum(-1)
            second += weighted @ x.mT

    def moments(self) -> Moments:
        """Means and scatters about them."""
        weight = np.maximum(self.weight, np.finfo(float).tiny)[:, None]
        means = [first / weight for first in self.first]
        scatters = [
            second / weight[..., None] - mean[..., :, None] * mean[..., None, :]
            for second, mean in zip(self.second, means, strict=True)
        ]
        return Moments(self.weight, tuple(means), tuple(scatters))


def whitening_of(covariance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inverse Cholesky factors (G, K, dim, dim), and log densities (K, 1) at zero."""
    W = np.linalg.inv(cholesky(covariance, "covariance of a component"))
    log_det = np.log(np.diagonal(W, axis1=-2, axis2=-1)).sum((0, -1))
    G, _, dim, _ = W.shape
    return W, (log_det - 0.5 * G * dim * LOG_2PI)[:, None]


def log_densities(
    tangents: Sequence[np.ndarray], whitening: Sequence[tuple[np.ndarray, np.ndarray]]
) -> np.ndarray:
    """Log densities (K, n) of tangent vectors, all frames together."""
    found: np.ndarray = np.zeros(())
    for x, (W, at_zero) in zip(tangents, whitening, strict=True):
        z = W @ x
        found = found + at_zero - 0.5 * np.einsum("gkdn,gkdn->kn", z, z)
    return found
