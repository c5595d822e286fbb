"""The verbs teach and learn of a study: demonstrations and models, in folders of their own."""

from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path

from tpsim import paths
from tpsim.checks import shown
from tpsim.errors import ArgumentError, SimulationError
from tpsim.study import learned
from tpsim.study.files.models_file import model_files, save_models
from tpsim.study.files.run import DEMONSTRATIONS, Run
from tpsim.study.recording import Answer, say
from tpsim.study.report import Section
from tpsim.study.study import Study
from tpsim.study.teaching_files import add_demonstrations, check_place, read_demonstrations
from tpsim.study.workers import Death, Executors, Workers
from tpsim.task.task import Models, Task
from tpsim.task.verbs import Taught, show_once
from tpsim.task.verbs import learn as learn_behaviours
from tpsim.whole import check_free, numbered_folder, whole_folder
from tpsim.world.course import Course, Shown
from tpsim.world.teaching import Attempt
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
    for behaviour, taught in all_shown.items():
        place = add_demonstrations(
            folder, study, behaviour, taught.trials, seed=seed, command=command
        )
        attempts[behaviour] = taught.attempts
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
        taught, here = given.world.robot.joints, study.task.stage.robot.joints
        if taught != here:
            raise ArgumentError(
                f"{given.folder} was taught with the joints {shown(taught)}, and this robot has "
                f"{shown(here)}: what one has learned another cannot do; teach this one"
            )
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


def taught_all(
    study: Study,
    count: int,
    seed: int,
    workers: int = 1,
    executor: Executors | None = None,
) -> dict[str, Shown]:
    """Teach all behaviours, attempts side by side with several workers: no bit is another then.

    Standard error says how every attempt ends.
    """
    courses = {name: _course(name, count) for name in study.task.behaviours()}
    workers = min(workers, count * len(courses)) or 1
    executor = executor if workers > 1 else None
    with Workers(workers, _teacher, (study.task, seed), executor) as pool:
        while jobs := [(name, k) for name, course in courses.items() for k in course.wanted]:
            for (name, attempt), found in zip(jobs, pool.map(jobs), strict=True):
                if isinstance(found, Death):
                    raise SimulationError(f"attempt {attempt + 1} at '{name}': {found}")
                courses[name].add(found)
    return {name: course.shown for name, course in courses.items()}


def _course(behaviour: str, count: int) -> Course:
    good = 0
    say(f"teaching {behaviour}: {count} demonstrations")

    def tell(attempt: int, outcome: str) -> None:
        nonlocal good
        good += outcome == "done"
        say(f"teaching {behaviour}: attempt {attempt + 1} {outcome}, {good} of {count} good")

    return Course(count, tell)


def _teacher(given: tuple[Task, int]) -> Callable[[tuple[str, int]], Attempt]:
    task, seed = given

    def attempt(job: tuple[str, int]) -> Attempt:
        return show_once(task, job[0], job[1], seed)

    return one_thread()(attempt)
