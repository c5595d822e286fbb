"""What views see along a movement."""

from collections.abc import Mapping, Sequence

import numpy as np

from tpsim.border import border
from tpsim.errors import ArgumentError
from tpsim.manifold.manifold import Manifold
from tpsim.manifold.orientations import Rotations
from tpsim.robot.objects import Objects
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
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
    rows = {name: row for row, name in enumerate(objects or {})}
    positions, quaternions = _beside(objects, 0, 3, len(q)), _beside(objects, 1, 4, len(q))
    values: list[list[np.ndarray]] = [[] for _ in views]
    at_rest = np.hstack((q, np.zeros_like(q)))
    at_rest.flags.writeable = False
    for t, x in enumerate(at_rest):
        state = State(robot, x, Objects(rows, positions[t], quaternions[t]))
        for column, view in zip(values, views, strict=True):
            column.append(view.value_at(state))
    return [
        _continuous(view.manifold(robot), np.array(column))
        for view, column in zip(views, values, strict=True)
    ]


def _continuous(manifold: Manifold, seen: np.ndarray) -> np.ndarray:
    """Points (T, width) along a movement, quaternions of one sign from sample to sample."""
    for space, columns, _ in manifold.work.single:
        if isinstance(space, Rotations):
            seen[:, columns] = continuous(seen[:, columns])
    return seen


def _beside(
    objects: Mapping[str, tuple[np.ndarray, np.ndarray]] | None, part: int, size: int, length: int
) -> np.ndarray:
    """Positions or quaternions (T, k, size) of all objects."""
    found = [places[part] for places in (objects or {}).values()]
    return np.stack(found, axis=1).astype(float) if found else np.zeros((length, 0, size))


def manifold_of(views: Sequence[View], robot: Robot) -> Manifold:
    """Where several views together live: the product of their manifolds, points side by side."""
    first, *others = (view.manifold(robot) for view in views)
    for other in others:
        first = first * other
    return first
