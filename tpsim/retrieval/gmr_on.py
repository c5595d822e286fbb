"""Gaussian mixture regression on manifolds, in tangent spaces at the components' means."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.border import unchecked
from tpsim.errors import ArgumentError
from tpsim.gaussian import Dimensions, Gaussian
from tpsim.learning.gmm import GMM
from tpsim.manifold.gaussian import RiemannianGaussian, shifted, split
from tpsim.manifold.manifold import Factors, Manifold
from tpsim.manifold.product import mixed
from tpsim.retrieval.gmr import Regression, parts_of

Split = tuple[Factors, Factors, np.ndarray | None]
"""Inputs, outputs, and the tangent rows of both in this order; None where they already are."""


@lru_cache(maxsize=64)
def _split_before(manifold: Manifold, given: tuple[int, ...]) -> Split:
    """Remembered, since regressions are made in control loops."""
    return _split(manifold, given, None)


def _split(manifold: Manifold, given: Dimensions, of: Dimensions | None) -> Split:
    inputs, outputs = split(manifold, given, of)
    rows = np.concatenate([inputs.rows, outputs.rows])
    return inputs, outputs, None if np.array_equal(rows, np.arange(manifold.dim)) else rows


@dataclass(frozen=True, eq=False)
class RiemannianRegression(Regression):
    """A mixture on a manifold split in inputs and outputs (Eq. 12), as :class:`Regression`.

    Inputs count by their tangent vectors at the components' input means; what they explain is a
    tangent vector at the output means, along which these move (Eq. 14) and carry their
    covariances (Eq. 15). One Gaussian of all of them (Eqs 17-19) is about the point at which their
    weighted tangent vectors sum to zero.

    Attributes
    ----------
    inputs, outputs : Manifold
    """

    inputs: Manifold
    outputs: Manifold

    def __post_init__(self) -> None:
        super().__post_init__()

    @classmethod
    def of(
        cls,
        gmm: GMM,
        given: Dimensions = (0,),
        of: Dimensions | None = None,
        *,
        ridge: float = 0.0,
    ) -> RiemannianRegression:
        """Split a mixture in the columns given and those to predict, Eqs 12, 14, 15."""
        gaussians = gmm.gaussians
        assert isinstance(gaussians, RiemannianGaussian)
        if of is None and isinstance(given, tuple) and all(type(i) is int for i in given):
            inputs, outputs, rows = _split_before(gaussians.manifold, given)
        else:
            inputs, outputs, rows = _split(gaussians.manifold, given, of)
        covariance = gaussians.covariance
        if rows is not None:
            covariance = covariance[..., rows[:, None], rows]
        # In the tangent spaces it is the regression of R^n.
        size = len(inputs.rows)
        linear, covariance, log_scale = parts_of(gmm.priors, covariance, size, given, ridge)
        return unchecked(
            cls,
            input_mean=gaussians.mean[..., inputs.columns],
            output_mean=gaussians.mean[..., outputs.columns],
            linear=linear,
            covariance=covariance,
            log_scale=log_scale,
            inputs=inputs.manifold,
            outputs=outputs.manifold,
        )

    def __call__(self, inputs: ArrayLike) -> RiemannianGaussian:
        """Single Gaussian at inputs (..., I), Eqs 17-19."""
        return self._single(self._points(inputs))

    def _single(self, points: NDArray) -> RiemannianGaussian:
        weights, shift = self._explained(points)
        means, carry = self.outputs.work.departing(self.output_mean, shift)
        return RiemannianGaussian.trusted_on(
            self.outputs, *mixed(self.outputs, weights, means, self.covariance, carry)
        )

    def at(self, point: ArrayLike) -> RiemannianGaussian:
        """Single Gaussian at one input (I,)."""
        point = self.inputs.points("point", point)
        if self.input_mean.ndim != 2 or point.size != self.inputs.width:
            raise ArgumentError(
                f"at() takes one point and a mixture without leading axes; got points "
                f"{point.shape} and leading axes {self.input_mean.shape[:-2]}"
            )
        return self._single(point.reshape(-1))

    def mixture(self, inputs: ArrayLike) -> tuple[NDArray, RiemannianGaussian]:
        """All modes at inputs (..., I), Eq. 13: weights (..., K) and Gaussian (..., K)."""
        weights, shift = self._components(inputs)
        return weights, shifted(
            self.outputs, self.output_mean, Gaussian.trusted(shift, self.covariance)
        )

    def _points(self, inputs: ArrayLike) -> NDArray:
        """Inputs as points (..., width) that fit the mixture."""
        points = np.asarray(inputs, float) if not isinstance(inputs, np.ndarray) else inputs
        if self.inputs.width == 1 and points.ndim <= 1:
            points = points[..., None] if points.shape != (1,) else points
        points = self.inputs.points("inputs", points)
        lead = self.input_mean.shape[:-2]
        if lead and points.shape[:-1] != lead:
            raise ArgumentError(
                f"inputs {points.shape} do not fit a mixture with leading axes {lead}"
            )
        return points

    def _components(self, inputs: ArrayLike) -> tuple[NDArray, NDArray]:
        return self._explained(self._points(inputs))

    def _explained(self, points: NDArray) -> tuple[NDArray, NDArray]:
        """Weights (..., K) at inputs, and tangent vectors to what these explain (..., K, O)."""
        size = self.linear.shape[-1]
        offset = self.inputs.work.log(self.input_mean, points[..., None, :])
        moved = np.matmul(self.linear, offset[..., None])[..., 0]
        white = moved[..., :size]
        log_weight = self.log_scale - 0.5 * np.vecdot(white, white)
        weights = np.exp(log_weight - np.maximum.reduce(log_weight, -1, keepdims=True))
        weights /= np.add.reduce(weights, -1, keepdims=True)
        return weights, moved[..., size:]
