"""The tasks that are taught, learned and reproduced.

``names()`` is cheap; ``load(name)`` imports what the task needs.
"""

from importlib import import_module

from tpsim.errors import ArgumentError

_ROOMS = {
    "cup": "cup_and_sugar",
    "sugar": "cup_and_sugar",
    "cup-and-sugar": "cup_and_sugar",
    "pointing": "pointing",
    "pointing-baxter": "pointing",
    "tracking": "tracking",
    "tracking-left": "tracking",
    "tracking-right": "tracking",
    "tracking-compromise": "tracking",
    "transfer": "transfer",
}


def names() -> tuple[str, ...]:
    """Names of all tasks."""
    return tuple(_ROOMS)


def room(name: str) -> str:
    """Name of the module in which the task called ``name`` lives."""
    if name not in _ROOMS:
        raise ArgumentError(f"there is no task '{name}'; choose one of {', '.join(names())}")
    return _ROOMS[name]


def load(name: str):
    """The :class:`tpsim.tasks.task.Task` called ``name``."""
    return import_module(f"tpsim.tasks.{room(name)}").task(name)
