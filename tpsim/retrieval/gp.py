"""Gaussian process regression, on raw trajectories or on model parameters (Section 8.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import solve_triangular

from tpsim.archive import Stored
from tpsim.checks import column_or_matrix, felt, flag, frozen_array, instance, number
from tpsim.errors import ArgumentError
from tpsim.gaussian import LOG_2PI, Gaussian, cholesky, floor_eigenvalues
from tpsim.retrieval.gp_kernel import SquaredExponential, likeliest_kernel, spread_of

LEAST = 1e-3  # of the spread of an output: a smaller deviation of the data is never believed


@dataclass(frozen=True, eq=False)
class GaussianProcess(Stored):
    """Gaussian process that has seen data; call it with queries. Made by :func:`fit_gp`.

    Attributes
    ----------
    inputs : (N, I)
    outputs : (N, O), centered.
    mean : (O,), taken off the outputs.
    kernel : covariance function, of all outputs or with one entry for each.
    factor : (1, N, N) or (O, N, N), lower Cholesky factors of K(Q, Q) + sigma^2 I.
    """

    inputs: NDArray
    outputs: NDArray
    mean: NDArray
    kernel: SquaredExponential
    factor: NDArray

    def __post_init__(self) -> None:
        instance("kernel", self.kernel, SquaredExponential)
        for name in ("inputs", "outputs", "mean", "factor"):
            object.__setattr__(self, name, frozen_array(name, getattr(self, name)))

    def __call__(self, queries: ArrayLike) -> Gaussian:
        """Prediction at queries (T, I), Eqs 46-47: mean (T, O), covariance (T, O, O).

        The covariance is the uncertainty about the function, independent of the outputs' values
        and of each other's; see :meth:`spread` for that of the data.
        """
        cross = self._cross(queries)
        white = self._white(cross.mT)
        variance = np.maximum(self.kernel.variances[:, None] - (white**2).sum(1), 0.0)
        outputs = len(self.mean)
        variance = np.broadcast_to(variance, (outputs, variance.shape[1])).T
        return Gaussian.trusted(self._predict(cross), variance[..., None] * np.eye(outputs))

    def joint_covariance(self, queries: ArrayLike) -> NDArray:
        """Covariance (T, T) between the predictions at queries (T, I), Eq. 47.

        One for every output, (O, T, T), where the kernel has an entry for each.
        """
        cross = self._cross(queries)
        white = self._white(cross.mT)
        rows = self._rows(queries)
        return self._plain(self.kernel.matrices(rows, rows) - white.mT @ white)

    def weights(self, queries: ArrayLike) -> NDArray:
        """Weights (T, N) of the outputs in the predictions: K(Q^d, Q) [K(Q, Q) + sigma^2 I]^-1.

        One for every output, (O, T, N), where the kernel has an entry for each.
        """
        return self._plain(self._weights(self._cross(queries)))

    def spread(self, queries: ArrayLike, ridge: float | None = None) -> Gaussian:
        """Prediction with the covariance of the data around it, Eq. 46 with Eq. 19.

        This is what lets the frames of a task-parameterized process disagree: the outputs, with
        the weights of the prediction, vary where the demonstrations do (TP-GP, Section 8).

        Parameters
        ----------
        queries
            (T, I).
        ridge
            Added to the covariance, whose eigenvalues are not allowed below (weights of a
            Gaussian process may be negative), in squared units of the outputs. By default a
            millionth of each output's own variance, whatever its unit.

        Returns
        -------
        Gaussian with mean (T, O) and covariance (T, O, O).
        """
        cross = self._cross(queries)
        W, y, mean = self._weights(cross), self.outputs, self._predict(cross) - self.mean
        covariance = _shared_spread(W[0], y, mean) if len(W) == 1 else _own_spread(W, y, mean)
        scale = spread_of(y)
        unit = np.outer(scale, scale)
        covariance = unit * floor_eigenvalues(covariance / unit, 0.0)
        if ridge is None:
            covariance += LEAST**2 * np.diag(scale**2)
        else:
            covariance += number("ridge", ridge, least=0) * np.eye(len(scale))
        return Gaussian.trusted(mean + self.mean, covariance)

    @property
    def log_likelihood(self) -> float:
        """Log marginal likelihood of the outputs, summed over their dimensions."""
        white = self._white(self.outputs.T[..., None] if len(self.factor) > 1 else self.outputs)
        points, outputs = self.outputs.shape
        log_det = np.log(self.factor.diagonal(0, -2, -1)).sum() * (outputs / len(self.factor))
        return float(-0.5 * (white**2).sum() - log_det - 0.5 * outputs * points * LOG_2PI)

    def _rows(self, queries: ArrayLike) -> NDArray:
        rows = column_or_matrix("queries", queries)
        if rows.shape[1] != self.inputs.shape[1]:
            raise ArgumentError(
                f"queries {rows.shape} must have {self.inputs.shape[1]} columns, as the inputs"
            )
        return rows

    def _cross(self, queries: ArrayLike) -> NDArray:
        """Covariance (1 or O, T, N) between queries and inputs."""
        return self.kernel.matrices(self._rows(queries), self.inputs)

    def _white(self, columns: NDArray) -> NDArray:
        """Columns (1 or O, N, T), or (N, T), in the coordinates where the outputs are white."""
        columns = np.broadcast_to(columns, (len(self.factor), *columns.shape[-2:]))
        pairs = zip(self.factor, columns, strict=True)
        return np.array([solve_triangular(L, column, lower=True) for L, column in pairs])

    def _weights(self, cross: NDArray) -> NDArray:
        white = self._white(cross.mT)
        pairs = zip(self.factor, white, strict=True)
        return np.array([solve_triangular(L, w, lower=True, trans=1).T for L, w in pairs])

    def _predict(self, cross: NDArray) -> NDArray:
        """Means (T, O)."""
        W = self._weights(cross)
        if len(W) == 1:
            return W[0] @ self.outputs + self.mean
        return np.einsum("otn,no->to", W, self.outputs) + self.mean

    def _plain(self, matrices: NDArray) -> NDArray:
        return matrices if self.kernel.outputs else matrices[0]


def fit_gp(
    inputs: ArrayLike,
    outputs: ArrayLike,
    kernel: SquaredExponential | None = None,
    *,
    center: bool = True,
) -> GaussianProcess:
    """Gaussian process through data, Eq. 45.

    Parameters
    ----------
    inputs
        Query points Q, (N, I) or (N,): task parameters, or time.
    outputs
        Theta, (N, O) or (N,): flattened trajectories, model parameters, or positions.
    kernel
        Covariance function; by default the one of largest marginal likelihood, for every output
        its own, so that neither units nor the other outputs matter.
    center
        Take the mean off the outputs, as Section 8.1 says.

    Raises
    ------
    ArgumentError
        Shapes that do not fit, values that are not finite, or inputs that repeat without noise.
    """
    inputs = felt("inputs", column_or_matrix("inputs", inputs))
    outputs = felt("outputs", column_or_matrix("outputs", outputs))
    if len(inputs) != len(outputs):
        raise ArgumentError(
            f"inputs {inputs.shape} and outputs {outputs.shape} need the same, positive length"
        )
    mean = outputs.mean(0) if flag("center", center) else np.zeros(outputs.shape[1])
    if kernel is None:
        kernel = likeliest_kernel(inputs, outputs - mean)
    instance("kernel", kernel, SquaredExponential)
    if kernel.outputs not in (0, outputs.shape[1]):
        raise ArgumentError(
            f"kernel has entries for {kernel.outputs} outputs, there are {outputs.shape[1]}"
        )
    covariance = kernel.matrices(inputs, inputs)
    covariance[:, range(len(inputs)), range(len(inputs))] += kernel.noises[:, None]
    factor = cholesky(covariance, "covariance of the inputs (repeated without noise?)")
    return GaussianProcess(inputs, outputs - mean, mean, kernel, factor)


def _shared_spread(W: NDArray, y: NDArray, mean: NDArray) -> NDArray:
    """Covariance (T, O, O) of outputs (N, O) around means (T, O) under weights (T, N) of all."""
    size = y.shape[1]
    squares = (y[:, :, None] * y[:, None]).reshape(-1, size**2)
    second = (W @ squares).reshape(-1, size, size)
    return second + (W.sum(1) - 2.0)[:, None, None] * (mean[:, :, None] * mean[:, None])


def _own_spread(W: NDArray, y: NDArray, mean: NDArray) -> NDArray:
    """The same for weights (O, T, N) of every output: two vary together by the mean of theirs."""
    size = y.shape[1]
    covariance = np.empty((W.shape[1], size, size))
    for i in range(size):
        for j in range(i + 1):
            w, mi, mj = 0.5 * (W[i] + W[j]), mean[:, i], mean[:, j]
            both = w @ (y[:, i] * y[:, j]) - mj * (w @ y[:, i]) - mi * (w @ y[:, j])
            covariance[:, i, j] = covariance[:, j, i] = both + w.sum(1) * mi * mj
    return covariance
