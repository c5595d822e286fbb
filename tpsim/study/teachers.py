"""The whole job of a study for many teachers: what holds for whom."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
from scipy.stats import binomtest

from tpsim.errors import SimulationError
from tpsim.study.files.checked import to_json
from tpsim.study.files.run import run_folder
from tpsim.study.lending import Lender
from tpsim.study.measure import Measure, Result
from tpsim.study.record import Records
from tpsim.study.recording import Answer, say
from tpsim.study.report import Section, write_report
from tpsim.study.running import run
from tpsim.study.study import Lab, Plan, Study
from tpsim.study.summary import plain
from tpsim.whole import write_text


def run_teachers(
    study: Study,
    plan: Plan,
    teachers: int,
    folder: Path | None = None,
    *,
    workers: int = 1,
    command: str = "",
) -> Answer:
    """Teach, learn and perform afresh for many teachers, and say for how many a claim holds.

    Teacher k is the seed ``plan.seed + k``: other demonstrations, situations and pushes. Each
    leaves a run folder of its own, as ``tpsim run --seed`` would.

    Parameters
    ----------
    study : Study
    plan : Plan
        Trials of every teacher.
    teachers : int
    folder : Path, optional
        A new or empty folder; a new one in ``recordings/runs`` by default.
    workers : int
        Processes; their number changes no result.
    command : str
        What was typed.

    Returns
    -------
    dict
        As :func:`tpsim.study.running.run`, of the trials of all teachers together; with
        ``kept``: for every measure of single trials that has a limit the share of trials that
        keep it, its 95 % Wilson interval, and the worst teacher; and with ``failed``: the seeds of
        teachers who could not show the task, or whose robot could not perform it, and why.

    Raises
    ------
    SimulationError
        If all of them failed.
    """
    folder = run_folder(study.task.name, plan.seed) if folder is None else folder
    numbers: dict[str, list[list[float]]] = {}
    wholes: dict[str, list[Result]] = {}
    lost: list[dict[str, object]] = []
    failed: list[dict[str, object]] = []
    counts = {"trials": 0, "situations": 0, "refused_demonstrations": 0}

    def look(lab: Lab, records: Records, results: Sequence[Result]) -> None:
        for measure in lab.study.all_measures:
            if measure.of is not None:
                numbers.setdefault(measure.name, []).append(measure.numbers(records))
        for result in results:
            wholes.setdefault(result.name, []).append(result)

    seeds = []
    with Lender(workers) as lender:
        for seed in range(plan.seed, plan.seed + teachers):
            say(f"teacher {seed - plan.seed + 1} of {teachers}: seed {seed}")
            try:
                answer = run(
                    study,
                    replace(plan, seed=seed),
                    folder / f"teacher-{seed}",
                    workers=workers,
                    video=False,
                    command=command,
                    look=look,
                    executor=lender,
                )
            except SimulationError as error:
                say(f"the teacher of seed {seed} is left out: {error}")
                failed.append({"seed": seed, "why": str(error)})
                if len(failed) == teachers:
                    raise
                continue
            seeds.append(seed)
            counts["trials"] += int(str(answer["trials"]))
            lost += [{"seed": seed, **row} for row in cast(list[dict], answer["lost"])]
            counts["situations"] += plan.situations
            counts["refused_demonstrations"] += int(str(answer.get("refused_demonstrations", 0)))
    measures = {m.name: m for m in study.all_measures}
    figures = {
        name: _together(measures.get(name), numbers.get(name), results)
        for name, results in wholes.items()
    }
    rows = [
        _kept(measures[name], found, seeds)
        for name, found in numbers.items()
        if measures[name].limit is not None
    ]
    results = [replace(found[-1], value=figures[name]) for name, found in wholes.items()]
    report = write_report(
        folder / "report.html",
        title=f"{study.title or study.task.name}: {teachers} teachers",
        lead=study.lead,
        command=command,
        figures=results,
        sections=[
            Section("For how many it holds", _TEXT, table=rows),
            _each(wholes, seeds, failed),
        ],
        film=None,
        no_film="Films are made of single runs.",
        about={"teachers": teachers, "seeds": f"{plan.seed} to {plan.seed + teachers - 1}"},
    )
    found = {
        "task": study.task.name,
        "seed": plan.seed,
        "teachers": teachers,
        **counts,
        "figures": figures,
        "kept": {str(row["measure"]): row for row in rows},
        "missed": [
            *(result.title for result in results if result.passed is False),
            *(f"the teacher of seed {one['seed']} failed" for one in failed),
        ],
        "lost": lost,
        "failed": failed,
        "paths": {"run": str(folder), "report": str(report)},
    }
    write_text(folder / "teachers.json", to_json(plain(found), indent=1))
    return found


_TEXT = (
    "Share of all trials of all teachers that keep the limit of a measure, with its 95 % interval "
    "(Wilson), and the teacher for whom the figure is worst. Trials of one teacher share what was "
    "learned, so that the interval is one of these teachers' trials, not of other teachers."
)


def _together(
    measure: Measure | None, found: list[list[float]] | None, results: Sequence[Result]
) -> float | int | None:
    """One figure of all teachers: across all trials, or the worst of what each teacher came to."""
    if measure is not None and found:
        every = [number for numbers in found for number in numbers]
        return float(measure.across(every)) if every else None
    values = [result.value for result in results if result.value is not None]
    if not values:
        return None
    if all(isinstance(value, int) for value in values):
        return int(sum(values))
    return min(values) if results[0].at_least else max(values)


def _kept(measure: Measure, found: list[list[float]], seeds: Sequence[int]) -> dict[str, object]:
    assert measure.limit is not None
    values = np.array([number for numbers in found for number in numbers])
    own = [float(measure.across(numbers)) if numbers else np.nan for numbers in found]
    limit, floor = measure.limit, measure.at_least
    kept = int((values >= limit).sum() if floor else (values <= limit).sum())
    row: dict[str, object] = {"measure": measure.name, "limit": limit, "trials": len(values)}
    if len(values):
        interval = binomtest(kept, len(values)).proportion_ci(method="wilson")
        worst = int(np.nanargmin(own) if floor else np.nanargmax(own))
        row["kept"] = f"{100 * kept / len(values):.1f} %"
        row["interval"] = f"{100 * interval.low:.1f} to {100 * interval.high:.1f} %"
        row["worst teacher"] = f"{own[worst]:.3g} (seed {seeds[worst]})"
    return row


def _each(
    wholes: Mapping[str, list[Result]],
    seeds: Sequence[int],
    failed: Sequence[Mapping[str, object]],
) -> Section:
    """Every figure of every teacher, and which ones failed."""
    rows = [
        {"seed": seed}
        | {
            name: "" if (value := found[k].value) is None else f"{value:.3g}"
            for name, found in wholes.items()
            if found[k].limit is not None
        }
        for k, seed in enumerate(seeds)
    ]
    left_out = "".join(
        f" The teacher of seed {one['seed']} failed: {one['why']}." for one in failed
    )
    text = f"The figures of each teacher's own run.{left_out}"
    return Section("Every teacher", text, table=rows)
