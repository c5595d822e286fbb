"""Imports go down only: the floors of the design, read from the source."""

import ast
from pathlib import Path

import pytest

import tpsim

PACKAGE = Path(tpsim.__file__).parent

# A module may import its own room and the floors below; rooms on one floor do not know each other.
FLOORS = (
    "root",
    "manifold",
    "learning",
    ("retrieval", "control"),
    "plot",
    "robot",
    "world",
    "controllers",
    ("scene", "film", "catalogue"),
    "task",
    "study",
    ("tasks", "deploy"),
    "campaign",
    ("lab", "section8", "data", "bench", "gallery"),
    "play",
    "cli",
)
SIMULATION = {"mujoco", "pinocchio", "mink", "dm_control", "dm_env", "gymnasium"}
PLAIN = {"numpy", "scipy"}
ROOMS = {"lab": "lab", "gallery": "gallery", "__main__": "cli", "__init__": "root"}


def height(room):
    return next(i for i, floor in enumerate(FLOORS) if room == floor or room in floor)


def room_of(module):
    """Room of ``tpsim.a.b``: a folder's name, or that of a module that stands for a room."""
    name = [*module.split("."), "__init__"][1]
    if (PACKAGE / name).is_dir():
        return name
    return ROOMS.get(name, "root")


def imports(source, module):
    """Modules that a source imports anywhere, with their lines; ``from a import b`` gives a.b."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node.lineno) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = module.split(".")[: -node.level] if node.level else []
            base = ".".join([*above, *filter(None, [node.module])])
            yield from ((f"{base}.{alias.name}", node.lineno) for alias in node.names)


def offences(source, module):
    """What a source must not import, one line each."""
    room = room_of(module)
    for target, line in imports(source, module):
        package = target.split(".")[0]
        if package == "tpsim":
            other = room_of(target)
            allowed = other == room or height(other) < height(room)
            # tpsim/mathematics.py shows the mathematics flat.
            allowed |= module == "tpsim.mathematics" and height(other) < height("plot")
        else:
            allowed = package not in SIMULATION or height(room) >= height("robot")
        if not allowed:
            yield f"{module}:{line}: {room} must not import {target}"


def modules():
    for path in sorted(PACKAGE.rglob("*.py")):
        yield ".".join(["tpsim", *path.relative_to(PACKAGE).with_suffix("").parts]), path


def test_no_module_imports_a_higher_floor():
    assert [o for name, path in modules() for o in offences(path.read_text(), name)] == []


WHERE_ASKED = {"tpsim.control.constrained": {"qpsolvers"}}
"""Imported where constraints are asked for: a quadratic programme needs a solver."""


@pytest.mark.parametrize("room", ["manifold", "learning", "retrieval", "control"])
def test_the_mathematics_needs_numpy_and_scipy_alone(room):
    import sys

    allowed = PLAIN | {"tpsim"} | sys.stdlib_module_names
    foreign = [
        f"{name}:{line}: {target}"
        for name, path in modules()
        if room_of(name) in (room, "root")
        for target, line in imports(path.read_text(), name)
        if target.split(".")[0] not in allowed | WHERE_ASKED.get(name, set())
    ]
    assert foreign == []


@pytest.mark.parametrize(
    ("module", "source", "words"),
    [
        ("tpsim.gaussian", "import numpy\nimport tpsim.learning.em", "tpsim.gaussian:2: root"),
        ("tpsim.retrieval.gmr", "from tpsim.control import lqt", "retrieval must not import"),
        ("tpsim.control.lqt", "def f():\n    import mujoco", "tpsim.control.lqt:2"),
        ("tpsim.robot.robot", "from tpsim import tasks", "robot must not import tpsim.tasks"),
        ("tpsim.task.task", "from ..study import plot", "task must not import"),
        ("tpsim.study.plot", "from tpsim.cli import main", "study must not import"),
    ],
)
def test_an_offence_is_named_with_its_line(module, source, words):
    (offence,) = offences(source, module)
    assert words in offence


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("tpsim.robot.robot", "import mujoco, pinocchio\nfrom tpsim.control import impedance"),
        ("tpsim.cli", "from tpsim.campaign import run"),
        ("tpsim.learning.em", "from tpsim.gaussian import Gaussian\nfrom .gmm import GMM"),
        ("tpsim.mathematics", "from tpsim.learning.gmm import GMM as GMM"),
    ],
)
def test_what_the_design_allows_passes(module, source):
    assert list(offences(source, module)) == []
