"""Gaussian algebra over leading axes: the one value that every model hands to the next.

Equation numbers are those of S. Calinon, "A Tutorial on Task-Parameterized Movement Learning
and Retrieval" (2016).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Stored
from tpsim.checks import (
    Seed,
    affordable,
    dimensions,
    finite_array,
    frozen,
    frozen_array,
    generator,
    instance,
    picked,
    several,
)
from tpsim.covariance import WORST_CONDITION as WORST_CONDITION
from tpsim.covariance import add_ridge as add_ridge
from tpsim.covariance import checked_covariance
from tpsim.covariance import cholesky as cholesky
from tpsim.covariance import faded as faded
from tpsim.covariance import floor_eigenvalues as floor_eigenvalues
from tpsim.covariance import inverse_spd as inverse_spd
from tpsim.covariance import symmetric as symmetric
from tpsim.covariance import unit_variances as unit_variances
from tpsim.errors import ArgumentError

LOG_2PI = float(np.log(2 * np.pi))

Dimensions = int | Sequence[int] | np.ndarray


@dataclass(frozen=True, eq=False, init=False)
class Gaussian(Stored):
    """Normal distributions N(mean, covariance), one for every index of the leading axes.

    Parameters
    ----------
    mean : (..., D)
    covariance : (..., D, D), symmetric and positive semi-definite
        Leading axes broadcast against those of ``mean``.

    Both are copied, and read-only from then on.

    Raises
    ------
    ArgumentError
        Wrong shapes, NaN or infinite entries, asymmetry, negative variances or eigenvalues. A
        singular covariance is accepted here and refused where it must be inverted.
    """

    mean: np.ndarray
    covariance: np.ndarray

    def __init__(self, mean: ArrayLike, covariance: ArrayLike):
        mean, covariance = frozen_array("mean", mean), frozen_array("covariance", covariance)
        D = mean.shape[-1] if mean.ndim else 0
        if D == 0 or covariance.shape[-2:] != (D, D):
            raise ArgumentError(
                f"mean has shape {mean.shape} and covariance {covariance.shape}; they must be "
                "(..., D) and (..., D, D) with the same D >= 1"
            )
        try:
            leading = np.broadcast_shapes(mean.shape[:-1], covariance.shape[:-2])
        except ValueError as error:
            raise ArgumentError(
                f"leading axes of mean {mean.shape} and covariance {covariance.shape} differ; "
                "make them equal or of length one"
            ) from error
        object.__setattr__(self, "mean", np.broadcast_to(mean, (*leading, D)))
        covariance = checked_covariance(covariance)
        object.__setattr__(self, "covariance", np.broadcast_to(covariance, (*leading, D, D)))

    @classmethod
    def trusted(cls, mean: np.ndarray, covariance: np.ndarray) -> "Gaussian":
        """Build without checks and copies, from arrays that are valid by construction.

        The trusted path of control loops: the arrays become read-only, the caller gives them away.
        """
        gaussian = object.__new__(cls)
        mean.setflags(write=False)
        covariance.setflags(write=False)
        fields = gaussian.__dict__
        fields["mean"], fields["covariance"] = mean, covariance
        return gaussian

    @property
    def dim(self) -> int:
        """Dimension D of the space."""
        return self.mean.shape[-1]

    def __getitem__(self, index: object) -> "Gaussian":
        """Select along the leading axes."""
        index = index if isinstance(index, tuple) else (index,)
        return Gaussian.trusted(
            picked(self.mean, (*index, Ellipsis, slice(None))),
            picked(self.covariance, (*index, Ellipsis, slice(None), slice(None))),
        )

    @cached_property
    def precision(self) -> np.ndarray:
        """Inverse of the covariance, (..., D, D); ArgumentError where it is singular."""
        return frozen(inverse_spd(self.covariance, "covariance"))

    @cached_property
    def _whitening(self) -> tuple[np.ndarray, np.ndarray]:
        """Inverse Cholesky factor W of the covariance (W Sigma W' = I), and log det W."""
        W = np.linalg.inv(cholesky(self.covariance, "covariance"))
        return W, np.log(np.diagonal(W, axis1=-2, axis2=-1)).sum(-1)

    def log_density(self, x: ArrayLike) -> np.ndarray:
        """Log density of ``x`` (..., D), broadcast against the leading axes.

        Use ``gaussian.log_density(x[..., None, :])`` for the densities (..., K) of K components.
        """
        x = finite_array("x", x)
        if x.shape[-1:] != (self.dim,):
            raise ArgumentError(f"x has shape {x.shape}; its last axis must be D = {self.dim}")
        W, log_det = self._whitening
        try:
            np.broadcast_shapes(x.shape[:-1], self.mean.shape[:-1])
        except ValueError:
            raise ArgumentError(
                f"x has leading axes {x.shape[:-1]}, the mean {self.mean.shape[:-1]}; they must "
                "broadcast, as in x[..., None, :]"
            ) from None
        z = np.matmul(W, (x - self.mean)[..., None])[..., 0]
        return log_det - 0.5 * (self.dim * LOG_2PI + np.einsum("...i,...i", z, z))

    def affine(self, A: ArrayLike, b: ArrayLike = 0.0) -> "Gaussian":
        """Distribution of A x + b, Eqs (1-2).

        Parameters
        ----------
        A : (..., E, D)
            Linear part.
        b : (..., E)
            Offset.
        """
        A, b = finite_array("A", A), finite_array("b", b)
        if A.ndim < 2 or A.shape[-1] != self.dim or (b.ndim and b.shape[-1] != A.shape[-2]):
            raise ArgumentError(
                f"A has shape {A.shape} and b {b.shape}; they must be (..., E, {self.dim}) and "
                "(..., E)"
            )
        mean = (A @ self.mean[..., None])[..., 0] + b
        covariance = symmetric(A @ self.covariance @ np.swapaxes(A, -1, -2))
        return Gaussian.trusted(mean, np.broadcast_to(covariance, (*mean.shape, mean.shape[-1])))

    def marginal(self, dims: Dimensions) -> "Gaussian":
        """Distribution of the dimensions ``dims`` alone."""
        dims = dimensions("dims", dims, self.dim)
        return Gaussian.trusted(self.mean[..., dims], self.covariance[..., dims[:, None], dims])

    def condition(
        self, value: ArrayLike, given: Dimensions, of: Dimensions | None = None
    ) -> "Gaussian":
        """Distribution of the dimensions ``of`` when ``given`` have ``value``, Eqs (14-15).

        Parameters
        ----------
        value : (..., I)
            Leading axes broadcast against those of the Gaussian.
        given : one or I integers
            Dimensions of the input.
        of : one or O integers, optional
            Dimensions of the output, default all the others in their order.
        """
        inputs = dimensions("given", given, self.dim)
        others = np.setdiff1d(np.arange(self.dim), inputs)
        outputs = dimensions("of", others if of is None else of, self.dim)
        if np.intersect1d(inputs, outputs).size:
            raise ArgumentError(f"given {inputs} and of {outputs} overlap; keep them disjoint")
        value = finite_array("value", value)
        if value.shape[-1:] != inputs.shape:
            raise ArgumentError(
                f"value has shape {value.shape}; its last axis must be {inputs.size}, "
                "one number for each dimension in given"
            )
        gain = self._regression(inputs, outputs)
        residual = value - self.mean[..., inputs]
        mean = self.mean[..., outputs] + (gain @ residual[..., None])[..., 0]
        joint = self.covariance[..., outputs[:, None], outputs]
        explained = gain @ self.covariance[..., inputs[:, None], outputs]
        covariance = symmetric(joint - explained)
        return Gaussian.trusted(mean, np.broadcast_to(covariance, (*mean.shape, outputs.size)))

    def _regression(self, given: np.ndarray, of: np.ndarray) -> np.ndarray:
        """Gain Sigma_OI Sigma_II^-1, (..., O, I)."""
        cross = self.covariance[..., of[:, None], given]
        return cross @ inverse_spd(self.covariance[..., given[:, None], given], "input covariance")

    def sample(self, rng: Seed, size: int | tuple[int, ...] = ()) -> np.ndarray:
        """Draw samples, shape ``size`` + (..., D), also where the covariance is singular.

        ``rng`` is a numpy Generator or a seed.
        """
        sizes = size if isinstance(size, tuple) else (size,)
        each = self.mean.size
        for one in sizes:
            each *= affordable("size", one, each, least=0)
        eigenvalues, V = np.linalg.eigh(self.covariance)
        root = V * np.sqrt(np.maximum(eigenvalues, 0))[..., None, :]
        z = generator("rng", rng).standard_normal((*sizes, *self.mean.shape))
        return self.mean + (root @ z[..., None])[..., 0]

    def _product(self, factors: Sequence["Gaussian"]) -> "Gaussian":
        """Product of factors, this one the first of them."""
        if len({g.dim for g in factors}) > 1:
            raise ArgumentError(
                f"the gaussians have dimensions {[g.dim for g in factors]}; they must be equal"
            )
        origin = self.mean  # far from zero, differences keep the digits that sums would lose
        precision, information = np.zeros(1), np.zeros(1)
        try:
            for g in factors:
                precision = precision + g.precision
                information = information + g.precision @ (g.mean - origin)[..., None]
        except ArgumentError as error:
            raise ArgumentError(f"a factor of gaussians cannot be inverted: {error}") from error
        except ValueError as error:
            raise ArgumentError(f"leading axes of the gaussians do not match ({error})") from error
        covariance = inverse_spd(precision, "sum of precisions")
        return Gaussian.trusted(origin + (covariance @ information)[..., 0], covariance)

    def _mixed(self, weights: np.ndarray) -> "Gaussian":
        """Single Gaussian of a mixture, of which these are the components."""
        return mixed_moments(weights, self)


def gaussian_product(gaussians: Sequence[Gaussian]) -> Gaussian:
    """Product of Gaussians, Eq. (6), in information form: precisions add.

    Its mean is the minimum of the weighted sum of squared errors of Eq. (3).

    Parameters
    ----------
    gaussians : sequence of Gaussian with the same D, or on one manifold
        Leading axes broadcast.

    Raises
    ------
    ArgumentError
        No factor, different dimensions, or a covariance that cannot be inverted.
    """
    factors = several("gaussians", gaussians, Gaussian)
    if not factors:
        raise ArgumentError("a product needs at least one Gaussian; none was given")
    curved = (g for g in factors if type(g) is not Gaussian)
    return next(curved, factors[0])._product(factors)


def match_moments(weights: ArrayLike, gaussian: Gaussian) -> Gaussian:
    """Single Gaussian with the mean and covariance of a mixture, Eqs (17-19) and App. C.

    Parameters
    ----------
    weights : (..., K)
        Non-negative, summing to one over the last axis.
    gaussian : Gaussian (..., K, D)
        The components.
    """
    h = finite_array("weights", weights)
    parts = instance("gaussian", gaussian, Gaussian)
    if h.ndim == 0 or parts.mean.ndim < 2 or parts.mean.shape[-2] != h.shape[-1]:
        raise ArgumentError(
            f"weights have shape {h.shape} and the gaussian means {parts.mean.shape}; they must be "
            "(..., K) and (..., K, D)"
        )
    if (h < 0).any() or (np.abs(h.sum(-1) - 1) > 1e-6).any():
        raise ArgumentError("weights must not be negative, and sum to one over the last axis")
    try:
        return parts._mixed(h)
    except ValueError as error:
        raise ArgumentError(f"leading axes do not match: {error}") from error


def mixed_moments(h: np.ndarray, gaussian: Gaussian) -> Gaussian:
    """Work of :func:`match_moments` for weights that are known to be a distribution."""
    mean = np.einsum("...k,...kd->...d", h, gaussian.mean)
    deviation = gaussian.mean - mean[..., None, :]
    within = np.einsum("...k,...kij->...ij", h, gaussian.covariance)
    between = np.swapaxes(h[..., None] * deviation, -1, -2) @ deviation
    return Gaussian.trusted(mean, symmetric(within + between))
