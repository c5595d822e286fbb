"""Constraints on a movement: joint range, speed, torque, or any linear function of its states."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Stored
from tpsim.checks import array_of, felt, finite_array, frozen_array, instance, shown
from tpsim.errors import ArgumentError


@dataclass(frozen=True, eq=False)
class Constraint(Stored):
    """Linear inequalities ``lower <= C xi_t + D u_t <= upper``, at every step t.

    Parameters
    ----------
    name : str
        What messages and plans call it.
    lower, upper : (c,) or (T, c)
        Infinite where there is no limit.
    state : (c, n) or (T, c, n), optional
        C; none by default.
    control : (c, m) or (T, c, m), optional
        D; none by default. A constraint on the control alone is kept in any case: it can be.

    Raises
    ------
    ArgumentError
        Neither C nor D, shapes that do not fit each other, NaN, or a lower limit above the upper.
    """

    name: str
    lower: np.ndarray
    upper: np.ndarray
    state: np.ndarray | None = None
    control: np.ndarray | None = None

    def __post_init__(self) -> None:
        instance("name", self.name, str)
        parts = {"state": self.state, "control": self.control}
        given = {name: frozen_array(name, part) for name, part in parts.items() if part is not None}
        for name, part in given.items():
            object.__setattr__(self, name, part)
        if not given:
            raise ArgumentError(f"constraint '{self.name}' limits nothing; give state or control")
        limits = [_limits(self.name, side, getattr(self, side)) for side in ("lower", "upper")]
        rows = {part.shape[-2] if part.ndim in (2, 3) else 0 for part in given.values()}
        rows |= {limit.shape[-1] for limit in limits}
        if len(rows) > 1 or not min(rows) or any(limit.ndim > 2 for limit in limits):
            shapes = {name: part.shape for name, part in given.items()}
            shapes |= {"lower": limits[0].shape, "upper": limits[1].shape}
            raise ArgumentError(
                f"constraint '{self.name}' has shapes {shapes}; give c limits (c,) or (T, c), and "
                "(c, n), (c, m) for state and control, or one for each step"
            )
        if np.broadcast(*limits).ndim and (limits[0] > limits[1]).any():
            raise ArgumentError(
                f"constraint '{self.name}' has a lower limit above its upper limit; swap them"
            )
        object.__setattr__(self, "lower", limits[0])
        object.__setattr__(self, "upper", limits[1])

    @property
    def rows(self) -> int:
        """Number c of inequalities at a step."""
        return self.lower.shape[-1]

    def over(
        self, steps: int, states: int, controls: int
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """C (T, c, n), D (T, c, m), lower and upper (T, c), of so many steps, states, controls.

        Raises
        ------
        ArgumentError
            If it is for other numbers of them.
        """
        c = self.rows
        shapes = (c, states), (c, controls), (c,), (c,)
        parts = self.state, self.control, self.lower, self.upper
        found = []
        for part, shape in zip(parts, shapes, strict=True):
            part = np.zeros(shape) if part is None else part
            if part.shape not in (shape, (steps, *shape)):
                raise ArgumentError(
                    f"constraint '{self.name}' has an array of shape {part.shape}; for {steps} "
                    f"steps, {states} states and {controls} controls give {shape} or "
                    f"{(steps, *shape)}"
                )
            found.append(np.broadcast_to(part, (steps, *shape)))
        C, D, lower, upper = found
        return C, D, lower, upper


def joint_range(lower: ArrayLike, upper: ArrayLike) -> Constraint:
    """Angles q of joints within lower and upper (n,) [rad], of states [q, dq]."""
    name = "joint range"
    least, most = _limits(name, "lower", lower), _limits(name, "upper", upper)
    n = least.shape[-1]
    return Constraint(name, least, most, state=np.eye(n, 2 * n))


def joint_speed(limit: ArrayLike) -> Constraint:
    """Velocities dq of joints within -limit and limit (n,) [rad/s], of states [q, dq]."""
    limit = np.atleast_1d(felt("limit", limit))
    n = limit.shape[-1]
    return Constraint("joint speed", -limit, limit, state=np.eye(n, 2 * n, k=n))


def joint_torque(limit: ArrayLike, mass: ArrayLike, bias: ArrayLike = 0.0) -> Constraint:
    """Torques ``M ddq + bias`` within -limit and limit (n,) [Nm], where ddq is the control.

    Parameters
    ----------
    limit : (n,)
        Of the motors [Nm].
    mass : (n, n) or (T, n, n)
        Inertia M.
    bias : (n,) or (T, n)
        Gravity, Coriolis and friction [Nm].
    """
    limit, mass = np.atleast_1d(felt("limit", limit)), finite_array("mass", mass)
    bias = finite_array("bias", bias)
    if bias.ndim > 2 or (bias.ndim and bias.shape[-1] != limit.shape[-1]):
        raise ArgumentError(
            f"bias has shape {bias.shape}; with limits {limit.shape} give (n,) or (T, n)"
        )
    return Constraint("joint torque", -limit - bias, limit - bias, control=mass)


def _limits(name: str, side: str, value: object) -> np.ndarray:
    """Limits as an array that may be infinite, or an ArgumentError."""
    given = array_of(f"{side} of constraint {shown(name)}", value)
    masked = isinstance(value, np.ma.MaskedArray)
    if masked or given.dtype.kind not in "iuf" or not given.size:
        raise ArgumentError(
            f"{side} of constraint {shown(name)} is {shown(value)}; give limits (c,) or (T, c)"
        )
    limits = np.atleast_1d(given.astype(float))
    if np.isnan(limits).any():
        raise ArgumentError(
            f"{side} of constraint {shown(name)} holds NaN; infinity means no limit"
        )
    limits.flags.writeable = False
    return limits
