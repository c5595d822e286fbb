"""Poses in space that signals hold, for those who draw them."""

import numpy as np

from tpsim import rotation
from tpsim.data.columns import listed
from tpsim.data.poses import poses_in
from tpsim.data.recording import Recording, Series
from tpsim.data.signals import Signals

Poses = dict[str, tuple[np.ndarray, np.ndarray]]
"""Positions (T, 3) [m] and quaternions (T, 4), w first, by name."""


def poses_of(signals: Signals) -> Poses:
    """Poses of a demonstration's movement and frames, or of what a trial names ``_position``."""
    return _of_demonstration(signals) if "data" in signals.columns else _of_trial(signals)


def _of_demonstration(signals: Signals) -> Poses:
    data = signals.columns["data"]
    if data.shape[1] < 2:
        return {}
    turn = data[:, 3:7]
    has_turn = turn.shape[1] == 4 and bool(np.allclose(np.linalg.norm(turn, axis=1), 1, atol=1e-2))
    found = {"movement": (_in_space(data[:, :3]), turn if has_turn else _unturned(len(data)))}
    j = 0
    while f"b_{j}" in signals.columns:
        b = signals.columns[f"b_{j}"]
        A = signals.columns[f"A_{j}"].reshape(len(b), b.shape[1], -1)
        if b.shape[1] == data.shape[1]:
            found[f"frame_{j}"] = (_in_space(b[:, :3]), _turn_of(A[:, :3, :3]))
        j += 1
    return found


def _of_trial(signals: Signals) -> Poses:
    found: Poses = {}
    recording = Recording(signals.name, (Series(signals.columns),))
    for name, pose in poses_in(recording).items():
        position = recording.find(listed(pose.position)[0])[1]
        names = listed(pose.orientation)
        turn = recording.find(names[0])[1] if names else _unturned(len(position))
        if position.shape[1] in (2, 3) and turn.shape[1] == 4:
            turn = turn if pose.order == "wxyz" else np.roll(turn, 1, axis=1)
            found[name or "pose"] = (_in_space(position), turn)
    return found


def _turn_of(A: np.ndarray) -> np.ndarray:
    """Quaternions of A (T, n, n) where it is a rotation, up to scale; else unturned."""
    n = A.shape[-1]
    R = np.tile(np.eye(3), (len(A), 1, 1))
    if A.shape[-2] != n or n < 2:
        return _unturned(len(A))
    scale = np.sqrt(np.maximum((A**2).sum((-2, -1)) / n, 1e-300))[:, None, None]
    R[:, :n, :n] = A / scale
    good = np.allclose(R.mT @ R, np.eye(3), atol=1e-6) and (np.linalg.det(R) > 0).all()
    return rotation.to_quaternion(R) if good else _unturned(len(A))


def _in_space(position: np.ndarray) -> np.ndarray:
    return np.hstack([position, np.zeros((len(position), 3 - position.shape[1]))])


def _unturned(count: int) -> np.ndarray:
    return np.tile([1.0, 0, 0, 0], (count, 1))
