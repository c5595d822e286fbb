"""Rows that cannot be used: which they are, in one line, or out of the way."""

import numpy as np

from tpsim.arrays import LARGEST
from tpsim.data.recording import Recording, Series
from tpsim.errors import RecordingError


def usable(values: np.ndarray) -> np.ndarray:
    """Where all numbers of a row (T, d) are finite and not beyond all range, (T,)."""
    return (np.abs(values) < LARGEST).all(1)


def refuse(recording: Recording, series: Series, what: str, bad: np.ndarray) -> None:
    """Raise where any row is bad.

    Raises
    ------
    RecordingError
        Names the rows, and the line of the first in the file.
    """
    rows = np.flatnonzero(bad)
    if len(rows):
        raise RecordingError(
            f"{_title(recording)}: {what} in {said(rows, series)}; mend them, or leave such rows "
            "out with Columns(bad_rows='drop')"
        )


def said(rows: np.ndarray, series: Series) -> str:
    """Name rows, counted from 0, and the line of the first where it is known."""
    shown = ", ".join(str(row) for row in rows[:5])
    line = "" if series.first_line is None else f" (line {series.first_line + rows[0]})"
    if len(rows) == 1:
        return f"row {shown}{line}"
    more = ", ..." if len(rows) > 5 else ""
    return f"{len(rows)} rows: {shown}{more}{line and line[:-1] + ' first)'}"


def used_rows(
    recording: Recording, series: Series, time: np.ndarray, parts: dict[str, np.ndarray], drop: bool
) -> np.ndarray:
    """Rows (indices) whose numbers are all finite and whose stamps increase.

    Raises
    ------
    RecordingError
        There are other rows and ``drop`` is false, or none is left.
    """
    missing = {"time": ~usable(time[:, None])}
    missing |= {name: ~usable(values) for name, values in parts.items()}
    if not drop:
        for name, bad in missing.items():
            refuse(recording, series, f"{name} is not a number", bad)
    rows = np.flatnonzero(~np.any(list(missing.values()), axis=0))
    latest = np.maximum.accumulate(time[rows]) if len(rows) else time[rows]
    late = np.concatenate([[False], time[rows][1:] <= latest[:-1]])[: len(rows)]
    if late.any() and not drop:
        row = int(rows[late][0])
        word = "repeats" if time[row] == time[row - 1] else "goes back behind"
        raise RecordingError(
            f"{_title(recording)}: the stamp of {said(np.array([row]), series)}, "
            f"{time[row]:.9g} s, {word} that of row {row - 1}, {time[row - 1]:.9g} s "
            f"({int(late.sum())} such rows); "
            "mend them, or leave such rows out with Columns(bad_rows='drop')"
        )
    if not (~late).any():
        raise RecordingError(f"{_title(recording)}: there are no rows of numbers to use")
    return rows[~late]


def _title(recording: Recording) -> str:
    """Name a recording by its file, and by its own name where the file holds several."""
    named = recording.name and recording.name not in recording.source
    return f"{recording.source}, {recording.name}" if named else recording.source
