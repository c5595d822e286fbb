"""How a table in text is written: its characters, its headings, its separator."""

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tpsim.data.foreign import check_size, opened
from tpsim.errors import RecordingError

_MARKS = ("#", "%", "//")


@dataclass(frozen=True)
class Written:
    """A table in text.

    Parameters
    ----------
    rows : str
        From row 0 on, with points in decimal numbers.
    headings : tuple of str, optional
    separator : str, optional
        None where columns stand between blanks.
    first_line : int
        Line of the file that holds row 0, counted from 1.
    """

    rows: str
    headings: tuple[str, ...] | None
    separator: str | None
    first_line: int

    def fields(self, line: str) -> list[str]:
        """Split a line."""
        return fields_of(line, self.separator)

    def first_fields(self) -> list[str]:
        """Fields of row 0."""
        end = self.rows.find("\n")
        return self.fields(self.rows if end < 0 else self.rows[:end])

    def heading(self, column: int) -> str:
        """Heading of a column, or ``c0``, ``c1``, ... where there are none."""
        return f"c{column}" if self.headings is None else self.headings[column]


COLUMNS = 4096
"""Most columns of a table."""


def written(path: Path) -> Written:
    """Look at the first lines: comments, at most one line of headings, then numbers.

    Raises
    ------
    RecordingError
        The file is no text, or has no rows of numbers.
    """
    text = _decoded(path)
    comment: str | None = None
    heading: str | None = None
    for i, start, content in _lines(text):
        if not content:
            continue
        separator = next((mark for mark in ("\t", ";", ",") if mark in content), None)
        fields = fields_of(content, separator)
        if len(fields) > COLUMNS:
            raise RecordingError(f"{path}: line {i} has {len(fields)} columns, at most {COLUMNS}")
        numbers = [_may_be_number(field, separator) for field in fields]
        few = sum(numbers) * 2 <= len(numbers)
        if any(numbers) and (heading is not None or numbers[0] or not few):
            headings = _headings(heading, separator)
            if headings is None:
                described = _headings(comment, separator)
                headings = described if described and len(described) == len(numbers) else None
            return Written(_with_points(text[start:], separator), headings, separator, i)
        if content.startswith(_MARKS):
            comment = content.lstrip("#%/ ")
        elif heading is None:
            heading = content
        else:
            raise RecordingError(
                f"{path}: line {i} holds no numbers; a table has one line of headings at most"
            )
    raise RecordingError(f"{path}: there are no rows of numbers")


def _lines(text: str) -> Iterator[tuple[int, int, str]]:
    """Yield number, start and content of every line, without a copy of the whole text."""
    start, number = 0, 1
    while start < len(text):
        end = text.find("\n", start)
        end = len(text) if end < 0 else end
        yield number, start, text[start:end].strip()
        start, number = end + 1, number + 1


def fields_of(line: str, separator: str | None) -> list[str]:
    """Split a line at a separator, outside quotes, or at blanks."""
    if separator is None:
        return line.split()
    return [field.strip() for field in next(csv.reader([line], delimiter=separator), [])]


def is_number(field: str) -> bool:
    """Whether a field is a number."""
    try:
        float(field)
    except ValueError:
        return False
    return True


def _may_be_number(field: str, separator: str | None) -> bool:
    return is_number(field.replace(",", ".") if separator in ("\t", ";") else field)


def _headings(line: str | None, separator: str | None) -> tuple[str, ...] | None:
    if line is None:
        return None
    if separator is None:
        # A unit stands behind its name: "t [s] x [m]".
        line = re.sub(r"\s+(?=[\[(][^\])]*[\])])", "", line)
        separator = "," if "," in line else None
    return tuple(fields_of(line, separator))


def _with_points(rows: str, separator: str | None) -> str:
    """Decimal commas, which only other separators allow, as points."""
    if separator not in ("\t", ";") or "," not in rows or re.search(r"\d\.\d", rows):
        return rows
    return re.sub(r"(?<=\d),(?=\d)", ".", rows)


def _decoded(path: Path) -> str:
    with opened(path, "text file"):
        check_size(path, path.stat().st_size // 8)
        raw = path.read_bytes()
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        with opened(path, "text file"):
            text = raw.decode("utf-16")
    elif b"\0" in raw:
        raise RecordingError(f"{path} is no text file (it holds zero bytes)")
    else:
        try:
            text = raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = raw.decode("latin-1")
    if not text or text.isspace():
        raise RecordingError(f"{path} is empty")
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text
