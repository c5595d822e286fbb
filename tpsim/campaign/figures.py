"""What is kept of a trial as figures: what the study measures, and what a push did."""

import hashlib
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tpsim.campaign.design import Asked
from tpsim.campaign.table import FAILED, Row
from tpsim.errors import one_line
from tpsim.robot.views.view import View
from tpsim.study.condition import Condition
from tpsim.study.measure import Measure, concerns
from tpsim.study.metrics import displacement, interval, mean_force, work
from tpsim.study.record import Record, Records
from tpsim.study.study import Study
from tpsim.task.task import Models
from tpsim.world.trial import Trial

UNPUSHED = "unpushed"
"""Label of undisturbed trials."""

WRENCHES = ("push_wrench", "lead_wrench")
"""Signals of who disturbs a trial."""

BAND = 0.1
"""A push is recovered from when the way that it leaves stays within this share of its peak."""

DISTURBED = {
    "displacement_max_mm": "Farthest that the pushed or led site is from where it is in the twin",
    "displacement_end_mm": "How far it is along the force, at the end of the push or lead",
    "recovery_s": "Time after the end until it stays within 10 % of the peak of where it ends",
    "work_J": "Work of the person on the robot",
    "force_mean_N": "Mean force of the person while it acts",
    "torque_rms_Nm": "Root of the mean square of all joint torques, beyond those of the twin",
}
"""Figures of every disturbed trial, whatever its study measures."""


def asked_row(asked: Asked, condition: Condition | None) -> Row:
    """What a row says of what was asked for."""
    row: Row = {
        "trial": asked.trial,
        "point": asked.point,
        "lesson": asked.lesson.number,
        "teacher": asked.lesson.teacher,
        "situation": asked.situation,
        "controller": asked.controller,
        "plant": asked.plant,
        **{f"task.{name}": _cell(value) for name, value in asked.lesson.fields.items()},
        **{f"task.{name}": _cell(value) for name, value in asked.fields.items()},
    }
    for push in () if condition is None else condition.push:
        row |= {"body": push.body, "onset_s": push.start, "duration_s": push.duration}
        row |= _vector("force", "N", push.force)
    for lead in () if condition is None else condition.lead:
        row |= {"body": lead.site, "onset_s": lead.start, "duration_s": lead.duration}
        row |= _vector("travel", "mm", tuple(1e3 * x for x in lead.travel))
    return row


def failed_row(row: Row, reason: object) -> Row:
    """The row of a trial that could not be performed."""
    return row | {"outcome": FAILED, "success": False, "reason": one_line(reason, 300)}


def figures_row(
    row: Row,
    study: Study,
    models: Models,
    condition: Condition,
    trial: Trial,
    beside: Record,
    success: tuple[str, ...],
) -> Row:
    """Row of a trial that was performed, beside the record of its undisturbed twin."""
    records, twin = Records(study.task, models), beside.trial
    records.include(beside)
    record = records.add(condition, trial) if condition.people else beside
    row = row | {
        "outcome": trial.outcome,
        "twin_outcome": twin.outcome,
        "reason": trial.touched or None,
        "simulated_s": float(trial.time[-1] + _period(trial)),
        "digest": digest(trial),
    }
    kept = trial.outcome not in ("diverged", "contact")
    as_if = _as_if_pushed(beside, trial) if condition.people else beside
    for measure in measures_of(study, condition.label):
        number = _number(measure, record)
        row[measure.name] = _finite(number)
        kept &= _keeps(measure, number, success)
        if condition.people:
            row[f"twin_{measure.name}"] = _finite(_in_twin(measure, trial, beside, as_if))
    row["saturated_steps"] = float(trial["saturated_steps"][-1])
    row["success"] = bool(kept)
    if condition.people:
        row |= dict(_disturbed(condition, study, trial, twin))
    return row


def measures_of(study: Study, label: str) -> Iterator[Measure]:
    """Measures that look at single trials of a label, whoever performs them."""
    for measure in study.all_measures:
        everybodys = measure.controller in (None, "learned")
        if measure.of is not None and everybodys and concerns(measure, label):
            yield measure


def digest(trial: Trial) -> str:
    """SHA-256 of how a trial ended and of all its signals."""
    found = hashlib.sha256(trial.outcome.encode())
    for name, array in sorted(trial.arrays.items()):
        array = np.ascontiguousarray(array)
        found.update(f"{name} {array.dtype.str} {array.shape}".encode())
        found.update(array.data)
    return found.hexdigest()


def _period(trial: Trial) -> float:
    return float(trial.time[1] - trial.time[0]) if len(trial.time) > 1 else 0.0


def _number(measure: Measure, record: Record) -> float | None:
    """What a trial comes to, infinite where it never comes; None where there is nothing to say."""
    try:
        number = measure.number(record)
    except Exception:
        if record.trial.outcome == "diverged":  # it may have ended before what is looked at
            return None
        raise
    return None if number is None else float(number)


def _finite(number: float | None) -> float | None:
    return None if number is None or not np.isfinite(number) else number


def _keeps(measure: Measure, number: float | None, success: tuple[str, ...]) -> bool:
    if measure.limit is None or (measure.name not in success if success else measure.at_least):
        return True
    if number is None:  # a push that misses what is measured, a trial that ends before it
        return True
    return number >= measure.limit if measure.at_least else number <= measure.limit


def _in_twin(measure: Measure, trial: Trial, twin: Record, as_if: Record) -> float | None:
    """The same measure of the twin, in the same part of the trial.

    ``as_if`` is the twin with the push in its signals.
    """
    if measure.window == "pushed":
        measure = replace(measure, window=_acting(trial))
    elif measure.window is None and not isinstance(measure.of, View):
        twin = as_if
    return _number(measure, twin)


def _as_if_pushed(twin: Record, trial: Trial) -> Record:
    """The twin with the push or lead of another trial in its signals: measures look when it was."""
    arrays, length = dict(twin.trial.arrays), len(twin.trial.time)
    for name in WRENCHES:
        if name in trial.arrays:
            wrench = trial[name][:length]
            arrays[name] = np.concatenate((wrench, np.zeros((length - len(wrench), 6))))
    return replace(twin, trial=replace(twin.trial, arrays=arrays))


def _acting(trial: Trial) -> tuple[float, float] | None:
    for name in WRENCHES:
        if name in trial.arrays and (span := interval(trial[name], trial.time)) is not None:
            return span
    return None


def _disturbed(
    condition: Condition, study: Study, trial: Trial, twin: Trial
) -> Iterator[tuple[str, float | None]]:
    """What the push or lead of a trial did; nothing where its site is not recorded."""
    person = "push" if condition.push else "lead"
    body = condition.push[0].body if condition.push else condition.lead[0].site
    names = {site: name for name, site in study.task.sites().items()}
    wrench, span = trial[f"{person}_wrench"], _acting(trial)
    length = min(len(trial.time), len(twin.time))
    yield "force_mean_N", mean_force(wrench)
    yield "work_J", work(wrench, trial[f"{person}_point"])
    yield "torque_rms_Nm", _rms(trial["torque"][:length] - twin["torque"][:length])
    if body not in names or span is None:
        return
    signal = f"{names[body]}_position"
    way = displacement(trial, twin, signal)
    last = min(int(np.searchsorted(trial.time, span[1])), length - 1)
    yield "displacement_max_mm", float(1e3 * way.max())
    force = wrench[:, :3].sum(axis=0)
    moved = (trial[signal][:length] - twin[signal][:length])[last]
    yield "displacement_end_mm", float(1e3 * moved @ force / max(np.linalg.norm(force), 1e-12))
    yield "recovery_s", _recovery(trial.time[:length], way, last)
    stiffness = twin.arrays.get(f"{names[body]}_stiffness")
    if stiffness is not None:
        begin = min(int(np.searchsorted(twin.time, span[0])), len(twin.time) - 1)
        for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
            yield f"stiffness_{'xyz'[i]}{'xyz'[j]}_N_m", float(stiffness[begin, i, j])


def _recovery(time: np.ndarray, way: np.ndarray, last: int) -> float | None:
    """Time after sample ``last`` until ``way`` (T,) stays near its end; None if it ends there."""
    after = way[last:]
    if len(after) < 2:
        return None
    away = np.flatnonzero(np.abs(after - after[-1]) > BAND * way.max())
    return float(time[last + (away[-1] + 1 if len(away) else 0)] - time[last])


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _vector(name: str, unit: str, value: tuple[float, ...]) -> Row:
    parts = {f"{name}_{axis}_{unit}": part for axis, part in zip("xyz", value, strict=True)}
    return {f"{name}_{unit}": float(np.linalg.norm(value)), **parts}


def _cell(value: object) -> object:
    """A field's value as a number or a text."""
    return value if isinstance(value, bool | int | float | str) else str(value)
