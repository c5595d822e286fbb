"""What keeps joints off their limits, under every controller."""

import numpy as np

from tpsim.sim.robot import Robot

WIDTH = 0.1
"""Angle [rad] from a joint limit within which it is guarded."""

STIFFNESS, DAMPING = 400.0, 50.0
"""Of the guard, as acceleration [1/s^2], [1/s]: torque is that times the joint's inertia."""


def guard(robot: Robot) -> np.ndarray:
    """Torque (n,) [Nm] that keeps joints off their limits of position and velocity.

    A one-sided spring near each limit and a one-sided brake above each velocity limit, scaled by
    the joint's inertia; zero elsewhere.
    """
    # Plain numbers: with so few joints, arrays would take ten times as long to say "far off".
    limits = robot.lower.tolist(), robot.upper.tolist(), robot.velocity_limit.tolist()
    joints = zip(robot.q.tolist(), robot.dq.tolist(), *limits, strict=True)
    if all(
        low + WIDTH <= q <= high - WIDTH and abs(dq) <= fast for q, dq, low, high, fast in joints
    ):
        return np.zeros(robot.n)
    low = np.maximum(robot.lower + WIDTH - robot.q, 0.0)
    high = np.maximum(robot.q + WIDTH - robot.upper, 0.0)
    fast = np.sign(robot.dq) * np.maximum(np.abs(robot.dq) - robot.velocity_limit, 0.0)
    return np.diagonal(robot.mass) * (STIFFNESS * (low - high) - DAMPING * fast)
