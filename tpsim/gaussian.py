"""Gaussian algebra over leading axes: the one value that every model hands to the next.

Equation numbers are those of S. Calinon, "A Tutorial on Task-Parameterized Movement Learning
and Retrieval" (2016).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from tpsim.errors import ArgumentError

LOG_2PI = float(np.log(2 * np.pi))
WORST_CONDITION = 1e13  # beyond it a double holds less than three digits of the inverse


@dataclass(frozen=True, eq=False)
class Gaussian:
    """Normal distributions N(mean, covariance), one for every index of the leading axes.

    Parameters
    ----------
    mean : (..., D)
    covariance : (..., D, D), symmetric and positive semi-definite
        Leading axes broadcast against those of ``mean``.

    Raises
    ------
    ArgumentError
        Wrong shapes, NaN or infinite entries, asymmetry, or negative variances. A singular
        covariance is accepted here and refused where it must be inverted.
    """

    mean: np.ndarray
    covariance: np.ndarray

    def __post_init__(self):
        mean = finite_array("mean", self.mean)
        covariance = finite_array("covariance", self.covariance)
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
        object.__setattr__(
            self, "covariance", np.broadcast_to(_checked_symmetric(covariance), (*leading, D, D))
        )

    @classmethod
    def trusted(cls, mean: np.ndarray, covariance: np.ndarray) -> "Gaussian":
        """Build without checks, for results of our own that are valid by construction."""
        gaussian = object.__new__(cls)
        gaussian.__dict__["mean"] = mean
        gaussian.__dict__["covariance"] = covariance
        return gaussian

    @property
    def dim(self) -> int:
        """Dimension D of the space."""
        return self.mean.shape[-1]

    def __getitem__(self, index) -> "Gaussian":
        """Select along the leading axes."""
        index = index if isinstance(index, tuple) else (index,)
        return Gaussian.trusted(
            self.mean[(*index, Ellipsis, slice(None))],
            self.covariance[(*index, Ellipsis, slice(None), slice(None))],
        )

    @cached_property
    def precision(self) -> np.ndarray:
        """Inverse of the covariance, (..., D, D); ArgumentError where it is singular."""
        return inverse_spd(self.covariance, "covariance")

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
        if A.ndim < 2 or A.shape[-1] != self.dim:
            raise ArgumentError(f"A has shape {A.shape}; it must be (..., E, {self.dim})")
        mean = (A @ self.mean[..., None])[..., 0] + b
        covariance = symmetric(A @ self.covariance @ np.swapaxes(A, -1, -2))
        return Gaussian(mean, covariance)

    def marginal(self, dims: Sequence[int]) -> "Gaussian":
        """Distribution of the dimensions ``dims`` alone."""
        dims = self._dimensions("dims", dims)
        return Gaussian.trusted(self.mean[..., dims], self.covariance[..., dims[:, None], dims])

    def condition(
        self, value: ArrayLike, given: Sequence[int], of: Sequence[int] | None = None
    ) -> "Gaussian":
        """Distribution of the dimensions ``of`` when ``given`` have ``value``, Eqs (14-15).

        Parameters
        ----------
        value : (..., I)
            Leading axes broadcast against those of the Gaussian.
        given : sequence of I integers
            Dimensions of the input.
        of : sequence of O integers, optional
            Dimensions of the output, default all the others in their order.
        """
        given = self._dimensions("given", given)
        of = np.setdiff1d(np.arange(self.dim), given) if of is None else of
        of = self._dimensions("of", of)
        if np.intersect1d(given, of).size:
            raise ArgumentError(f"given {given} and of {of} overlap; keep them disjoint")
        value = finite_array("value", value)
        if value.shape[-1:] != given.shape:
            raise ArgumentError(
                f"value has shape {value.shape}; its last axis must be {given.size}, "
                "one number for each dimension in given"
            )
        gain = self._regression(given, of)
        residual = value - self.mean[..., given]
        mean = self.mean[..., of] + (gain @ residual[..., None])[..., 0]
        joint = self.covariance[..., of[:, None], of]
        explained = gain @ self.covariance[..., given[:, None], of]
        covariance = symmetric(joint - explained)
        return Gaussian.trusted(mean, np.broadcast_to(covariance, (*mean.shape, of.size)))

    def _regression(self, given: np.ndarray, of: np.ndarray) -> np.ndarray:
        """Gain Sigma_OI Sigma_II^-1, (..., O, I)."""
        cross = self.covariance[..., of[:, None], given]
        return cross @ inverse_spd(self.covariance[..., given[:, None], given], "input covariance")

    def sample(self, rng: np.random.Generator, size: int | tuple[int, ...] = ()) -> np.ndarray:
        """Draw samples, shape ``size`` + (..., D), also where the covariance is singular."""
        size = (size,) if np.ndim(size) == 0 else tuple(size)
        eigenvalues, V = np.linalg.eigh(self.covariance)
        root = V * np.sqrt(np.maximum(eigenvalues, 0))[..., None, :]
        z = rng.standard_normal((*size, *self.mean.shape))
        return self.mean + (root @ z[..., None])[..., 0]

    def _dimensions(self, name: str, dims: Sequence[int]) -> np.ndarray:
        dims = np.atleast_1d(np.asarray(dims))
        if dims.dtype == bool or not np.issubdtype(dims.dtype, np.integer) or dims.ndim != 1:
            raise ArgumentError(f"{name} is {dims!r}; it must be a sequence of integers")
        if dims.size == 0 or dims.min() < -self.dim or dims.max() >= self.dim:
            raise ArgumentError(
                f"{name} is {dims.tolist()}; the dimensions are 0 to {self.dim - 1}, at least one"
            )
        return dims % self.dim


def gaussian_product(gaussians: Sequence[Gaussian]) -> Gaussian:
    """Product of Gaussians, Eq. (6), in information form: precisions add.

    Parameters
    ----------
    gaussians : sequence of Gaussian with the same D
        Leading axes broadcast.

    Raises
    ------
    ArgumentError
        No factor, different dimensions, or a covariance that cannot be inverted.
    """
    gaussians = list(gaussians)
    if not gaussians:
        raise ArgumentError("a product needs at least one Gaussian; none was given")
    if len({g.dim for g in gaussians}) > 1:
        raise ArgumentError(
            f"the factors have dimensions {[g.dim for g in gaussians]}; they must be equal"
        )
    precision = sum(g.precision for g in gaussians)
    information = sum((g.precision @ g.mean[..., None]) for g in gaussians)
    covariance = inverse_spd(precision, "sum of precisions")
    return Gaussian.trusted((covariance @ information)[..., 0], covariance)


def match_moments(weights: ArrayLike, gaussian: Gaussian) -> Gaussian:
    """Single Gaussian with the mean and covariance of a mixture, Eqs (17-19) and App. C.

    Parameters
    ----------
    weights : (..., K)
        Non-negative, summing to one over the last axis.
    gaussian : Gaussian (..., K, D)
        The components.
    """
    h = np.asarray(weights, float)
    mean = np.einsum("...k,...kd->...d", h, gaussian.mean)
    deviation = gaussian.mean - mean[..., None, :]
    within = np.einsum("...k,...kij->...ij", h, gaussian.covariance)
    between = np.swapaxes(h[..., None] * deviation, -1, -2) @ deviation
    return Gaussian.trusted(mean, symmetric(within + between))


def floor_eigenvalues(covariance: ArrayLike, minimum: float) -> np.ndarray:
    """Raise the eigenvalues of covariances (..., D, D) to at least ``minimum``, Eq. (7)."""
    eigenvalues, V = np.linalg.eigh(np.asarray(covariance, float))
    return symmetric((V * np.maximum(eigenvalues, minimum)[..., None, :]) @ np.swapaxes(V, -1, -2))


def add_ridge(covariance: ArrayLike, rho: float) -> np.ndarray:
    """Add an isotropic covariance rho I to covariances (..., D, D), Eq. (8)."""
    covariance = np.asarray(covariance, float)
    return covariance + rho * np.eye(covariance.shape[-1])


def symmetric(matrix: np.ndarray) -> np.ndarray:
    """Remove the asymmetry that rounding left."""
    return 0.5 * (matrix + matrix.mT)


def cholesky(matrix: np.ndarray, name: str) -> np.ndarray:
    """Cholesky factor, or an ArgumentError that says how to regularise."""
    try:
        return np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError as error:
        raise ArgumentError(_singular(name)) from error


def inverse_spd(matrix: np.ndarray, name: str) -> np.ndarray:
    """Inverse of symmetric positive definite matrices; ArgumentError where it is meaningless.

    Variables are scaled to unit variance first, so that their units do not matter. The diagonal
    of the inverse then holds how many times each variance shrinks when all others are known.
    """
    diagonal = matrix.diagonal(0, -2, -1)
    if not (diagonal > 0).all():
        raise ArgumentError(_singular(name))
    scale = 1 / np.sqrt(diagonal)
    scale = scale[..., :, None] * scale[..., None, :]
    try:
        inverse = np.linalg.inv(matrix * scale)
    except np.linalg.LinAlgError as error:
        raise ArgumentError(_singular(name)) from error
    shrinkage = inverse.diagonal(0, -2, -1)
    if not (shrinkage.min() > 0 and shrinkage.max() < WORST_CONDITION):
        raise ArgumentError(_singular(name))
    return symmetric(inverse) * scale


def finite_array(name: str, value: ArrayLike) -> np.ndarray:
    """Array of finite floats, or an ArgumentError that names it."""
    try:
        array = np.asarray(value, float)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{name} must be an array of numbers; {error}") from error
    if not np.isfinite(array).all():
        raise ArgumentError(f"{name} holds NaN or infinite entries; remove or fill them first")
    return array


def _checked_symmetric(covariance: np.ndarray) -> np.ndarray:
    if (np.diagonal(covariance, axis1=-2, axis2=-1) < 0).any():
        raise ArgumentError("covariance has negative variances on its diagonal")
    asymmetry = np.abs(covariance - covariance.mT).max(initial=0.0)
    if asymmetry > 1e-8 * np.abs(covariance).max(initial=0.0):
        raise ArgumentError("covariance is not symmetric; pass 0.5 * (S + S.T) if that is meant")
    return symmetric(covariance) if asymmetry else covariance


def _singular(name: str) -> str:
    return (
        f"{name} is singular, so it has no inverse; add a ridge (add_ridge) or floor its "
        "eigenvalues (floor_eigenvalues) first"
    )
