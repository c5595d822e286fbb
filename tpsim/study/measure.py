"""Measures: what is measured of the trials of a study, and the limit that it has to keep."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import Endless, border, checked
from tpsim.errors import ArgumentError
from tpsim.robot.views.view import View
from tpsim.study.metrics import push_interval
from tpsim.study.record import Record, Records

Series = float | np.ndarray
"""What is measured of one trial: a number, or a series (T,)."""

Figure = Endless | int | None
"""What came out of all trials; None where it could not be measured."""


@border
def rms(values: ArrayLike) -> float:
    """Root of the mean square, in the unit of ``values``."""
    if not np.size(values):
        raise ArgumentError("values is empty; give at least one number")
    return float(np.sqrt(np.mean(np.square(values))))


def mean(values: Sequence[float]) -> float:
    """Mean over trials."""
    return float(np.mean(values))


def most(values: Sequence[float]) -> float:
    """The number that 95 % of the trials keep: their 95th percentile."""
    return float(np.percentile(values, 95))


@dataclass(frozen=True)
class Measure:
    """One figure of a study.

    Of every trial that it concerns, ``of`` gives a series, ``reduce`` makes one number of it and
    ``across`` one figure of all trials; or ``whole`` measures all of them together. With neither,
    the figure comes from the study's probe of this name.

    Parameters
    ----------
    name : str
        Of the figure in results, such as ``"tilt_max_deg"``.
    of : View or callable, optional
        A view, of whose value the norm is taken along the trial and scaled to ``unit``; or a
        function ``of(record) -> (T,) or number`` in ``unit``, None where a trial has nothing to
        say.
    unit : str
        ``"mm"``, ``"deg"``, ``"N"``, ... as reports show it.
    whole : callable, optional
        ``whole(records) -> number`` in ``unit``, None where there is nothing to say.
    label : str or sequence of str, optional
        Conditions whose trials count; all by default. If the study has none of these, those of
        ``otherwise`` count.
    otherwise : str or sequence of str, optional
        Labels that count where there are none of ``label``.
    controller : str, optional
        Controllers whose trials count; ``None`` for all.
    reduce, across : callable
        Of the series of a trial, and of the numbers of all trials; the largest by default.
    window : (float, float) or "pushed", optional
        Part of the trial that counts [s]; ``"pushed"`` is while somebody pushes. Trials without
        a push then count as a whole.
    limit : float, optional
        The most allowed; with ``at_least`` the least asked.
    at_least : bool
        Whether ``limit`` is a floor.
    title : str
        What reports call it; the name by default.
    """

    name: str
    of: View | Callable[[Record], Series | None] | None = None
    unit: str = ""
    whole: Callable[[Records], Figure] | None = None
    label: str | Sequence[str] | None = None
    otherwise: str | Sequence[str] | None = None
    controller: str | None = "learned"
    reduce: Callable[[np.ndarray], float] = np.max
    across: Callable[[Sequence[float]], float] = max
    window: tuple[float, Endless] | Literal["pushed"] | None = None
    limit: float | None = None
    at_least: bool = False
    title: str = ""

    def __post_init__(self) -> None:
        checked(self)
        window = self.window
        if isinstance(window, tuple) and not window[0] < window[1]:
            raise ArgumentError(
                f"measure '{self.name}' has the window {window}; give (begin, end) in seconds"
            )

    @border
    def series(self, record: Record) -> Series | None:
        """What is measured of one trial, in ``unit``."""
        if self.of is None:
            return None
        if not isinstance(self.of, View):
            return self.of(record)
        value = np.linalg.norm(record.see(self.of), axis=-1)
        return value * self.of.scale(record.task.stage.robot, self.unit)

    @border
    def figure(self, records: Records) -> Figure:
        """The figure over all trials; None where there are none."""
        if self.whole is not None:
            return self.whole(records)
        numbers = self.numbers(records)
        return float(self.across(numbers)) if numbers else None

    @border
    def number(self, record: Record) -> float | None:
        """What one trial comes to, in ``unit``; None where it has nothing to say."""
        if self.name in record.numbers:
            return record.numbers[self.name]
        series = self.series(record)
        if series is None:
            return None
        if np.ndim(series) == 0:
            return float(series)
        series, time = np.asarray(series, float), record.trial.time
        if len(series) != len(time):
            raise ArgumentError(
                f"measure '{self.name}' gave {len(series)} values for {len(time)} samples"
            )
        window = self._window(record)
        if window is not None:
            series = series[(time >= window[0]) & (time <= window[1])]
            if not len(series) and record.trial.outcome != "diverged":
                raise ArgumentError(
                    f"measure '{self.name}' looks at {window} s; the trial ends at {time[-1]:.2f} s"
                )
        return float(self.reduce(series)) if len(series) else None

    def _window(self, record: Record) -> tuple[float, float] | None:
        return push_interval(record.trial) if self.window == "pushed" else self.window

    @border
    def numbers(self, records: Records) -> list[float]:
        """What every trial that counts comes to, in ``unit``."""
        chosen = records.select(self.label, self.controller)
        if not chosen and self.otherwise is not None:
            chosen = records.select(self.otherwise, self.controller)
        return [n for record in chosen if (n := self.number(record)) is not None]

    @border
    def result(self, value: Figure, *, asked: bool = True) -> "Result":
        """The figure with its limit, which says nothing where no trial was to be measured."""
        limit = self.limit if asked else None
        return Result(self.name, self.title or self.name, value, self.unit, limit, self.at_least)


def concerns(measure: Measure, label: str) -> bool:
    """Whether trials of a label may count for a measure."""
    asked = [measure.label, measure.otherwise] if measure.label is not None else [None]
    labels = [(one,) if isinstance(one, str) else one for one in asked]
    return measure.label is None or any(one is not None and label in one for one in labels)


@dataclass(frozen=True)
class Result:
    """One figure that came out, and whether it keeps its limit.

    Parameters
    ----------
    name, title : str
        In results and in reports.
    value : float, int or None
        None where it could not be measured.
    unit : str
    limit : float, optional
    at_least : bool
        Whether ``limit`` is a floor.
    """

    name: str
    title: str
    value: Figure
    unit: str = ""
    limit: float | None = None
    at_least: bool = False

    @property
    def passed(self) -> bool | None:
        """Whether the limit is kept; None without a limit."""
        if self.limit is None:
            return None
        if self.value is None or not np.isfinite(self.value):
            return False
        return bool(self.value >= self.limit if self.at_least else self.value <= self.limit)
