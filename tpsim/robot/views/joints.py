"""Views of postures: joint angles, and what an arm does with its redundancy."""

from dataclasses import dataclass

import numpy as np

from tpsim.border import Positive, checked
from tpsim.checks import finite_array
from tpsim.errors import ArgumentError
from tpsim.robot.along import Along
from tpsim.robot.indices import Names
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.robot.views.nullspace import stacked_rows, through_nullspace
from tpsim.robot.views.view import DAMPING, Seen, View


@dataclass(frozen=True)
class Joints(View):
    """Joint angles in a fixed frame, Eq. (39): d = number of joints.

    ``Joints(...).beneath(view)`` is the posture in the nullspace of a view, Eq. (42).

    Parameters
    ----------
    names : str, tuple of str or Chain
        A regular expression that matches whole joint names, names, or all joints that move a
        site. All joints by default.
    """

    names: Names = ".*"

    def __post_init__(self) -> None:
        checked(self)

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        return tuple(f"{robot.joints[i]} [rad]" for i in robot.index(self.names))

    def kinds(self, robot: Robot) -> tuple[str, ...]:
        """Postures are compared with postures alone."""
        return ("posture",) * len(self.labels(robot))

    def see(self, state: State) -> Seen:
        """Value and Jacobian at a state."""
        index = state.robot.span(self.names)
        rows = self.resolved(state.robot, self._rows)
        return Seen(state.q[index], rows, np.zeros(len(rows)))

    def along(self, movement: Along) -> np.ndarray:
        """Values along a movement."""
        return movement.q[:, movement.robot.span(self.names)].astype(float)

    def _rows(self, robot: Robot) -> np.ndarray:
        return np.eye(robot.n)[robot.index(self.names)]

    def spare(
        self,
        *first: View,
        origin: np.ndarray | None = None,
        free: tuple[str, ...] = (),
        damping: float = DAMPING,
    ) -> "Spare":
        """What these joints do with the freedom that views of higher priority leave.

        See :class:`Spare`.
        """
        start = (
            None if origin is None else tuple(finite_array("origin", origin).reshape(-1).tolist())
        )
        return Spare(self.names, first, start, free, damping)


@dataclass(frozen=True)
class Spare(View):
    """Self-motion of joints: their posture seen through a nullspace (Eq. 42), d = its dimension.

    ``N (q - q_0)`` is what the joints do with the freedom that the first views leave, such as the
    swivel of an elbow. N has not full rank, and a Gaussian over all joints would take the lack of
    freedom for precision; so only as many numbers are observed as the nullspace has dimensions:
    along an orthonormal basis of it, which turns with the posture from that at q_0, or the shares
    of some joints that are named.

    Near q_0 the value does not feel how N turns, which the Jacobian leaves out.

    Parameters
    ----------
    names : str, tuple of str or Chain
        The joints.
    first : tuple of View
        What has priority.
    origin : (k,) tuple, optional
        Posture q_0 of these joints [rad]; home by default.
    free : tuple of str
        Joints whose shares are observed, as many as the nullspace has dimensions; by default the
        basis is used.
    damping : float
        Singular value of the first Jacobian below which its nullspace grows.
    """

    names: Names
    first: tuple[View, ...]
    origin: tuple[float, ...] | None = None
    free: tuple[str, ...] = ()
    damping: Positive = DAMPING

    def __post_init__(self) -> None:
        checked(self)

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        if self.free:
            return tuple(f"{joint} [rad]" for joint in self.free)
        count = len(self.resolved(robot, self._basis))
        if count == 1:
            return ("along the nullspace [rad]",)
        return tuple(f"nullspace {k + 1} [rad]" for k in range(count))

    def kinds(self, robot: Robot) -> tuple[str, ...]:
        """Postures are compared with postures alone."""
        return ("posture",) * len(self.labels(robot))

    def see(self, state: State) -> Seen:
        """Value and Jacobian at a state."""
        robot = state.robot
        index = robot.span(self.names)
        J_first = stacked_rows(self.first, state)[:, index]
        rows = through_nullspace(self.resolved(robot, self._basis), J_first, self.damping)
        if not self.free:
            rows = _orthonormal(rows)
        J = np.zeros((len(rows), robot.n))
        J[:, index] = rows
        away = state.q[index] - (robot.home[index] if self.origin is None else self.origin)
        return Seen(rows.dot(away), J, np.zeros(len(rows)))

    def _basis(self, robot: Robot) -> np.ndarray:
        """Rows (k, m): the free joints, or a basis of the nullspace at q_0."""
        index = robot.index(self.names)
        if self.free:
            names = [robot.joints[i] for i in index]
            return np.eye(len(index))[[names.index(joint) for joint in self.free]]
        q = robot.home.copy()
        if self.origin is not None:
            q[index] = self.origin
        state = robot.at(q)
        J = stacked_rows(self.first, state)[:, index]
        singular, Vt = np.linalg.svd(J)[1:]
        rank = int((singular > self.damping).sum())
        if rank == len(index):
            raise ArgumentError(
                f"the joints {self.names} have no freedom beneath these views: {len(index)} "
                f"joints for {rank} dimensions; leave this view out"
            )
        return Vt[rank:]


def _orthonormal(rows: np.ndarray) -> np.ndarray:
    """Rows (k, m) made orthonormal, turned as little as possible."""
    if len(rows) == 1:
        return rows / np.sqrt(rows[0].dot(rows[0]))
    values, V = np.linalg.eigh(rows @ rows.T)
    return (V / np.sqrt(values)) @ V.T @ rows
