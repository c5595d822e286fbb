"""A tree of transforms over time: the pose of every frame in the root of its tree."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from tpsim.data import orientation
from tpsim.timeline import interpolate

Track = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Stamps (T,) [ns], positions (T, 3) [m], quaternions (T, 4), w first."""


@dataclass
class Transforms:
    """Transforms as they arrive, each from a child frame to its parent."""

    _parents: dict[str, str] = field(default_factory=dict)
    _rows: dict[str, list[tuple[int, list[float]]]] = field(default_factory=dict)

    def add(self, message: Any, stamp: int, static: bool) -> None:
        """Take a TransformStamped of ROS or a FrameTransform of Foxglove."""
        inner = getattr(message, "transform", message)
        p, q = inner.translation, inner.rotation
        parent = getattr(getattr(message, "header", None), "frame_id", None)
        parent = getattr(message, "parent_frame_id", parent) or ""
        child = message.child_frame_id.lstrip("/")
        self._parents[child] = parent.lstrip("/")
        row = (stamp, [p.x, p.y, p.z, q.w, q.x, q.y, q.z])
        if static:
            self._rows[child] = [row]
        else:
            self._rows.setdefault(child, []).append(row)

    def composed(self) -> dict[str, Track]:
        """Track of every frame in its root, at its own stamps or at those of what carries it."""
        tracks = {child: _track(rows) for child, rows in self._rows.items()}
        return {child: self._in_root(child, tracks) for child in tracks}

    def _in_root(self, child: str, tracks: dict[str, Track]) -> Track:
        chain, frame = [child], self._parents[child]
        while frame in tracks and frame not in chain:
            chain.append(frame)
            frame = self._parents[frame]
        times = max((tracks[name][0] for name in chain), key=len)
        position, turn = np.zeros((len(times), 3)), Rotation.identity(len(times))
        for name in chain:
            p, R = _at(tracks[name], times)
            position, turn = R.apply(position) + p, R * turn
        quaternion = turn.as_quat(scalar_first=True)
        return times, position, quaternion


def _track(rows: list[tuple[int, list[float]]]) -> Track:
    stamps = np.array([stamp for stamp, _ in rows], np.int64)
    values = np.array([pose for _, pose in rows], float)
    stamps, first = np.unique(stamps, return_index=True)
    quaternion = orientation.quaternions(values[first, 3:], "wxyz")
    good = np.isfinite(quaternion).all(1)
    return stamps[good], values[first][good, :3], quaternion[good]


def _at(track: Track, times: np.ndarray) -> tuple[np.ndarray, Rotation]:
    stamps, position, quaternion = track
    own, wanted = (stamps - times[0]) * 1e-9, (times - times[0]) * 1e-9
    p = interpolate(own, position, wanted)
    turned = orientation.interpolated(own, quaternion, wanted)
    return p, Rotation.from_quat(turned, scalar_first=True)
