"""What a file holds, before anybody says what its columns mean."""

import difflib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase

import numpy as np

from tpsim.border import border, checked, read
from tpsim.checks import array_of, instance, shown
from tpsim.data.columns import Columns, Name
from tpsim.errors import ArgumentError, RecordingError


@dataclass(frozen=True, eq=False)
class Series:
    """Columns on one clock.

    Parameters
    ----------
    columns : mapping of names to (T,) or (T, d)
    time : (T,), optional
        Stamps that the format itself gives [s].
    units : mapping of names to units
        As the headings say.
    first_line : int, optional
        Line of the file that holds row 0.
    """

    columns: Mapping[str, np.ndarray]
    time: np.ndarray | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    first_line: int | None = None

    def __post_init__(self) -> None:
        columns = read("columns", self.columns, Mapping[str, object])
        lengths = {
            len(instance(f"columns[{k!r}]", v, np.ndarray)) if np.ndim(v) else -1
            for k, v in columns.items()
        }
        if len(lengths) > 1 or -1 in lengths:
            raise ArgumentError(
                f"columns have {sorted(lengths)} rows; give equally many, (T,) or (T, d)"
            )
        if self.time is not None and np.shape(instance("time", self.time, np.ndarray)) != (
            len(self),
        ):
            raise ArgumentError(
                f"time has shape {self.time.shape}; give ({len(self)},), as the columns"
            )
        read("units", self.units, Mapping[str, str])
        read("first_line", self.first_line, int | None)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()))) if self.columns else 0

    @border
    def names_of(self, name: Name) -> list[str]:
        """Return the columns that ``name`` stands for; none where it stands for none."""
        names = list(self.columns)
        if isinstance(name, int):
            return names[name : name + 1] if name >= 0 else []
        if name in self.columns:
            return [name]
        if "*" in name or "?" in name:
            pattern = name.replace("[", "[[]")
            return [known for known in names if fnmatchcase(known, pattern)]
        return _numbered(name, names) or _at_the_end(name, names)

    @border
    def values(self, name: Name) -> np.ndarray | None:
        """Values (T, d) of the columns that ``name`` stands for; ``q[2]`` is the third of ``q``."""
        found = self.names_of(name)
        if found:
            return np.column_stack([self.columns[known] for known in found])
        part = re.fullmatch(r"(.+)\[(\d+)\]", str(name))
        whole = self.values(part[1]) if part else None
        if part and whole is not None and int(part[2]) < whole.shape[1]:
            return whole[:, int(part[2])][:, None]
        return None

    @border
    def rows(self, keep: object) -> "Series":
        """Only the given rows."""
        rows = array_of("keep", keep)
        masks = rows.dtype == bool and rows.shape == (len(self),)
        if not masks and (rows.dtype.kind not in "iu" or rows.ndim != 1):
            raise ArgumentError(
                f"keep is {shown(keep)}; give row numbers, or True and False for all"
            )
        if not masks and rows.size and not 0 <= rows.min() <= rows.max() < len(self):
            raise ArgumentError(f"keep is {shown(keep)}; give rows from 0 to {len(self) - 1}")
        time = None if self.time is None else self.time[rows]
        columns = {name: values[rows] for name, values in self.columns.items()}
        return Series(columns, time, self.units, None)


@dataclass(frozen=True, eq=False)
class Recording:
    """One demonstration as its file holds it.

    Parameters
    ----------
    source : str
        Of the file, for messages.
    series : tuple of Series
        One for every clock: the topics of a bag; one for a table.
    name : str
    format : str
    defaults : Columns
        What the format says of its columns.
    clock : bool
        Whether the stamps are those of a clock, so that time counts from the first sample.
    """

    source: str
    series: tuple[Series, ...]
    name: str = ""
    format: str = ""
    defaults: Columns = field(default_factory=Columns)
    clock: bool = False

    def __post_init__(self) -> None:
        checked(self)

    def names(self) -> Iterator[str]:
        """Yield the names of all columns."""
        for series in self.series:
            yield from series.columns

    @border
    def find(self, name: Name) -> tuple[Series, np.ndarray]:
        """Return the series that holds ``name``, and the values (T, d).

        Raises
        ------
        RecordingError
            There is no such column; the message names those that are there.
        """
        for series in self.series:
            values = series.values(name)
            if values is not None:
                return series, values
        raise RecordingError(f"{self.source}: there is no column {shown(name)}; {self.known(name)}")

    @border
    def has(self, name: Name) -> bool:
        """Whether there is such a column."""
        return any(series.values(name) is not None for series in self.series)

    @border
    def known(self, name: Name = "") -> str:
        """Say which columns there are, those like ``name`` first."""
        names = list(self.names())
        near = difflib.get_close_matches(str(name), names, n=3, cutoff=0.6)
        names = [*near, *(other for other in names if other not in near)]
        more = f" and {len(names) - 20} more" if len(names) > 20 else ""
        return f"there are {', '.join(names[:20])}{more}" if names else "there are none"


def by_length(columns: Mapping[str, np.ndarray]) -> tuple[Series, ...]:
    """Put columns of equal length together, the longest run of columns first."""
    lengths: dict[int, dict[str, np.ndarray]] = {}
    for name, values in columns.items():
        lengths.setdefault(len(values), {})[name] = values
    groups = sorted(lengths.values(), key=lambda group: ("time" not in group, -len(group)))
    return tuple(Series(group) for group in groups)


def split(recording: Recording, column: Name) -> list[Recording]:
    """Make one recording of the rows of every value of ``column``, in order of appearance."""
    holder, values = recording.find(column)
    labels = values[:, 0]
    if np.isnan(labels).any():
        row = int(np.flatnonzero(np.isnan(labels))[0])
        raise RecordingError(f"{recording.source}: {column} is not a number in row {row}")
    found, first = np.unique(labels, return_index=True)
    parts = []
    for label in found[np.argsort(first)]:
        series = tuple(s.rows(labels == label) if s is holder else s for s in recording.series)
        name = f"{recording.name}-{label:g}" if recording.name else f"{label:g}"
        parts.append(replace(recording, series=series, name=name))
    return parts


def _numbered(name: str, names: list[str]) -> list[str]:
    pattern = re.compile(re.escape(name) + r"[\[_./]?(\d+)\]?")
    found = [(int(match[1]), known) for known in names if (match := pattern.fullmatch(known))]
    return [known for _, known in sorted(found)]


def _at_the_end(name: str, names: list[str]) -> list[str]:
    found = [known for known in names if known.endswith((f"/{name}", f".{name}"))]
    return found if len(found) == 1 else []
