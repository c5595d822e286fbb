"""Gaussian process regression, on raw trajectories or on model parameters (Section 8.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import cho_solve, solve_triangular

from tpsim.errors import ArgumentError
from tpsim.gaussian import LOG_2PI, Gaussian, cholesky, finite_array, floor_eigenvalues


@dataclass(frozen=True)
class SquaredExponential:
    """Covariance function variance exp(-|a - b|^2 / (2 length^2)), and the noise of outputs.

    Attributes
    ----------
    variance : of the function, squared units of the output.
    length : over which the function varies, units of the input.
    noise : sigma^2 of Eq. 45, squared units of the output.
    """

    variance: float = 1.0
    length: float = 1.0
    noise: float = 1e-3

    def __post_init__(self):
        if not (0 < self.variance < np.inf and 0 < self.length < np.inf and self.noise >= 0):
            raise ArgumentError(f"{self}: variance and length must be positive, noise not negative")

    def __call__(self, a: NDArray, b: NDArray) -> NDArray:
        """Covariance K(a, b) of shape (N, M) between inputs (N, I) and (M, I)."""
        square = (a**2).sum(-1)[:, None] + (b**2).sum(-1) - 2 * a @ b.T
        return self.variance * np.exp(-0.5 * np.maximum(square, 0.0) / self.length**2)


@dataclass(frozen=True)
class GaussianProcess:
    """Gaussian process that has seen data; call it with queries. Made by :func:`fit_gp`.

    Attributes
    ----------
    inputs : (N, I)
    outputs : (N, O), centered.
    mean : (O,), taken off the outputs.
    kernel : covariance function of every output.
    factor : (N, N), lower Cholesky factor of K(Q, Q) + sigma^2 I.
    """

    inputs: NDArray
    outputs: NDArray
    mean: NDArray
    kernel: SquaredExponential
    factor: NDArray

    def __call__(self, queries: ArrayLike) -> Gaussian:
        """Prediction at queries (T, I), Eqs 46-47: mean (T, O), covariance (T, O, O).

        The covariance is the uncertainty about the function, the same for every output and
        independent of their values; see :meth:`spread` for that of the data.
        """
        cross = self._cross(queries)
        white = solve_triangular(self.factor, cross.T, lower=True)
        variance = np.maximum(self.kernel.variance - (white**2).sum(0), 0.0)
        identity = np.eye(len(self.mean))
        return Gaussian.trusted(self._predict(cross), variance[:, None, None] * identity)

    def joint_covariance(self, queries: ArrayLike) -> NDArray:
        """Covariance (T, T) between the predictions at queries (T, I), Eq. 47."""
        cross = self._cross(queries)
        queries = _rows("queries", queries)
        white = solve_triangular(self.factor, cross.T, lower=True)
        return self.kernel(queries, queries) - white.T @ white

    def weights(self, queries: ArrayLike) -> NDArray:
        """Weights (T, N) of the outputs in the predictions: K(Q^d, Q) [K(Q, Q) + sigma^2 I]^-1."""
        return cho_solve((self.factor, True), self._cross(queries).T).T

    def spread(self, queries: ArrayLike, ridge: float = 1e-4) -> Gaussian:
        """Prediction with the covariance of the data around it, Eq. 46 with Eq. 19.

        This is what lets the frames of a task-parameterized process disagree: the outputs, with
        the weights of the prediction, vary where the demonstrations do (TP-GP, Section 8).

        Parameters
        ----------
        queries
            (T, I).
        ridge
            Added to the covariance, whose eigenvalues are not allowed below (weights of a
            Gaussian process may be negative).

        Returns
        -------
        Gaussian with mean (T, O) and covariance (T, O, O).
        """
        W = self.weights(queries)
        mean = W @ self.outputs
        size = mean.shape[1]
        squares = (self.outputs[:, :, None] * self.outputs[:, None]).reshape(-1, size**2)
        second = (W @ squares).reshape(-1, size, size)
        apart = W.sum(1)[:, None, None] - 2.0
        covariance = second + apart * (mean[:, :, None] * mean[:, None])
        covariance = floor_eigenvalues(covariance, 0.0) + ridge * np.eye(size)
        return Gaussian.trusted(mean + self.mean, covariance)

    @property
    def log_likelihood(self) -> float:
        """Log marginal likelihood of the outputs, summed over their dimensions."""
        white = solve_triangular(self.factor, self.outputs, lower=True)
        points, outputs = self.outputs.shape
        log_det = np.log(self.factor.diagonal()).sum()
        return float(-0.5 * (white**2).sum() - outputs * (log_det + 0.5 * points * LOG_2PI))

    def _cross(self, queries: ArrayLike) -> NDArray:
        queries = _rows("queries", queries)
        if queries.shape[1] != self.inputs.shape[1]:
            raise ArgumentError(
                f"queries {queries.shape} must have {self.inputs.shape[1]} columns, as the inputs"
            )
        return self.kernel(queries, self.inputs)

    def _predict(self, cross: NDArray) -> NDArray:
        return cross @ cho_solve((self.factor, True), self.outputs) + self.mean


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
        Covariance function; by default the one of largest marginal likelihood.
    center
        Take the mean off the outputs, as Section 8.1 says.

    Raises
    ------
    ArgumentError
        Shapes that do not fit, values that are not finite, or inputs that repeat without noise.
    """
    inputs, outputs = _rows("inputs", inputs), _rows("outputs", outputs)
    if len(inputs) != len(outputs) or len(inputs) == 0:
        raise ArgumentError(
            f"inputs {inputs.shape} and outputs {outputs.shape} need the same, positive length"
        )
    mean = outputs.mean(0) if center else np.zeros(outputs.shape[1])
    kernel = kernel or likeliest_kernel(inputs, outputs - mean)
    covariance = kernel(inputs, inputs)
    covariance.flat[:: len(inputs) + 1] += kernel.noise
    factor = cholesky(covariance, "covariance of the inputs (repeated without noise?)")
    return GaussianProcess(inputs, outputs - mean, mean, kernel, factor)


def likeliest_kernel(inputs: NDArray, outputs: NDArray) -> SquaredExponential:
    """Kernel of largest marginal likelihood for inputs (N, I) and centered outputs (N, O).

    Lengths between a hundredth and ten times the extent of the inputs are searched by L-BFGS-B.
    """
    from scipy.optimize import minimize

    scale = float(outputs.var()) or 1.0
    extent = float(np.linalg.norm(np.ptp(inputs, axis=0))) or 1.0

    def kernel(log) -> SquaredExponential:
        variance, length, noise = np.exp(log)
        return SquaredExponential(variance * scale, length * extent, noise * scale)

    def cost(log) -> float:
        return -fit_gp(inputs, outputs, kernel(log), center=False).log_likelihood

    bounds = np.log([(1e-3, 1e3), (1e-2, 1e1), (1e-6, 1.0)])
    return kernel(minimize(cost, np.log([1.0, 0.3, 1e-3]), method="L-BFGS-B", bounds=bounds).x)


def _rows(name: str, values: ArrayLike) -> NDArray:
    values = finite_array(name, values)
    values = values[:, None] if values.ndim == 1 else values
    if values.ndim != 2 or values.shape[1] == 0:
        raise ArgumentError(f"{name} {values.shape} must be (N,) or (N, columns)")
    return values
