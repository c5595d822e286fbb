"""The columns of a recording as position, orientation and joints, in SI units, row by row."""

from dataclasses import dataclass, replace

import numpy as np

from tpsim.data.columns import Columns, PoseColumns
from tpsim.data.layouts import layout_of
from tpsim.data.poses import pose_named
from tpsim.data.recording import Recording
from tpsim.data.rows import usable, used_rows
from tpsim.data.table import Table
from tpsim.errors import RecordingError


@dataclass(frozen=True, eq=False)
class Placed:
    """An object: position (T, n) [m] and quaternion (T, 4) or none; one row where it stays."""

    name: str
    position: np.ndarray
    quaternion: np.ndarray | None
    moving: bool

    def rows(self, keep: np.ndarray) -> "Placed":
        """Only the given rows, of an object that moves."""
        if not self.moving:
            return self
        quaternion = None if self.quaternion is None else self.quaternion[keep]
        return replace(self, position=self.position[keep], quaternion=quaternion)


@dataclass(frozen=True, eq=False)
class Movement:
    """Time (T,) [s] and the parts of a movement: (T, 0) where a part is not there."""

    time: np.ndarray
    position: np.ndarray
    quaternion: np.ndarray
    rest: np.ndarray
    objects: tuple[Placed, ...] = ()

    @property
    def data(self) -> np.ndarray:
        """Position, quaternion, joints and other columns beside each other, (T, D)."""
        return np.hstack([self.position, self.quaternion, self.rest])

    def rows(self, keep: np.ndarray) -> "Movement":
        """Only the given rows."""
        return Movement(
            self.time[keep],
            self.position[keep],
            self.quaternion[keep],
            self.rest[keep],
            tuple(placed.rows(keep) for placed in self.objects),
        )


def movement_of(recording: Recording, columns: Columns) -> Movement:
    """Read the movement and its objects from a recording.

    Raises
    ------
    RecordingError
        Columns that are not there, of other lengths, or bad rows; the message names the first.
    """
    columns = described(recording, columns)
    table = Table.of(recording, columns)
    order = columns.order or "wxyz"
    movement = Movement(
        table.time,
        table.values(columns.position, "length"),
        table.turn(columns.orientation, order),
        np.hstack([table.values(columns.joints, "angle"), table.values(columns.other)]),
        tuple(placed_in(table, frame, columns) for frame in objects_of(columns)),
    )
    if movement.position.shape[1] not in (0, 2, 3):
        raise RecordingError(
            f"{recording.source}: position has {movement.position.shape[1]} columns; give 3, or 2 "
            "in the plane; what is no position goes to Columns(other=...)"
        )
    movement = movement.rows(
        used_rows(recording, table.series, table.time, _parts(movement), columns.bad_rows == "drop")
    )
    if not recording.clock:
        return movement
    return replace(movement, time=movement.time - movement.time[0])


def described(recording: Recording, columns: Columns) -> Columns:
    """Complete a description from the format and from the names of the columns."""
    columns = columns.over(recording.defaults)
    return columns if columns.says_movement else columns.over(layout_of(recording, columns))


def objects_of(columns: Columns) -> list[str | PoseColumns]:
    """Frames that are objects of the file, not the movement's own ends."""
    return [frame for frame in columns.frames or () if frame not in ("start", "end")]


def placed_in(table: Table, frame: str | PoseColumns, columns: Columns) -> Placed:
    """Read an object's pose: at every sample, or at the first that knows it."""
    source = table.recording.source
    if isinstance(frame, str):
        frame = replace(pose_named(table.recording, frame), name=frame, moving=columns.moving)
    position = table.values(frame.position, "length")
    if position.shape[1] not in (2, 3):
        raise RecordingError(
            f"{source}: frame {frame.name!r} has {position.shape[1]} position columns; give 3, or "
            "2 in the plane"
        )
    quaternion = table.turn(frame.orientation, frame.order)
    if not frame.moving:
        known = np.flatnonzero(usable(np.hstack([position, quaternion])))
        if not len(known):
            raise RecordingError(f"{source}: frame {frame.name!r} is not a number in any row")
        position, quaternion = position[known[:1]], quaternion[known[:1]]
    return Placed(frame.name, position, quaternion if quaternion.size else None, frame.moving)


def _parts(movement: Movement) -> dict[str, np.ndarray]:
    parts = {
        "position": movement.position,
        "orientation": movement.quaternion,
        "joints or other": movement.rest,
    }
    for placed in movement.objects:
        if placed.moving:
            turn = [] if placed.quaternion is None else [placed.quaternion]
            parts[f"frame {placed.name!r}"] = np.hstack([placed.position, *turn])
    return parts
