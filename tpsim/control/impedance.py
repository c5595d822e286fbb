"""Stiffness and damping from precision: minimal intervention in closed form (Section 6)."""

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import felt, instance, shown
from tpsim.control.feedback import Feedback
from tpsim.control.lqr import Regulator
from tpsim.errors import ArgumentError

_INDEFINITE = 1e-8
"""Relative size of a negative eigenvalue that is still taken for rounding of zero."""


def impedance(precision: ArrayLike, effort: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Optimal stiffness and damping of a double integrator, infinite horizon, closed form.

    The controller u = -stiffness (x - x_hat) - damping dx minimises the integral of
    (x - x_hat)ᵀ Λ (x - x_hat) + uᵀ R u for ddx = u (Eq. 34 in continuous time, no cost on
    velocity). With R = r I

        stiffness = (Λ / r)^(1/2),    damping = (2 stiffness)^(1/2),

    both from one symmetric eigendecomposition. A matrix effort R = L Lᵀ is brought to the
    identity by the congruence y = Lᵀ x, which exists for every positive definite R: the closed
    form holds with Λ replaced by L⁻¹ Λ L⁻ᵀ, and the gains are L⁻ᵀ (.) Lᵀ. Then R stiffness is
    symmetric (stiffness alone is not); with R = r M(q) so is the physical stiffness M stiffness.
    Where Λ is zero in a direction, so are stiffness and damping: the arm is free there.

    Parameters
    ----------
    precision : array (..., n, n)
        Symmetric positive semi-definite Λ [1/m², 1/rad²].
    effort : float, array (..., 1, 1) or array (..., n, n)
        Cost r > 0 of acceleration, or the symmetric positive definite matrix R.

    Returns
    -------
    stiffness : ndarray (..., n, n)
        Acceleration per displacement [1/s²]; times inertia it is N/m or Nm/rad.
    damping : ndarray (..., n, n)
        Acceleration per velocity [1/s].

    Raises
    ------
    ArgumentError
        If the precision is indefinite or not finite, or the effort is not positive.

    """
    precision, effort = felt("precision", precision), felt("effort", effort)
    shape = precision.shape
    if len(shape) < 2 or shape[-1] != shape[-2] or shape[-1] == 0:
        raise ArgumentError(
            f"precision has shape {precision.shape}; give square matrices (..., n, n)"
        )
    if np.abs(precision - precision.mT).max(initial=0.0) > 1e-6 * np.abs(precision).max(
        initial=0.0
    ):
        raise ArgumentError("precision is not symmetric; pass 0.5 * (P + P.T) if that is meant")
    if effort.ndim == 1:
        raise ArgumentError(f"effort has shape {effort.shape}; give efforts over time as (T, 1, 1)")
    if effort.ndim == 0 or effort.shape[-1] == 1:
        if not (effort > 0).all():
            raise ArgumentError(f"effort is {shown(effort)}; give a positive number")
        return _scaled_roots(precision / effort)
    return _congruent_roots(precision, effort)


def impedance_of(feedback: Feedback | Regulator) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and damping inside feedback gains, K_t = [K_p, K_v] (Section 6).

    The force law is then u_t = K_p (x_hat_t - x) - K_v dx, up to the feedforward term.

    Parameters
    ----------
    feedback : Feedback or Regulator
        With ``gain`` (..., m, 2 m), made by :func:`lqt` or :func:`lqr` for a double integrator.

    Returns
    -------
    stiffness, damping : ndarray (..., m, m)

    Raises
    ------
    ArgumentError
        If the gain is not that of a double integrator.

    """
    if not isinstance(feedback, Feedback):
        instance("feedback", feedback, Regulator, "or a Feedback")
    gain = feedback.gain
    controls, states = gain.shape[-2:]
    if states != 2 * controls:
        raise ArgumentError(
            f"gain has shape {gain.shape}; stiffness and damping need (..., m, 2 m): "
            "use integrator(dim, dt, order=2)"
        )
    return gain[..., :controls], gain[..., controls:]


def _scaled_roots(scaled):
    """Square roots of Λ / r and of twice that root, from one eigendecomposition."""
    values, vectors = np.linalg.eigh(scaled)
    if (values[..., 0] < -_INDEFINITE * np.maximum(np.abs(values[..., -1]), 1e-300)).any():
        raise ArgumentError(
            f"precision is indefinite (smallest eigenvalue over effort {values[..., 0].min():.3g});"
            " give a symmetric positive semi-definite matrix"
        )
    roots = np.sqrt(np.maximum(values, 0.0))
    transposed = np.swapaxes(vectors, -1, -2)
    stiffness = (vectors * roots[..., None, :]) @ transposed
    damping = (vectors * np.sqrt(2.0 * roots)[..., None, :]) @ transposed
    return stiffness, damping


def _congruent_roots(precision, effort):
    """The roots in the coordinates y = Lᵀ x where the effort is the identity, brought back."""
    try:
        L = np.linalg.cholesky(effort)
        half = np.linalg.solve(L, precision)
    except (np.linalg.LinAlgError, ValueError) as error:
        raise ArgumentError(
            f"effort of shape {effort.shape} is not usable with a precision of shape "
            f"{precision.shape}: {error}; give a positive number or a symmetric positive "
            "definite matrix (n, n)"
        ) from error
    L_transposed = np.swapaxes(L, -1, -2)
    whitened = np.linalg.solve(L, np.swapaxes(half, -1, -2))
    return tuple(
        np.linalg.solve(L_transposed, root @ L_transposed) for root in _scaled_roots(whitened)
    )
