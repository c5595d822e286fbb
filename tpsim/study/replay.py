"""Does a run repeat? Its trials are performed again, from its own folder alone."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from tpsim.errors import ArgumentError, RecordingError, TpsimError
from tpsim.study.executor import perform_all
from tpsim.study.files.about import Demonstrated, Led, Performed, read_about, with_fields
from tpsim.study.files.limits import check_condition
from tpsim.study.files.run import Run, number_of
from tpsim.study.files.run_file import differing
from tpsim.study.reference import is_ours, load_study
from tpsim.study.study import Study
from tpsim.task.task import draw_situation
from tpsim.world.teaching import demonstrate, show
from tpsim.world.threads import one_thread
from tpsim.world.trial import Trial


@one_thread()
def replay(
    run: Run, study: Study | None = None, workers: int = 1, only: Path | None = None
) -> dict[str, object]:
    """Perform the trials of a run again and compare all signals bit for bit.

    Scene, models, conditions and the task's fields come from the run's folder and from nothing
    else; the code of task and controllers comes from tpsim or from the caller, never from what
    the folder names.

    Parameters
    ----------
    run : Run
        Of a whole run, or of the demonstrations of a behaviour.
    study : Study, optional
        Of the run; those that tpsim brings are found by themselves.
    workers : int
        Processes.
    only : Path, optional
        The file of one trial; all by default.

    Returns
    -------
    dict
        ``verdict`` in words, ``repeats`` (whether all is there, as it was, and came out again),
        ``trials``, ``identical``, ``whole`` (whether the run came to its end), ``missing``,
        ``changed`` since then and ``different`` now (names of files), ``largest_difference`` over
        all signals (each in its SI unit), ``other_versions`` (what has changed since the
        recording and may change bits).

    Raises
    ------
    RecordingError
        If the folder holds no trials, or anything in it contradicts the rest.
    ArgumentError
        If the study is the caller's own and was not given.
    """
    files = run.files() if only is None else (only,)
    if not files:
        raise RecordingError(f"{run.folder} holds no trials; give a run's folder")
    here = study_of(run, study)
    different, largest = [], 0.0
    try:
        for file, (recorded, again) in zip(files, _pairs(run, files, here, workers), strict=True):
            difference = difference_of(recorded, again)
            if difference is not None:
                different.append(file.name)
                largest = max(largest, difference)
    except (ValueError, TypeError, ArithmeticError, LookupError, AttributeError) as error:
        if isinstance(error, TpsimError):
            raise
        raise RecordingError(
            f"{run.folder} cannot be performed again ({type(error).__name__}: {error}); its "
            "files do not belong together"
        ) from error
    whole, missing = run.file.whole is not None, _missing(run)
    changed = [name for name in run.changed() if name not in missing]
    faults = {
        f"{len(different)} of {len(files)} trials differ": bool(different),
        "the run was interrupted before its end": not whole,
        f"{len(missing)} files are missing": bool(missing),
        f"{', '.join(changed)} changed after the run": bool(changed),
    }
    found = "; ".join(fault for fault, there in faults.items() if there)
    all_of_them = f"all {len(files)} trials" if only is None else f"{only.name}"
    return {
        "verdict": found or f"{all_of_them} came out again, bit for bit",
        "repeats": not found,
        "trials": len(files),
        "identical": len(files) - len(different),
        "whole": whole,
        "missing": missing,
        "changed": changed,
        "different": different,
        "largest_difference": largest,
        "other_versions": differing(run.file.versions),
    }


def _missing(run: Run) -> list[str]:
    """Files that the run had at its end, or that stand between others."""
    there = {file.name for file in run.files()}
    count = max((1 + number_of(file) for file in run.files()), default=0)
    between = [name for i in range(count) if (name := run.path(i).name) not in there]
    whole = run.file.whole
    had = [] if whole is None else [n for n in whole.files if not (run.folder / n).is_file()]
    return sorted({*between, *had})


def study_of(run: Run, study: Study | None = None) -> Study:
    """The study of a run with the recorded world and fields.

    Raises
    ------
    ArgumentError
        If it is the caller's own and was not given, or another one was.
    """
    task = run.file.task
    if study is None:
        if not is_ours(task.reference):
            named = f"its study is {task.reference}" if task.reference else "it names no study"
            raise ArgumentError(
                f"{run.folder} is not of tpsim's own tasks: {named}; name it yourself if you "
                "trust it, --study my_task.py:study"
            )
        study = load_study(task.reference)
    recorded = with_fields(study.task, task.fields, f"{run.folder / 'run.json'}: task.fields")
    if recorded.name != task.name:
        raise ArgumentError(
            f"{run.folder} is of the task '{task.name}', the study is of '{recorded.name}'"
        )
    return study.about(recorded.in_world(run.world))


def _pairs(
    run: Run, files: Sequence[Path], study: Study, workers: int
) -> Iterator[tuple[Trial, Trial]]:
    """Every recorded trial beside its repetition."""
    conditions = []
    for file, trial in zip(files, run.trials(files), strict=True):
        about = read_about(trial, file)
        if isinstance(about, Performed):
            if about.task != run.file.task:
                raise RecordingError(f"{file}: about.task is not that of run.json")
            check_condition(about.condition, run.world.timestep, f"{file}: about.condition")
            conditions.append(about.condition)
        elif conditions:
            raise RecordingError(f"{file} is a demonstration among trials")
        elif isinstance(about, Led):
            check_condition(about.lesson, run.world.timestep, f"{file}: about.lesson")
        _check_seed(run, study, about, file)
    if not conditions:
        for file, trial in zip(files, run.trials(files), strict=True):
            yield trial, _shown(study, read_about(trial, file), file)
        return
    models = run.models
    if missing := study.task.behaviours().keys() - models.keys():
        raise RecordingError(f"{run.folder} has no model of {', '.join(sorted(missing))}")
    yield from zip(run.trials(files), perform_all(study, models, conditions, workers), strict=True)


def _check_seed(run: Run, study: Study, about: Performed | Demonstrated | Led, file: Path) -> None:
    """A drawn situation and a demonstration are of the seed of their run."""
    seed = run.file.seed
    if isinstance(about, Led):
        return
    if isinstance(about, Demonstrated):
        same = about.seed == seed
    else:
        drawn = about.condition.situation
        # A study may make situations of its own; only those that are drawn are of the run's seed.
        same = drawn.seed == seed or drawn != draw_situation(study.task, drawn.seed, drawn.index)
    if not same:
        raise RecordingError(f"{file} is of another seed than the {seed} of run.json")


def _shown(study: Study, about: Performed | Demonstrated | Led, where: object) -> Trial:
    """A demonstration, shown or led again."""
    assert not isinstance(about, Performed)
    behaviours = study.task.behaviours()
    if about.behaviour not in behaviours:
        raise RecordingError(
            f"{where}: about.behaviour is '{about.behaviour}'; the task has {', '.join(behaviours)}"
        )
    if isinstance(about, Led):
        return demonstrate(study.task.stage, about.lesson.lesson, study.task.sites())
    teacher = behaviours[about.behaviour].teacher
    return show(study.task.stage, teacher, about.attempt, seed=about.seed, sites=study.task.sites())


def difference_of(one: Trial, other: Trial) -> float | None:
    """Largest difference of two trials' signals; None where all bits agree."""
    if {n: a.shape for n, a in one.arrays.items()} != {n: a.shape for n, a in other.arrays.items()}:
        return float("inf")
    same = (one.outcome, one.channels) == (other.outcome, other.channels)
    if same and all(_same_bits(one[name], other[name]) for name in one.arrays):
        return None
    gaps = (np.abs(one[n] - other[n].astype(float)) for n in one.arrays)
    return max(float(np.max(gap, initial=0)) for gap in gaps)


def _same_bits(one: np.ndarray, other: np.ndarray) -> bool:
    return one.dtype == other.dtype and one.tobytes() == other.tobytes()
