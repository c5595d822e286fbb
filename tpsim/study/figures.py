"""The figures of a study: its measures of the trials, its probes, and its speed."""

import time
from collections.abc import Callable

from tpsim.errors import ArgumentError, SimulationError
from tpsim.robot.views.view import View
from tpsim.study.executor import perform_condition
from tpsim.study.measure import Figure, Measure, Result, concerns
from tpsim.study.record import Records
from tpsim.study.recording import say
from tpsim.study.study import Lab, Study
from tpsim.task.check import check as check_task
from tpsim.task.check import look
from tpsim.world.rollout import RECORD_PERIOD

SPEED = "realtime_factor"
"""Simulated over processor time of a trial: every run has this figure."""


def check(study: Study) -> None:
    """Refuse a study that does not fit its world, or does not say how its figures are measured.

    Raises
    ------
    SimulationError
        If a view asks for a site, a joint or an object that is not there.
    ArgumentError
        If a measure has neither ``of`` nor ``whole`` and there is no probe of its name, or two
        have one name.
    """
    check_task(study.task)
    names = [measure.name for measure in study.all_measures]
    for name in names:
        if names.count(name) > 1:
            raise ArgumentError(f"two measures are called '{name}'; give each its own name")
    for measure in study.all_measures:
        if not (_of_trials(measure) or measure.name == SPEED or measure.name in study.probes):
            raise ArgumentError(
                f"measure '{measure.name}' has neither of nor whole, and the study has no probe "
                "of this name; give one of them"
            )
        if isinstance(measure.of, View):
            look(study.task, f"measure '{measure.name}'", measure.of)
            measure.of.scale(study.task.stage.robot, measure.unit)


def of_trials(study: Study, records: Records) -> dict[str, Figure]:
    """Figures that follow from the trials alone, by name."""
    return {m.name: m.figure(records) for m in study.all_measures if _of_trials(m)}


def results(lab: Lab, records: Records) -> list[Result]:
    """All figures with their limits: those of measures in their order, then other probes."""
    study = lab.study
    figures = of_trials(study, records)
    figures |= {name: _probed(name, probe, lab) for name, probe in study.probes.items()}
    figures[SPEED] = _speed(lab, records)
    measures = {measure.name: measure for measure in study.all_measures}
    plain = {SPEED: Measure(SPEED, unit="x", title="Faster than real time, one core")}
    others = [plain.get(name) or Measure(name) for name in figures if name not in measures]
    labels = {record.condition.label for record in records}
    found = []
    for measure in (*study.all_measures, *others):
        number = figures[measure.name]
        asked = number is not None or any(concerns(measure, label) for label in labels)
        found.append(measure.result(number, asked=asked))
    return found


def _probed(name: str, probe: Callable[[Lab], float], lab: Lab) -> float | None:
    """What a probe measures; None where the robot does not do what it needs, and why is said."""
    try:
        return probe(lab)
    except SimulationError as error:
        # The trials are all there: one experiment that fails is no reason to lose the report.
        say(f"{name} is not measured: {error}")
        return None


def _of_trials(measure: Measure) -> bool:
    return measure.of is not None or measure.whole is not None


def _speed(lab: Lab, records: Records) -> float | None:
    """Simulated over processor time of one performance: the best of four."""
    conditions = (record.condition for record in records)
    condition = next((c for c in conditions if c.shown is None), None)
    if condition is None:
        return None
    spent = []
    for _ in range(4):
        began = time.process_time()
        trial = perform_condition(lab.study, lab.models, condition)
        spent.append(time.process_time() - began)
    return RECORD_PERIOD * len(trial.time) / min(spent)
