"""Mixtures predicted from task parameters by Gaussian process regression (GPR-GMM, Section 8.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian, floor_eigenvalues, symmetric
from tpsim.learning.gmm import GMM
from tpsim.retrieval.gp import GaussianProcess, SquaredExponential, fit_gp

Encoding = Literal["logarithm", "entries"]


@dataclass(frozen=True)
class MixtureProcess:
    """Gaussian process from task parameters to the parameters of a mixture.

    Attributes
    ----------
    process : Gaussian process with outputs (M, K + K*D + K*D*D): priors, means, covariances.
    shape : K and D.
    encoding : how priors and covariances were written.
    floor : smallest eigenvalue of a covariance that was predicted by its entries.
    """

    process: GaussianProcess
    shape: tuple[int, int]
    encoding: Encoding
    floor: float

    def __call__(self, task: ArrayLike) -> GMM:
        """Mixture for new task parameters (q,), Eq. 46."""
        theta = self.process(np.atleast_2d(task)).mean[0]
        K, D = self.shape
        priors, means, covariances = np.split(theta, [K, K + K * D])
        covariances = symmetric(covariances.reshape(K, D, D))
        if self.encoding == "logarithm":
            priors = np.exp(priors)
            covariances = _of_eigenvalues(np.exp, covariances)
        else:
            priors = np.maximum(priors, 0.0)
            covariances = floor_eigenvalues(covariances, self.floor)
        return GMM(priors / priors.sum(), Gaussian(means.reshape(K, D), covariances))


def fit_gp_gmm(
    tasks: ArrayLike,
    gmms: Sequence[GMM],
    kernel: SquaredExponential | None = None,
    *,
    encoding: Encoding = "logarithm",
    floor: float = 1e-3,
) -> MixtureProcess:
    """Learn how the mixtures of single demonstrations depend on their task parameters, Eq. 45.

    Parameters
    ----------
    tasks
        Query points Q, (M, q): the A and b of the demonstrations, flattened.
    gmms
        M mixtures whose components correspond (same K, D and order).
    kernel
        Covariance function; by default the one of largest marginal likelihood.
    encoding
        "logarithm" interpolates covariances by their matrix logarithm, so that every prediction
        is positive definite; "entries" interpolates their entries, as the tutorial's code does.
    floor
        With "entries", the eigenvalue floor of the predicted covariances (Eq. 7).

    Raises
    ------
    ArgumentError
        Mixtures of different size, a singular covariance, or another number of tasks.
    """
    if encoding not in ("logarithm", "entries"):
        raise ArgumentError(f"encoding is {encoding!r}; allowed are 'logarithm' and 'entries'")
    shapes = {gmm.gaussians.mean.shape for gmm in gmms}
    if len(shapes) != 1 or len(min(shapes)) != 2:
        raise ArgumentError(f"gmms have means of shapes {sorted(shapes)}; give one shape (K, D)")
    theta = [_parameters(gmm, encoding) for gmm in gmms]
    process = fit_gp(tasks, theta, kernel)
    return MixtureProcess(process, min(shapes), encoding, floor)


def _parameters(gmm: GMM, encoding: Encoding) -> NDArray:
    priors, covariances = gmm.priors, gmm.gaussians.covariance
    if encoding == "logarithm":
        if not (np.linalg.eigvalsh(covariances) > 0).all() or not (priors > 0).all():
            raise ArgumentError("a mixture has a zero prior or a singular covariance; add a ridge")
        priors, covariances = np.log(priors), _of_eigenvalues(np.log, covariances)
    return np.concatenate([priors, gmm.gaussians.mean.ravel(), covariances.ravel()])


def _of_eigenvalues(function, matrix: NDArray) -> NDArray:
    """Function of symmetric matrices (..., D, D), applied to their eigenvalues."""
    eigenvalues, V = np.linalg.eigh(matrix)
    return symmetric((V * function(eigenvalues)[..., None, :]) @ V.mT)
