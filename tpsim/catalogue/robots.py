"""The catalogue: every robot by the name that ``--robot`` takes."""

import difflib
from functools import lru_cache, partial
from pathlib import Path

from tpsim.catalogue import installed, menagerie, ours
from tpsim.catalogue.entry import Entry
from tpsim.catalogue.files import of_file
from tpsim.errors import ArgumentError
from tpsim.robot.robot import Robot

_ENTRIES = (
    Entry("baxter", "Baxter, two arms of seven joints", "Apache-2.0, kinematics BSD", ours.baxter),
    Entry("planar3", "An arm of three links in the plane", "Apache-2.0", ours.planar3),
    Entry("planar5", "A trunk with two arms in the plane", "Apache-2.0", ours.planar5),
    Entry(
        "openarm",
        "OpenArm v2, two arms of seven joints",
        "Apache-2.0",
        lambda: installed.openarm().robot(),
        "openarm_mujoco",
        "openarm-mujoco",
    ),
    Entry(
        "jaco",
        "Kinova Jaco, one arm of six joints",
        "Apache-2.0 (dm_control), model Kinova's",
        lambda: installed.jaco().robot(),
        "dm_control",
        "dm-control",
    ),
    Entry(
        "aloha",
        "Aloha's two ViperX 300, joints as they are identified",
        "Apache-2.0 (gym-aloha, joints Menagerie's)",
        lambda: installed.aloha().robot(),
        "gym_aloha",
        "gym-aloha",
    ),
    Entry(
        "viperx",
        "Aloha's two ViperX 300 as gym-aloha ships them",
        "Apache-2.0 (gym-aloha)",
        lambda: installed.viperx().robot(),
        "gym_aloha",
        "gym-aloha",
    ),
)

CATALOGUE = {entry.name: entry for entry in _ENTRIES}
"""Entries by name; Menagerie's robots are found by ``menagerie:NAME`` beside these."""

PREFIX = "menagerie:"


def entry(name: str) -> Entry:
    """The entry of a name.

    Raises
    ------
    ArgumentError
        If there is none; with the nearest names.
    """
    if name in CATALOGUE:
        return CATALOGUE[name]
    if name.startswith(PREFIX):
        return menagerie.entry(name.removeprefix(PREFIX))
    if Path(name).suffix.lower() in (".xml", ".urdf", ".py") or ".py:" in name:
        return Entry(name, "a file of yours", "", partial(of_file, name))
    names = [*CATALOGUE, *(PREFIX + arm for arm in menagerie.names())]
    near = difflib.get_close_matches(name, names, 3, 0.4)
    near += [n for n in names if name and name.lower() in n and n not in near][:3]
    hint = f"; did you mean {' or '.join(near)}?" if near else "."
    raise ArgumentError(
        f"unknown robot '{name}'{hint} There are {', '.join(CATALOGUE)}, menagerie:NAME, and files "
        "of yours (.xml, .urdf, my_arms.py:name); tpsim robots lists them"
    )


@lru_cache(maxsize=8)
def find(name: str) -> Robot:
    """The robot of a name, taken in once in a process; errors are those of :func:`entry`."""
    return entry(name).robot()
