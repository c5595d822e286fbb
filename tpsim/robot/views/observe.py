"""What views see along a movement."""

from collections.abc import Mapping, Sequence

import numpy as np

from tpsim.border import border
from tpsim.errors import ArgumentError
from tpsim.manifold.manifold import Manifold
from tpsim.manifold.orientations import Rotations
from tpsim.robot.along import Along
from tpsim.robot.robot import Robot
from tpsim.robot.views.view import View
from tpsim.rotation import continuous


@border
def observe(
    robot: Robot,
    views: Sequence[View],
    q: np.ndarray,
    objects: Mapping[str, tuple[np.ndarray, np.ndarray]] | None = None,
) -> list[np.ndarray]:
    """Values (T, d_j) of every view along a movement: points of its manifold.

    Parameters
    ----------
    robot : Robot
    views : sequence of View
    q : (T, n)
        [rad]
    objects : mapping of str to (positions (T, 3), quaternions (T, 4)), optional
        Where objects are meanwhile [m].
    """
    if q.ndim != 2 or q.shape[1] != robot.n:
        raise ArgumentError(f"q has shape {q.shape}; give (T, {robot.n})")
    for name, (positions, quaternions) in (objects or {}).items():
        if positions.shape != (len(q), 3) or quaternions.shape != (len(q), 4):
            raise ArgumentError(
                f"objects[{name!r}] has positions of shape {positions.shape} and quaternions of "
                f"{quaternions.shape}; give ({len(q)}, 3) and ({len(q)}, 4)"
            )
    movement = Along(robot, q, objects or {})
    return [_continuous(view.manifold(robot), view.along(movement)) for view in views]


def _continuous(manifold: Manifold, seen: np.ndarray) -> np.ndarray:
    """Points (T, width) along a movement, quaternions of one sign from sample to sample."""
    for space, columns, _ in manifold.work.single:
        if isinstance(space, Rotations):
            seen[:, columns] = continuous(seen[:, columns])
    return seen


def manifold_of(views: Sequence[View], robot: Robot) -> Manifold:
    """Where several views together live: the product of their manifolds, points side by side."""
    first, *others = (view.manifold(robot) for view in views)
    for other in others:
        first = first * other
    return first
