"""The tracking problem of Eqs 34 and 38, checked and in information form."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import felt, finite_array, instance
from tpsim.control.system import LinearSystem
from tpsim.errors import ArgumentError


@dataclass(frozen=True, eq=False)
class TrackingProblem:
    """Eq. 34 in information form: minimise the sum of xiᵀ Λ xi - 2 xiᵀ eta + uᵀ R u.

    Parameters
    ----------
    system : LinearSystem
        Discrete dynamics with n states and m controls.
    A, B : ndarray (T - 1, n, n), (T - 1, n, m)
        Its matrices at every step.
    Lambda : ndarray (T, n, n)
        Precision of the reference; several coordinate systems add up (Eq. 38).
    eta : ndarray (T, n)
        Λ mu, which needs no inverse where Λ is singular.
    R : ndarray (m, m) or (T, m, m)
        Effort.
    strict : bool
        R is positive definite, so it determines every control.

    """

    system: LinearSystem
    A: np.ndarray
    B: np.ndarray
    Lambda: np.ndarray
    eta: np.ndarray
    R: np.ndarray
    strict: bool


def tracking_problem(
    means: ArrayLike, precisions: ArrayLike, system: LinearSystem, effort: ArrayLike
) -> TrackingProblem:
    """Check the arguments of :func:`lqt`; several coordinate systems become one (Eq. 38)."""
    if instance("system", system, LinearSystem, "integrator(dim, dt)").dt is None:
        raise ArgumentError("the system is continuous (dt = None); give integrator(dim, dt)")
    means, weights = finite_array("means", means), felt("precisions", precisions)
    n, m = system.size
    if (
        means.ndim not in (2, 3)
        or means.shape[-1] != n
        or means.shape[-2] < 1
        or weights.shape != (*means.shape, n)
    ):
        raise ArgumentError(
            f"means have shape {means.shape} and precisions {weights.shape}; for a system "
            f"of {n} states give (T, {n}) and (T, {n}, {n}), or (P, T, ...) for P frames"
        )
    _check_semidefinite(weights, "precision")
    R, strict = _checked_effort(effort, means.shape[-2], m)
    A, B = system.over(means.shape[-2] - 1)
    eta = (weights @ means[..., None])[..., 0]
    if means.ndim == 3:
        weights, eta = weights.sum(axis=0), eta.sum(axis=0)
    return TrackingProblem(system, A, B, weights, eta, R, strict)


def _checked_effort(effort: ArrayLike, T: int, m: int) -> tuple[np.ndarray, bool]:
    """R (m, m) or (T, m, m) and whether it is positive definite."""
    R = felt("effort", effort)
    R = R * np.eye(m) if R.ndim == 0 else R
    if R.shape not in ((m, m), (T, m, m)):
        raise ArgumentError(
            f"effort has shape {R.shape}; give a number, ({m}, {m}) or ({T}, {m}, {m})"
        )
    _check_semidefinite(R, "effort")
    values = np.linalg.eigvalsh(R)
    strict = bool((values[..., 0] > 1e-14 * values[..., -1]).all())
    return R, strict


def _check_semidefinite(matrices: np.ndarray, name: str) -> None:
    """Raise unless all matrices are symmetric and positive semi-definite up to rounding."""
    size = np.abs(matrices).max(axis=(-1, -2))
    skew = np.abs(matrices - np.swapaxes(matrices, -1, -2)).max(axis=(-1, -2))
    slack = (1e-8 * size + 1e-300)[..., None, None] * np.eye(matrices.shape[-1])
    try:
        if (skew > 1e-6 * size).any():
            raise np.linalg.LinAlgError
        np.linalg.cholesky(matrices + slack)
    except np.linalg.LinAlgError:
        raise ArgumentError(
            f"{name} is not symmetric positive semi-definite at every step; "
            "invert a regularised covariance, or give zeros where nothing is asked"
        ) from None
