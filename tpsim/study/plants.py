"""The plant unlike the model: the same trials on other plants, beside the nominal twin."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.study import series
from tpsim.study.condition import Condition
from tpsim.study.measure import Measure
from tpsim.study.record import Record, Records
from tpsim.study.report import Section
from tpsim.study.study import ConditionsOf, Lab, Phases, Plan, Study
from tpsim.world.plant import PLANTS, Plant

_TEXT = (
    "The same trials where the simulated robot differs from the controller's model. Each is beside "
    "its nominal twin, of the same situation and push."
)


def chosen(names: Sequence[str]) -> dict[str, Plant]:
    """Plants by their names in :data:`~tpsim.world.plant.PLANTS`; ``("all",)`` for every one.

    Raises
    ------
    ArgumentError
        If there is no plant of a name.
    """
    if tuple(names) == ("all",):
        return dict(PLANTS)
    for name in names:
        if name not in PLANTS:
            raise ArgumentError(
                f"there is no plant '{name}'; there are {', '.join(PLANTS)}, or all of them: all"
            )
    return {name: PLANTS[name] for name in names}


def label(name: str) -> str:
    """Label of the conditions on a plant."""
    return f"plant: {name}"


def on_plants(
    conditions: Sequence[Condition], plants: Mapping[str, Plant] = PLANTS
) -> Iterator[Condition]:
    """The conditions on every plant, labelled by it.

    Parameters
    ----------
    conditions : sequence of Condition
        Nominal ones, such as the pushed ones.
    plants : mapping of str to Plant
    """
    for name, plant in plants.items():
        for condition in conditions:
            yield replace(condition, label=label(name), plant=plant)


def with_plants(
    study: Study,
    plants: Mapping[str, Plant] = PLANTS,
    of: str = "pushed",
    controllers: Sequence[str] | None = None,
) -> Study:
    """The same study with one more phase: the trials of a label on every plant.

    Its report has a table of the measures by plant.

    Parameters
    ----------
    study : Study
    plants : mapping of str to Plant
    of : str
        Label of the nominal trials that are performed on the plants, too.
    controllers : sequence of str, optional
        Whose trials these are; by default those of what was learned.
    """
    asked = study.conditions

    def conditions(lab: Lab, plan: Plan) -> Phases:
        phases, records = asked(lab, plan), None
        found = next(phases, [])
        while True:
            records = yield found
            try:
                found = phases.send(records)
            except StopIteration:
                break
        names = _learned(records) if controllers is None else controllers
        chosen = [r.condition for name in names for r in records.select(of, name)]
        if not chosen:
            raise ArgumentError(
                f"the study has no trials '{of}' of {', '.join(names)} to perform on other plants; "
                "it has " + ", ".join(dict.fromkeys(r.condition.label for r in records))
            )
        yield list(on_plants(chosen, plants))

    def sections(records: Records) -> list[Section]:
        shown = series.of_study(study, records)
        return [*shown, section(records, study.all_measures, plants, of)]

    extended: ConditionsOf = conditions
    return replace(study, conditions=extended, sections=sections)


def section(
    records: Records,
    measures: Sequence[Measure],
    plants: Mapping[str, Plant] = PLANTS,
    of: str = "pushed",
) -> Section:
    """Table of the measures of one label on every plant."""
    return Section("The plant unlike the model", _TEXT, table=table(records, measures, plants, of))


def table(
    records: Records,
    measures: Sequence[Measure],
    plants: Mapping[str, Plant] = PLANTS,
    of: str = "pushed",
) -> list[dict[str, object]]:
    """A row for the nominal plant and for each other: figures, and what went wrong.

    Parameters
    ----------
    records : Records
    measures : sequence of Measure
        Those that count in trials of the label ``of``; the others are left out.
    plants : mapping of str to Plant
    of : str
    """
    counted = [m for m in measures if m.of is not None and _counts(m, of)]
    rows = []
    for name, group in {"nominal": of, **{name: label(name) for name in plants}}.items():
        found = [r for one in _learned(records) for r in records.select(group, one)]
        row: dict[str, object] = {"plant": name, "trials": len(found)}
        for measure in counted:
            value = replace(measure, label=group, otherwise=None).figure(records)
            row[_heading(measure)] = "–" if value is None else value
        row["diverged"] = sum(r.trial.outcome == "diverged" for r in found)
        row["saturated steps"] = int(sum(_last(r) for r in found))
        rows.append(row)
    return rows


def _counts(measure: Measure, of: str) -> bool:
    labels = (measure.label,) if isinstance(measure.label, str) else measure.label
    return measure.controller in (None, "learned") and (labels is None or of in labels)


def _learned(records: Records) -> tuple[str, ...]:
    """Controllers of what was learned: of all behaviours, or of each that is performed apart."""
    return ("learned", *records.task.behaviours())


def _heading(measure: Measure) -> str:
    title = measure.title or measure.name
    return f"{title} [{measure.unit}]" if measure.unit else title


def _last(record: Record) -> int:
    return int(np.asarray(record["saturated_steps"])[-1])
