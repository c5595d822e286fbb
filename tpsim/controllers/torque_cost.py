"""What the acceleration of a hand costs in torque, in postures of its arm."""

import numpy as np
from scipy.linalg.lapack import dposv

from tpsim.robot.robot import Robot

SINGULAR = 0.05
"""Mobility [1/kg], [1/(kg m^2)] below which the arm counts as unable to move its hand."""


def felt_inertia(M: np.ndarray, J: np.ndarray) -> np.ndarray:
    """Inertia (6, 6) that the hand feels, bounded where the arm is singular."""
    values, V = np.linalg.eigh(J @ dposv(M, J.T)[1])
    felt: np.ndarray = (V / np.maximum(values, SINGULAR)) @ V.T
    return felt


def inertia_and_cost(
    robot: Robot, arm: slice, site: str, postures: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Inertia (T, m, m) in postures (T, m), and |tau|^2 of the hand's acceleration there.

    The latter (T, 6, 6) is ``L J J^T L`` with L the inertia that the hand feels.
    """
    q = np.zeros(robot.n)
    masses, costs = [], []
    for posture in postures:
        q[arm] = posture
        state = robot.at(q)
        M, J = state.mass[arm, arm], state.jacobian(site)[:, arm]
        inertia = felt_inertia(M, J)
        masses.append(M)
        costs.append(inertia @ J @ J.T @ inertia)
    return np.array(masses), np.array(costs)


def share_within(pull: np.ndarray, brake: np.ndarray, weights: np.ndarray) -> float:
    """Share, up to 1, of a pull (m,) [Nm] that motors give, beside a brake (m,) [Nm] that stays.

    The largest s with ``|s pull - brake|^2 <= 1`` in the metric of weights (m,) [1/(Nm)^2]: what
    the brakes take, of a movement as it is asked for, is no burden. Never less than at rest.
    """
    a, b, c = (pull * pull) @ weights, (pull * brake) @ weights, (brake * brake) @ weights
    if a <= 1:
        return 1.0
    root = np.sqrt(max(b * b + a * max(1.0 - c, 0.0), 0.0))
    return float(min(1.0, max((b + root) / a, a**-0.5)))
