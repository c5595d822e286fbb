"""Sums over samples in tangent spaces: densities, and weighted moments."""

from collections.abc import Sequence

import numpy as np

from tpsim.gaussian import LOG_2PI, cholesky
from tpsim.learning.moments import Moments
from tpsim.manifold.manifold import Manifold


class Sums:
    """Weighted sums over blocks of samples, per group of frames.

    Parameters
    ----------
    bases : sequence of (G, K, width)
    manifolds : sequence of Manifold
    partly : bool
        Whether frames did not see all samples, so that each has weights of its own.
    """

    def __init__(
        self, bases: Sequence[np.ndarray], manifolds: Sequence[Manifold], partly: bool = False
    ):
        K = bases[0].shape[1]
        self.weight = np.zeros(K)
        self.first = [np.zeros((len(b), K, m.dim)) for b, m in zip(bases, manifolds, strict=True)]
        self.second = [
            np.zeros((len(b), K, m.dim, m.dim)) for b, m in zip(bases, manifolds, strict=True)
        ]
        self.seen = tuple(np.zeros((len(b), K)) for b in bases) if partly else None

    def add(
        self, h: np.ndarray, tangents: Sequence[np.ndarray], observed: Sequence[np.ndarray] = ()
    ) -> None:
        """Add a block with responsibilities (K, n) and tangent vectors (G, K, dim, n).

        ``observed`` (G, n) is one where a frame saw the sample, and zero elsewhere.
        """
        self.weight += h.sum(1)
        if self.seen is not None:
            parts = zip(self.seen, self.first, self.second, tangents, observed, strict=True)
            for seen, first, second, x, o in parts:
                weight = h * o[:, None]
                seen += weight.sum(-1)
                first += np.matmul(x, weight[..., None])[..., 0]
                second += (x * weight[:, :, None]) @ x.mT
            return
        for first, second, x in zip(self.first, self.second, tangents, strict=True):
            first += np.matmul(x, h[..., None])[..., 0]
            second += (x * h[:, None, :]) @ x.mT

    def moments(self) -> Moments:
        """Means and scatters about them."""
        of_frames = [self.weight] * len(self.first) if self.seen is None else self.seen
        means, scatters = [], []
        for first, second, sums in zip(self.first, self.second, of_frames, strict=True):
            weight = np.maximum(sums, np.finfo(float).tiny)[..., None]
            mean = first / weight
            means.append(mean)
            scatters.append(second / weight[..., None] - mean[..., :, None] * mean[..., None, :])
        return Moments(self.weight, tuple(means), tuple(scatters), self.seen)


def whitening_of(covariance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inverse Cholesky factors (G, K, dim, dim), and log densities (G, K, 1) at zero."""
    W = np.linalg.inv(cholesky(covariance, "covariance of a component"))
    log_det = np.log(np.diagonal(W, axis1=-2, axis2=-1)).sum(-1)
    return W, (log_det - 0.5 * W.shape[-1] * LOG_2PI)[..., None]


def log_densities(
    tangents: Sequence[np.ndarray],
    whitening: Sequence[tuple[np.ndarray, np.ndarray]],
    observed: Sequence[np.ndarray] = (),
) -> np.ndarray:
    """Log densities (K, n) of tangent vectors, all frames together that saw a sample.

    ``observed`` (G, n) is one where they did, and zero elsewhere; by default all did.
    """
    found: np.ndarray = np.zeros(())
    for i, (x, (W, at_zero)) in enumerate(zip(tangents, whitening, strict=True)):
        z = W @ x
        if observed:
            own = at_zero - 0.5 * np.einsum("gkdn,gkdn->gkn", z, z)
            found = found + np.einsum("gkn,gn->kn", own, observed[i])
        else:
            found = found + at_zero.sum(0) - 0.5 * np.einsum("gkdn,gkdn->kn", z, z)
    return found
