"""What keeps joints off their limits, under every controller."""

import numpy as np

from tpsim.sim.robot import Robot

WIDTH = 0.1
"""Angle [rad] from a joint limit within which it is guarded."""

STIFFNESS, DAMPING = 400.0, 50.0
"""Of the guard, as acceleration [1/s^2], [1/s]: torque is that times the joint's inertia."""

SLEEP = 4
"""Time steps between two looks: no joint crosses a tenth of WIDTH meanwhile."""


class Guard:
    """Torque that keeps joints off their limits of position and velocity.

    A one-sided spring near each limit and a one-sided brake above each velocity limit, scaled by
    the joint's inertia; zero elsewhere.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot):
        self._robot, self._asleep = robot, 0
        self._low, self._high = robot.lower + WIDTH, robot.upper - WIDTH
        self._least = np.concatenate((self._low, -robot.velocity_limit))
        self._most = np.concatenate((self._high, robot.velocity_limit))

    def wakes(self) -> bool:
        """Whether the robot is near or beyond a limit; far from all, it only looks at times."""
        if self._asleep:
            self._asleep -= 1
            return False
        state = self._robot.state
        near = np.count_nonzero(state < self._least) + np.count_nonzero(state > self._most) > 0
        self._asleep = 0 if near else SLEEP
        return near

    def torque(self) -> np.ndarray:
        """Torque (n,) [Nm] at the robot's last update."""
        robot = self._robot
        q, dq, fast = robot.q, robot.dq, robot.velocity_limit
        angle = np.maximum(self._low - q, 0.0) - np.maximum(q - self._high, 0.0)
        speed = np.sign(dq) * np.maximum(np.abs(dq) - fast, 0.0)
        return np.diagonal(robot.mass) * (STIFFNESS * angle - DAMPING * speed)
