"""The fields of a task as options of its commands."""

import dataclasses
import math
import typing
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Annotated

from docstring_parser import parse_from_object
from tyro.conf import arg

from tpsim.cli.options import StudyCommand
from tpsim.errors import ArgumentError

if TYPE_CHECKING:
    from tpsim.study.study import Study
    from tpsim.task.task import Task


def with_fields(command: type[StudyCommand], task: "Task") -> type[StudyCommand]:
    """The options of a command and, with their values as defaults, the fields of a task.

    A field that has the name of one of the command's own options becomes ``--task-<field>``.
    """
    hints, helps = typing.get_type_hints(type(task), include_extras=True), _helps(type(task))
    options = []
    for field, option in option_names(command, task).items():
        told = arg(help=helps.get(field, "A field of the task."))
        kind: object = Annotated[hints[field], told]
        default = dataclasses.field(default_factory=_returning(getattr(task, field)))
        options.append((option, kind, default))
    extended = dataclasses.make_dataclass(
        command.__name__, options, bases=(command,), frozen=True, kw_only=True
    )
    extended.__doc__ = command.__doc__
    return extended


def option_names(command: type[StudyCommand], task: "Task") -> dict[str, str]:
    """Fields of a task, and the names that they have among a command's options."""
    if not dataclasses.is_dataclass(task):
        return {}
    taken = {field.name for field in dataclasses.fields(command)}
    names = [field.name for field in dataclasses.fields(task) if field.init]
    return {name: f"task_{name}" if name in taken else name for name in names}


def varied(study: "Study", options: StudyCommand) -> "Study":
    """The study with its task's fields as they were given.

    Raises
    ------
    ArgumentError
        If a number is not finite, or the task refuses a value.
    """
    changed = {}
    for field, option in option_names(_own(type(options)), study.task).items():
        given = getattr(options, option)
        if not _same(given, getattr(study.task, field)):
            changed[field] = given
            if isinstance(given, float) and not math.isfinite(given):
                raise ArgumentError(
                    f"--{option.replace('_', '-')} is {given}; give a finite number"
                )
    try:
        return study.with_task(**changed) if changed else study
    except (ValueError, TypeError) as error:
        raise ArgumentError(f"task '{study.task.name}' refuses {changed}: {error}") from None


def _own(extended: type[StudyCommand]) -> type[StudyCommand]:
    """The command that was extended."""
    base: type[StudyCommand] = extended.__bases__[0]
    return base


def _same(one: object, other: object) -> bool:
    if one is other:
        return True
    try:
        return bool(one == other)
    except ValueError:  # arrays
        return False


def _returning(value: object) -> Callable[[], object]:
    return lambda: value


def _helps(task: type) -> Mapping[str, str]:
    """What the docstrings of a dataclass say about its fields."""
    found: dict[str, str] = {}
    for parent in reversed(task.__mro__):
        if dataclasses.is_dataclass(parent):
            parameters = parse_from_object(parent).params
            found |= {p.arg_name: _plain(p.description or "") for p in parameters}
    return found


def _plain(text: str) -> str:
    """A paragraph without line breaks and marks of literals."""
    return " ".join(text.replace("``", "").split())
