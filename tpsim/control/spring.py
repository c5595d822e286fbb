"""Mass-spring-damper paths: the attractor that follows a reference (Section 5, demo_spring01)."""

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import HUGE, finite_array, matrix, number
from tpsim.control.feedback import Plan
from tpsim.errors import ArgumentError


def spring_damper(
    targets: ArrayLike,
    stiffness: ArrayLike,
    damping: ArrayLike,
    dt: float,
    initial: ArrayLike | None = None,
) -> Plan:
    """Path of a unit mass on a spring to a moving target, ddx = K (target - x) - D dx.

    The step is semi-implicit Euler (the velocity first), stable for stiff springs.

    Parameters
    ----------
    targets : array (T, dim)
        Where the spring is tied at each step [m, rad].
    stiffness, damping : float, array (dim, dim) or (T, dim, dim)
        K [1/s²] and D [1/s], as returned by :func:`impedance` and :func:`impedance_of`.
    dt : float
        Time step [s].
    initial : array (2 dim,), optional
        Position and velocity before the first step; by default at rest on the first target.

    Returns
    -------
    Plan
        states (T, 2 dim) after each step and controls (T, dim), the accelerations of each step.

    Raises
    ------
    ArgumentError
        If shapes do not fit, an entry is not finite, dt is not positive, or the path diverges.

    """
    targets, dt = matrix("targets", targets), number("dt", dt, above=0, what="step [s]")
    T, dim = targets.shape
    K, D = _over_time("stiffness", stiffness, T, dim), _over_time("damping", damping, T, dim)
    initial = (
        np.r_[targets[0], np.zeros(dim)] if initial is None else finite_array("initial", initial)
    )
    if initial.shape != (2 * dim,):
        raise ArgumentError(f"initial has shape {initial.shape}; give position and velocity")
    x, dx = initial[:dim], initial[dim:]
    states, controls = np.empty((T, 2 * dim)), np.empty((T, dim))
    with np.errstate(over="ignore", invalid="ignore"):
        for t in range(T):
            controls[t] = K[t] @ (targets[t] - x) - D[t] @ dx
            dx = dx + dt * controls[t]
            x = x + dt * dx
            states[t, :dim], states[t, dim:] = x, dx
    if not np.abs(states).max() < HUGE or not np.abs(controls).max() < HUGE:
        raise ArgumentError(
            "with this stiffness and damping the spring diverges from its targets at dt = "
            f"{dt} s; take a smaller step, or K dt² and D dt below 1"
        )
    return Plan(states, controls)


def damping_of(stiffness: float, ratio: float = 1.0) -> float:
    """Damping D = 2 ratio sqrt(K) [1/s] of a unit mass, ``ratio`` 1 being critical.

    The optimal controller of :func:`impedance`, D = sqrt(2 K), has the ratio 1/sqrt(2).
    """
    stiffness, ratio = number("stiffness", stiffness, least=0), number("ratio", ratio, least=0)
    return 2.0 * ratio * float(np.sqrt(stiffness))


def _over_time(name: str, gain: ArrayLike, T: int, dim: int) -> np.ndarray:
    gain = finite_array(name, gain)
    gain = gain * np.eye(dim) if gain.ndim == 0 else gain
    if gain.shape not in ((dim, dim), (T, dim, dim)):
        raise ArgumentError(
            f"{name} has shape {gain.shape}; give a number, ({dim}, {dim}) or ({T}, {dim}, {dim})"
        )
    return np.broadcast_to(gain, (T, dim, dim))
