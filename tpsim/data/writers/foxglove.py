"""Foxglove's published messages in JSON: their schemas, and how they are filled."""

from typing import Any

import numpy as np

_TIME = {
    "type": "object",
    "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}},
}


def _numbers(names: str) -> dict[str, Any]:
    return {"type": "object", "properties": {name: {"type": "number"} for name in names}}


POSE_IN_FRAME = {
    "title": "foxglove.PoseInFrame",
    "type": "object",
    "properties": {
        "timestamp": _TIME,
        "frame_id": {"type": "string"},
        "pose": {
            "title": "foxglove.Pose",
            "type": "object",
            "properties": {"position": _numbers("xyz"), "orientation": _numbers("xyzw")},
        },
    },
}
"""A pose at a time, in a frame of reference."""

SAMPLES = {
    "title": "tpsim.Samples",
    "type": "object",
    "properties": {"timestamp": _TIME},
    "additionalProperties": {"type": "array", "items": {"type": "number"}},
}
"""All signals of one sample, by name."""


def stamp(nanoseconds: int) -> dict[str, int]:
    """Seconds and nanoseconds of a stamp [ns]."""
    return {"sec": nanoseconds // 1_000_000_000, "nsec": nanoseconds % 1_000_000_000}


def pose_in_frame(
    nanoseconds: int, frame: str, position: np.ndarray, quaternion: np.ndarray
) -> dict[str, Any]:
    """Fill a PoseInFrame with a position (3,) [m] and a quaternion (4,), w first."""
    w, x, y, z = quaternion.tolist()
    return {
        "timestamp": stamp(nanoseconds),
        "frame_id": frame,
        "pose": {
            "position": dict(zip("xyz", position.tolist(), strict=True)),
            "orientation": {"x": x, "y": y, "z": z, "w": w},
        },
    }
