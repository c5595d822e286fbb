"""Teaching and learning of whole tasks: demonstrations and models, written and read."""

import shutil
import tempfile
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from tpsim import paths, tasks
from tpsim.errors import RecordingError
from tpsim.experiment.recording import Run, load_run, load_trial, open_run
from tpsim.experiment.report import Section
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim.teach import teach as teach_lessons
from tpsim.sim.trial import Trial
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


def recorded(task: Task, folder: Path | None = None) -> Taught:
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


def fit(task: Task, taught: Taught, components: int | None = None) -> dict[str, TPGMM]:
    """Fit the model of every behaviour to its demonstrations."""
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
    taught = recorded(found)
    models = fit(found, taught, components)
    target = paths.recordings() / "models" / task if folder is None else folder
    files = save_models(_made(target), models)
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


def table_of(task: Task, models: Mapping[str, TPGMM]) -> Section:
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


def save_models(folder: Path, models: Mapping[str, TPGMM]) -> list[str]:
    """Write the models to a folder, ``model-<behaviour>.npz``; return the files' names."""
    return [str(model.save(folder / f"model-{name}.npz")) for name, model in models.items()]


def teach_all(run: Run, task: Task, seed, workers) -> Taught:
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
