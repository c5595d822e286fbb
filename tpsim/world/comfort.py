"""Comfortable postures: views as wanted, joints off their limits, motors with torque to spare."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from scipy.optimize import least_squares

from tpsim.border import Count, border
from tpsim.errors import SimulationError
from tpsim.robot.objects import NONE, Objects
from tpsim.robot.robot import Robot
from tpsim.robot.views.view import View
from tpsim.world.reach import satisfy

MARGIN = 0.1
"""Share of a joint's range that is kept at either end."""

LOAD, MIDDLE, EXACT = 1.0, 0.3, 100.0
"""Weights of the shares of the torque limits, of the ranges, and of what must be zero."""


@border
def comfortable(
    robot: Robot,
    exact: Sequence[View],
    liked: Mapping[View, float] | None = None,
    *,
    objects: Objects = NONE,
    starts: Count = 8,
) -> Iterator[np.ndarray]:
    """Postures (n,) at which views are zero, best first: easy to hold, in the middle of ranges.

    From several starts, home first, the sum of squares is minimised of the views (``exact`` ones
    weigh so much that they can be made zero in the end), of the shares of the motors' torque that
    gravity takes, and of the joints' distances from the middle of their ranges.

    Parameters
    ----------
    robot : Robot
    exact : sequence of View
        What is to be zero.
    liked : mapping of View to float, optional
        What is to be near zero, with its weight [1/m], [1/rad].
    objects : Objects
    starts : int

    Raises
    ------
    SimulationError
        If no posture within the joint limits is found.
    """
    low, high = _inner(robot)
    rng, found = np.random.default_rng(0), []
    weights = [(view, EXACT) for view in exact] + list((liked or {}).items())
    for k in range(starts):
        start = np.clip(robot.home, low, high) if k == 0 else rng.uniform(low, high)
        result = least_squares(
            _residual,
            start,
            jac=_slope,
            bounds=(low - 1e-6, high + 1e-6),
            args=(robot, weights, objects, low, high),
            max_nfev=60,
            x_scale="jac",
        )
        try:
            found.append((float(result.cost), satisfy(robot, list(exact), result.x, objects)))
        except SimulationError as error:
            why = str(error)
    if not found:
        raise SimulationError(f"{why}, from each of {starts} starts")
    return iter(q for _, q in sorted(found, key=lambda pair: pair[0]))


def _inner(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Ranges of the joints (n,) without their ends; a turn both ways where there is no limit."""
    low = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
    high = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
    margin = MARGIN * (high - low)
    return low + margin, high - margin


def _residual(
    q: np.ndarray,
    robot: Robot,
    weights: list[tuple[View, float]],
    objects: Objects,
    low: np.ndarray,
    high: np.ndarray,
) -> np.ndarray:
    state = robot.at(q, objects=objects)
    parts = [weight * view(state).value for view, weight in weights]
    middle = (q - (low + high) / 2) / ((high - low) / 2)
    return np.concatenate([*parts, LOAD * state.gravity / robot.torque_limit, MIDDLE * middle**3])


def _slope(
    q: np.ndarray,
    robot: Robot,
    weights: list[tuple[View, float]],
    objects: Objects,
    low: np.ndarray,
    high: np.ndarray,
) -> np.ndarray:
    state, step = robot.at(q, objects=objects), 1e-6
    parts = [weight * view(state).jacobian for view, weight in weights]
    gravity = (
        np.array([robot.gravity_torque(q + step * e) for e in np.eye(robot.n)]) - state.gravity
    )
    half = (high - low) / 2
    middle = (q - (low + high) / 2) / half
    return np.concatenate(
        [
            *parts,
            LOAD * gravity.T / step / robot.torque_limit[:, None],
            np.diag(3 * MIDDLE * middle**2 / half),
        ]
    )
