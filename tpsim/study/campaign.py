"""The verb run: the whole job of a study, from teaching to its report."""

import inspect
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import asdict
from pathlib import Path

from tqdm import tqdm  # type: ignore[import-untyped]

from tpsim.border import Count, border
from tpsim.errors import RenderingError
from tpsim.film import rendering
from tpsim.film.video import film as write_film
from tpsim.study import clips, figures, learned, series
from tpsim.study.files.run import Run
from tpsim.study.measure import Result
from tpsim.study.record import Records
from tpsim.study.recording import Answer, open_folder, record_all, say
from tpsim.study.report import write_report
from tpsim.study.study import Lab, Plan, Study
from tpsim.study.teaching import taught_all
from tpsim.study.teaching_files import write_demonstrations
from tpsim.task.verbs import learn


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

    Returns
    -------
    dict
        ``task``, ``seed``, ``trials``, ``figures`` by name, ``missed`` (titles of the measures
        whose limit is not kept), ``wall_seconds``, ``paths`` to ``run``, ``report``, ``film``.
    """
    began, task = time.monotonic(), study.task
    figures.check(study)
    command = command or f"tpsim.lab.run(study, {plan!r})  # {task!r}"
    settings = {"plan": asdict(plan), "demonstrations": task.demonstrations}
    where = None if folder is None else Path(folder)
    opened = open_folder(study, command, settings, plan.seed, where)
    with removed_if_nothing_came(opened.folder):
        taught = taught_all(study, task.demonstrations, plan.seed, workers)
    for behaviour, trials in taught.items():
        where = opened.folder / "demonstrations" / behaviour
        write_demonstrations(where, study, behaviour, trials, seed=plan.seed, command=command)
    models = learn(task, taught)
    opened.save_models(models)
    lab = Lab(study, models, taught)
    records = _experiment(opened, lab, plan, workers, progress)
    say("measuring")
    results = figures.results(lab, records)
    film, hint = _film(opened, lab, records) if video else (None, "No film was asked for.")
    opened = opened.finish()
    report = _report(opened, lab, records, results, film, hint)
    return {
        "task": task.name,
        "seed": plan.seed,
        "trials": len(records),
        "figures": {result.name: result.value for result in results},
        "missed": [result.title for result in results if result.passed is False],
        "wall_seconds": round(time.monotonic() - began, 1),
        "paths": {
            "run": str(opened.folder),
            "report": str(report),
            "film": None if film is None else str(film),
        },
    }


@contextmanager
def removed_if_nothing_came(folder: Path) -> Iterator[None]:
    """Take a new run folder away again if the first thing that should fill it fails."""
    try:
        yield
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _experiment(run: Run, lab: Lab, plan: Plan, workers: int, progress: bool) -> Records:
    records, phases = Records(lab.task, lab.models), lab.study.conditions(lab, plan)
    conditions = next(phases, [])
    while True:
        labels = ", ".join(dict.fromkeys(c.label for c in conditions))
        say(f"{len(conditions)} trials: {labels}")
        bar = tqdm(total=len(conditions), file=sys.stderr) if progress else None
        with bar or nullcontext():
            record_all(run, lab.study, records, conditions, workers, bar and bar.update)
        try:
            conditions = phases.send(records)
        except StopIteration:
            return records


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
    run: Run, lab: Lab, records: Records, results: list[Result], film: Path | None, hint: str
) -> Path:
    study, task = lab.study, lab.task
    if study.sections is None:
        sections = series.sections(records, study.all_measures)
    else:
        sections = study.sections(records)
    return write_report(
        run.folder / "report.html",
        title=study.title or task.name,
        lead=study.lead or inspect.cleandoc(type(task).__doc__ or "").partition("\n\n")[0],
        command=run.file.command,
        figures=results,
        sections=[*sections, learned.section(task, lab.models)],
        film=film,
        no_film=hint,
        about={"seed": run.file.seed, "started": run.file.started},
    )
