"""Probabilistic movement primitives: trajectories as weighted basis functions (Section 5.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian, add_ridge, cholesky, finite_array
from tpsim.learning.product import product_of_frames
from tpsim.retrieval.distribution import TrajectoryDistribution


def radial_basis(steps: int, count: int, width: float | None = None) -> NDArray:
    """Radial basis functions (T, K) over the phase 0..1, summing to one at every step.

    Parameters
    ----------
    steps
        Number of time steps T.
    count
        Number of functions K, centred from phase 0 to 1.
    width
        Standard deviation of each, in phase; by default the distance between centres.
    """
    if steps < 1 or count < 1:
        raise ArgumentError(f"steps is {steps} and count {count}; both must be at least 1")
    width = 1 / max(count - 1, 1) if width is None else width
    if not width > 0:
        raise ArgumentError(f"width is {width}; it must be positive")
    log = -0.5 * ((np.linspace(0, 1, steps)[:, None] - np.linspace(0, 1, count)) / width) ** 2
    basis = np.exp(log - log.max(1, keepdims=True))
    return basis / basis.sum(1, keepdims=True)


@dataclass(frozen=True)
class ProMP:
    """Probabilistic movement primitive x_t = sum_k psi_k(t) w_k + noise.

    Attributes
    ----------
    weights : Gaussian (K*D,), weight vectors of the basis functions one after the other.
    count : number of basis functions K.
    width : their width in phase; None as in :func:`radial_basis`.
    noise : variance of a single coordinate around the sum.
    """

    weights: Gaussian
    count: int
    width: float | None = None
    noise: float = 1e-6

    def distribution(self, steps: int) -> TrajectoryDistribution:
        """Distribution of trajectories of a number of steps; condition and sample it there."""
        K, D = self.count, self.weights.dim // self.count
        basis = radial_basis(steps, K, self.width)
        root = cholesky(self.weights.covariance, "covariance of the weights")
        modes = np.einsum("tk,kdn->ntd", basis, root.reshape(K, D, K * D))
        noise = np.tile(self.noise * np.eye(D), (steps, 1, 1))
        return TrajectoryDistribution(basis @ self.weights.mean.reshape(K, D), modes, noise)


@dataclass(frozen=True)
class TPProMP:
    """Probabilistic movement primitives seen from several frames (demo_TPproMP01).

    Attributes
    ----------
    frames : one :class:`ProMP` for every frame, with the same basis functions.
    """

    frames: tuple[ProMP, ...]

    def adapt(self, frames: Sequence[Frame]) -> ProMP:
        """Product of the weights carried to the common coordinates, Eqs 5-6.

        The basis functions sum to one, so that a frame maps every weight vector like a point.

        Parameters
        ----------
        frames
            P constant frames. For moving ones adapt
            :class:`tpsim.retrieval.distribution.TPTrajectoryDistribution`.
        """
        if len(frames) != len(self.frames) or any(frame.shape for frame in frames):
            raise ArgumentError(
                f"give {len(self.frames)} constant frames; got {len(frames)} with leading axes "
                f"{[frame.shape for frame in frames]}"
            )
        first = self.frames[0]
        lifted = [
            Frame(np.kron(np.eye(first.count), frame.A), np.tile(frame.b, first.count))
            for frame in frames
        ]

        def stack(group: tuple[int, ...]) -> tuple[NDArray, NDArray]:
            weights = [self.frames[j].weights for j in group]
            means, precisions = (
                [w.mean[None] for w in weights],
                [w.precision[None] for w in weights],
            )
            return np.stack(means), np.stack(precisions)

        weights = product_of_frames(stack, lifted, prior=None)[0]
        return ProMP(weights, first.count, first.width, first.noise)


def fit_promp(
    trajectories: Sequence[ArrayLike],
    count: int,
    *,
    width: float | None = None,
    ridge: float = 1e-6,
    weight_ridge: float = 1e-4,
    noise: float = 1e-6,
) -> ProMP:
    """Weights of every demonstration by ridge regression, and their Gaussian.

    Parameters
    ----------
    trajectories
        M demonstrations (T_m, D), of any lengths.
    count
        Number of basis functions K.
    width
        Their width in phase; see :func:`radial_basis`.
    ridge
        Penalty on squared weights: w = (Psi^T Psi + ridge I)^-1 Psi^T x.
    weight_ridge
        Added to the covariance of the weights (Eq. 8), which M - 1 < K*D demonstrations leave
        singular.
    noise
        Variance of a single coordinate around the sum of basis functions.

    Raises
    ------
    ArgumentError
        Trajectories of another shape, or ridges that are not positive.
    """
    paths = [finite_array("trajectories", path) for path in trajectories]
    if not paths or any(p.ndim != 2 or p.shape[1] != paths[0].shape[1] for p in paths):
        raise ArgumentError(
            f"trajectories have shapes {[p.shape for p in paths]}; give M >= 1 of (T_m, D)"
        )
    if not (ridge > 0 and weight_ridge > 0 and noise >= 0):
        raise ArgumentError(
            f"ridge {ridge} and weight_ridge {weight_ridge} must be positive, noise {noise} >= 0"
        )
    weights = np.array([_regress(path, count, width, ridge).ravel() for path in paths])
    apart = weights - weights.mean(0)
    covariance = apart.T @ apart / max(len(paths) - 1, 1)
    return ProMP(
        Gaussian(weights.mean(0), add_ridge(covariance, weight_ridge)), count, width, noise
    )


def fit_tp_promp(demonstrations: Sequence[Demonstration], count: int, **options) -> TPProMP:
    """Probabilistic movement primitive of demonstrations in each of their frames.

    Parameters
    ----------
    demonstrations
        M demonstrations with the same number of frames.
    count
        Number of basis functions K.
    **options
        Keywords of :func:`fit_promp`.
    """
    views = zip(*(d.observations for d in demonstrations), strict=True)
    return TPProMP(tuple(fit_promp(view, count, **options) for view in views))


def _regress(path: NDArray, count: int, width: float | None, ridge: float) -> NDArray:
    """Weights (K, D) of one trajectory (T, D)."""
    basis = radial_basis(len(path), count, width)
    return np.linalg.solve(add_ridge(basis.T @ basis, ridge), basis.T @ path)
