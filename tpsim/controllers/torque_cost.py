"""What the acceleration of a hand costs in torque, in postures of its arm."""

from collections.abc import Iterator

import numpy as np

from tpsim.robot.anatomy import mobility
from tpsim.robot.robot import Robot

STRENGTH = 0.3
"""Share of the motors' torque that springs do not exceed beyond brakes, as after a jump."""

HELD = 0.16
"""The same where somebody holds the hand: let go, critically damped, torque changes by
1 + exp(-1) / 2 of that at most, and hardly by a fifth."""

SINGULAR = 0.05
"""Mobility [1/kg], [1/(kg m^2)] below which the arm counts as unable to move its hand."""

HEAVY = 0.8
"""The same of arms so heavy that it is usual for them: as a share of their usual mobility."""

_NEVER = 1e-9
"""Share of the largest mobility that is none."""


def effort_of(robot: Robot, joints: tuple[str, ...]) -> float:
    """Cost of torque [1/(Nm)^2] with which a usual deviation is worth all that springs may pull.

    ``1 / (STRENGTH limit)^2``, the mean over the motors of some joints.
    """
    pulls = STRENGTH * robot.torque_limit[robot.index(joints)]
    return float(np.mean(pulls**-2.0))


def acceleration_effort(robot: Robot, strength: float = STRENGTH) -> float:
    """The same for the cost of acceleration [s^4/(kg m^2)]: ``M_ii / (strength limit_i)^2``.

    The mean over the joints, with their inertia at home. A usual deviation in a direction z of
    unit inertia is pulled back with the torque ``|M^1/2| / r^1/2``.
    """
    pulls = strength * robot.torque_limit
    return float(np.mean(robot.at_home.mass.diagonal() / pulls**2))


def held(robot: Robot, arm: slice) -> float:
    """Share of the motors' torque that springs of an arm do not exceed while it is held.

    Beyond joint friction, which nobody else overcomes: let go, weaker springs would not move it.
    """
    rubs = float(np.linalg.norm(robot.friction[arm] / robot.torque_limit[arm]))
    return min(HELD + rubs, STRENGTH)


def felt_inertia(M: np.ndarray, J: np.ndarray, least: float) -> np.ndarray:
    """Inertia (6, 6) that the hand feels, bounded where the arm is singular: least mobility."""
    values, V = np.linalg.eigh(mobility(M, J))
    felt: np.ndarray = (V / np.maximum(values, least)) @ V.T
    return felt


def least_mobility(robot: Robot, arm: slice, site: str, postures: np.ndarray) -> float:
    """Mobility below which an arm is singular, by its usual postures (T, m).

    Directions in which an arm never moves, such as out of a plane, say nothing about that.
    """
    found = [np.linalg.eigvalsh(mobility(*one)) for one in _along(robot, arm, site, postures)]
    usual = np.median(found, axis=0)
    return min(SINGULAR, HEAVY * float(usual[usual > _NEVER * usual[-1]][0]))


def inertia_and_cost(
    robot: Robot, arm: slice, site: str, postures: np.ndarray, least: float
) -> tuple[np.ndarray, np.ndarray]:
    """Inertia (T, m, m) in postures (T, m), and |tau|^2 of the hand's acceleration there.

    The latter (T, 6, 6) is ``L J J^T L`` with L the inertia that the hand feels.
    """
    masses, costs = [], []
    for M, J in _along(robot, arm, site, postures):
        inertia = felt_inertia(M, J, least)
        masses.append(M)
        costs.append(inertia @ J @ J.T @ inertia)
    return np.array(masses), np.array(costs)


def _along(
    robot: Robot, arm: slice, site: str, postures: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Inertia (m, m) of an arm and Jacobian (6, m) of its hand, in postures (T, m)."""
    q = np.zeros(robot.n)
    for posture in postures:
        q[arm] = posture
        state = robot.at(q)
        yield state.mass[arm, arm], state.jacobian(site)[:, arm]


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
