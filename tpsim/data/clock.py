"""Time of a recording: from a column, from the format, or from a rate."""

import re

import numpy as np

from tpsim.data.columns import Columns
from tpsim.data.recording import Recording, Series
from tpsim.data.units import TIME, name_and_unit, unit_of_stamps
from tpsim.errors import RecordingError

CLOCK = 1e6
"""Stamps beyond this [s] are those of a clock: time counts from the first sample."""

_TIME = re.compile(
    r"[%#_ ]*(t|times?|time_?stamps?|stamps?|secs?|seconds|clock|elapsed(_time)?|time_from_start)"
    r"(_(s|ms|us|ns|sec|secs|msec))?",
    re.IGNORECASE,
)


def is_time(name: str) -> bool:
    """Whether a column with this heading holds stamps."""
    return _TIME.fullmatch(name_and_unit(name)[0]) is not None


def time_column(series: Series) -> str | None:
    """Name of the column that holds the stamps, by its name."""
    return next((name for name in series.columns if _TIME.fullmatch(name)), None)


def stamps(recording: Recording, series: Series, columns: Columns) -> np.ndarray:
    """Stamps (T,) [s] of a series; not yet checked.

    Raises
    ------
    RecordingError
        There is neither a time column nor a rate.
    """
    name = columns.time
    if name is None and series.time is not None:
        return series.time
    if name is None and columns.rate is None:
        name = time_column(series)
    if name is not None:
        return _seconds(recording, series, columns)
    if columns.rate is not None:
        return np.arange(len(series)) / columns.rate
    raise RecordingError(
        f"{recording.source}: no time column is recognised; name it, Columns(time=...), or give "
        f"the samples per second, Columns(rate=...); {recording.known('time')}"
    )


def _seconds(recording: Recording, series: Series, columns: Columns) -> np.ndarray:
    name = columns.time if columns.time is not None else time_column(series)
    assert name is not None
    values = series.values(name)
    if values is None:
        recording.find(name)  # tells which columns there are
        raise RecordingError(f"{recording.source}: {name!r} is on another clock than the movement")
    found = series.names_of(name)
    label = found[0] if found else str(name)
    finite = values[np.isfinite(values[:, 0]), 0]
    last = float(finite[-1]) if len(finite) else 0.0
    unit = columns.time_unit or series.units.get(label) or unit_of_stamps(label, last)
    if unit not in TIME:
        raise RecordingError(
            f"{recording.source}: {label} is in {unit!r}; give Columns(time_unit=...), one of "
            f"{', '.join(TIME)}"
        )
    start = finite[0] if len(finite) and abs(last) * TIME[unit] > CLOCK else 0.0
    return np.asarray(values[:, 0] - start, float) * TIME[unit]
