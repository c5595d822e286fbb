"""The tasks that are taught, learned and reproduced.

``names()`` is cheap; ``load(name)`` imports what the task needs.
"""

from importlib import import_module

from tpsim.errors import ArgumentError

_ROOMS = {
    "cup": "cup_and_sugar",
    "sugar": "cup_and_sugar",
    "cup-and-sugar": "cup_and_sugar",
}


def names() -> tuple[str, ...]:
    """Names of all tasks."""
    return tuple(_ROOMS)


def load(name: str):
    """The :class:`tpsim.tasks.task.Task` called ``name``."""
    if name not in _ROOMS:
        raise ArgumentError(f"there is no task '{name}'; choose one of {', '.join(names())}")
    return import_module(f"tpsim.tasks.{_ROOMS[name]}").task(name)
