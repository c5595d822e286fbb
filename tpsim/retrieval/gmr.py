"""Gaussian mixture regression: any part of a mixture from any other part (Section 5.1, App. C)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.archive import Stored
from tpsim.border import checked, unchecked
from tpsim.checks import FLOAT, dimensions, finite_array, instance, number
from tpsim.errors import ArgumentError
from tpsim.gaussian import Dimensions, Gaussian, add_ridge, mixed_moments
from tpsim.learning.gmm import GMM

_BEYOND = 1e100  # squares of larger inputs overflow
_TINY = float(np.finfo(float).tiny)


def gmr(
    gmm: GMM,
    inputs: ArrayLike,
    given: Dimensions = (0,),
    of: Dimensions | None = None,
    *,
    ridge: float = 0.0,
) -> Gaussian:
    """Gaussian mixture regression as a single Gaussian, Eqs 12-19 and 75.

    Parameters
    ----------
    gmm
        Mixture, gaussians (K, D), or (T, K, D) when its frames move.
    inputs
        (T, I) values of the given dimensions, or (T,) when there is one.
    given
        The I input dimensions, or one; on a manifold columns, all those of a curved factor.
    of
        The O output dimensions; all others by default.
    ridge
        Added to the diagonal of the output covariance (Eq. 8).

    Returns
    -------
    Gaussian with mean (T, O) and covariance (T, O, O), the spread between components included.

    Raises
    ------
    ArgumentError
        Dimensions that do not fit, inputs that are not finite or beyond all support, or a
        component whose input covariance is not positive definite.

    Notes
    -----
    Far from the data the component of the largest density answers alone, extrapolating linearly
    with its own conditional covariance: the answer is finite, and worth what an extrapolation is.
    """
    return Regression.of(gmm, given, of, ridge=ridge)(inputs)


def gmr_mixture(
    gmm: GMM, inputs: ArrayLike, given: Dimensions = (0,), of: Dimensions | None = None
) -> tuple[NDArray, Gaussian]:
    """Gaussian mixture regression with all its modes, Eq. 13.

    Parameters as in :func:`gmr`.

    Returns
    -------
    weights (T, K) of Eq. 16 and Gaussian (T, K, O) of Eqs 14-15.
    """
    return Regression.of(gmm, given, of).mixture(inputs)


@dataclass(frozen=True, eq=False)
class Regression(Stored):
    """A mixture split in inputs and outputs (Eq. 12), ready to be asked in a control loop.

    Attributes
    ----------
    input_mean : (..., K, I)
    output_mean : (..., K, O)
    linear : (..., K, I+O, I), the map that whitens an input stacked on the slope of Eq. 14.
    covariance : (..., K, O, O), Eq. 15.
    log_scale : (..., K), logarithm of the prior over the normaliser of the input density.
    """

    input_mean: NDArray
    output_mean: NDArray
    linear: NDArray
    covariance: NDArray
    log_scale: NDArray

    def __post_init__(self) -> None:
        checked(self)
        I, O = self.input_mean.shape[-1:], self.output_mean.shape[-1:]
        lead = self.input_mean.shape[:-1]
        shapes = [array.shape for array in vars(self).values()]
        wanted = [(*lead, *I), (*lead, *O), (*lead, *I, *O), (*lead, *O, *O), lead]
        if len(lead) and len(O):
            wanted[2] = (*lead, I[0] + O[0], I[0])
        if shapes != wanted:
            raise ArgumentError(
                f"input_mean, output_mean, linear, covariance and log_scale have shapes {shapes}; "
                f"give (..., K, I), (..., K, O), (..., K, I + O, I), (..., K, O, O) and (..., K)"
            )

    @classmethod
    def trusted(
        cls,
        input_mean: NDArray,
        output_mean: NDArray,
        linear: NDArray,
        covariance: NDArray,
        log_scale: NDArray,
    ) -> Regression:
        """Build without checks and copies, from arrays of one's own: the path of control loops."""
        return unchecked(
            cls,
            input_mean=input_mean,
            output_mean=output_mean,
            linear=linear,
            covariance=covariance,
            log_scale=log_scale,
        )

    @classmethod
    def of(
        cls,
        gmm: GMM,
        given: Dimensions = (0,),
        of: Dimensions | None = None,
        *,
        ridge: float = 0.0,
    ) -> Regression:
        """Split a mixture in the given dimensions and those to predict, Eqs 12, 14, 15.

        The ridge of Eq. 8 goes to every component, which adds it once to their weighted sum.
        """
        instance("gmm", gmm, GMM, "adapt(frames) makes one of a task-parameterized model")
        if type(gmm.gaussians) is not Gaussian:
            from tpsim.retrieval.gmr_on import RiemannianRegression

            return RiemannianRegression.of(gmm, given, of, ridge=ridge)
        mean, covariance = gmm.gaussians.mean, gmm.gaussians.covariance
        inputs, order = _order(mean.shape[-1], given, of)
        if order is not None:
            mean, covariance = mean[..., order], covariance[..., order[:, None], order]
        parts = parts_of(gmm.priors, covariance, inputs, given, ridge)
        return cls.trusted(mean[..., :inputs], mean[..., inputs:], *parts)

    def __call__(self, inputs: ArrayLike) -> Gaussian:
        """Single Gaussian at inputs (..., I), Eqs 17-19: mean (..., O), covariance (..., O, O)."""
        return mixed_moments(*self.mixture(inputs))

    def at(self, point: ArrayLike) -> Gaussian:
        """Single Gaussian at one input (I,), as a call, in a fraction of its time.

        The mixture must have no leading axes: adapt it to the frames of this moment.
        """
        size, outputs = self.linear.shape[-1], self.covariance.shape[-1]
        if type(point) is not np.ndarray or point.dtype is not FLOAT:
            try:
                point = finite_array("point", point)
            except ArgumentError as error:
                raise ArgumentError(f"at() takes {size} finite values; {error}") from error
        point = point.reshape(-1)
        if self.input_mean.ndim != 2 or len(point) != size or not point.dot(point) < _BEYOND**2:
            raise ArgumentError(
                f"at() takes a point of {size} finite values and a mixture without leading axes; "
                f"got {point} and leading axes {self.input_mean.shape[:-2]}"
            )
        moved = self.linear @ (point - self.input_mean)[..., None]
        white, shift = moved[:, :size, 0], moved[:, size:, 0]
        log_weight = self.log_scale - 0.5 * np.vecdot(white, white)
        weights = np.exp(log_weight - np.maximum.reduce(log_weight))
        weights /= np.add.reduce(weights)
        means = self.output_mean + shift
        mean = weights @ means
        apart = means - mean
        covariance = apart.T @ (apart * weights[:, None])
        covariance += (weights @ self.covariance.reshape(len(weights), -1)).reshape(
            outputs, outputs
        )
        return Gaussian.trusted(mean, covariance)

    def mixture(self, inputs: ArrayLike) -> tuple[NDArray, Gaussian]:
        """All modes at inputs (..., I), Eq. 13: weights (..., K) and Gaussian (..., K, O)."""
        weights, means = self._components(inputs)
        shape = (*means.shape, means.shape[-1])
        return weights, Gaussian.trusted(means, np.broadcast_to(self.covariance, shape))

    def weights(self, inputs: ArrayLike) -> NDArray:
        """Influence h (..., K) of every component at inputs (..., I), Eq. 16."""
        return self._components(inputs)[0]

    def _components(self, inputs: ArrayLike) -> tuple[NDArray, NDArray]:
        size = self.linear.shape[-1]
        inputs = self._check(finite_array("inputs", inputs), size)
        offset = inputs[..., None, :] - self.input_mean
        moved = np.einsum("...kai,...ki->...ka", self.linear, offset)
        white = moved[..., :size]
        log_weight = self.log_scale - 0.5 * np.vecdot(white, white)
        weights = np.exp(log_weight - np.maximum.reduce(log_weight, -1, keepdims=True))
        weights /= np.add.reduce(weights, -1, keepdims=True)
        return weights, self.output_mean + moved[..., size:]

    def _check(self, inputs: NDArray, size: int) -> NDArray:
        lead = self.input_mean.shape[:-2]
        if size == 1 and inputs.ndim <= 1:
            inputs = inputs[..., None]
        if inputs.shape[-1:] != (size,):
            raise ArgumentError(f"inputs {inputs.shape} must have {size} values in the last axis")
        if lead and inputs.shape[:-1] != lead:
            raise ArgumentError(
                f"inputs {inputs.shape} do not fit a mixture with leading axes {lead}"
            )
        if not (abs(inputs) < _BEYOND).all():
            raise ArgumentError("inputs hold values beyond all support; change their unit")
        return inputs


def parts_of(
    priors: NDArray, covariance: NDArray, inputs: int, given: Dimensions, ridge: float
) -> tuple[NDArray, NDArray, NDArray]:
    """What of a regression depends on no mean: its ``linear``, ``covariance`` and ``log_scale``.

    Of covariances (..., K, I + O, I + O) with the inputs first, which messages call ``given``.
    """
    whiten = _whitening(covariance[..., :inputs, :inputs])
    if whiten is None:
        raise ArgumentError(
            f"The covariance of the given dimensions {given} is not positive definite "
            "in every component. Fit with a larger ridge, or give other dimensions"
        )
    explained = covariance[..., inputs:, :inputs] @ whiten.swapaxes(-1, -2)
    linear = np.concatenate((whiten, explained @ whiten), axis=-2)
    conditional = covariance[..., inputs:, inputs:] - explained @ explained.swapaxes(-1, -2)
    if type(ridge) is not float or ridge != 0.0:
        conditional = add_ridge(conditional, number("ridge", ridge, least=0))
    diagonal = whiten.diagonal(axis1=-2, axis2=-1)
    log_scale = np.log(np.maximum(priors * np.multiply.reduce(diagonal, -1), _TINY))
    return linear, conditional, log_scale


def _whitening(covariance: NDArray) -> NDArray | None:
    """Inverse Cholesky factor (..., I, I); None if a covariance is not positive definite."""
    if covariance.shape[-1] == 1:
        return covariance**-0.5 if (covariance > 0).all() else None
    try:
        return np.linalg.inv(np.linalg.cholesky(covariance))
    except np.linalg.LinAlgError:
        return None


def _order(dim: int, given: Dimensions, of: Dimensions | None) -> tuple[int, NDArray | None]:
    """Number of inputs, and dimensions in the order inputs, outputs; None when they already are."""
    if of is None and isinstance(given, tuple) and given == (0,) and dim > 1:
        return 1, None
    inputs = dimensions("given", given, dim)
    outputs = dimensions("of", np.setdiff1d(np.arange(dim), inputs) if of is None else of, dim)
    order = np.concatenate([inputs, outputs])
    if len(np.unique(order)) < len(order):
        raise ArgumentError(
            f"given={inputs.tolist()} and of={outputs.tolist()} must be different dimensions out "
            f"of 0..{dim - 1}, at least one each"
        )
    return len(inputs), None if np.array_equal(order, np.arange(dim)) else order
