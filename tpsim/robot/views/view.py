"""What a view is: a quantity of robot and objects with its Jacobian.

One definition serves learning, control (``J^T W J``), reward, measures and plots. Around a state a
view is an affine map to joint space, Eqs (39)-(44): ``q_hat = J^+ mu + q - J^+ y``.
"""

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import sqrt
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dposv

from tpsim.border import NotNegative, Positive, border, checked, read
from tpsim.checks import finite_array, shown
from tpsim.errors import ArgumentError
from tpsim.manifold.manifold import Manifold, R
from tpsim.robot.along import Along
from tpsim.robot.indices import as_slice
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.robot.views.nullspace import eye, stacked_rows, through_nullspace

DAMPING = 0.01
"""Singular value of a Jacobian below which its nullspace is no longer told apart [m/rad]."""

MOST = 1000
"""Dimensions in a part of a view, at most."""

UNITS = {"mm": ("m", 1e3), "deg": ("rad", 180 / np.pi), "cm": ("m", 1e2)}
"""Units that people read, with the SI unit that they are made of and how many go into one."""


class Seen(NamedTuple):
    """A view at one state.

    Parameters
    ----------
    value : (d,)
        [m], [rad]; a point of the view's manifold.
    jacobian : (d, n)
        What precision acts on; on a curved manifold of its tangent coordinates.
    drift : (d,)
        Rate at which the value changes while the robot rests, since objects move [1/s].
    rate : (d, n), optional
        How the value follows the joints where that is not ``jacobian``: views beneath others.
    """

    value: np.ndarray
    jacobian: np.ndarray
    drift: np.ndarray
    rate: np.ndarray | None = None


class View(ABC):
    """A quantity y (d,) of the robot and the objects around it; subclasses are frozen values.

    Call it with a :class:`~tpsim.robot.state.State`, which remembers what was seen of it.
    """

    @property
    def curved(self) -> bool:
        """Whether values are points of a curved manifold, which have no parts or differences."""
        return False

    @abstractmethod
    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions with their units, such as ``"x [m]"``."""

    def manifold(self, robot: Robot) -> Manifold:
        """Where the view's values live: R^n by default."""
        return R(len(self.labels(robot)))

    def kinds(self, robot: Robot) -> tuple[str, ...]:
        """Kind of quantity of each dimension: those of one kind can be compared."""
        return tuple("position" if "[m]" in label else "angle" for label in self.labels(robot))

    @abstractmethod
    def see(self, state: State) -> Seen:
        """Compute the view; callers use ``view(state)``, which remembers."""

    def __call__(self, state: State) -> Seen:
        """Value (d,), Jacobian (d, n) and drift (d,) of the view at a state."""
        try:
            known = state.seen.get(id(self))
        except AttributeError:
            raise ArgumentError(f"state is {shown(state)}; give robot.at(q)") from None
        if known is None:
            # The view is kept with its answer, so that no other can take its identity.
            known = state.seen[id(self)] = (self, self.see(state))
        return known[1]

    def along(self, movement: Along) -> np.ndarray:
        """Values (T, d) along a recorded movement, of which nobody asks how they change."""
        return np.array([self(state).value for state in movement.states])

    def rows(self, state: State) -> np.ndarray:
        """Jacobian (d, n) up to an invertible map of its rows: all that a nullspace needs."""
        return self(state).jacobian

    def resolved(self, robot: Robot, compute: Callable[[Robot], np.ndarray]) -> np.ndarray:
        """What a view needs to know of a robot besides its state: computed once for each robot."""
        robot_before, resolved = self.__dict__.get("_known", (None, np.zeros(0)))
        if robot_before is not robot:
            resolved = compute(robot)
            # Not a field of the value, so the frozen dataclass does not mind.
            self.__dict__["_known"] = (robot, resolved)
        return resolved

    def __getstate__(self) -> dict[str, object]:
        """Fields alone travel to other processes."""
        return {name: value for name, value in self.__dict__.items() if name[0] != "_"}

    def __getitem__(self, rows: int | slice | Sequence[int]) -> "Part":
        """Some of the dimensions: ``view[:2]``, ``view[0]``, ``view[[0, 2]]``."""
        if isinstance(rows, slice):
            if rows.stop is None:
                raise ArgumentError("say where the part of a view ends, as in view[:2]")
            rows = range(rows.start or 0, rows.stop, rows.step or 1)
        return Part(self, tuple(read("rows", rows, Sequence[int])))

    def minus(self, origin: Sequence[float] | np.ndarray) -> "Offset":
        """The view measured from an origin (d,)."""
        return Offset(self, tuple(finite_array("origin", origin).reshape(-1).tolist()))

    def beneath(
        self, *first: "View", bend: float | None = None, damping: float = DAMPING
    ) -> "Beneath":
        """The view in the nullspace of others that have priority: see :class:`Beneath`."""
        return Beneath(self, first, bend, damping)

    @border
    def scale(self, robot: Robot, unit: str) -> float:
        """Factor from the view's SI unit to a unit that people read, such as ``"mm"``.

        Raises
        ------
        ArgumentError
            If the view has not this unit.
        """
        base, factor = UNITS.get(unit, (unit, 1.0))
        found = (re.search(r"\[(.*)\]", label) for label in self.labels(robot))
        own = {match.group(1) for match in found if match}
        if own != {base}:
            raise ArgumentError(f"unit {shown(unit)} does not fit a view in {sorted(own)}")
        return factor


@dataclass(frozen=True)
class Part(View):
    """Some dimensions of a view.

    Parameters
    ----------
    whole : View
    indices : tuple of int
    """

    whole: View
    indices: tuple[int, ...]

    def __post_init__(self) -> None:
        checked(self)
        _check_flat(self.whole, "parts")
        if not self.indices or len(self.indices) > MOST:
            raise ArgumentError(f"indices are {shown(self.indices)}; give 1 to {MOST}")

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        whole = self.whole.labels(robot)
        return tuple(whole[index] for index in self.indices)

    def kinds(self, robot: Robot) -> tuple[str, ...]:
        """Kinds of the dimensions."""
        whole = self.whole.kinds(robot)
        return tuple(whole[index] for index in self.indices)

    @cached_property
    def _rows(self) -> slice | np.ndarray:
        return as_slice(self.indices)

    def see(self, state: State) -> Seen:
        """Select the rows."""
        rows, (value, jacobian, drift, rate) = self._rows, self.whole(state)
        return Seen(value[rows], jacobian[rows], drift[rows], None if rate is None else rate[rows])

    def along(self, movement: Along) -> np.ndarray:
        """Select the columns of the values."""
        return self.whole.along(movement)[:, self._rows]


@dataclass(frozen=True)
class Offset(View):
    """A view measured from an origin.

    Parameters
    ----------
    whole : View
    origin : (d,) tuple
    """

    whole: View
    origin: tuple[float, ...]

    def __post_init__(self) -> None:
        checked(self)
        _check_flat(self.whole, "differences")

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        return self.whole.labels(robot)

    def kinds(self, robot: Robot) -> tuple[str, ...]:
        """Kinds of the dimensions."""
        return self.whole.kinds(robot)

    def see(self, state: State) -> Seen:
        """Take the origin off."""
        value, jacobian, drift, rate = self.whole(state)
        return Seen(self._off(value), jacobian, drift, rate)

    def along(self, movement: Along) -> np.ndarray:
        """Take the origin off the values."""
        return self._off(self.whole.along(movement))

    def _off(self, value: np.ndarray) -> np.ndarray:
        given, d = len(self.origin), value.shape[-1]
        if given != d:
            raise ArgumentError(f"an origin of {given} numbers was given for {d} dimensions")
        return value - self.origin


@dataclass(frozen=True)
class Beneath(View):
    """A view in the nullspace of others, Eqs (42)-(44): its Jacobian is ``J~ N``.

    With ``N = I - J^+ J`` of what has priority, the posture of joints (Eq. 42) enters joint space
    as ``N W N``. A task-space view (Eqs 43, 44) has done its best where ``(J~ N)^T e = 0``; the
    printed ``N J~^+`` rests elsewhere where both share a trunk (docs/priorities.md).

    Of an error e that cannot be removed as a whole, ``y = P e`` is the part that can be,

        P = G (G + bend |e| I)^-1,    G = J~ N J~^T,

    a Newton step: a nearly stretched arm reaches only ``|J|^2 / bend`` farther, however far its
    goal is. Near its goal the whole error counts. Without ``bend`` it always does.

    Parameters
    ----------
    second : View
        What is observed.
    first : tuple of View
        What has priority.
    bend : float, optional
        Curvature of the hand's way as its arm stretches [m/rad^2]: the length of a link.
    damping : float
        Singular value of the first Jacobian below which its nullspace grows.
    """

    second: View
    first: tuple[View, ...]
    bend: NotNegative | None = None
    damping: Positive = DAMPING

    def __post_init__(self) -> None:
        checked(self)
        _check_flat(self.second, "projections")

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        return self.second.labels(robot)

    def kinds(self, robot: Robot) -> tuple[str, ...]:
        """Kinds of the dimensions."""
        return self.second.kinds(robot)

    def see(self, state: State) -> Seen:
        """Project the second Jacobian onto the nullspace of the first."""
        value, J_second, drift, rate = self.second(state)
        J = stacked_rows(self.first, state)
        beneath = through_nullspace(J_second, J, self.damping)
        if self.bend is None:
            return Seen(value, beneath, drift, beneath)
        s = self.damping**2 + self.bend * sqrt(value.dot(value))
        one, follows = eye(len(value)), J_second if rate is None else rate
        # P = G (G + s I)^-1 = I - s (G + s I)^-1.
        free = one - s * dposv(beneath.dot(beneath.T) + s * one, one)[1]
        return Seen(free.dot(value), beneath, free.dot(drift), free.dot(follows))


def _check_flat(view: View, what: str) -> None:
    if view.curved:
        raise ArgumentError(
            f"{shown(view)} lives on a curved manifold, which has no {what}; give its rotation "
            "vector, as in Site(name).orientation"
        )
