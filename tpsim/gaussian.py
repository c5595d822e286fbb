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
    dimensions,
    finite_array,
    frozen,
    frozen_array,
    generator,
    instance,
    number,
    several,
    whole,
)
from tpsim.errors import ArgumentError

LOG_2PI = float(np.log(2 * np.pi))
WORST_CONDITION = 1e13  # beyond it a double holds less than three digits of the inverse
ROUNDING = 1e-8  # of unit variances: a negative eigenvalue up to this is taken for zero

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
        covariance = _checked_covariance(covariance)
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
            self.mean[(*index, Ellipsis, slice(None))],
            self.covariance[(*index, Ellipsis, slice(None), slice(None))],
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
        sizes = tuple(whole("size", one) for one in sizes)
        eigenvalues, V = np.linalg.eigh(self.covariance)
        root = V * np.sqrt(np.maximum(eigenvalues, 0))[..., None, :]
        z = generator("rng", rng).standard_normal((*sizes, *self.mean.shape))
        return self.mean + (root @ z[..., None])[..., 0]


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
    factors = several("gaussians", gaussians, Gaussian)
    if not factors:
        raise ArgumentError("a product needs at least one Gaussian; none was given")
    if len({g.dim for g in factors}) > 1:
        raise ArgumentError(
            f"the factors have dimensions {[g.dim for g in factors]}; they must be equal"
        )
    origin = factors[0].mean  # far from zero, differences keep the digits that sums would lose
    precision, information = np.zeros(1), np.zeros(1)
    try:
        for g in factors:
            precision = precision + g.precision
            information = information + g.precision @ (g.mean - origin)[..., None]
    except ValueError as error:
        raise ArgumentError(f"leading axes of the factors do not match ({error})") from error
    covariance = inverse_spd(precision, "sum of precisions")
    return Gaussian.trusted(origin + (covariance @ information)[..., 0], covariance)


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
        return mixed_moments(h, parts)
    except ValueError as error:
        raise ArgumentError(f"leading axes do not match: {error}") from error


def mixed_moments(h: np.ndarray, gaussian: Gaussian) -> Gaussian:
    """Work of :func:`match_moments` for weights that are known to be a distribution."""
    mean = np.einsum("...k,...kd->...d", h, gaussian.mean)
    deviation = gaussian.mean - mean[..., None, :]
    within = np.einsum("...k,...kij->...ij", h, gaussian.covariance)
    between = np.swapaxes(h[..., None] * deviation, -1, -2) @ deviation
    return Gaussian.trusted(mean, symmetric(within + between))


def floor_eigenvalues(covariance: ArrayLike, minimum: ArrayLike) -> np.ndarray:
    """Raise eigenvalues of covariances (..., D, D) to at least ``minimum`` (...), Eq. (7)."""
    eigenvalues, V = np.linalg.eigh(_square("covariance", covariance))
    least = finite_array("minimum", minimum)[..., None]
    return symmetric((V * np.maximum(eigenvalues, least)[..., None, :]) @ np.swapaxes(V, -1, -2))


def add_ridge(covariance: ArrayLike, rho: float) -> np.ndarray:
    """Add an isotropic covariance rho I to covariances (..., D, D), Eq. (8)."""
    covariance = _square("covariance", covariance)
    return covariance + number("rho", rho, least=0) * np.eye(covariance.shape[-1])


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


def unit_variances(matrix: np.ndarray) -> np.ndarray:
    """Scale variables (..., D, D) to unit variance, so that eigenvalues do not depend on units.

    Where a variance is zero, the largest one is the scale.
    """
    variances = matrix.diagonal(0, -2, -1)
    largest = variances.max(-1, keepdims=True)
    size = np.where(variances > 0, variances, np.where(largest > 0, largest, 1.0))
    scale = 1 / np.sqrt(size)
    return matrix * scale[..., :, None] * scale[..., None, :]


def _square(name: str, matrix: ArrayLike) -> np.ndarray:
    matrix = finite_array(name, matrix)
    if matrix.ndim < 2 or matrix.shape[-1] != matrix.shape[-2] or matrix.shape[-1] == 0:
        raise ArgumentError(f"{name} has shape {matrix.shape}; it must be (..., D, D), D >= 1")
    return matrix


def _checked_covariance(covariance: np.ndarray) -> np.ndarray:
    variances = np.diagonal(covariance, axis1=-2, axis2=-1)
    if (variances < 0).any():
        raise ArgumentError("covariance has negative variances on its diagonal")
    asymmetry = np.abs(covariance - covariance.mT).max(initial=0.0)
    if asymmetry > 1e-8 * np.abs(covariance).max(initial=0.0):
        raise ArgumentError("covariance is not symmetric; pass 0.5 * (S + S.T) if that is meant")
    if asymmetry:
        covariance = frozen(symmetric(covariance))
    try:
        np.linalg.cholesky(covariance)
    except np.linalg.LinAlgError:
        _check_eigenvalues(covariance)
    return covariance


def _check_eigenvalues(covariance: np.ndarray) -> None:
    """Raise an ArgumentError where an eigenvalue is below zero by more than rounding."""
    least = np.linalg.eigvalsh(unit_variances(covariance))[..., 0]
    if (least < -ROUNDING).any():
        index = tuple(int(i) for i in np.argwhere(least < -ROUNDING)[0])
        where = f" at index {index}" if index else ""
        raise ArgumentError(
            f"covariance{where} is indefinite: scaled to unit variances, its least eigenvalue is "
            f"{least.min():.3g}. No data have such a covariance; if it is rounding, raise the "
            "eigenvalues with floor_eigenvalues"
        )


def _singular(name: str) -> str:
    return (
        f"{name} is singular, so it has no inverse; add a ridge (add_ridge) or floor its "
        "eigenvalues (floor_eigenvalues) first"
    )
