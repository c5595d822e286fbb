"""Kernelized movement primitives: a probabilistic path that bends through desired points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag, cho_factor, cho_solve

from tpsim.border import Positive, checked
from tpsim.checks import number
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian, finite_array, symmetric


@dataclass(frozen=True, eq=False)
class KMP:
    """Kernelized movement primitive, [Huang, Rozo, Silverio and Caldwell 2019].

    The mean at a query s is k(s) (K + lambda Sigma)^-1 mu and the covariance
    N / lambda (k(s, s) - k(s) (K + lambda Sigma)^-1 k(s)'), with the N points of a reference
    distribution, mean mu and covariance Sigma, and K = exp(-(s - s')^2 / (2 length^2)) I. The
    mean of the reference over all points is taken off first, since the kernel alone pulls to zero.

    Attributes
    ----------
    inputs : (N,), usually time [s].
    reference : Gaussian (N, O), such as what GMR retrieved.
    length : over which the path bends, units of the inputs.
    regularisation : lambda.
    """

    inputs: NDArray
    reference: Gaussian
    length: Positive
    regularisation: Positive = 1.0

    def __post_init__(self) -> None:
        checked(self)
        inputs = self.inputs
        if inputs.shape != self.reference.mean.shape[:1] or len(inputs) == 0:
            raise ArgumentError(
                f"inputs {inputs.shape} and reference {self.reference.mean.shape} must be (N,) "
                "and (N, O) with N >= 1"
            )

    def __call__(self, queries: ArrayLike) -> Gaussian:
        """Path at queries (T,): mean (T, O), covariance (T, O, O)."""
        queries = np.atleast_1d(finite_array("queries", queries)).reshape(-1)
        if not len(queries):
            raise ArgumentError("queries is empty; give at least one input")
        O = self.reference.dim
        kernel = self._kernel(queries, self.inputs)
        cross = np.kron(kernel, np.eye(O))
        mean = (cross @ self._weights).reshape(-1, O) + self._center
        solved = cho_solve(self._factor, cross.T).reshape(-1, len(queries), O)
        blocks = np.einsum("tan,ntb->tab", cross.reshape(len(queries), O, -1), solved)
        scale = len(self.inputs) / self.regularisation
        return Gaussian.trusted(mean, scale * symmetric(np.eye(O) - blocks))

    def through(self, input: float, point: ArrayLike, covariance: ArrayLike) -> KMP:
        """Pass a desired point (O,) at an input, with a covariance (O, O).

        It takes the place of a reference point that is nearer than half the usual distance
        between them, and joins the reference otherwise.
        """
        input, point = number("input", input), finite_array("point", point)
        O, covariance = self.reference.dim, finite_array("covariance", covariance)
        if point.shape != (O,) or covariance.shape not in ((), (O, O)):
            raise ArgumentError(
                f"point has shape {point.shape} and covariance {covariance.shape}; give ({O},) and "
                f"({O}, {O})"
            )
        wanted = Gaussian(point, covariance * np.eye(O) if covariance.ndim == 0 else covariance)
        apart = np.abs(self.inputs - input)
        spacing = np.median(np.diff(np.sort(self.inputs))) if len(self.inputs) > 1 else 0.0
        kept = apart > 0.5 * spacing
        return KMP(
            np.r_[self.inputs[kept], input],
            Gaussian(
                np.vstack([self.reference.mean[kept], wanted.mean]),
                np.concatenate([self.reference.covariance[kept], wanted.covariance[None]]),
            ),
            self.length,
            self.regularisation,
        )

    def _kernel(self, a: NDArray, b: NDArray) -> NDArray:
        return np.exp(-0.5 * ((a[:, None] - b) / self.length) ** 2)

    @cached_property
    def _center(self) -> NDArray:
        return self.reference.mean.mean(0)

    @cached_property
    def _factor(self) -> tuple[NDArray, bool]:
        K = np.kron(self._kernel(self.inputs, self.inputs), np.eye(self.reference.dim))
        noise = self.regularisation * block_diag(*self.reference.covariance)
        try:
            return cho_factor(K + noise, lower=True)
        except np.linalg.LinAlgError as error:
            raise ArgumentError(
                "the kernel matrix is singular; give a larger regularisation or a shorter length"
            ) from error

    @cached_property
    def _weights(self) -> NDArray:
        return cho_solve(self._factor, (self.reference.mean - self._center).ravel())
