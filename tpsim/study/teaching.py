"""The verbs teach and learn of a study: demonstrations and models, in folders of their own."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path

from threadpoolctl import threadpool_limits

from tpsim import paths
from tpsim.errors import SimulationError
from tpsim.study import learned
from tpsim.study.files.models_file import save_models
from tpsim.study.recording import Answer, say
from tpsim.study.study import Study
from tpsim.study.teaching_files import (
    place_for,
    read_demonstrations,
    replaced,
    write_demonstrations,
)
from tpsim.study.workers import Death, Workers
from tpsim.task.task import Task
from tpsim.task.verbs import Taught
from tpsim.task.verbs import learn as learn_behaviours
from tpsim.task.verbs import teach as teach_behaviours
from tpsim.world.trial import Trial


def teach(
    study: Study,
    count: int | None = None,
    seed: int = 0,
    folder: Path | None = None,
    *,
    command: str = "",
) -> Answer:
    """Teach every behaviour of a study's task, and write the demonstrations.

    Parameters
    ----------
    study : Study
    count : int, optional
        Demonstrations of each behaviour; as many as the task asks for by default.
    seed : int
    folder : Path, optional
        The demonstrations go to ``<folder>/<behaviour>``, which must be new; by default to
        ``recordings/demonstrations/<behaviour>``, where they replace others of this robot.
    command : str
        For people who read the folder.

    Raises
    ------
    SimulationError
        If too many demonstrations are useless.
    RecordingError
        If the demonstrations would overwrite those of somebody else.
    """
    task = study.task
    count = task.demonstrations if count is None else count
    attempts, written = {}, []
    targets = {behaviour: place_for(task, folder, behaviour) for behaviour in task.behaviours()}
    for behaviour, trials in taught_all(study, count, seed).items():
        target = targets[behaviour]
        with replaced(target) as new:
            write_demonstrations(new, study, behaviour, trials, seed=seed, command=command)
        attempts[behaviour] = int(str(trials[-1].about["attempt"])) + 1
        written.append(str(target))
    return {
        "task": task.name,
        "seed": seed,
        "count": count,
        "attempts": attempts,
        "paths": {"demonstrations": written},
    }


def learn(
    study: Study, demonstrations: Path | Taught | None = None, out: Path | None = None
) -> Answer:
    """Learn every behaviour of a study's task, and say what was learned.

    Parameters
    ----------
    study : Study
    demonstrations : Path or mapping of str to sequence of Trial, optional
        A folder that :func:`teach` wrote, ``recordings/demonstrations`` by default; or the
        demonstrations themselves.
    out : Path, optional
        Where the models are written, beside no others; ``recordings/models/<task>`` by default,
        where they replace those learned before.
    """
    task, taught = study.task, demonstrations_of(study, demonstrations)
    models = learn_behaviours(task, taught)
    if out is None:
        target = paths.recordings() / "models" / task.name
        with replaced(target) as new:
            files = [target / file.name for file in save_models(new, models)]
    else:
        out.mkdir(parents=True, exist_ok=True)
        files = save_models(out, models)
    return {
        "task": task.name,
        "components": next(iter(models.values())).components,
        "demonstrations": {name: len(trials) for name, trials in taught.items()},
        "log_likelihood": {name: float(model.history[-1]) for name, model in models.items()},
        "deviations": learned.deviations(task, models),
        "paths": {"models": [str(file) for file in files]},
    }


def demonstrations_of(study: Study, given: Path | Taught | None) -> Taught:
    """Demonstrations as they are, or out of the folder that holds them."""
    return given if isinstance(given, Mapping) else read_demonstrations(study.task, given)


def taught_all(study: Study, count: int, seed: int, workers: int = 1) -> dict[str, list[Trial]]:
    """Teach all behaviours, side by side with several workers; their number changes no bit."""
    behaviours = list(study.task.behaviours())
    if workers == 1 or len(behaviours) == 1:
        return {behaviour: _taught(study.task, count, seed, behaviour) for behaviour in behaviours}
    with Workers(min(workers, len(behaviours)), _teacher, (study.task, count, seed)) as pool:
        return {
            name: _whole(name, found)
            for name, found in zip(behaviours, pool.map(behaviours), strict=True)
        }


def _whole(behaviour: str, found: list[Trial] | Death) -> list[Trial]:
    if isinstance(found, Death):
        raise SimulationError(f"'{behaviour}' was not taught: {found}")
    return found


def _teacher(given: tuple[Task, int, int]) -> "partial[list[Trial]]":
    return partial(_taught, *given)


def _taught(task: Task, count: int, seed: int, behaviour: str) -> list[Trial]:
    """Demonstrations of one behaviour; standard error says how every attempt ends."""
    good = 0
    say(f"teaching {behaviour}: {count} demonstrations")

    def tell(name: str, attempt: int, outcome: str) -> None:
        nonlocal good
        good += outcome == "done"
        say(f"teaching {name}: attempt {attempt + 1} {outcome}, {good} of {count} good")

    with threadpool_limits(1):
        return teach_behaviours(task, count, seed, [behaviour], tell)[behaviour]
