"""Two hands that follow two targets: frames of Eqs (41) and (44), and a roll-out."""

from collections.abc import Callable, Sequence

import numpy as np

from tpsim import Frame, PlanarChain, projection, two_armed

LEFT, RIGHT = two_armed((0.5,) * 5)
START = np.array([np.pi / 2, np.pi / 2, np.pi / 3, -np.pi / 2, -np.pi / 3])
STEPS, GAIN, CLIP = 150, 0.3, 0.1

Act = Callable[[np.ndarray, Sequence[Frame]], np.ndarray]
"""From the posture (5,) and the frames to the next posture."""


def targets(way: Sequence[float]) -> np.ndarray:
    """Targets (T, 2, 2): both hands go out along ``way`` [m], mirrored, and come back."""
    out = np.sin(np.linspace(0, np.pi, STEPS))[:, None] * way
    return np.stack([LEFT.position(START) + out * [-1, 1], RIGHT.position(START) + out], axis=1)


def frames_at(q: np.ndarray, goals: np.ndarray) -> list[Frame]:
    """Left, right in the nullspace of left, left in the nullspace of right, right."""
    (J, x), (K, y) = (_look(arm, q) for arm in (LEFT, RIGHT))
    I, step = np.eye(2), {"gain": GAIN, "clip": CLIP}
    return [
        projection.relative(J, q, x, I, goals[0], **step),
        projection.nullspace_relative(J, q, K, y, I, goals[1], **step),
        projection.nullspace_relative(K, q, J, x, I, goals[0], **step),
        projection.relative(K, q, y, I, goals[1], **step),
    ]


def move(act: Act, goals: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Postures (T, 5), and what every frame sees, 4 arrays (T, 2)."""
    path, seen = [START], []
    for now in goals:
        frames = frames_at(path[-1], now)
        path.append(act(path[-1], frames))
        seen.append([frame.to_local(path[-1]) for frame in frames])
    return np.array(path[1:]), list(np.swapaxes(seen, 0, 1))


def errors(q: np.ndarray, goals: np.ndarray) -> np.ndarray:
    """Largest errors of both hands (2,) [m]."""
    reached = np.stack([LEFT.position(q), RIGHT.position(q)], axis=1)
    return np.linalg.norm(reached - goals, axis=2).max(axis=0)


def _look(arm: PlanarChain, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return arm.jacobian(q), arm.position(q)
