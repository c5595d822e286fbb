"""Mixtures predicted from task parameters by Gaussian process regression (GPR-GMM, Section 8.1)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.archive import Stored
from tpsim.border import Count, checked
from tpsim.checks import choice, column_or_matrix, felt, finite_array, matrix, number, several
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian, floor_eigenvalues, symmetric
from tpsim.learning.gmm import GMM
from tpsim.retrieval.gp import GaussianProcess, fit_gp
from tpsim.retrieval.gp_kernel import SquaredExponential

Encoding = Literal["logarithm", "entries"]


@dataclass(frozen=True, eq=False)
class MixtureProcess(Stored):
    """Gaussian process from task parameters to the parameters of a mixture.

    Attributes
    ----------
    process : Gaussian process with outputs (M, K + K*D + K*D*D): priors, means, covariances.
    shape : K and D.
    encoding : how priors and covariances were written.
    floor : (K,), smallest eigenvalue of a covariance that was predicted by its entries.
    """

    process: GaussianProcess
    shape: tuple[Count, Count]
    encoding: Encoding
    floor: NDArray

    def __post_init__(self) -> None:
        checked(self)
        K, D = self.shape
        size = K + K * D + K * D * D
        if self.floor.shape != (K,) or len(self.process.mean) != size:
            raise ArgumentError(
                f"floor has shape {self.floor.shape} and process {len(self.process.mean)} outputs; "
                f"with shape {self.shape} give ({K},) and {size}"
            )

    def __call__(self, task: ArrayLike) -> GMM:
        """Mixture for new task parameters (q,), Eq. 46."""
        wanted = matrix(
            "task", finite_array("task", task).reshape(1, -1), self.process.inputs.shape[1]
        )
        theta = self.process(wanted).mean[0]
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
    floor: float | None = None,
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
        With "entries", the eigenvalue floor of the predicted covariances (Eq. 7), in squared
        units of the data. By default the smallest eigenvalue that each component has shown.

    Raises
    ------
    ArgumentError
        Mixtures of different size, a singular covariance, or another number of tasks.
    """
    choice("encoding", encoding, ("logarithm", "entries"))
    gmms, tasks = several("gmms", gmms, GMM), felt("tasks", column_or_matrix("tasks", tasks))
    if len(tasks) != len(gmms):
        raise ArgumentError(f"{len(tasks)} tasks and {len(gmms)} gmms need the same length")
    shapes = {gmm.gaussians.mean.shape for gmm in gmms}
    if len(shapes) != 1 or len(min(shapes)) != 2:
        raise ArgumentError(f"gmms have means of shapes {sorted(shapes)}; give one shape (K, D)")
    theta = [_parameters(gmm, encoding) for gmm in gmms]
    process = fit_gp(tasks, theta, kernel)
    least = np.array([np.linalg.eigvalsh(gmm.gaussians.covariance)[:, 0] for gmm in gmms]).min(0)
    if floor is not None:
        least = np.full_like(least, number("floor", floor, least=0))
    return MixtureProcess(process, min(shapes), encoding, least)


def _parameters(gmm: GMM, encoding: Encoding) -> NDArray:
    priors, covariances = gmm.priors, gmm.gaussians.covariance
    if encoding == "logarithm":
        if not (np.linalg.eigvalsh(covariances) > 0).all() or not (priors > 0).all():
            raise ArgumentError("a mixture has a zero prior or a singular covariance; add a ridge")
        priors, covariances = np.log(priors), _of_eigenvalues(np.log, covariances)
    return np.concatenate([priors, gmm.gaussians.mean.ravel(), covariances.ravel()])


def _of_eigenvalues(function: Callable[[NDArray], NDArray], matrix: NDArray) -> NDArray:
    """Function of symmetric matrices (..., D, D), applied to their eigenvalues."""
    eigenvalues, V = np.linalg.eigh(matrix)
    return symmetric((V * function(eigenvalues)[..., None, :]) @ V.mT)
