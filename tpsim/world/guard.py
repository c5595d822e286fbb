"""What keeps joints off their limits, under every impedance."""

import numpy as np

from tpsim.robot.robot import Robot
from tpsim.robot.state import State

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
        self._asleep = 0
        lower, upper = unguarded(robot)
        # Of angles over velocities.
        self._least = np.concatenate((lower, -robot.velocity_limit))
        self._most = np.concatenate((upper, robot.velocity_limit))

    def torque(self, state: State) -> np.ndarray | None:
        """Torque (n,) [Nm] at a state; None away from all limits, where it only looks at times."""
        if self._asleep:
            self._asleep -= 1
            return None
        x, n = state.x, len(state.q)
        back = np.maximum(self._least - x, 0.0) - np.maximum(x - self._most, 0.0)
        if not np.count_nonzero(back):
            self._asleep = SLEEP
            return None
        torque: np.ndarray = state.mass.diagonal() * (STIFFNESS * back[:n] + DAMPING * back[n:])
        return torque


def unguarded(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Between which angles (n,), (n,) [rad] joints are left to themselves."""
    return robot.lower + WIDTH, robot.upper - WIDTH
