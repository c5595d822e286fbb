"""The numbers of a table in text: by Arrow where it is installed, else by NumPy."""

import re
from pathlib import Path

import numpy as np

from tpsim.data.readers.text_layout import Written, fields_of, is_number
from tpsim.errors import RecordingError, one_line


def numbers(path: Path, table: Written, columns: list[int]) -> np.ndarray:
    """Numbers (T, n) of the given columns; NaN where a cell is empty.

    Raises
    ------
    RecordingError
        A row of another length, or a word among the numbers; the message names row and line.
    """
    if table.separator and (values := _by_arrow(table, table.separator, columns)) is not None:
        return values
    lines, separator = table.rows.splitlines(), table.separator
    try:
        if table.separator and _has_gaps(table.rows, table.separator):
            # Empty cells become NaN; slower, so only where there are any.
            return np.genfromtxt(lines, delimiter=separator, usecols=columns, ndmin=2)
        return np.loadtxt(lines, delimiter=separator, usecols=columns, ndmin=2, quotechar='"')
    except ValueError as error:
        fault = _fault(table, columns) or one_line(error)
        raise RecordingError(f"{path}: {fault}") from error


def exact(table: Written, column: int) -> np.ndarray:
    """Stamps of a clock (T,): a double rounds Unix time to 0.2 us, and nanoseconds by 0.1 us."""
    return np.loadtxt(
        table.rows.splitlines(),
        dtype=np.longdouble,
        delimiter=table.separator,
        usecols=column,
        ndmin=1,
        quotechar='"',
    )


def dates(path: Path, table: Written, column: int) -> np.ndarray:
    """Dates such as ``2026-05-01T12:00:00.25`` as seconds since the first, (T,).

    Raises
    ------
    RecordingError
        A row that holds no date.
    """
    lines = [line for line in table.rows.splitlines() if line.strip()]
    found = np.empty(len(lines), "datetime64[ns]")
    for row, line in enumerate(lines):
        field = table.fields(line)[column]
        try:
            found[row] = np.datetime64(re.sub(r"\s*(Z|[+-]\d\d:?\d\d)$", "", field))
        except ValueError as error:
            where = f"row {row} (line {table.first_line + row})"
            raise RecordingError(
                f"{path}: {where} has {field[:40]!r} in column {table.heading(column)}, which is "
                "neither a number nor a date"
            ) from error
    return (found - found[0]) / np.timedelta64(1, "s")


def is_date(field: str) -> bool:
    """Whether a field is a date with a time of day."""
    return re.match(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d", field) is not None


def _by_arrow(table: Written, separator: str, columns: list[int]) -> np.ndarray | None:
    """Numbers of a table without a fault, four times as fast; None where NumPy must have a look."""
    try:
        import pyarrow
        from pyarrow import csv as arrow
    except ImportError:
        return None
    names = [str(i) for i in range(len(table.first_fields()))]
    used = [names[i] for i in columns]
    try:
        read = arrow.read_csv(
            pyarrow.BufferReader(table.rows.encode()),
            read_options=arrow.ReadOptions(use_threads=False, column_names=names),
            parse_options=arrow.ParseOptions(delimiter=separator),
            convert_options=arrow.ConvertOptions(
                include_columns=used, column_types=dict.fromkeys(used, pyarrow.float64())
            ),
        )
    except pyarrow.ArrowInvalid:
        return None
    return np.column_stack([read[name].to_numpy() for name in used])


def _has_gaps(rows: str, mark: str) -> bool:
    gaps = (mark * 2, f"{mark} {mark}", f"{mark}\n", f"\n{mark}")
    return rows.startswith(mark) or rows.endswith(mark) or any(gap in rows for gap in gaps)


def _fault(table: Written, columns: list[int]) -> str | None:
    """Say where a table breaks off."""
    width = len(table.first_fields())
    lines = [(i, line) for i, line in enumerate(table.rows.splitlines()) if line.split("#")[0]]
    for row, (i, line) in enumerate(lines):
        where = f"row {row} (line {table.first_line + i})"
        fields = fields_of(line, table.separator)
        if len(fields) != width:
            return f"{where} has {len(fields)} fields and row 0 has {width}"
        for column in columns:
            if fields[column] and not is_number(fields[column]):
                name = table.heading(column)
                return f"{where} has {fields[column][:30]!r} in column {name}, which is no number"
    return None
