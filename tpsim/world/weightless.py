"""Weightless arms, for kinesthetic teaching."""

import numpy as np

from tpsim.border import NotNegative, border
from tpsim.errors import ArgumentError
from tpsim.robot.robot import Robot
from tpsim.robot.state import State

HOLD = 400.0
"""Stiffness [1/s^2] of joints that are not taught, times inertia; critically damped."""

_CRITICAL = 2 * HOLD**0.5
"""Damping [1/s] with it."""

DAMPING = 0.5
"""Of every joint [Nms/rad]: without it the elbow swings."""


class Weightless:
    """Gravity torque, light damping and no stiffness: arms that can be led by hand.

    Parameters
    ----------
    robot : Robot
    damping : float
        Of every joint [Nms/rad]: without it the elbow swings.
    held : tuple of str
        Joints that are not taught and hold still.
    posture : (n,), optional
        Where the held joints are held [rad]; home by default.
    """

    @border
    def __init__(
        self,
        robot: Robot,
        *,
        damping: NotNegative = DAMPING,
        held: tuple[str, ...] = (),
        posture: np.ndarray | None = None,
    ):
        if unknown := [joint for joint in held if joint not in robot.joints]:
            raise ArgumentError(f"held has no joint '{unknown[0]}'; the robot has {robot.joints}")
        self._held = np.array([joint in held for joint in robot.joints])
        self._any = bool(self._held.any())
        self._posture = robot.home if posture is None else robot.posture("posture", posture)
        self._damping = damping

    def command(self, state: State, time: float) -> np.ndarray:
        """Joint torques (n,) [Nm]."""
        robot, q, dq = state.robot, state.q, state.dq
        torque = robot.compute_gravity(q) - self._damping * dq
        if robot.has_friction:
            torque = torque + robot.friction_torque(dq)
        if self._any:
            pull = HOLD * (self._posture - q) - _CRITICAL * dq
            torque = np.where(self._held, robot.compute_torque(q, dq, pull), torque)
        return torque
