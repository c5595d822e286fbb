"""Impedance: stiffness, damping and a reference in joint space, and the torque that they make.

The torque law is ``tau = K (q_hat - q) + D (dq_hat - dq) + bias(q, dq)``; controllers differ in
where q_hat, dq_hat, K and D come from.
"""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from tpsim.border import Positive, border
from tpsim.errors import ArgumentError
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.world.guard import Guard
from tpsim.world.tank import Energies, Ledger, Tank

_LEAST = 1e-10
"""Share of all stiffness that is taken for none."""


@dataclass(frozen=True, eq=False)
class Impedance:
    """What a controller commands, in joint space; it lasts until the next command.

    Parameters
    ----------
    stiffness : (n, n)
        [Nm/rad]: with ``damping`` what a push meets.
    damping : (n, n)
        [Nms/rad]
    reference : (n,)
        q_hat [rad] at the moment of the command.
    velocity : (n,), optional
        dq_hat [rad/s], at which the reference moves on; at rest by default.
    """

    stiffness: np.ndarray
    damping: np.ndarray
    reference: np.ndarray
    velocity: np.ndarray | None = None

    @classmethod
    def of_modes(
        cls, modes: np.ndarray, stiffness: np.ndarray, reference: np.ndarray
    ) -> "Impedance":
        """Optimum of unit double integrators, frozen modes: damping is (2 stiffness)^1/2.

        Parameters
        ----------
        modes : (n, n)
            In the columns; with M = modes modes^T they are independent unit masses.
        stiffness : (n,)
            Of each mode [1/s^2].
        reference : (n,)
            Posture [rad].
        """
        damping = np.sqrt(2 * stiffness)
        back = modes.T
        return cls((modes * stiffness).dot(back), (modes * damping).dot(back), reference)

    @border
    def weaker(self, factor: Positive) -> "Impedance":
        """The same with springs that pull less by a factor; dampers keep their strength."""
        return replace(self, stiffness=self.stiffness / factor)


class Controller(Protocol):
    """What drives a robot: any object with this method."""

    def command(self, state: State, time: float) -> Impedance | np.ndarray:
        """Command at a state, called at every time step.

        Parameters
        ----------
        state : State
            What the robot senses of itself and of the objects.
        time : float
            Since the start of the trial [s].

        Returns
        -------
        Impedance or ndarray (n,)
            An impedance, to which gravity, Coriolis and friction are compensated and joint limits
            guarded (return the same object for as long as it holds: that is cheap), or the joint
            torques themselves [Nm], which are used as they are.
        """
        ...


class Drive:
    """Turns commands into joint torques, step by step, for one trial.

    What impedances may put into the robot comes out of a tank (:mod:`tpsim.world.tank`): whoever
    pushes or leads it gets back what they gave and what was in the tank, no more.

    Parameters
    ----------
    robot : Robot
    period : float
        Time between two steps [s].
    tank : Tank, optional
        The robot's own, :meth:`Tank.of <tpsim.world.tank.Tank.of>`, by default.

    Attributes
    ----------
    ledger : Ledger
        The tank's books.
    """

    def __init__(self, robot: Robot, period: float, tank: Tank | None = None):
        self._robot, self.period, self._guard = robot, period, Guard(robot)
        self.ledger = Ledger(robot, period, Tank.of(robot) if tank is None else tank)
        self._now: Impedance | None = None
        self._age, self._wanted = 0, np.zeros(0)
        self._gain, self._given = np.zeros(0), np.diag(robot.damping)
        self._lead: np.ndarray | None = None

    @property
    def energies(self) -> Energies:
        """What was counted up to the last look into the books, which are 10 ms apart at most."""
        return self.ledger.energies

    def torque(self, command: Impedance | np.ndarray, state: State) -> np.ndarray:
        """Joint torques (n,) [Nm] wanted, before the motors' limits."""
        if isinstance(command, np.ndarray):
            if command.shape != (self._robot.n,):
                self._refuse(f"an array of shape {command.shape}")
            if self._now is not None:
                self.ledger.close(state)
                self._now = None
            return command
        short = False
        if command is not self._now:
            if not isinstance(command, Impedance):
                self._refuse(f"{command!r}")
            self._begin(command)
            short = self.ledger.short(command, state)
        else:
            self._age += 1
            if self._lead is not None:
                self._wanted = self._wanted + self._lead
        # For a matrix so small, @ costs twice as much.
        torque: np.ndarray = self._wanted - self._gain.dot(state.x)
        torque += state.bias
        if self._robot.has_friction:
            torque = torque + self._robot.friction_torque(state.dq)
        guard = self._guard.torque(state)
        return self.ledger.enter(torque, guard, command, state, self._age, short)

    def _refuse(self, what: str) -> None:
        raise ArgumentError(
            f"the controller commanded {what}; give joint torques ({self._robot.n},) or an "
            "Impedance"
        )

    def _begin(self, now: Impedance) -> None:
        self._now, self._age = now, 0
        # The joints' own damping is compensated.
        self._gain = np.concatenate((now.stiffness, now.damping - self._given), axis=1)
        self._wanted, self._lead = now.stiffness.dot(now.reference), None
        if now.velocity is not None:
            self._wanted += now.damping.dot(now.velocity)
            self._lead = now.stiffness.dot(self.period * now.velocity)


def compliance(J: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """How far directions J (..., m, n) give way, J K^-1 J^T (..., m, m), under K (..., n, n).

    A motion without any stiffness gives way ten thousand million times as far as the others.
    """
    least = _LEAST * np.trace(stiffness, axis1=-2, axis2=-1)
    known = stiffness + least[..., None, None] * np.eye(stiffness.shape[-1])
    given: np.ndarray = J @ np.linalg.solve(known, J.mT)
    return given


def hand_stiffness(J: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """Physical stiffness (..., 6, 6) of a hand, from joint stiffness (..., n, n) [Nm/rad].

    ``(J K^-1 J^T)^-1`` with the hand's Jacobian J (..., 6, n): what a slow push meets, N/m and
    Nm/rad, when the rest of the arm is free to give way. Without stiffness it is zero, and so it
    is in directions in which the arm cannot move.
    """
    J, stiffness = np.asarray(J), np.asarray(stiffness)
    felt = np.zeros((*J.shape[:-2], 6, 6))
    stiff = stiffness.any(axis=(-1, -2))
    if not stiff.any():
        return felt
    # Directions in which the arm never moves, such as out of a plane, are left out.
    rows = np.flatnonzero(np.abs(J).max(axis=(*range(J.ndim - 2), -1)) > 1e-9)
    moving = J[stiff][..., rows, :]
    given = compliance(moving, stiffness[stiff])
    first = moving.reshape(-1, *moving.shape[-2:])[0]
    full = np.linalg.matrix_rank(first) == len(rows)
    inverse = np.linalg.inv(given) if full else np.linalg.pinv(given, rcond=1e-10)
    block = np.zeros((*given.shape[:-2], 6, 6))
    block[..., rows[:, None], rows] = inverse
    felt[stiff] = block
    return felt
