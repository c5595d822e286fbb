"""Tables in text: CSV, TSV, columns between blanks; TUM and EuRoC trajectories."""

from pathlib import Path

import numpy as np

from tpsim.data.clock import CLOCK, is_time
from tpsim.data.columns import Columns
from tpsim.data.readers.text_layout import Written, is_number, written
from tpsim.data.readers.text_numbers import dates, exact, is_date, numbers
from tpsim.data.recording import Recording, Series
from tpsim.data.units import name_and_unit
from tpsim.errors import RecordingError

_TUM = ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")


def recordings(path: Path) -> list[Recording]:
    """Read a table of numbers; columns of words are passed over, but for dates of a time column."""
    table = written(path)
    first = table.first_fields()
    if table.headings is not None and len(table.headings) != len(first):
        raise RecordingError(
            f"{path}: the heading names {len(table.headings)} columns and row 0 (line "
            f"{table.first_line}) has {len(first)}"
        )
    columns, units = _columns(path, table, first)
    if table.headings is None and _is_tum(columns):
        columns = dict(zip(_TUM, columns.values(), strict=True))
    length = len(next(iter(columns.values())))
    plain = table.rows.count("\n") + (not table.rows.endswith("\n")) == length
    series = Series(columns, units=units, first_line=table.first_line if plain else None)
    # libfranka's log writes milliseconds and does not say so.
    franka = {"success_rate", "time"} <= columns.keys() and "time" not in units
    defaults = Columns(time_unit="ms" if franka else None)
    return [Recording(str(path), (series,), path.stem, _kind(columns), defaults)]


def _columns(
    path: Path, table: Written, first: list[str]
) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Columns of numbers, and of dates, by name, and their units."""
    named = [i for i in range(len(first)) if table.heading(i)]
    numeric = [i for i in named if not first[i] or is_number(first[i])]
    dated = [i for i in named if is_date(first[i]) and is_time(table.heading(i))]
    if not numeric:
        raise RecordingError(f"{path}: row 0 (line {table.first_line}) holds no numbers")
    values = dict(zip(numeric, numbers(path, table, numeric).T, strict=True))
    columns: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    for i in sorted([*numeric, *dated]):
        name, unit = name_and_unit(table.heading(i))
        if name in columns:
            raise RecordingError(f"{path}: two columns have the same name, {name}")
        if i in dated:
            columns[name], unit = dates(path, table, i), "s"
        else:
            far = bool((np.abs(values[i]) > CLOCK).all())
            columns[name] = exact(table, i) if far else values[i]
        if unit is not None:
            units[name] = unit
    return columns, units


def _kind(columns: dict[str, np.ndarray]) -> str:
    if any(name.startswith("p_RS_R") for name in columns):
        return "euroc"
    return "tum" if set(_TUM[1:]) <= columns.keys() else "text"


def _is_tum(columns: dict[str, np.ndarray]) -> bool:
    if len(columns) != len(_TUM):
        return False
    turns = np.column_stack([*columns.values()][4:])
    norms = np.linalg.norm(np.where(np.abs(turns) < CLOCK, turns, 0.0), axis=1)
    return bool(np.median(np.abs(norms - 1)) < 1e-2)
