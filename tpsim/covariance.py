"""Covariance matrices: checked, regularised, inverted, whatever the units of their variables."""

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import finite_array, frozen, number
from tpsim.errors import ArgumentError

WORST_CONDITION = 1e13  # beyond it a double holds less than three digits of the inverse


ROUNDING = 1e-8  # of unit variances: a negative eigenvalue up to this is taken for zero


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
    unit = scales(matrix, name)
    return symmetric(inverse_of_scaled(matrix * unit, name)) * unit


def scales(matrix: np.ndarray, name: str) -> np.ndarray:
    """By what to multiply the entries of matrices (..., D, D) for unit variances."""
    diagonal = matrix.diagonal(0, -2, -1)
    if not np.minimum.reduce(diagonal, None, initial=np.inf) > 0:
        raise ArgumentError(_singular(name))
    scale = 1 / np.sqrt(diagonal)
    return scale[..., :, None] * scale[..., None, :]


def inverse_of_scaled(matrix: np.ndarray, name: str) -> np.ndarray:
    """Work of :func:`inverse_spd` for variances near one; symmetric but for rounding."""
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError as error:
        raise ArgumentError(_singular(name)) from error
    shrinkage = inverse.diagonal(0, -2, -1)
    least = np.minimum.reduce(shrinkage, None, initial=np.inf)
    if not (least > 0 and np.maximum.reduce(shrinkage, None, initial=0.0) < WORST_CONDITION):
        raise ArgumentError(_singular(name))
    return inverse


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


def checked_covariance(covariance: np.ndarray) -> np.ndarray:
    """Covariances (..., D, D), exactly symmetric, or an ArgumentError where they are none."""
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


def faded(precision: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Shares (..., D, D) that are left of information when its place is uncertain.

    What is known with a precision Lambda about a place that is itself known up to a covariance S
    has the precision (Lambda^-1 + S)^-1 = (I + Lambda S)^-1 Lambda, and the information Lambda mu
    becomes (I + Lambda S)^-1 Lambda mu; Lambda and S may be singular.
    """
    return np.linalg.inv(np.eye(precision.shape[-1]) + precision @ covariance)


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
