"""From recordings and what their columns mean to demonstrations."""

import itertools
from collections.abc import Sequence

import numpy as np

from tpsim.data.columns import Columns
from tpsim.data.frames import frames_of, signed
from tpsim.data.layouts import NUMBERS
from tpsim.data.movement import Movement, described, movement_of
from tpsim.data.recording import Recording, split
from tpsim.data.table import Table
from tpsim.demonstration import Demonstration
from tpsim.errors import RecordingError, TpsimError
from tpsim.frame import Frame


def demonstrations_of(recordings: Sequence[Recording], columns: Columns) -> list[Demonstration]:
    """Make demonstrations of recordings, with signs of quaternions that agree among all.

    Raises
    ------
    RecordingError
        Rows or columns that cannot be used, or recordings of different widths.
    """
    recordings = [part for recording in recordings for part in _parts(recording, columns)]
    demonstrations: list[Demonstration] = []
    first: Movement | None = None
    for recording in recordings:
        movement = movement_of(recording, columns)
        if first is not None and movement.data.shape[1] != first.data.shape[1]:
            raise RecordingError(
                f"{recording.source}: {recording.name} has {movement.data.shape[1]} columns and "
                f"{recordings[0].name} {first.data.shape[1]}; name the same columns in all, "
                "Columns(...)"
            )
        movement = signed(movement, first)
        first = first or movement
        demonstrations.append(_demonstration(recording, columns, movement))
    return demonstrations


def _demonstration(recording: Recording, columns: Columns, movement: Movement) -> Demonstration:
    frames, observations = frames_of(movement, columns.frames or ()), None
    if columns.frames is None and not columns.says_movement:
        frames, observations = stored_frames(recording, columns, len(movement.time))
    try:
        return Demonstration(movement.time, movement.data, frames, observations, recording.name)
    except TpsimError as error:
        raise RecordingError(f"{recording.source}: {error}") from error


def _parts(recording: Recording, columns: Columns) -> list[Recording]:
    if columns.demonstration is not None:
        return split(recording, columns.demonstration)
    names = list(recording.names())
    number = next((name for name in NUMBERS if name in names), None)
    if number is None or not recording.has(number):
        return [recording]
    values = recording.find(number)[1]
    stepwise = values.shape[1] == 1 and np.array_equal(values, np.round(values))
    return split(recording, number) if stepwise else [recording]


def stored_frames(
    recording: Recording, columns: Columns, samples: int
) -> tuple[tuple[Frame, ...], tuple[np.ndarray, ...] | None]:
    """Frames, and what they saw, that tpsim's own exporters have written beside the data."""
    if not (recording.has("A_0") and recording.has("b_0")):
        return (), None
    table = Table.of(recording, described(recording, columns))
    frames, observations = [], []
    for j in itertools.count():
        if not recording.has(f"A_{j}"):
            break
        A, b = table.values(f"A_{j}"), table.values(f"b_{j}")
        if not b.shape[1] or A.shape[1] % b.shape[1] or len(A) != samples:
            raise RecordingError(
                f"{recording.source}: A_{j} and b_{j} have shapes {A.shape} and {b.shape}; they "
                f"must be ({samples}, D d) and ({samples}, D)"
            )
        A = A.reshape(samples, b.shape[1], -1)
        constant = bool((A[0] == A).all() and (b == b[0]).all())
        frames.append(Frame(A[0], b[0]) if constant else Frame(A, b))
        if recording.has(f"observation_{j}"):
            observations.append(table.values(f"observation_{j}"))
    own = tuple(observations) if len(observations) == len(frames) else None
    return tuple(frames), own
