"""Computed torque along a joint trajectory, which inverse kinematics makes of a task's goal."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from tpsim.border import Positive, border
from tpsim.controllers.operational_space import Aim, prioritised
from tpsim.controllers.renewed import RenewedImpedance
from tpsim.controllers.seeking import PERIOD, moving
from tpsim.errors import ArgumentError
from tpsim.robot.state import State
from tpsim.world.impedance import Impedance

SINGULAR = 1e-3
"""Squared singular value [m^2/rad^2] of a Jacobian below which joints count as unable to move."""


CLOSING = 400.0
"""A gain [1/s^2] with which inverse kinematics closes in within some 0.15 s."""


class Motion(NamedTuple):
    """A joint trajectory at one moment: (n,) [rad], [rad/s], [rad/s^2]."""

    posture: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


Trajectory = Callable[[State], Motion]
"""Where the joints are to be at a state's time, among its objects."""


class ComputedTorque(RenewedImpedance):
    """Inverse dynamics with a joint servo (Luh, Walker and Paul 1980).

    It commands

        tau = M (ddq_d + kp (q_d - q) + kd (dq_d - dq)) + bias,

    so that the error of every joint falls as ``s^2 + kd s + kp``, whatever the arm weighs.

    Parameters
    ----------
    trajectory : callable or (n,)
        ``trajectory(state) -> Motion``, or a posture [rad] to stay in.
    gain : float
        kp [1/s^2]
    damping : float
        Ratio: kd = 2 ratio kp^1/2.
    period : float
        Time for which a command lasts [s]; the torque follows every state.
    """

    @border
    def __init__(
        self,
        trajectory: Trajectory | np.ndarray,
        gain: Positive,
        *,
        damping: Positive = 1.0,
        period: Positive = PERIOD,
    ):
        super().__init__(period)
        self.gain, self.damping = gain, damping
        self.trajectory = trajectory if callable(trajectory) else staying(trajectory)

    def renew(self, state: State, time: float) -> Impedance:
        """The servo about the trajectory; what accelerates it is a shift of its reference."""
        q, dq, ddq = self.trajectory(state)
        M, kp = state.mass, self.gain
        now = Impedance(kp * M, 2 * self.damping * kp**0.5 * M, q + ddq / kp)
        return moving(now, dq, state)


def staying(posture: np.ndarray) -> Trajectory:
    """The trajectory of a robot that stays in a posture (n,) [rad]."""
    rest = np.zeros(np.shape(posture))
    motion = Motion(np.array(posture, float), rest, rest)
    return lambda state: motion


class InverseKinematics:
    """Joint trajectory that brings views to their references, in the order of their priority.

    A posture of its own is moved by the accelerations that the aims ask for (:func:`prioritised`
    with unit inertia), step by step: it never feels what pushes the robot, and objects that move
    take it along.

    Parameters
    ----------
    aims : sequence of Aim
        The first one has priority; their gains [1/s^2] say how fast it closes in.
    start : (n,)
        Where it begins, at rest [rad].
    posture : (n,)
        Preferred beneath the aims [rad].
    posture_gain : float
        [1/s^2]
    """

    @border
    def __init__(
        self,
        aims: Sequence[Aim],
        start: np.ndarray,
        posture: np.ndarray,
        *,
        posture_gain: Positive = 4.0,
    ):
        if not aims:
            raise ArgumentError("no aim was given; give at least one")
        self.aims = tuple(aims)
        self._q, self._dq = np.array(start, float), np.zeros(np.shape(start))
        self._posture = np.array(posture, float), posture_gain, 1.0
        self._time: float | None = None

    def __call__(self, state: State) -> Motion:
        """Where the joints are to be; called as time goes on."""
        robot = state.robot
        step = 0.0 if self._time is None else state.time - self._time
        self._time = state.time
        imagined = robot.at(self._q, self._dq, state.objects, state.time)
        S, D, way, pace = prioritised(self.aims, imagined, np.eye(robot.n), self._posture, SINGULAR)
        ddq = S @ way + D @ (pace - self._dq)
        limit = robot.velocity_limit
        self._dq = np.clip(self._dq + step * ddq, -limit, limit)
        self._q = np.clip(self._q + step * self._dq, robot.lower, robot.upper)
        return Motion(self._q, self._dq, ddq)
