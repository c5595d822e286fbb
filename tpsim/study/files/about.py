"""What a trial says about itself: enough to perform it, or to show it, again."""

from dataclasses import dataclass, fields
from typing import TypeVar

from tpsim.errors import ArgumentError, RecordingError
from tpsim.study.condition import Condition
from tpsim.study.files.checked import plain, restore
from tpsim.study.study import Study
from tpsim.task.task import Task
from tpsim.world.trial import Trial

T = TypeVar("T", bound=Task)


@dataclass(frozen=True)
class TaskFile:
    """A task in a recording.

    Parameters
    ----------
    reference : str
        Where its study is from, as :func:`tpsim.study.reference.load_study` takes it; empty where
        it was made in a program.
    name : str
        Of the task.
    fields : dict
        Its parameters, as plain JSON values.
    """

    reference: str
    name: str
    fields: dict[str, object]

    @classmethod
    def of(cls, study: Study) -> "TaskFile":
        """The task of a study."""
        return cls(study.reference, study.task.name, task_fields(study.task))


@dataclass(frozen=True)
class Performed:
    """``about`` of a trial that was performed under a condition."""

    condition: Condition
    task: TaskFile


@dataclass(frozen=True)
class Demonstrated:
    """``about`` of a demonstration: attempt ``attempt`` of a seed to show a behaviour."""

    behaviour: str
    seed: int
    attempt: int


@dataclass(frozen=True)
class Led:
    """``about`` of a demonstration that a person led by hand in the playground.

    Parameters
    ----------
    behaviour : str
        That was shown.
    lesson : Condition
        Start, objects, hands and duration; no controller.
    """

    behaviour: str
    lesson: Condition


def task_fields(task: Task) -> dict[str, object]:
    """Parameters of a task as plain JSON values.

    Raises
    ------
    RecordingError
        If a field is no plain value: it could not stand in ``run.json``.
    """
    found = {}
    for field in fields(task):  # type: ignore[arg-type]  # subclasses are dataclasses
        try:
            found[field.name] = plain(getattr(task, field.name))
        except RecordingError as error:
            raise RecordingError(f"field '{field.name}' of task {task.name}: {error}") from None
    return found


def with_fields(task: T, found: dict[str, object], where: object) -> T:
    """The task with the parameters that a recording states.

    Raises
    ------
    RecordingError
        Names file and field: a field that the task does not have, or of another type.
    """
    return restore(found, type(task), where)


def read_about(trial: Trial, where: object) -> Performed | Demonstrated | Led:
    """What a recorded trial says about itself.

    Raises
    ------
    RecordingError
        Names file and field.
    """
    found, name = dict(trial.about), f"{where}: about"
    if "condition" in found:
        return restore(found, Performed, name)
    if "lesson" in found:
        return restore(found, Led, name)
    shown = restore(found, Demonstrated, name)
    for field, number in (("seed", shown.seed), ("attempt", shown.attempt)):
        if not 0 <= number < 2**32:
            raise RecordingError(f"{name}: {field} is {number}; from 0 to below 2^32")
    return shown


def condition_of(trial: Trial, where: object = "the trial") -> Condition:
    """The condition under which a recorded trial was performed.

    Raises
    ------
    ArgumentError
        If it is a demonstration.
    """
    about = read_about(trial, where)
    if not isinstance(about, Performed):
        raise ArgumentError(f"{where} is a demonstration: it was not performed under a condition")
    return about.condition
