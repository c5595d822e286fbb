"""The verb run: the whole job of a study, from teaching to its report."""

import inspect
import sys
import time
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path

from tqdm import tqdm  # type: ignore[import-untyped]

from tpsim.border import Count, border
from tpsim.errors import RenderingError
from tpsim.film import rendering
from tpsim.film.video import film as write_film
from tpsim.study import clips, figures, fronts, learned, series, teaching
from tpsim.study.embedded import embedded
from tpsim.study.files.run import DEMONSTRATIONS, Run
from tpsim.study.lending import Lender
from tpsim.study.measure import Result
from tpsim.study.record import Records
from tpsim.study.recording import Answer, kept_or_removed, open_folder, record_all, say
from tpsim.study.report import Section, write_report
from tpsim.study.study import Lab, Phases, Plan, Study
from tpsim.study.teaching_files import write_demonstrations
from tpsim.study.workers import Executors
from tpsim.task.verbs import learn
from tpsim.world.threads import one_thread

Look = Callable[[Lab, Records, list[Result]], None]

_LOST = "They ended their worker process twice; no figure counts them."


@one_thread()
@border
def run(
    study: Study,
    plan: Plan = Plan(),  # noqa: B008 - a frozen value
    folder: str | Path | None = None,
    *,
    workers: Count = 1,
    video: bool = True,
    progress: bool = False,
    command: str = "",
    look: Look | None = None,
    executor: Executors | None = None,
) -> Answer:
    """The whole job of a study: teach, learn, perform every condition, film and report.

    Parameters
    ----------
    study : Study
    plan : Plan
        Seed, and how many trials.
    folder : Path, optional
        A new or empty folder; a new one in ``recordings/runs`` by default.
    workers : int
        Processes; their number changes no result.
    video : bool
        Whether to film.
    progress : bool
        Whether to draw a bar on standard error.
    command : str
        What was typed, for people who read the folder and the report.
    look : callable, optional
        ``look(lab, records, results)`` is shown what came out.
    executor : callable, optional
        Makes an executor of so many workers; by default processes of this run, which serve
        teaching and performing.

    Returns
    -------
    dict
        ``task``, ``seed``, ``trials``, ``figures`` by name, ``missed`` (titles of the measures
        whose limit is not kept), ``refused_demonstrations``, ``refusals`` (how many, by reason),
        ``lost`` (trials that ended their worker twice, with the reason), ``wall_seconds``,
        ``paths`` to ``run``, ``report``, ``film``.
    """
    began, task = time.monotonic(), study.task
    figures.check(study)
    command = command or f"tpsim.lab.run(study, {plan!r})  # {task!r}"
    settings = {"plan": asdict(plan), "demonstrations": task.demonstrations}
    where = None if folder is None else Path(folder)
    opened = open_folder(study, command, settings, plan.seed, where)
    with kept_or_removed(opened.folder), Lender(workers) as lender:
        executor = executor or lender
        shown = teaching.taught_all(study, task.demonstrations, plan.seed, workers, executor)
        taught = {behaviour: found.trials for behaviour, found in shown.items()}
        for behaviour, trials in taught.items():
            place = opened.folder / DEMONSTRATIONS / behaviour
            write_demonstrations(place, study, behaviour, trials, seed=plan.seed, command=command)
        models = learn(task, taught)
        opened.save_models(models)
        lab = Lab(study, models, taught)
        records = _experiment(opened, lab, plan, workers, executor, progress)
        lender.end()
        say("measuring")
        results = figures.results(lab, records)
        if look is not None:
            look(lab, records, results)
        film, hint = _film(opened, lab, records) if video else (None, "No film was asked for.")
        # A folder in which a trial is missing is not whole.
        opened = opened if records.lost else opened.finish()
        report = _report(opened, lab, records, results, film, hint, teaching.section(shown))
        return {
            "task": task.name,
            "seed": plan.seed,
            "trials": len(records),
            **teaching.refused(shown),
            # What the study measures itself has its name first: a contest looks at fewer trials.
            "figures": _compared(study, records)
            | {result.name: result.value for result in results},
            "missed": [result.title for result in results if result.passed is False],
            "lost": [lost.row() for lost in records.lost],
            "wall_seconds": round(time.monotonic() - began, 1),
            "paths": {
                "run": str(opened.folder),
                "report": str(report),
                "film": None if film is None else str(film),
            },
        }


def _experiment(
    run: Run, lab: Lab, plan: Plan, workers: int, executor: Executors, progress: bool
) -> Records:
    records, phases = Records(lab.task, lab.models), _phases(lab, plan)
    conditions = next(phases, [])
    while True:
        labels = ", ".join(dict.fromkeys(c.label for c in conditions))
        say(f"{len(conditions)} trials: {labels}")
        bar = tqdm(total=len(conditions), file=sys.stderr) if progress else None
        with bar or nullcontext():
            tick = bar and bar.update
            record_all(run, lab.study, records, conditions, workers, tick, executor)
        try:
            conditions = phases.send(records)
        except StopIteration:
            return records


def _phases(lab: Lab, plan: Plan) -> Phases:
    """Conditions of the study, then of its contest."""
    yield from lab.study.conditions(lab, plan)
    contest = lab.study.contest
    if contest is not None and contest.apart:
        yield from contest.conditions(lab, plan)


def _compared(study: Study, records: Records) -> dict[str, object]:
    """Figures of all controllers, where the study compares them."""
    return {} if study.contest is None else study.contest.standing(records).answer


def _film(run: Run, lab: Lab, records: Records) -> tuple[Path | None, str]:
    try:
        rendering.environment()
        say("filming")
        shown = (lab.study.clips or clips.clips)(lab, records)
        return write_film(shown, run.folder / "film.mp4"), ""
    except RenderingError as error:
        say(str(error))
        return None, str(error)


def _report(
    run: Run,
    lab: Lab,
    records: Records,
    results: list[Result],
    film: Path | None,
    hint: str,
    taught: Section,
) -> Path:
    study, task = lab.study, lab.task
    sections = series.of_study(study, records)
    if study.contest is not None:
        sections = [*sections, *fronts.sections(study.contest, records)]
    if records.lost:
        rows = [lost.row() for lost in records.lost]
        sections = [Section("Trials that are missing", _LOST, table=rows), *sections]
    return write_report(
        run.folder / "report.html",
        title=study.title or task.name,
        lead=study.lead or inspect.cleandoc(type(task).__doc__ or "").partition("\n\n")[0],
        command=run.file.command,
        figures=results,
        sections=[*sections, taught, learned.section(task, lab.models)],
        film=film,
        no_film=hint,
        in_3d=embedded(clips.best_median_worst(lab, records)),
        about={"seed": run.file.seed, "started": run.file.started},
    )
