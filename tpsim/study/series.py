"""What a report shows of a study that draws nothing itself: every measure over time."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from tpsim.study import plot
from tpsim.study.measure import Measure
from tpsim.study.record import Record, Records
from tpsim.study.report import Picture, Section
from tpsim.study.study import Study

COLUMNS = 4
"""Panels beside each other, at most."""

_TEXT = "Over time, by condition and controller. Thin lines are trials, the thick one their median."
_BESIDE = "The same measures under every controller, in the same situations."


def sections(records: Records, measures: Sequence[Measure]) -> list[Section]:
    """Controllers beside each other, and a section for each series that is measured.

    Measures of the same series share their section, such as its largest value and its rms.
    """
    of_trials = [measure for measure in measures if measure.of is not None]
    shown: list[Measure] = []
    for measure in of_trials:
        if not any(m.of is measure.of and m.label == measure.label for m in shown):
            shown.append(measure)
    found = [_beside(records, of_trials), *(_section(records, measure) for measure in shown)]
    return [section for section in found if section is not None]


def of_study(study: Study, records: Records) -> list[Section]:
    """What a study shows itself, or all its measures."""
    if study.sections is None:
        return sections(records, study.all_measures)
    return study.sections(records)


def _controllers(records: Sequence[Record]) -> list[str]:
    performed = (r.condition.controller for r in records if r.condition.shown is None)
    return list(dict.fromkeys(performed))


def _beside(records: Records, measures: Sequence[Measure]) -> Section | None:
    """Table of the figures by controller; measures that name another controller are one."""
    alike = [measure for measure in measures if measure.controller == "learned"]
    names = _controllers(records)
    if len(names) < 2 or not alike:
        return None
    rows: list[dict[str, object]] = []
    for name in names:
        row: dict[str, object] = {"controller": name}
        for measure in alike:
            value = replace(measure, controller=name).figure(records)
            row[_axis(measure, measure.title)] = "–" if value is None else value
        rows.append(row)
    return Section("Controllers beside each other", _BESIDE, table=rows)


def _section(records: Records, measure: Measure) -> Section | None:
    chosen = records.select(measure.label, None)
    if not chosen and measure.otherwise is not None:
        chosen = records.select(measure.otherwise, None)
    curves = [record for record in chosen if np.ndim(_series(measure, record)) == 1]
    if not curves:
        return None
    # A limit on a mean or an rms is none on the curve.
    limit = measure.limit if measure.reduce in (np.max, np.min, max, min) else None
    pictures = [
        Picture(plot.panels(row, lambda r: _series(measure, r), label=_axis(measure), limit=limit))
        for row in _rows(curves)
    ]
    return Section(measure.title or measure.name, _TEXT, pictures)


def _series(measure: Measure, record: Record) -> np.ndarray:
    """The series of a record; what has none is a scalar."""
    series = measure.series(record)
    return np.array(np.nan if series is None else series)


def _axis(measure: Measure, title: str = "") -> str:
    return (title or measure.name) + (f" [{measure.unit}]" if measure.unit else "")


def _rows(records: Sequence[Record]) -> Iterator[Mapping[str, Sequence[Record]]]:
    """Panels in rows: all labels of one controller, or all controllers of one label each."""
    labels = list(dict.fromkeys(record.condition.label for record in records))
    if len(_controllers(records)) < 2:
        rows = [{label: [r for r in records if r.condition.label == label] for label in labels}]
    else:
        rows = [_by_controller(label, records) for label in labels]
    for row in rows:
        names = list(row)
        for start in range(0, len(names), COLUMNS):
            yield {name: row[name] for name in names[start : start + COLUMNS]}


def _by_controller(label: str, records: Sequence[Record]) -> dict[str, list[Record]]:
    found: dict[str, list[Record]] = {}
    for record in records:
        if record.condition.label == label:
            found.setdefault(f"{label}, {record.condition.controller}", []).append(record)
    return found
