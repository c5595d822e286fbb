"""Campaigns: teach, learn, reproduce, push, film and report, each written as a run folder."""

import shlex
import shutil
import sys
import tempfile
import time
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import asdict, replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from tqdm import tqdm

from tpsim import paths, tasks
from tpsim.errors import RecordingError, RenderingError
from tpsim.experiment.conditions import Condition, perform
from tpsim.experiment.metrics import Measure
from tpsim.experiment.recording import Run, load_run, load_trial, open_run, run_folder
from tpsim.experiment.report import Section, write_report
from tpsim.experiment.studies import study as study_of
from tpsim.experiment.whole import whole_path
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim import rendering
from tpsim.sim.push import Push
from tpsim.sim.teach import teach as teach_lessons
from tpsim.sim.trial import Trial
from tpsim.sim.video import film as write_film
from tpsim.tasks.task import Task

Taught = dict[str, list[Trial]]
"""Demonstrations by behaviour."""


def teach(task: str, *, count: int, seed: int, folder: Path | None = None) -> dict:
    """Teach every behaviour of a task and write the demonstrations.

    They go to ``recordings/demonstrations/<behaviour>/`` and replace what is there once all are
    good, or to ``<folder>/<behaviour>/``, which must be new.
    """
    found = tasks.load(task)
    attempts, written = {}, []
    for behaviour in found.behaviours:
        target = paths.demonstrations(behaviour) if folder is None else folder / behaviour
        if folder is not None and target.exists():
            raise RecordingError(f"{target} exists; give a new folder")
        trials = _teach(task, behaviour, count, seed)
        command = f"tpsim teach {behaviour} --count {count} --seed {seed}"
        with tempfile.TemporaryDirectory(dir=_made(target.parent)) as temporary:
            _write_demonstrations(Path(temporary) / "new", found, command, count, seed, trials)
            shutil.rmtree(target, ignore_errors=True)
            (Path(temporary) / "new").rename(target)
        attempts[behaviour] = trials[-1].about["attempt"] + 1
        written.append(str(target))
    return {
        "task": task,
        "seed": seed,
        "count": count,
        "attempts": attempts,
        "paths": {"demonstrations": written},
    }


def _made(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _teach(task: str, behaviour: str, count: int, seed: int) -> list[Trial]:
    found = tasks.load(task)
    simulation = found.simulation()
    return teach_lessons(
        simulation,
        lambda simulation, rng: found.lesson(simulation, behaviour, rng),
        count,
        seed=seed,
        sites=found.sites,
    )


def _write_demonstrations(folder, task: Task, command, count, seed, trials) -> None:
    simulation = task.simulation()
    run = open_run(
        folder,
        command=command,
        configuration={"count": count},
        seed=seed,
        scene_xml=simulation.xml,
        model=simulation.model,
    )
    for index, trial in enumerate(trials):
        run.save(index, trial)


def _taught(task: Task, folder: Path | None = None) -> Taught:
    """Demonstrations that were recorded, of every behaviour of a task."""
    taught = {}
    for behaviour in task.behaviours:
        where = paths.demonstrations(behaviour) if folder is None else folder / behaviour
        files = load_run(where).files() if where.is_dir() else ()
        if not files:
            raise RecordingError(
                f"no demonstrations of '{behaviour}' in {where}; first: tpsim teach {task.name}"
            )
        taught[behaviour] = [load_trial(file) for file in files]
    return taught


def _learn(task: Task, taught: Taught, components: int | None = None) -> dict[str, TPGMM]:
    components = task.components if components is None else components
    simulation = task.simulation()
    return {
        behaviour: task.learn(simulation, behaviour, trials, components)
        for behaviour, trials in taught.items()
    }


def learn(task: str, *, components: int | None, folder: Path | None = None) -> dict:
    """Learn every behaviour of a task from its recorded demonstrations, and say what was learned.

    ``folder`` is where the models are written, ``recordings/models/<task>/`` by default.
    """
    found = tasks.load(task)
    taught = _taught(found)
    models = _learn(found, taught, components)
    target = paths.recordings() / "models" / task if folder is None else folder
    files = _save_models(_made(target), models)
    return {
        "task": task,
        "components": next(iter(models.values())).components,
        "demonstrations": {name: len(trials) for name, trials in taught.items()},
        "log_likelihood": {name: float(model.history[-1]) for name, model in models.items()},
        "deviations": {name: _deviations(found, name, model) for name, model in models.items()},
        "paths": {"models": files},
    }


def _deviations(task: Task, behaviour: str, model: TPGMM) -> dict:
    """Standard deviation of every dimension of every frame: small where the teacher cared."""
    coordinates = task.coordinates(task.simulation(), behaviour)
    return {
        coordinate.name: {
            label: float(deviation)
            for label, deviation in zip(
                coordinate.labels,
                np.sqrt(np.einsum("k,kii->i", model.priors, gaussian.covariance))[
                    -len(coordinate.labels) :
                ],
                strict=True,
            )
        }
        for coordinate, gaussian in zip(coordinates, model.frames, strict=True)
    }


def _learned(task: Task, models: Mapping[str, TPGMM]) -> Section:
    """Table of the report: what the teacher cared about, and what not."""
    rows = [
        {"behaviour": name, "frame": frame, "dimension": label, "deviation": deviation}
        for name, model in models.items()
        for frame, dimensions in _deviations(task, name, model).items()
        for label, deviation in dimensions.items()
    ]
    text = (
        "Standard deviation of the demonstrations along every dimension of every candidate "
        "frame. Nothing was set by hand: where the teacher was precise the number is small, and "
        "there the robot is stiff."
    )
    return Section("What was learned", text, table=rows)


def _save_models(folder: Path, models: Mapping[str, TPGMM]) -> list[str]:
    return [str(model.save(folder / f"model-{name}.npz")) for name, model in models.items()]


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
    body: str,
    seed: int,
    folder: Path | None = None,
) -> dict:
    """Perform a task in an unseen situation, pushed and, beside it, not."""
    return _try(task, situation, seed, folder, Push(body, tuple(force), start, duration))


def _try(task, situation, seed, folder, push: Push | None) -> dict:
    found, study = tasks.load(task), study_of(task)
    models = _learn(found, _taught(found))
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
    _save_models(run.folder, models)
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
    taught = _teach_all(run, found, seed, workers)
    models = _learn(found, taught)
    _save_models(run.folder, models)
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
    sections = [*study.sections(records, models), _learned(found, models)]
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


def _teach_all(run: Run, task: Task, seed, workers) -> Taught:
    """Teach the behaviours side by side, and keep the demonstrations in the run folder."""
    count = task.demonstrations
    jobs = [(task.name, behaviour, count, seed) for behaviour in task.behaviours]
    if workers == 1 or len(jobs) == 1:
        results = [_teach(*job) for job in jobs]
    else:
        with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
            results = list(pool.map(_teach, *zip(*jobs, strict=True)))
    taught = dict(zip(task.behaviours, results, strict=True))
    for behaviour, trials in taught.items():
        command = f"tpsim teach {behaviour} --count {count} --seed {seed}"
        target = run.folder / "demonstrations" / behaviour
        _write_demonstrations(target, task, command, count, seed, trials)
    return taught


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
    """Simulated over processor time of one trial, physics, control and recording."""
    short = replace(condition, duration=2.0)
    short.perform(task, simulation, models)
    began = time.process_time()
    short.perform(task, simulation, models)
    return 2.0 / (time.process_time() - began)


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
