"""Messages of robots, topic by topic, as columns on their own clocks."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tpsim.data.readers.transforms import Transforms
from tpsim.data.recording import Series

LARGEST = 1024
"""Arrays of more numbers are pictures and clouds, not signals."""

_HEADERS = ("header", "timestamp", "stamp")
_PICTURES = ("Image", "PointCloud", "CameraInfo", "LaserScan", "Grid", "Video", "Log", "String")


@dataclass
class Messages:
    """Collects messages in the order of a file."""

    _rows: dict[tuple, list[np.ndarray]] = field(default_factory=dict)
    _stamps: dict[tuple, list[int]] = field(default_factory=dict)
    _transforms: Transforms = field(default_factory=Transforms)

    def add(self, topic: str, kind: str, logged: int, message: Any) -> None:
        """Take a message of type ``kind`` that was logged at ``logged`` [ns]."""
        kind = kind.rsplit("/", 1)[-1].rsplit(".", 1)[-1]
        if any(word in kind for word in _PICTURES):
            return
        if kind in ("TFMessage", "FrameTransforms"):
            for transform in message.transforms:
                self._transforms.add(transform, stamp_of(transform, logged), "static" in topic)
            return
        if kind in ("FrameTransform", "TransformStamped"):
            self._transforms.add(message, stamp_of(message, logged), "static" in topic)
            return
        leaves = dict(_joints(message) if kind.startswith("JointState") else _leaves(message))
        if not leaves:
            return
        # Messages of one topic may name different joints: each set of names is a series.
        key = (topic, *((name, value.size) for name, value in leaves.items()))
        self._rows.setdefault(key, []).append(np.concatenate([v.ravel() for v in leaves.values()]))
        self._stamps.setdefault(key, []).append(stamp_of(message, logged))

    def series(self) -> tuple[Series, ...]:
        """All series, with stamps [s] since the first; joints before others, then the longest."""
        transforms = self._transforms.composed()
        starts = [stamps[0] for stamps in self._stamps.values()]
        starts += [int(stamps[0]) for stamps, _, _ in transforms.values() if len(stamps) > 1]
        start = min(starts, default=0)
        found = [self._series(key, start) for key in self._rows]
        for name, (stamps, position, quaternion) in transforms.items():
            axes = {f"tf/{name}/position/{axis}": position[:, i] for i, axis in enumerate("xyz")}
            axes |= {f"tf/{name}/orientation/{w}": quaternion[:, i] for i, w in enumerate("wxyz")}
            found.append(Series(axes, (stamps - start) * 1e-9))
        return tuple(sorted(found, key=lambda s: (not _of_joints(s), -len(s))))

    def _series(self, key: tuple, start: int) -> Series:
        topic, *parts = key
        values = np.array(self._rows[key])
        ends = np.cumsum([size for _, size in parts])
        columns = {}
        for (name, size), end in zip(parts, ends, strict=True):
            block = values[:, end - size : end]
            columns[f"{topic}/{name}"] = block[:, 0] if size == 1 else block
        stamps = np.array(self._stamps[key], np.int64) - start
        return Series(columns, stamps * 1e-9)


def stamp_of(message: Any, logged: int) -> int:
    """Stamp of a message [ns]: of its header, or when it was logged where there is none."""
    header = getattr(message, "header", message)
    stamp = getattr(header, "stamp", None) or getattr(message, "timestamp", None)
    seconds = getattr(stamp, "sec", getattr(stamp, "secs", 0))
    rest = next(
        (getattr(stamp, n) for n in ("nanosec", "nsec", "nsecs", "nanos") if hasattr(stamp, n)), 0
    )
    return (int(seconds) * 1_000_000_000 + int(rest)) or logged


def fields_of(message: Any) -> dict[str, Any]:
    """Fields of a decoded message, whichever library decoded it."""
    names = getattr(message, "__dataclass_fields__", None) or getattr(message, "__slots__", None)
    names = names or getattr(message, "__dict__", {})
    return {name: getattr(message, name) for name in names if not name.startswith("_")}


def _joints(message: Any) -> Iterator[tuple[str, np.ndarray]]:
    names: Sequence[str] = list(getattr(message, "name", ()))
    for quantity in ("position", "velocity", "effort"):
        values = np.asarray(getattr(message, quantity, ()), float)
        if len(values) == len(names):
            for name, value in zip(names, values, strict=True):
                yield f"{name}/{quantity}", np.atleast_1d(value)


def _leaves(message: Any, prefix: str = "") -> Iterator[tuple[str, np.ndarray]]:
    for name, value in fields_of(message).items():
        if name in _HEADERS or isinstance(value, str | bytes):
            continue
        if isinstance(value, int | float | np.number | np.ndarray | list | tuple):
            try:
                numbers = np.asarray(value, float)
            except (ValueError, TypeError):
                continue
            if 0 < numbers.size <= LARGEST:
                yield prefix + name, numbers
        else:
            yield from _leaves(value, f"{prefix}{name}/")


def _of_joints(series: Series) -> bool:
    return any(name.endswith("/position") for name in series.columns)
