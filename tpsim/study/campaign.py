"""Campaigns: teach, learn, reproduce, push, film and report, each written as a run folder."""

import shlex
import sys
import time
from contextlib import nullcontext
from dataclasses import asdict, replace
from pathlib import Path

from tqdm import tqdm

from tpsim import tasks
from tpsim.errors import RenderingError
from tpsim.experiment.conditions import Condition, perform
from tpsim.experiment.metrics import Measure
from tpsim.experiment.recording import Run, open_run, run_folder
from tpsim.experiment.report import write_report
from tpsim.experiment.studies import study as study_of
from tpsim.experiment.teaching import fit, recorded, save_models, table_of, teach_all
from tpsim.experiment.teaching import learn as learn
from tpsim.experiment.teaching import teach as teach
from tpsim.sim import rendering
from tpsim.sim.push import Push
from tpsim.sim.rollout import RECORD_PERIOD
from tpsim.sim.video import film as write_film
from tpsim.tasks.task import Task
from tpsim.whole import whole_path


def _open(task: Task, command: str, configuration: dict, seed: int, folder: Path | None):
    simulation = task.simulation()
    run = open_run(
        run_folder(task.name, seed) if folder is None else folder,
        command=command,
        configuration=configuration,
        seed=seed,
        scene_xml=simulation.xml,
        model=simulation.model,
    )
    return run, simulation


def reproduce(task: str, *, situation: int, seed: int, folder: Path | None = None) -> dict:
    """Perform a task once in an unseen situation."""
    return _try(task, situation, seed, folder, None)


def push(
    task: str,
    *,
    situation: int,
    force: tuple[float, float, float],
    start: float,
    duration: float,
    body: str | None,
    seed: int,
    folder: Path | None = None,
) -> dict:
    """Perform a task in an unseen situation, pushed and, beside it, not."""
    body = tasks.load(task).hand if body is None else body
    return _try(task, situation, seed, folder, Push(body, tuple(force), start, duration))


def _try(task, situation, seed, folder, push: Push | None) -> dict:
    found, study = tasks.load(task), study_of(task)
    models = fit(found, recorded(found))
    command = ["tpsim", "reproduce", task, "--situation", str(situation), "--seed", str(seed)]
    duration = found.duration
    if push is not None:
        command[1] = "push"
        command += ["--force", *map(repr, push.force), "--start", repr(push.start)]
        command += ["--duration", repr(push.duration), "--body", push.body]
        duration = max(duration, push.start + push.duration + 1.0)
    simulation = found.simulation()
    if push is not None:
        simulation.attachment(push.body)
    drawn = found.situation(simulation, seed, situation)
    conditions = [Condition("unpushed", drawn, duration=duration)]
    if push is not None:
        conditions.append(replace(conditions[0], label="pushed", push=push))
    configuration = {"situation": asdict(drawn), "push": push and asdict(push)}
    run, _ = _open(found, shlex.join(command), configuration, seed, folder)
    save_models(run.folder, models)
    records = _record(run, conditions, perform(conditions, task, simulation.xml, models, 1))
    return {
        "task": task,
        "seed": seed,
        "situation": situation,
        "outcome": records[-1][1].outcome,
        "figures": study.figures(records, models),
        "paths": {"run": str(run.folder)},
    }


def _record(run: Run, conditions, trials, first: int = 0, bar=None) -> list:
    records = []
    for index, (condition, trial) in enumerate(zip(conditions, trials, strict=True), first):
        run.save(index, trial)
        records.append((condition, trial))
        if bar is not None:
            bar.update()
    return records


def run(
    task: str,
    *,
    seed: int,
    video: bool,
    situations: int,
    pushes: int,
    workers: int,
    folder: Path | None = None,
    progress: bool = False,
) -> dict:
    """The whole job of a task: teach, learn, reproduce, push, film and report."""
    began = time.monotonic()
    found, study = tasks.load(task), study_of(task)
    command = f"tpsim run {task} --situations {situations} --pushes {pushes} --seed {seed}"
    count = found.demonstrations
    configuration = {"situations": situations, "pushes": pushes, "demonstrations": count}
    run, simulation = _open(found, command, configuration, seed, folder)
    _say(f"teaching {', '.join(found.behaviours)}: {count} demonstrations each")
    taught = teach_all(run, found, seed, workers)
    models = fit(found, taught)
    save_models(run.folder, models)
    records = _experiment(
        run, found, study, simulation, models, situations, pushes, workers, progress
    )
    _say("measuring")
    figures = study.figures(records, models)
    figures |= study.probe(simulation, models)
    figures["realtime_factor"] = _realtime_factor(records[0][0], found, simulation, models)
    measures = study.measures(figures)
    film, hint = None, "No film was asked for."
    if video:
        film, hint = _film(run, study, simulation, models, records, taught)
    sections = [*study.sections(records, models), table_of(found, models)]
    report = _report(run, study, command, measures, sections, film, hint)
    return {
        "task": task,
        "seed": seed,
        "trials": len(records),
        "figures": figures,
        "missed": [measure.name for measure in measures if measure.passed is False],
        "wall_seconds": round(time.monotonic() - began, 1),
        "paths": {
            "run": str(run.folder),
            "report": str(report),
            "film": None if film is None else str(film),
        },
    }


def _say(message: str) -> None:
    print(f"tpsim: {message}", file=sys.stderr)


def _experiment(run, task, study, simulation, models, situations, pushes, workers, progress):
    phases = study.phases(simulation, models, run.description["seed"], situations, pushes)
    records, conditions = [], next(phases)
    while True:
        _say(f"{len(conditions)} trials: {', '.join(dict.fromkeys(c.label for c in conditions))}")
        trials = perform(conditions, task.name, simulation.xml, models, workers)
        bar = tqdm(total=len(conditions), file=sys.stderr) if progress else nullcontext()
        with bar as shown:
            done = _record(run, conditions, trials, len(records), shown)
        records += done
        try:
            conditions = phases.send([trial for _, trial in done])
        except StopIteration:
            return records


def _realtime_factor(condition, task, simulation, models) -> float:
    """Simulated over processor time of one trial, physics, control and recording: best of four."""
    spent = []
    for _ in range(4):
        began = time.process_time()
        trial = condition.perform(task, simulation, models)
        spent.append(time.process_time() - began)
    return RECORD_PERIOD * len(trial["time"]) / min(spent)


def _film(run, study, simulation, models, records, taught) -> tuple[Path | None, str]:
    try:
        rendering.environment()
        _say("filming")
        clips = study.clips(simulation, models, records, taught)
        return write_film(clips, run.folder / "film.mp4"), ""
    except RenderingError as error:
        _say(str(error))
        return None, str(error)


def _report(run: Run, study, command, measures: list[Measure], sections, film, hint) -> Path:
    about = {"seed": run.description["seed"], "started": run.description["started"]}
    with whole_path(run.folder / "report.html") as temporary:
        write_report(
            temporary,
            title=study.title,
            lead=study.lead,
            command=command,
            figures=measures,
            sections=sections,
            film=film,
            no_film=hint,
            about=about,
        )
    return run.folder / "report.html"
