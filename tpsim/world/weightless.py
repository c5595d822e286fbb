"""Weightless arms, for kinesthetic teaching."""

import numpy as np

from tpsim.robot.robot import Robot
from tpsim.robot.state import State

HOLD = 400.0
"""Stiffness [1/s^2] of joints that are not taught, times inertia; critically damped."""

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

    def __init__(
        self,
        robot: Robot,
        *,
        damping: float = DAMPING,
        held: tuple[str, ...] = (),
        posture: np.ndarray | None = None,
    ):
        self._held = np.array([joint in held for joint in robot.joints])
        self._any = bool(self._held.any())
        self._posture = robot.home if posture is None else np.array(posture, float)
        self._damping = damping

    def command(self, state: State, time: float) -> np.ndarray:
        """Joint torques (n,) [Nm]."""
        torque = state.gravity - self._damping * state.dq
        if self._any:
            rate = HOLD**0.5
            pull = rate**2 * (self._posture - state.q) - 2 * rate * state.dq
            torque = np.where(self._held, state.mass @ pull + state.bias, torque)
        return torque
