"""An arm of three links that points at two objects: the teacher, the frames, a roll-out."""

from collections.abc import Callable

import numpy as np

from tpsim import Frame, PlanarChain, projection
from tpsim.control.projection import nullspace, pseudoinverse

ARM, START, T, DT = PlanarChain((0.2, 0.2, 0.2)), np.array([0.0, np.pi / 2, 0.0]), 150, 0.02
J, TIME = ARM.orientation_jacobian(START), DT * np.arange(T)[:, None]
OBJECTS = np.array([[0.9, 0.4], [-0.7, 0.6]])

Act = Callable[[int, np.ndarray, np.ndarray], np.ndarray]
"""From the step, the posture (3,) and the objects (2, 2) to the next posture."""


def angles(q: np.ndarray, objects: np.ndarray) -> np.ndarray:
    """Angles at which the hand sees the objects (2,), within half a turn of its own [rad]."""
    own, (x, y) = ARM.orientation(q), (objects - ARM.position(q)).T
    return own + np.mod(np.arctan2(y, x) - own + np.pi, 2 * np.pi) - np.pi


def teach(t: int, q: np.ndarray, objects: np.ndarray) -> np.ndarray:
    """Point at the first object, at the second, then return; hold the posture where free."""
    goal = [*angles(q, objects), START.sum()][3 * t // T]
    return q + 0.15 * (nullspace(J) @ (START - q) + pseudoinverse(J) @ [goal - q.sum()])


def frames_at(q: np.ndarray, objects: np.ndarray) -> list[Frame]:
    """Posture in the nullspace (Eq. 42), both objects (Eq. 41), the hand's own angle (Eq. 40)."""
    to = [projection.relative(J, q, [q.sum()], np.eye(1), [a]) for a in angles(q, objects)]
    return [projection.nullspace_joint(J, q), *to, projection.absolute(J, q, [q.sum()])]


def move(act: Act, objects: np.ndarray, speed: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Postures (T, 3) and pointing errors (T, 2) [rad]; the second object moves up [m/s]."""
    objects, path, errors = objects.copy(), [START], []
    for t in range(T):
        objects[1, 1] += speed * DT
        errors.append(path[-1].sum() - angles(path[-1], objects))
        path.append(act(t, path[-1], objects))
    return np.array(path[:-1]), np.array(errors)


def seen(q: np.ndarray, errors: np.ndarray) -> list[np.ndarray]:
    """What the four frames see of a demonstration, with time, 4 arrays (T, 1 + d)."""
    views = q @ nullspace(J), errors[:, :1], errors[:, 1:], ARM.orientation(q)
    return [np.hstack([TIME, view]) for view in views]
