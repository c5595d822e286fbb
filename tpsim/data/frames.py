"""Object poses of a file as task parameters: frames of the movement's own coordinates, Eq. (4)."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tpsim import rotation
from tpsim.border import border
from tpsim.data.clock import time_column
from tpsim.data.columns import Columns, PoseColumns
from tpsim.data.movement import Movement, Placed, movement_of
from tpsim.data.orientation import agreeing, left_multiplication
from tpsim.data.readers.arrays import numeric
from tpsim.data.recording import Recording, by_length
from tpsim.errors import ArgumentError
from tpsim.frame import Frame


@border
def frames_from(recording: Recording | Mapping[str, Any], columns: Columns) -> tuple[Frame, ...]:
    """Task parameters from the object poses that are recorded beside a movement.

    Parameters
    ----------
    recording : Recording or mapping of names to arrays (T, ...)
        As :func:`tpsim.data.recordings` reads it, or a recorded trial.
    columns : Columns
        Its ``frames`` name the objects.

    Returns
    -------
    tuple of Frame
        In the order of ``columns.frames``; constant, from the first sample, or moving (T,). With
        the object's rotation R and quaternion p, position x and quaternion q of the movement are
        ``R x' + b`` and ``p q'``, which is linear in q' as well; joints and other columns are the
        same from every object. The frames ``"start"`` and ``"end"`` lie at the first and last
        sample, unturned, and take the joints' first or last value as their origin.

    Raises
    ------
    RecordingError
        No pose of that name, or rows that cannot be used.
    ArgumentError
        An object in the plane beside a movement in space, or the reverse.
    """
    if not isinstance(recording, Recording):
        arrays = {name: np.asarray(values) for name, values in recording.items()}
        recording = Recording("the arrays", by_length(numeric(arrays, "the arrays")))
        if columns.time is None and not any(map(time_column, recording.series)):
            columns = replace(columns, rate=columns.rate or 1.0)  # frames need no time
    return frames_of(signed(movement_of(recording, columns)), columns.frames or ())


def signed(movement: Movement, like: Movement | None = None) -> Movement:
    """Choose the signs of all quaternions: continuous in time, and as in another demonstration.

    A movement's quaternions agree with the other's, an object's are such that what it sees does.
    """
    quaternion = movement.quaternion
    if quaternion.size:
        quaternion = rotation.continuous(quaternion)
        quaternion = quaternion if like is None else agreeing(quaternion, like.quaternion)
    objects = []
    for j, placed in enumerate(movement.objects):
        turn = placed.quaternion
        if turn is not None:
            turn = rotation.continuous(turn)
            other = None if like is None else like.objects[j].quaternion
            if like is not None and other is not None and quaternion.size:
                turn = turn * _sign(_seen(turn, quaternion), _seen(other, like.quaternion))
        objects.append(replace(placed, quaternion=turn))
    return replace(movement, quaternion=quaternion, objects=tuple(objects))


def _sign(quaternion: np.ndarray, like: np.ndarray) -> float:
    return -1.0 if like.mean(0) @ quaternion.mean(0) < 0 else 1.0


def frames_of(movement: Movement, frames: Sequence[str | PoseColumns]) -> tuple[Frame, ...]:
    """Frames of a movement whose quaternions have their signs."""
    objects = iter(movement.objects)
    return tuple(
        _own_frame(movement, 0 if frame == "start" else -1)
        if frame in ("start", "end")
        else _object_frame(movement, next(objects))
        for frame in frames
    )


def _seen(turn: np.ndarray, quaternion: np.ndarray) -> np.ndarray:
    return (left_multiplication(turn).mT @ quaternion[..., None])[..., 0]


def _object_frame(movement: Movement, placed: Placed) -> Frame:
    n, dim = placed.position.shape[1], movement.position.shape[1]
    if n != dim:
        raise ArgumentError(
            f"frame {placed.name!r} has {n} position columns and the movement {dim}; an object can "
            "only be a frame of a movement with as many: name the movement's, Columns(position=...)"
        )
    at = slice(None) if placed.moving else 0
    p = placed.position[at]
    turn = np.array([1.0, 0, 0, 0]) if placed.quaternion is None else placed.quaternion[at]
    R = rotation.from_quaternion(turn)[..., :n, :n]
    return _frame(movement, R, p, turn, np.zeros(movement.rest.shape[1]))


def _own_frame(movement: Movement, row: int) -> Frame:
    turn = movement.quaternion[row] if movement.quaternion.size else np.array([1.0, 0, 0, 0])
    n = movement.position.shape[1]
    return _frame(movement, np.eye(n), movement.position[row], turn, movement.rest[row])


def _frame(
    movement: Movement, R: np.ndarray, p: np.ndarray, turn: np.ndarray, rest: np.ndarray
) -> Frame:
    n, m, r = (part.shape[1] for part in (movement.position, movement.quaternion, movement.rest))
    leading = np.broadcast_shapes(R.shape[:-2], turn.shape[:-1])
    A = np.zeros((*leading, n + m + r, n + m + r))
    A[..., :n, :n] = R
    if m:
        A[..., n : n + m, n : n + m] = left_multiplication(turn)
    A[..., n + m :, n + m :] = np.eye(r)
    b = np.zeros((*leading, n + m + r))
    b[..., :n], b[..., n + m :] = p, rest
    return Frame(A, b)
