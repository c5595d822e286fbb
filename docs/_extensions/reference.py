"""The API reference: what each public room offers, listed by looking, documented by docstrings."""

import ast
import inspect
from dataclasses import dataclass
from functools import cache
from importlib import import_module


@dataclass(frozen=True)
class Room:
    """A module from which users import, and the name under which they know it."""

    module: str
    prefix: str

    @property
    def names(self) -> tuple[str, ...]:
        """What it offers: its own things and those that it re-exports by name."""
        found = vars(import_module(self.module))
        return tuple(name for name, value in found.items() if self._offers(name, value))

    def _offers(self, name: str, value: object) -> bool:
        if name[0] == "_" or inspect.ismodule(value) or name == "TYPE_CHECKING":
            return False
        home = getattr(value, "__module__", None)
        if self.module in ("tpsim.mathematics", "tpsim.plot", "tpsim.data"):
            return home is None or home.startswith("tpsim")
        if self.module == "tpsim.lab":
            return home is None or home.startswith("tpsim") or isinstance(value, dict)
        return home == self.module and inspect.isfunction(value)


ROOMS = (
    Room("tpsim.mathematics", "tpsim"),
    Room("tpsim.control.projection", "tpsim.projection"),
    Room("tpsim.rotation", "tpsim.rotation"),
    Room("tpsim.plot", "tpsim.plot"),
    Room("tpsim.data", "tpsim.data"),
    Room("tpsim.lab", "tpsim.lab"),
)

PAGES = {
    "values": ("tpsim", ("",)),
    "manifold": ("tpsim", ("manifold",)),
    "learning": ("tpsim", ("learning",)),
    "retrieval": ("tpsim", ("retrieval",)),
    "control": ("tpsim", ("control",)),
    "projection": ("tpsim.projection", None),
    "rotation": ("tpsim.rotation", None),
    "plot": ("tpsim.plot", None),
    "data": ("tpsim.data", None),
    "robot": ("tpsim.lab", ("", "robot", "catalogue")),
    "world": ("tpsim.lab", ("world", "scene", "film")),
    "controllers": ("tpsim.lab", ("controllers", "control")),
    "task": ("tpsim.lab", ("task",)),
    "study": ("tpsim.lab", ("study", "campaign")),
    "deploy": ("tpsim.lab", ("deploy",)),
}
"""Pages of the reference: the room, and the folders whose things stand on it (None: all)."""


@cache
def listed(page: str) -> tuple[tuple[str, object], ...]:
    """Public names of a page with their values, in the order of the alphabet, classes first."""
    prefix, folders = PAGES[page]
    (room,) = (room for room in ROOMS if room.prefix == prefix)
    module = import_module(room.module)
    found = [(name, getattr(module, name)) for name in room.names]
    chosen = [(n, v) for n, v in found if folders is None or _folder(v) in folders]
    chosen.sort(key=lambda pair: (not inspect.isclass(pair[1]), pair[0].lower()))
    return tuple((f"{prefix}.{name}", value) for name, value in chosen)


def directives(page: str) -> str:
    """Directives of a page, for MyST."""
    lines = []
    for name, value in listed(page):
        if inspect.isclass(value):
            lines += [f".. autoclass:: {name}", "   :members:", ""]
        elif callable(value):
            lines += [f".. autofunction:: {name}", ""]
        else:
            lines += [f".. autodata:: {_home(name)}", "   :no-value:", ""]
    return "\n".join(["```{eval-rst}", *lines, "```"])


def _home(constant: str) -> str:
    """Where a constant that a room re-exports is defined, and documented."""
    prefix, _, name = constant.rpartition(".")
    (room,) = (room for room in ROOMS if room.prefix == prefix)
    source = inspect.getsource(import_module(room.module))
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and name in {alias.name for alias in node.names}:
            return f"{node.module}.{name}"
    return constant


def _folder(value: object) -> str:
    """Folder of the package in which a value is defined; empty for the values at its root."""
    home = (getattr(value, "__module__", None) or type(value).__module__).split(".")
    if isinstance(value, dict):
        home = type(next(iter(value.values()))).__module__.split(".")
    return home[1] if len(home) > 2 else ""
