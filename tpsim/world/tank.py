"""The energy tank: what an impedance may take out of its motors, kept in books step by step.

The argument, with its assumptions, is in ``docs/passivity.md``; after Ferraguti et al. 2013 and
Hannaford and Ryu 2002.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tpsim.border import NotNegative, Strength, border, checked
from tpsim.errors import ArgumentError
from tpsim.robot.robot import Robot
from tpsim.robot.state import State

if TYPE_CHECKING:
    from tpsim.world.impedance import Impedance

SETTLED = 0.01
"""Time [s] between two looks into the books, while there is enough in the tank."""

UNKNOWN = 0.01
"""Friction that a model is assumed not to know, as a share of the motors' torque: 0.5 Nm of 50."""

SPEED = 2.0
"""Joint speed [rad/s], [m/s] that counts where a robot's file states no limit."""


@dataclass(frozen=True)
class Tank:
    """Energy that impedances may put into the robot beyond what was put into them.

    Parameters
    ----------
    initial : float
        What is in it at the start [J].
    capacity : float, optional
        What it holds at most [J]: more of what dampers take is lost. As much as ``initial`` by
        default.
    friction : float
        Of every joint, as a share of its motor's torque: what friction that the model does not
        know may take is no expense of the tank's. Without any, an arm that rubs empties it.
    """

    initial: Strength
    capacity: Strength | None = None
    friction: NotNegative = 0.0

    def __post_init__(self) -> None:
        checked(self)
        if self.capacity is not None and not self.capacity >= self.initial:
            raise ArgumentError(
                f"tank capacity is {self.capacity} J; give at least the initial {self.initial} J"
            )

    @property
    def size(self) -> float:
        """What it holds at most [J]."""
        return self.initial if self.capacity is None else self.capacity

    @classmethod
    @border
    def of(cls, robot: Robot) -> "Tank":
        """The robot's own: the kinetic energy of all joints at their velocity limits, at home.

        ``sum_i M_ii(home) v_i^2 / 2``: moving as fast as it may, the robot carries that much. One
        hundredth of each motor's torque may be friction that the model does not know.
        """
        energy = float(np.diagonal(robot.at_home.mass) @ speeds(robot) ** 2) / 2
        return cls(energy, friction=UNKNOWN)


def speeds(robot: Robot) -> np.ndarray:
    """Velocity limits (n,) [rad/s], [m/s]; :data:`SPEED` where the file states none."""
    limit = robot.velocity_limit
    return np.where(np.isfinite(limit), limit, SPEED)


UNLIMITED = Tank(np.inf)
"""A tank that is never empty: energies are counted, nothing is held back."""


class Energies(NamedTuple):
    """What was counted up to a moment [J].

    Attributes
    ----------
    stored : float
        In the springs, ``(q_hat - q)^T K (q_hat - q) / 2``.
    dissipated : float
        Taken by the dampers since the start, ``sum dq^T D dq h``.
    injected : float
        Come in by renewals, moving references and compensation since the start; net work of the
        motors is ``injected - dissipated - stored``.
    tank : float
        Left in the tank.
    """

    stored: float
    dissipated: float
    injected: float
    tank: float


class Ledger:
    """The books of one trial: what goes out of the tank, and what must not.

    The work of the motors beyond gravity and the joints' own damping and friction, known or
    allowed for, exact for torques that are held between two steps, is taken from what the
    controller owns: tank and springs together.
    While there is enough, torques pass as they are. Springs that would hold more than is owned
    pull less; what leads the movement is scaled to the work that is left. Dampers stay.

    Parameters
    ----------
    robot : Robot
    period : float
        Time between two steps [s].
    tank : Tank
    """

    def __init__(self, robot: Robot, period: float, tank: Tank):
        self._robot, self._period, self._size = robot, period, tank.size
        self._unknown = tank.friction * robot.torque_limit
        self._every = max(1, round(SETTLED / period))
        # More than the motors can do in a step.
        self._most_done = period * float(robot.torque_limit @ speeds(robot))
        # Of velocity over torque.
        self._most = np.concatenate((np.full(robot.n, np.inf), robot.torque_limit))
        self._least = -self._most
        self._owned, self._work, self._dissipated = tank.initial, 0.0, 0.0
        self._left, self._regular, self._scarce, self._share = 1, 0, False, 1.0
        self._height: float | None = None
        # State and torque of every step since the last look, in turn.
        self._rows: list[np.ndarray] = []
        # What work and dampers are summed with; before, with the step at which that ended.
        n = robot.n
        self._plain = np.zeros((2, 2 * n * n))
        self._plain[0] = np.hstack((np.diag(-robot.damping), np.eye(n))).ravel()
        self._weights = self._plain
        self._ends: list[tuple[int, np.ndarray]] = []
        self.energies = Energies(0.0, 0.0, 0.0, tank.initial)

    def short(self, command: "Impedance", state: State) -> bool:
        """Whether a new command's spring would hold more than is owned."""
        way = command.reference - state.q
        stored = 0.5 * float(way.dot(command.stiffness.dot(way)))
        return stored > self._owned

    def enter(
        self,
        torque: np.ndarray,
        guard: np.ndarray | None,
        command: "Impedance",
        state: State,
        age: int,
        short: bool,
    ) -> np.ndarray:
        """Torque (n,) [Nm] that the tank allows, entered into the books.

        Parameters
        ----------
        torque, guard : (n,)
            Wanted by the command, and by the guard of the joint limits, which is never held back.
        command : Impedance
        state : State
        age : int
            Steps since the command was given.
        short : bool
            Whether to look into the books now, whenever the last look was.
        """
        self._left -= 1
        if self._left <= 0 or short:
            self._settle(command, state, age)
            if self._scarce:
                torque = self._allowed(torque, command, state, age)
        elif age == 0:
            self._ends.append((len(self._rows) // 2, self._weights))
            self._weights = self._weigh(command)
        if guard is not None:
            torque = torque + guard
        self._rows += (state.x, torque)
        return torque

    def close(self, state: State) -> None:
        """Enter what was done up to now; what the robot does until the next entry is not ours."""
        self._close(state)
        self._height, self._left = None, 1

    def _close(self, state: State) -> None:
        """Take the work since the last look from what is owned."""
        height = state.potential_energy
        if self._rows:
            assert self._height is not None
            work, taken = self._done(state)
            work -= height - self._height
            self._owned -= work
            self._work += work
            self._dissipated += taken
        self._height, self._rows = height, []

    def _done(self, state: State) -> tuple[float, float]:
        """Work of the motors beyond the joints' own losses, and what the dampers took [J]."""
        n = self._robot.n
        rows = np.concatenate((*self._rows, state.x, self._most[n:])).reshape(-1, 3 * n)
        moved = rows[1:, :n] - rows[:-1, :n]
        # What friction takes was given for it.
        rubbed = float(np.abs(moved).sum(0).dot(self._unknown))
        if self._robot.has_friction:
            rubbed += float((moved * self._robot.friction_torque(rows[:-1, n : 2 * n])).sum())
        did = np.minimum(np.maximum(rows[:-1, n:], self._least), self._most)
        if not self._ends:
            work, taken = self._weights.dot(moved.T.dot(did).ravel()).tolist()
            return work - rubbed, taken
        work, taken = -rubbed, 0.0
        ends = [*self._ends, (len(moved), self._weights)]
        for (last, weights), first in zip(ends, [0, *(end for end, _ in ends)], strict=False):
            some = weights.dot(moved[first:last].T.dot(did[first:last]).ravel()).tolist()
            work, taken = work + some[0], taken + some[1]
        return work, taken

    def _weigh(self, command: "Impedance") -> np.ndarray:
        """Weights (2, n 2n) of way times velocity and torque (n, 2n), in the two sums."""
        n, weights = self._robot.n, self._plain.copy()
        weights[1].reshape(n, 2 * n)[:, :n] = command.damping
        return weights

    def _settle(self, command: "Impedance", state: State, age: int) -> None:
        """Look into the books: what is owned, what the spring holds, what is left."""
        self._regular -= len(self._rows) // 2
        if self._regular <= 0:
            self._regular = self._every
        self._close(state)
        self._ends = []
        if age == 0:
            self._weights = self._weigh(command)
        way = self._way(command, state, age)
        stored = max(0.5 * float(way.dot(command.stiffness.dot(way))), 0.0)
        # What the tank cannot hold is lost.
        owned = self._owned = min(self._owned, stored + self._size)
        # Where less than this is owned, the spring pulls less.
        least = max(owned, 0.0)
        self._share = 1.0 if stored <= least else least / stored
        # Until the next look nobody can spend more than is owned.
        safe = 0.0 if self._share < 1.0 else least / self._most_done
        self._scarce, self._left = safe < 1.0, max(int(min(safe, self._regular)), 1)
        stored *= self._share
        taken = self._dissipated
        self.energies = Energies(stored, taken, self._work + stored + taken, owned - stored)

    def _way(self, command: "Impedance", state: State, age: int) -> np.ndarray:
        way = command.reference - state.q
        if command.velocity is not None:
            way = way + (age * self._period) * command.velocity
        return way

    def _allowed(
        self, torque: np.ndarray, command: "Impedance", state: State, age: int
    ) -> np.ndarray:
        """Torque (n,) that the tank can pay for: less spring, less of what leads the movement.

        Dampers stay. Of the rest p, which leads the velocity and compensates Coriolis torques, a
        share b is left whose work in the next step, ``h b p^T (dq + h b M^-1 p)``, is paid for by
        the tank and by the dampers.
        """
        h, dq = self._period, state.dq
        spring = command.stiffness @ self._way(command, state, age)
        brake = command.damping @ dq
        taken = h * float(brake @ dq)
        damped = state.gravity + self._robot.damping * dq - (brake if taken > 0 else 0.0)
        if self._robot.has_friction:
            damped = damped + self._robot.friction_torque(dq)
        rest = torque - spring - damped
        a = h * float(rest @ dq)
        b = h**2 * float(rest @ np.linalg.solve(state.mass, rest))
        rubs = h * float(self._unknown @ np.abs(dq))
        paid = max(self.energies.tank, 0.0) + max(taken, 0.0) + rubs
        share = 1.0
        if a + b > paid:
            # The larger root of b s^2 + a s = paid, without cancellation.
            root = float(np.sqrt(a**2 + 4 * b * paid))
            share = 2 * paid / (a + root) if a > 0 else (root - a) / (2 * b)
        if share == 1.0 and self._share == 1.0:
            return torque
        allowed: np.ndarray = damped + self._share * spring + share * rest
        return allowed
