"""Covariance functions of Gaussian processes, and the likeliest one (Section 8.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_solve, solve_triangular

from tpsim.archive import Part
from tpsim.checks import affordable, finite_array, frozen_array, matrix, shown
from tpsim.errors import ArgumentError

SHORTEST, LONGEST = 1e-2, 1e1  # lengths searched, of the extent of the inputs
CLEANEST, NOISIEST = 1e-8, 1e3  # noise searched, of the variance of the function


@dataclass(frozen=True, eq=False)
class SquaredExponential(Part):
    """Covariance function ``variance exp(-|a - b|^2 / (2 length^2))``, and the noise of outputs.

    Attributes
    ----------
    variance : of the function, squared units of the output.
    length : over which the function varies, units of the input.
    noise : sigma^2 of Eq. 45, squared units of the output.

    Numbers hold for all outputs; arrays (O,) have an entry for each.
    """

    variance: float | NDArray = 1.0
    length: float | NDArray = 1.0
    noise: float | NDArray = 1e-3

    def __post_init__(self) -> None:
        shapes = set()
        for name in ("variance", "length", "noise"):
            value = finite_array(name, getattr(self, name))
            if value.ndim > 1 or (not (value > 0).all() and (name != "noise" or (value < 0).any())):
                raise ArgumentError(
                    f"{name} is {shown(value)}; variance and length must be positive, "
                    "noise not negative: numbers, or one for every output"
                )
            shapes.add(value.shape)
            object.__setattr__(
                self, name, frozen_array(name, value) if value.ndim else float(value)
            )
        if len(shapes - {()}) > 1:
            raise ArgumentError(f"variance, length and noise have shapes {sorted(shapes)}")

    def __call__(self, a: NDArray, b: NDArray) -> NDArray:
        """Covariance K(a, b) of shape (N, M), or (O, N, M), between inputs (N, I) and (M, I)."""
        matrices = self.matrices(a, b)
        return matrices if self.outputs else matrices[0]

    def matrices(self, a: NDArray, b: NDArray) -> NDArray:
        """Covariance of every output, (O, N, M), or of all of them, (1, N, M)."""
        a, b = matrix("a", a), matrix("b", b)
        if a.shape[1] != b.shape[1]:
            raise ArgumentError(f"a has shape {a.shape} and b {b.shape}; give (N, I) and (M, I)")
        affordable("a", len(a), len(b) * max(self.outputs, 1))
        variance, length, _ = self._columns
        return variance[:, None, None] * np.exp(-0.5 * _squares(a, b) / length[:, None, None] ** 2)

    @property
    def outputs(self) -> int:
        """Number of outputs O that have entries of their own; zero for one kernel of all."""
        columns = [np.size(v) for v in (self.variance, self.length, self.noise) if np.ndim(v)]
        return columns[0] if columns else 0

    @property
    def variances(self) -> NDArray:
        """Variance of every output (O,), or of all of them (1,)."""
        return self._columns[0]

    @property
    def noises(self) -> NDArray:
        """Noise of every output (O,), or of all of them (1,)."""
        return self._columns[2]

    @property
    def _columns(self) -> NDArray:
        each = np.ones(max(self.outputs, 1))
        return np.array([each * self.variance, each * self.length, each * self.noise])


def likeliest_kernel(inputs: NDArray, outputs: NDArray) -> SquaredExponential:
    """Kernel of largest marginal likelihood for inputs (N, I) and centered outputs (N, O).

    Every output has its own variance, length and noise. Inputs and outputs are scaled first, so
    that units do not matter; lengths from the spacing of the inputs to ten times their extent are
    searched, from the best of a grid on by L-BFGS-B.
    """
    extent = float(np.linalg.norm(np.ptp(inputs, axis=0))) or 1.0
    squares = _squares(inputs, inputs) / extent**2
    shortest = SHORTEST
    if inputs.shape[1] == 1 and len(inputs) > 1:
        spacing = np.diff(np.unique(inputs[:, 0])) / extent
        shortest = min(shortest, float(np.median(spacing))) if len(spacing) else shortest
    scale = spread_of(outputs)
    bounds = np.log([(shortest, LONGEST), (CLEANEST, NOISIEST)])
    unit = outputs / scale
    begin = _best_of_grid(squares, unit, bounds)
    found = np.array(
        [_ascend(squares, y, start, bounds) for y, start in zip(unit.T, begin, strict=True)]
    )
    length, ratio = np.exp(found.T)
    variance = np.array(
        [_profile(squares, y[:, None], *logs)[1][0] for y, logs in zip(unit.T, found, strict=True)]
    )
    variance = np.maximum(variance, CLEANEST) * scale**2
    return SquaredExponential(variance, length * extent, ratio * variance)


def spread_of(outputs: NDArray) -> NDArray:
    """Standard deviation (O,) of centered outputs; that of the widest where one is constant."""
    scale = np.sqrt((outputs**2).mean(0))
    widest = scale.max()
    return np.where(scale > 1e-12 * widest, scale, widest) if widest > 0 else np.ones(len(scale))


def _best_of_grid(squares: NDArray, outputs: NDArray, bounds: NDArray) -> NDArray:
    """Logarithms of length and noise ratio (O, 2) where the search of every output begins."""
    low, high = bounds[0]
    grid = [
        (length, np.log(ratio))
        for length in np.linspace(low, min(high, np.log(3.0)), 8)
        for ratio in (1e-6, 1e-3, 1e-1)
    ]
    scores = np.array([_profile(squares, outputs, *logs)[0] for logs in grid])
    return np.array(grid)[scores.argmin(0)]


def _ascend(squares: NDArray, y: NDArray, start: NDArray, bounds: NDArray) -> NDArray:
    from scipy.optimize import minimize

    def cost(logs: NDArray) -> tuple[float, NDArray]:
        return _slope(squares, y, *logs)

    options = {"ftol": 1e-14, "gtol": 1e-9, "maxiter": 200}
    found: NDArray = minimize(
        cost, start, jac=True, method="L-BFGS-B", bounds=bounds, options=options
    ).x
    return found


def _slope(squares: NDArray, y: NDArray, length: float, ratio: float) -> tuple[float, NDArray]:
    """Cost of :func:`_profile` for one output (N,), and its gradient."""
    scaled = squares / np.exp(2 * length)
    correlation = np.exp(-0.5 * scaled)
    noise = np.exp(ratio)
    try:
        inverse = cho_solve(
            (np.linalg.cholesky(correlation + noise * np.eye(len(y))), True), np.eye(len(y))
        )
    except LinAlgError:
        return 1e12, np.zeros(2)
    cost, variance = _profile(squares, y[:, None], length, ratio)
    alpha = inverse @ y
    bend = correlation * scaled
    fit = np.array([alpha @ bend @ alpha, noise * (alpha @ alpha)]) / variance[0]
    size = np.array([(inverse * bend).sum(), noise * np.trace(inverse)])
    return float(cost[0]), 0.5 * (size - fit)


def _profile(
    squares: NDArray, outputs: NDArray, length: float, ratio: float
) -> tuple[NDArray, NDArray]:
    """Negative log marginal likelihood (O,) at the best variance (O,) for logs of the others."""
    correlation = np.exp(-0.5 * squares / np.exp(2 * length))
    correlation.flat[:: len(squares) + 1] += np.exp(ratio)
    try:
        factor = np.linalg.cholesky(correlation)
    except LinAlgError:
        return np.full(outputs.shape[1], 1e12), np.ones(outputs.shape[1])
    white = solve_triangular(factor, outputs, lower=True)
    variance = np.maximum((white**2).mean(0), CLEANEST)
    log_det = np.log(factor.diagonal()).sum()
    misfit = (white**2).mean(0) / variance
    return log_det + 0.5 * len(squares) * (np.log(variance) + misfit), variance


def _squares(a: NDArray, b: NDArray) -> NDArray:
    """Squared distances (N, M), from the middle of the inputs, so that their size cancels."""
    origin = b.mean(0)
    a, b = a - origin, b - origin
    square = (a**2).sum(-1)[:, None] + (b**2).sum(-1) - 2 * a @ b.T
    return np.maximum(square, 0.0)
