"""The verbs teach and learn of a study: demonstrations and models, in folders of their own."""

from collections import Counter
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from tpsim import paths
from tpsim.errors import SimulationError
from tpsim.study import learned
from tpsim.study.files.models_file import model_files, save_models
from tpsim.study.files.run import DEMONSTRATIONS, Run
from tpsim.study.recording import Answer, say
from tpsim.study.report import Section
from tpsim.study.study import Study
from tpsim.study.teaching_files import add_demonstrations, check_place, read_demonstrations
from tpsim.study.workers import Death, Workers
from tpsim.task.task import Models, Task
from tpsim.task.verbs import Taught, show_all
from tpsim.task.verbs import learn as learn_behaviours
from tpsim.whole import check_free, numbered_folder, whole_folder
from tpsim.world.teaching import Shown
from tpsim.world.threads import one_thread

TEXT = (
    "Demonstrations are refused, and shown again, where the robot came to its limits or touched "
    "something, where the teacher pulled as hard as it can, and where it missed what it cares "
    "about itself."
)

Source = Path | Run | Taught
"""Where demonstrations, or models, come from."""


@one_thread()
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
        ``recordings/demonstrations/<behaviour>``, ``<behaviour>~2``, ...: earlier ones stay, and
        the last are learned from.
    command : str
        For people who read the folder.

    Raises
    ------
    SimulationError
        If too many demonstrations are useless.
    RecordingError
        If the folder holds something, or the usual one demonstrations of another robot.
    """
    task = study.task
    count = task.demonstrations if count is None else count
    attempts, written = {}, []
    for behaviour in task.behaviours():
        check_place(task, folder, behaviour)
    all_shown = taught_all(study, count, seed)
    for behaviour, shown in all_shown.items():
        place = add_demonstrations(
            folder, study, behaviour, shown.trials, seed=seed, command=command
        )
        attempts[behaviour] = shown.attempts
        written.append(str(place))
    return {
        "task": task.name,
        "seed": seed,
        "count": count,
        "attempts": attempts,
        **refused(all_shown),
        "paths": {"demonstrations": written},
    }


@one_thread()
def learn(study: Study, demonstrations: Source | None = None, out: Path | None = None) -> Answer:
    """Learn every behaviour of a study's task, and say what was learned.

    Parameters
    ----------
    study : Study
    demonstrations : Path, Run or mapping of str to sequence of Trial, optional
        A folder that :func:`teach` wrote, ``recordings/demonstrations`` by default; a run, whose
        own are taken; or the demonstrations themselves.
    out : Path, optional
        A new folder for the models; by default ``recordings/models/<task>``, ``<task>~2``, ...:
        earlier ones stay.
    """
    if out is not None:
        check_free(out)
    task, taught = study.task, demonstrations_of(study, demonstrations)
    models = learn_behaviours(task, taught)
    if out is None:
        place = paths.recordings() / "models" / task.name
        out = numbered_folder(place, lambda new: save_models(new, models))
    else:
        with whole_folder(out) as new:
            save_models(new, models)
    return {
        "task": task.name,
        "components": next(iter(models.values())).components,
        "demonstrations": {name: len(trials) for name, trials in taught.items()},
        "log_likelihood": {name: float(model.history[-1]) for name, model in models.items()},
        "deviations": learned.deviations(task, models),
        "paths": {"models": [str(file) for file in model_files(out).values()]},
    }


def demonstrations_of(study: Study, given: Source | None) -> Taught:
    """Demonstrations as they are, or out of the folder or run that holds them."""
    if isinstance(given, Mapping):
        return given
    where = given.check().folder / DEMONSTRATIONS if isinstance(given, Run) else given
    return read_demonstrations(study.task, where)


def models_of(study: Study, given: Source | None) -> Models:
    """The models of a run, where one is given that has them all; else learned."""
    if isinstance(given, Run):
        models = given.check().models
        if study.task.behaviours().keys() <= models.keys():
            return models
    return learn_behaviours(study.task, demonstrations_of(study, given))


def refused(shown: Mapping[str, Shown]) -> Answer:
    """How many demonstrations were refused, and how many for each reason."""
    reasons: Counter[str] = Counter()
    for found in shown.values():
        reasons.update(found.refusals)
    return {"refused_demonstrations": reasons.total(), "refusals": dict(reasons.most_common())}


def section(shown: Mapping[str, Shown]) -> Section:
    """Part of a report: how often every behaviour was shown, and why some was not learned from."""
    rows = [
        {
            "behaviour": behaviour,
            "attempts": found.attempts,
            "learned from": len(found.trials),
            "refused": ", ".join(f"{count} {why}" for why, count in found.refusals.items())
            or "none",
        }
        for behaviour, found in shown.items()
    ]
    return Section("What was shown", TEXT, table=rows)


def taught_all(study: Study, count: int, seed: int, workers: int = 1) -> dict[str, Shown]:
    """Teach all behaviours, side by side with several workers; their number changes no bit."""
    behaviours = list(study.task.behaviours())
    if workers == 1 or len(behaviours) == 1:
        return {behaviour: _taught(study.task, count, seed, behaviour) for behaviour in behaviours}
    with Workers(min(workers, len(behaviours)), _teacher, (study.task, count, seed)) as pool:
        return {
            name: _whole(name, found)
            for name, found in zip(behaviours, pool.map(behaviours), strict=True)
        }


def _whole(behaviour: str, found: Shown | Death) -> Shown:
    if isinstance(found, Death):
        raise SimulationError(f"'{behaviour}' was not taught: {found}")
    return found


def _teacher(given: tuple[Task, int, int]) -> "partial[Shown]":
    return partial(_taught, *given)


def _taught(task: Task, count: int, seed: int, behaviour: str) -> Shown:
    """Demonstrations of one behaviour; standard error says how every attempt ends."""
    good = 0
    say(f"teaching {behaviour}: {count} demonstrations")

    def tell(name: str, attempt: int, outcome: str) -> None:
        nonlocal good
        good += outcome == "done"
        say(f"teaching {name}: attempt {attempt + 1} {outcome}, {good} of {count} good")

    return show_all(task, count, seed, [behaviour], tell)[behaviour]
