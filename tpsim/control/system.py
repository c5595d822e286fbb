"""Linear dynamics for optimal control: integrator chains (Eq. 33) and any A, B."""

from dataclasses import dataclass
from math import factorial

import numpy as np

from tpsim.archive import Stored
from tpsim.checks import affordable, finite_array, flag, frozen_array, number, whole
from tpsim.errors import ArgumentError


@dataclass(frozen=True, eq=False)
class LinearSystem(Stored):
    """A linear system, discrete (xi' = A xi + B u every dt) or continuous (dxi = A xi + B u).

    Parameters
    ----------
    A : array (n, n)
        State matrix.
    B : array (n, m)
        Input matrix.
    dt : float or None
        Time step [s]; None for a system in continuous time.

    Raises
    ------
    ArgumentError
        If the shapes do not fit, an entry is not finite or dt is not positive.

    """

    A: np.ndarray
    B: np.ndarray
    dt: float | None = None

    def __post_init__(self) -> None:
        A, B = frozen_array("A", self.A), frozen_array("B", self.B)
        if A.ndim != 2 or A.shape[0] != A.shape[1] or B.ndim != 2 or B.shape[0] != A.shape[0]:
            raise ArgumentError(
                f"A has shape {A.shape} and B {B.shape}; give A (n, n) and B (n, m)"
            )
        if self.dt is not None:
            object.__setattr__(self, "dt", number("dt", self.dt, above=0, what="step [s]"))
        object.__setattr__(self, "A", A)
        object.__setattr__(self, "B", B)

    def step(self, state: np.ndarray, control: np.ndarray) -> np.ndarray:
        """Next state (..., n) of a discrete system: A state + B control."""
        state, control = finite_array("state", state), finite_array("control", control)
        n, m = self.B.shape
        if state.shape[-1:] != (n,) or control.shape[-1:] != (m,):
            raise ArgumentError(
                f"state has shape {state.shape} and control {control.shape}; give (..., {n}) and "
                f"(..., {m})"
            )
        following: np.ndarray = state @ self.A.T + control @ self.B.T
        return following


def integrator(
    dim: int, dt: float | None = None, order: int = 2, exact: bool = False
) -> LinearSystem:
    """Chain of integrators driven at its highest derivative, Eq. 33.

    The state is [x, dx, ...] with ``order`` blocks of ``dim`` entries; the control is the
    derivative of that order (velocity, acceleration, jerk).

    Parameters
    ----------
    dim : int
        Dimension of x.
    dt : float or None
        Time step [s]; None gives the chain in continuous time.
    order : int
        1, 2, 3 or more integrators.
    exact : bool
        False is the Euler step of Eq. 33; True integrates a control held over the step exactly.

    Returns
    -------
    LinearSystem
        A (order dim, order dim), B (order dim, dim).

    Raises
    ------
    ArgumentError
        If dim or order is below one, or dt is not positive.

    """
    order = whole("order", order, least=1)
    dim = affordable("dim", dim, order**2 * int(whole("dim", dim, least=1)))
    if dt is not None:
        dt = number("dt", dt, above=0, what="step [s]")
    if dt is None:
        A, B = np.eye(order, k=1), np.eye(order)[:, -1:]
    elif flag("exact", exact):
        A = np.sum([np.eye(order, k=k) * dt**k / factorial(k) for k in range(order)], axis=0)
        B = np.array([[dt**k / factorial(k)] for k in range(order, 0, -1)])
    else:
        A, B = np.eye(order) + dt * np.eye(order, k=1), dt * np.eye(order)[:, -1:]
    return LinearSystem(np.kron(A, np.eye(dim)), np.kron(B, np.eye(dim)), dt)
