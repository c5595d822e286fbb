"""Tables in text: CSV, TSV, columns between blanks; TUM and EuRoC trajectories."""

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tpsim.data.clock import CLOCK
from tpsim.data.columns import Columns
from tpsim.data.foreign import opened
from tpsim.data.recording import Recording, Series
from tpsim.data.units import name_and_unit
from tpsim.errors import RecordingError

_MARKS = ("#", "%", "//")
_TUM = ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")


@dataclass(frozen=True)
class _Layout:
    """How a table is written: its headings, its separator, and the line of row 0 (from 1)."""

    headings: tuple[str, ...] | None
    separator: str | None
    first_line: int
    decimal_comma: bool


def recordings(path: Path) -> list[Recording]:
    """Read a table of numbers; columns of words are passed over."""
    text = _decoded(path)
    layout = _layout(path, text)
    rows = text.split("\n", layout.first_line - 1)[-1]
    fields = _fields(_first_row(rows), layout.separator)
    headings = layout.headings
    if headings is not None and len(headings) != len(fields):
        raise RecordingError(
            f"{path}: the heading names {len(headings)} columns and row 0 (line "
            f"{layout.first_line}) has {len(fields)}"
        )
    numeric = [
        i
        for i, field in enumerate(fields)
        if _is_number(field, layout) and (headings is None or headings[i])
    ]
    if not numeric:
        raise RecordingError(f"{path}: row 0 (line {layout.first_line}) holds no numbers")
    if layout.decimal_comma:
        rows = rows.replace(",", ".")
    values = _numbers(path, rows, layout, numeric)
    table = {}
    units = {}
    for column, i in enumerate(numeric):
        name, unit = name_and_unit(headings[i]) if headings is not None else (f"c{i}", None)
        known = values[:, column]
        table[name] = _exact(rows, layout, i) if (np.abs(known) > CLOCK).all() else known
        if unit is not None:
            units[name] = unit
    if len(table) < len(numeric):
        raise RecordingError(f"{path}: two columns have the same name")
    return [_recording(path, table, units, layout, rows)]


def _recording(
    path: Path, table: dict[str, np.ndarray], units: dict[str, str], layout: _Layout, rows: str
) -> Recording:
    if layout.headings is None and _is_tum(table):
        table = dict(zip(_TUM, table.values(), strict=True))
    length = len(next(iter(table.values())))
    plain = rows.count("\n") + (not rows.endswith("\n")) == length
    series = Series(table, units=units, first_line=layout.first_line if plain else None)
    kind = "tum" if set(_TUM[1:]) <= set(table) else "text"
    if any(name.startswith("p_RS_R") for name in table):
        kind = "euroc"
    franka = "success_rate" in table and "time" in table
    return Recording(
        str(path),
        (series,),
        path.stem,
        kind,
        # libfranka's log writes milliseconds and does not say so.
        Columns(time_unit="ms" if franka and "time" not in units else None),
    )


def _decoded(path: Path) -> str:
    with opened(path, "text file"):
        raw = path.read_bytes()
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        with opened(path, "text file"):
            return _unix(raw.decode("utf-16"))
    if b"\0" in raw:
        raise RecordingError(f"{path} is no text file (it holds zero bytes)")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    if not text.strip():
        raise RecordingError(f"{path} is empty")
    return _unix(text)


def _unix(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def _layout(path: Path, text: str) -> _Layout:
    """Look at the first lines: comments, at most one line of headings, then numbers."""
    comment: str | None = None
    heading: str | None = None
    for i, line in enumerate(io.StringIO(text), start=1):
        content = line.strip()
        if not content:
            continue
        separator = _separator(content)
        numbers = [_number(field, separator) for field in _fields(content, separator)]
        if any(numbers) and (heading is not None or numbers[0] or sum(numbers) * 2 > len(numbers)):
            headings = _headings(heading, separator)
            if headings is None and comment is not None:
                headings = _headings(comment, separator)
                if headings is not None and len(headings) != len(numbers):
                    headings = None
            comma = separator in ("\t", ";") and "," in content and "." not in content
            return _Layout(headings, separator, i, comma)
        if content.startswith(_MARKS):
            comment = content.lstrip("#%/ ")
        elif heading is None:
            heading = content
        else:
            raise RecordingError(
                f"{path}: line {i} holds no numbers; a table has one line of headings at most"
            )
    raise RecordingError(f"{path}: there are no rows of numbers")


def _separator(line: str) -> str | None:
    return next((mark for mark in ("\t", ";", ",") if mark in line), None)


def _fields(line: str, separator: str | None) -> list[str]:
    if separator is None:
        return line.split()
    return [field.strip() for field in next(csv.reader([line], delimiter=separator))]


def _headings(line: str | None, separator: str | None) -> tuple[str, ...] | None:
    if line is None:
        return None
    if separator is None:
        # A unit stands behind its name: "t [s] x [m]".
        line = re.sub(r"\s+(?=[\[(][^\])]*[\])])", "", line)
        if "," in line:
            separator = ","
    return tuple(_fields(line, separator))


def _first_row(rows: str) -> str:
    return rows[: rows.find("\n")].strip() if "\n" in rows else rows.strip()


def _is_number(field: str, layout: _Layout) -> bool:
    return not field or _number(field, layout.separator)


def _number(field: str, separator: str | None) -> bool:
    if separator in ("\t", ";"):
        field = field.replace(",", ".")
    try:
        float(field)
    except ValueError:
        return False
    return True


def _numbers(path: Path, rows: str, layout: _Layout, columns: list[int]) -> np.ndarray:
    separator = layout.separator
    if separator and (values := _by_arrow(rows, separator, columns)) is not None:
        return values
    try:
        if separator and _has_gaps(rows, separator):
            # Empty cells become NaN; slower, so only where there are any.
            return np.genfromtxt(rows.splitlines(), delimiter=separator, usecols=columns, ndmin=2)
        return np.loadtxt(
            rows.splitlines(), delimiter=separator, usecols=columns, ndmin=2, quotechar='"'
        )
    except ValueError as error:
        fault = _fault(rows, layout, columns) or " ".join(str(error).split())
        raise RecordingError(f"{path}: {fault}") from error


def _fault(rows: str, layout: _Layout, columns: list[int]) -> str | None:
    """Say where a table breaks off."""
    width = len(_fields(_first_row(rows), layout.separator))
    lines = [
        (i, line) for i, line in enumerate(rows.splitlines()) if line.partition("#")[0].strip()
    ]
    for row, (i, line) in enumerate(lines):
        where = f"row {row} (line {layout.first_line + i})"
        fields = _fields(line, layout.separator)
        if len(fields) != width:
            return f"{where} has {len(fields)} fields and row 0 has {width}"
        for column in columns:
            if fields[column] and not _number(fields[column], layout.separator):
                name = layout.headings[column] if layout.headings else f"c{column}"
                return f"{where} has {fields[column][:30]!r} in column {name}, which is no number"
    return None


def _exact(rows: str, layout: _Layout, column: int) -> np.ndarray:
    """Stamps of a clock: a double rounds Unix time to 0.2 us, and nanoseconds by 0.1 us."""
    lines = rows.splitlines()
    return np.loadtxt(
        lines,
        dtype=np.longdouble,
        delimiter=layout.separator,
        usecols=column,
        ndmin=1,
        quotechar='"',
    )


def _by_arrow(rows: str, separator: str, columns: list[int]) -> np.ndarray | None:
    """Numbers of a table without a fault, four times as fast; None where NumPy must have a look."""
    try:
        import pyarrow
        from pyarrow import csv as arrow
    except ImportError:
        return None
    width = len(_fields(_first_row(rows), separator))
    names = [str(i) for i in range(width)]
    used = [names[i] for i in columns]
    try:
        table = arrow.read_csv(
            pyarrow.BufferReader(rows.encode()),
            read_options=arrow.ReadOptions(use_threads=False, column_names=names),
            parse_options=arrow.ParseOptions(delimiter=separator),
            convert_options=arrow.ConvertOptions(
                include_columns=used, column_types=dict.fromkeys(used, pyarrow.float64())
            ),
        )
    except pyarrow.ArrowInvalid:
        return None
    return np.column_stack([table[name].to_numpy() for name in used])


def _has_gaps(rows: str, mark: str) -> bool:
    gaps = (mark * 2, f"{mark} {mark}", f"{mark}\n", f"\n{mark}")
    return rows.startswith(mark) or rows.endswith(mark) or any(gap in rows for gap in gaps)


def _is_tum(table: dict[str, np.ndarray]) -> bool:
    if len(table) != len(_TUM):
        return False
    norms = np.linalg.norm(np.column_stack([*table.values()][4:]), axis=1)
    return bool(np.nanmedian(np.abs(norms - 1)) < 1e-2)
