"""Linear dynamics for optimal control: integrator chains (Eq. 33) and any A, B."""

from dataclasses import dataclass
from math import factorial, isqrt

import numpy as np

from tpsim.archive import Stored
from tpsim.checks import ROOM, finite_array, flag, frozen_array, number, whole
from tpsim.errors import ArgumentError


@dataclass(frozen=True, eq=False)
class LinearSystem(Stored):
    """A linear system, discrete (xi' = A xi + B u every dt) or continuous (dxi = A xi + B u).

    Parameters
    ----------
    A : array (n, n) or (S, n, n)
        State matrix, or one for each of S steps.
    B : array (n, m) or (S, n, m)
        Input matrix, or one for each step.
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
        steps = {len(part) for part in (A, B) if part.ndim == 3}
        fits = min(A.ndim, B.ndim) >= 2 and max(A.ndim, B.ndim) <= 3 and len(steps) < 2
        if not fits or A.shape[-2] != A.shape[-1] or B.shape[-2] != A.shape[-1]:
            raise ArgumentError(
                f"A has shape {A.shape} and B {B.shape}; give A (n, n) and B (n, m), or as many "
                "of each as there are steps, (S, n, n) and (S, n, m)"
            )
        if self.dt is not None:
            object.__setattr__(self, "dt", number("dt", self.dt, above=0, what="step [s]"))
        object.__setattr__(self, "A", A)
        object.__setattr__(self, "B", B)

    @property
    def size(self) -> tuple[int, int]:
        """Number of states n and of controls m."""
        return self.B.shape[-2], self.B.shape[-1]

    @property
    def steps(self) -> int | None:
        """Number of steps S of a system that changes over time; None where it does not."""
        return next((len(part) for part in (self.A, self.B) if part.ndim == 3), None)

    def over(self, steps: int) -> tuple[np.ndarray, np.ndarray]:
        """Matrices A (steps, n, n) and B (steps, n, m) of the first steps, views of its own.

        Raises
        ------
        ArgumentError
            If it changes over time and has another number of steps.
        """
        if self.steps not in (None, steps):
            raise ArgumentError(
                f"the system has matrices for {self.steps} steps, {steps} are asked for: of T "
                "states there are T - 1 steps"
            )
        n, m = self.size
        return np.broadcast_to(self.A, (steps, n, n)), np.broadcast_to(self.B, (steps, n, m))

    def step(self, state: np.ndarray, control: np.ndarray, t: int | None = None) -> np.ndarray:
        """Next state (..., n) of a discrete system: A state + B control, at step t if it changes.

        Raises
        ------
        ArgumentError
            Shapes that do not fit, or a t that is missing or beyond the steps of the system.
        """
        state, control = finite_array("state", state), finite_array("control", control)
        n, m = self.size
        A, B = self.A, self.B
        if self.steps is not None:
            if t is None:
                raise ArgumentError(f"the system changes over {self.steps} steps; give t as well")
            t = whole("t", t, most=self.steps - 1)
            A, B = (part[t] if part.ndim == 3 else part for part in (A, B))
        if state.shape[-1:] != (n,) or control.shape[-1:] != (m,):
            raise ArgumentError(
                f"state has shape {state.shape} and control {control.shape}; give (..., {n}) and "
                f"(..., {m})"
            )
        following: np.ndarray = state @ A.T + control @ B.T
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
    order, dim = whole("order", order, least=1), whole("dim", dim, least=1)
    if (order * dim) ** 2 > ROOM:
        raise ArgumentError(
            f"dim is {dim} and order {order}: {dim * order} states; give at most {isqrt(ROOM)}, "
            "dim times order"
        )
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
