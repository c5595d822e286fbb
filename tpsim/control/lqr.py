"""Infinite-horizon linear quadratic regulation, discrete and continuous."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import solve_continuous_are, solve_discrete_are

from tpsim.archive import Stored
from tpsim.border import checked
from tpsim.checks import felt, flag
from tpsim.control.system import LinearSystem
from tpsim.errors import ArgumentError

_UNSTABLE = (
    "no stabilising regulator exists: give Q some weight on every mode that does not vanish by "
    "itself, or use impedance() or a finite horizon (lqt)"
)


@dataclass(frozen=True, eq=False)
class Regulator(Stored):
    """Stationary optimal feedback u = -gain xi.

    Parameters
    ----------
    gain : ndarray (..., m, n)
        Feedback gain.
    riccati : ndarray (..., n, n)
        Solution P of the algebraic Riccati equation: the cost-to-go is xiᵀ P xi.

    """

    gain: np.ndarray
    riccati: np.ndarray

    def __post_init__(self) -> None:
        checked(self)


def lqr(
    system: LinearSystem | tuple, Q: ArrayLike, R: ArrayLike, *, discrete: bool = True
) -> Regulator:
    """Infinite-horizon regulator, the limit of Eq. 34 for T to infinity.

    Parameters
    ----------
    system : LinearSystem or pair (A, B)
        Dynamics, xi' = A xi + B u (discrete) or dxi = A xi + B u (continuous).
    Q : array (..., n, n)
        Symmetric positive semi-definite cost (precision) of the state.
    R : float or array (..., m, m)
        Positive cost (effort) of the control.
    discrete : bool
        Discrete or continuous time. A LinearSystem must agree with it: it is continuous when
        its dt is None.

    Returns
    -------
    Regulator
        gain (..., m, n) and riccati (..., n, n); leading axes of Q and R broadcast.

    Raises
    ------
    ArgumentError
        If shapes do not fit, Q is indefinite, R is not positive definite, or no stabilising
        solution exists: a mode that is not stable is not seen by Q or not moved by B.

    """
    A, B = _matrices(system, flag("discrete", discrete))
    n, m = B.shape
    Q, R = felt("Q", Q), felt("R", R)
    R = R * np.eye(m) if R.ndim == 0 else R
    if Q.shape[-2:] != (n, n) or R.shape[-2:] != (m, m):
        raise ArgumentError(
            f"Q has shape {Q.shape} and R {R.shape}; for this system give Q (..., {n}, {n}) "
            f"and R scalar or (..., {m}, {m})"
        )
    _check_definite(Q, R)
    leading = np.broadcast_shapes(Q.shape[:-2], R.shape[:-2])
    Q, R = np.broadcast_to(Q, (*leading, n, n)), np.broadcast_to(R, (*leading, m, m))
    P = np.empty((*leading, n, n))
    for index in np.ndindex(leading):
        P[index] = _riccati(A, B, Q[index], R[index], discrete)
    if discrete:
        gain = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
    else:
        gain = np.linalg.solve(R, B.T @ P)
    _check_stable(A - B @ gain, discrete)
    return Regulator(gain, P)


def _riccati(A, B, Q, R, discrete):
    solve = solve_discrete_are if discrete else solve_continuous_are
    try:
        # Only the ratio of Q and R matters for the gain; a unit scale keeps the solver accurate.
        scale = np.trace(R) / len(R)
        with np.errstate(invalid="ignore"):  # what is not solved is not stable, and refused below
            return scale * solve(A, B, Q / scale, R / scale)
    except (np.linalg.LinAlgError, ValueError) as error:
        raise ArgumentError(_UNSTABLE) from error


def _check_stable(closed_loop, discrete):
    """Raise where a mode stays for ever; rounding moves a double eigenvalue by 1e-8."""
    modes = np.linalg.eigvals(closed_loop)
    growth = np.abs(modes) - 1.0 if discrete else modes.real / np.abs(modes).max(initial=1e-300)
    if (growth > -1e-7).any():
        raise ArgumentError(_UNSTABLE)


def _matrices(system, discrete):
    """The matrices A, B of a LinearSystem or pair, checked against ``discrete``."""
    if isinstance(system, tuple | list) and len(system) == 2:
        system = LinearSystem(*system, None)
    elif not isinstance(system, LinearSystem):
        raise ArgumentError(
            f"system is a {type(system).__name__}; give integrator(dim, dt), or a pair (A, B)"
        )
    elif discrete is (system.dt is None):
        kind = "continuous" if system.dt is None else "discrete"
        raise ArgumentError(
            f"the system is {kind} (dt = {system.dt}) but discrete is {discrete}; "
            "call lqr(..., discrete=False) for a continuous system and only for one"
        )
    if system.steps is not None:
        raise ArgumentError(
            f"the system changes over {system.steps} steps; an infinite horizon needs one that "
            "stays as it is: give A (n, n) and B (n, m), or use lqt()"
        )
    return system.A, system.B


def _check_definite(Q, R):
    if not (np.linalg.eigvalsh(R)[..., 0] > 0).all():
        raise ArgumentError("R (effort) is not positive definite; give a positive number or matrix")
    values = np.linalg.eigvalsh(Q)
    if (values[..., 0] < -1e-8 * np.abs(values).max(axis=-1)).any():
        raise ArgumentError(
            f"Q (precision) is indefinite (smallest eigenvalue {values[..., 0].min():.3g}); "
            "give a positive semi-definite matrix"
        )
