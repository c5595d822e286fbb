"""Columns of a recording by what they mean, all on the clock of the movement."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from tpsim.data import orientation
from tpsim.data.clock import stamps
from tpsim.data.columns import Columns, Name, Names, listed
from tpsim.data.recording import Recording, Series
from tpsim.data.rows import refuse, usable
from tpsim.data.units import ANGLE, LENGTH
from tpsim.errors import RecordingError

Kind = Literal["length", "angle", "number"]


@dataclass(frozen=True, eq=False)
class Table:
    """A recording seen on the clock of the series that holds the movement, with its stamps [s]."""

    recording: Recording
    columns: Columns
    series: Series
    time: np.ndarray

    @classmethod
    def of(cls, recording: Recording, columns: Columns) -> "Table":
        """Choose the series of the movement, and cut it to where all of the movement is known."""
        parts = (columns.position, columns.orientation, columns.joints, columns.other)
        holders = [recording.find(name)[0] for names in parts for name in listed(names)]
        if not holders:
            raise RecordingError(
                f"{recording.source}: no columns are named for the movement; {recording.known()}"
            )
        series = holders[0]
        others = [other.time for other in holders if other is not series and other.time is not None]
        if others and series.time is not None:
            inside = np.all(
                [(time.min() <= series.time) & (series.time <= time.max()) for time in others],
                axis=0,
            )
            series = series.rows(inside)
        if not len(series):
            raise RecordingError(f"{recording.source}: the movement's columns share no time")
        return cls(recording, columns, series, stamps(recording, series, columns))

    def values(self, names: Names | None, kind: Kind = "number") -> np.ndarray:
        """Values (T, n) of columns, in SI units: [m] of a length, [rad] of an angle."""
        parts = [np.empty((len(self.time), 0))]
        for name in listed(names):
            series, values = self._find(name)
            values = np.asarray(values * self._factor(series, name, kind), float)
            parts.append(self._on_clock(series, values, name))
        return np.hstack(parts)

    def turn(self, names: Names | None, order: str) -> np.ndarray:
        """Quaternions (T, 4), w first; (T, 0) where no columns are named."""
        found = [self._find(name) for name in listed(names)]
        if not found:
            return np.empty((len(self.time), 0))
        series, first = found[0][0], listed(names)[0]
        if any(other is not series for other, _ in found):
            raise RecordingError(f"{self.recording.source}: {names} are on different clocks")
        values = np.hstack([part for _, part in found])
        if values.shape[1] != orientation.width(order):
            raise RecordingError(
                f"{self.recording.source}: {names} are {values.shape[1]} columns; the order "
                f"{order!r} asks for {orientation.width(order)}"
            )
        result = orientation.quaternions(
            np.asarray(values, float), order, self._factor(series, first, "angle")
        )
        if self.columns.bad_rows == "refuse":
            lost = np.isnan(result).any(1) & usable(values)
            refuse(self.recording, series, f"the quaternion {first} has length zero", lost)
        return self._on_clock(series, result, first, turn=True)

    def _find(self, name: Name) -> tuple[Series, np.ndarray]:
        values = self.series.values(name)
        return self.recording.find(name) if values is None else (self.series, values)

    def _factor(self, series: Series, name: Name, kind: Kind) -> float:
        """Factor to SI: the description's unit, else the heading's."""
        described = {"length": self.columns.length_unit, "angle": self.columns.angle_unit}
        found = series.names_of(name)
        unit = described.get(kind) or (series.units.get(found[0]) if found else None)
        return {**LENGTH, **ANGLE}.get(unit or "", 1.0)

    def _on_clock(
        self, series: Series, values: np.ndarray, name: Name, *, turn: bool = False
    ) -> np.ndarray:
        """Values at the movement's stamps; before and after its own, another series is held."""
        if series is self.series:
            return values
        if len(values) == 1:
            return np.repeat(values, len(self.time), axis=0)
        if series.time is None or self.series.time is None:
            raise RecordingError(
                f"{self.recording.source}: {name} has {len(values)} rows and the movement "
                f"{len(self.time)}; columns that belong together must be equally long"
            )
        good = usable(values) & np.isfinite(series.time)
        time, first = np.unique(series.time[good], return_index=True)
        values = values[good][first]
        if not len(time):
            return np.full((len(self.time), values.shape[1]), np.nan)
        if turn:
            return orientation.interpolated(time, values, self.series.time)
        return np.column_stack([np.interp(self.series.time, time, column) for column in values.T])
