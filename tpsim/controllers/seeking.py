"""What hand-set controllers share: views that are to reach a reference, and their gains."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.robot.state import State
from tpsim.robot.views.view import View
from tpsim.world.impedance import Impedance

PERIOD = 0.008
"""Time for which a hand-set impedance lasts by default [s]."""

Reference = Sequence[float] | np.ndarray | Callable[[float], tuple[np.ndarray, np.ndarray]]
"""Where a view is to be (d,), [m] or [rad]; or ``reference(time) -> (value, velocity)``."""


class Sought(NamedTuple):
    """How far a view is from where it is to be.

    Parameters
    ----------
    error : (d,)
        Reference minus value [m], [rad].
    velocity : (d,)
        Rate of the joints' share that keeps up with the reference: its own rate minus the drift.
    jacobian : (d, n)
    """

    error: np.ndarray
    velocity: np.ndarray
    jacobian: np.ndarray


def seek(view: View, reference: Reference | None, state: State) -> Sought:
    """How far a view is from its reference at a state; zero is sought by default."""
    value, jacobian, drift, _ = view(state)
    if reference is None:
        return Sought(-value, -drift, jacobian)
    if not callable(reference):
        return Sought(_fitting(reference, value) - value, -drift, jacobian)
    wanted, velocity = reference(state.time)
    return Sought(_fitting(wanted, value) - value, _fitting(velocity, value) - drift, jacobian)


def _fitting(reference: object, value: np.ndarray) -> np.ndarray:
    found = np.asarray(reference, float)
    if found.shape != value.shape:
        raise ArgumentError(
            f"a reference of shape {found.shape} was given for a view of {len(value)} dimensions"
        )
    return found


def gains(name: str, given: float | Sequence[float] | np.ndarray, size: int) -> np.ndarray:
    """A gain for each dimension of a view (d,), from one for all or one for each.

    Raises
    ------
    ArgumentError
        If there are more or fewer than dimensions, or one is negative or not finite.
    """
    found = np.asarray(given, float)
    if found.ndim > 1 or (found.ndim == 1 and len(found) != size):
        raise ArgumentError(
            f"{name} has shape {found.shape} for a view of {size} dimensions; give a number or "
            f"{size} of them"
        )
    if not (np.isfinite(found).all() and (found >= 0).all()):
        raise ArgumentError(f"{name} is {given}; it must be finite and not negative")
    return np.broadcast_to(found, (size,))


def positive(name: str, value: float) -> float:
    """Return a gain of the whole robot, or raise ArgumentError where it is not positive."""
    if not (np.isfinite(value) and value > 0):
        raise ArgumentError(f"{name} is {value}; it must be positive and finite")
    return float(value)


def moving(now: Impedance, velocity: np.ndarray, state: State) -> Impedance:
    """The impedance with a reference that moves on (n,) [rad/s], no faster than joints may."""
    if not velocity.any():
        return now
    limit = state.robot.velocity_limit
    return replace(now, velocity=np.clip(velocity, -limit, limit))
