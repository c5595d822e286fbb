"""What keeps joints off their limits, under every controller."""

import numpy as np

from tpsim.sim.robot import Robot

WIDTH = 0.1
"""Angle [rad] from a joint limit within which it is guarded."""

STIFFNESS, DAMPING = 400.0, 50.0
"""Of the guard, as acceleration [1/s^2], [1/s]: torque is that times the joint's inertia."""


class Guard:
    """Torque that keeps joints off their limits of position and velocity.

    A one-sided spring near each limit and a one-sided brake above each velocity limit, scaled by
    the joint's inertia; zero elsewhere.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot):
        self._robot = robot
        self._low, self._high = robot.lower + WIDTH, robot.upper - WIDTH
        self._bounds = np.concatenate([self._high, -self._low, *[robot.velocity_limit] * 2])
        self._nothing = np.zeros(robot.n)

    def torque(self) -> np.ndarray:
        """Torque (n,) [Nm] at the robot's last update."""
        robot = self._robot
        q, dq, fast = robot.q, robot.dq, robot.velocity_limit
        # One comparison for all bounds: this is asked at every step, and mostly in vain.
        if not np.count_nonzero(np.concatenate((q, -q, dq, -dq)) > self._bounds):
            return self._nothing
        angle = np.maximum(self._low - q, 0.0) - np.maximum(q - self._high, 0.0)
        speed = np.sign(dq) * np.maximum(np.abs(dq) - fast, 0.0)
        return np.diagonal(robot.mass) * (STIFFNESS * angle - DAMPING * speed)
