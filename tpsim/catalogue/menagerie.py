"""MuJoCo Menagerie's arms, by the package ``mujoco-menagerie``, which downloads them."""

from functools import partial
from importlib.util import find_spec

from tpsim.catalogue.entry import Entry
from tpsim.catalogue.hands import arms_in
from tpsim.errors import ArgumentError, one_line
from tpsim.robot.reading import read
from tpsim.robot.robot import Robot

PACKAGE = "mujoco-menagerie"

_ARMS = ("arm", "dual_arm")


def names() -> list[str]:
    """Names of Menagerie's arms; none without the package."""
    if find_spec("mujoco_menagerie") is None:
        return []
    import mujoco_menagerie

    return [robot.name for robot in mujoco_menagerie.robots() if robot.category in _ARMS]


def entry(name: str) -> Entry:
    """Entry of one of Menagerie's arms.

    Raises
    ------
    ArgumentError
        If the package is missing, or Menagerie has no such arm.
    """
    full = f"menagerie:{name}"
    if find_spec("mujoco_menagerie") is None:
        raise ArgumentError(f"robot '{full}' comes by {PACKAGE}: pip install {PACKAGE}")
    import mujoco_menagerie

    try:
        found = mujoco_menagerie.get(name)
    except mujoco_menagerie.MenagerieError as error:
        known = ", ".join(names())
        raise ArgumentError(f"menagerie: {one_line(error)} Its arms are {known}") from None
    if found.category not in _ARMS:
        kind = found.category.replace("_", " ")
        raise ArgumentError(f"'{full}' is a {kind}; tasks need arms: {', '.join(names())}")
    make = partial(_robot, name)
    return Entry(full, found.display_name, found.license, make, "mujoco_menagerie", PACKAGE)


def _robot(name: str) -> Robot:
    """The robot, downloaded when it is first used."""
    import mujoco_menagerie

    found = mujoco_menagerie.get(name)
    try:
        path = found.xml(found.default_model)
    except (mujoco_menagerie.MenagerieError, OSError) as error:
        raise ArgumentError(
            f"menagerie:{name} is not here and cannot be downloaded ({one_line(error)}); connect "
            "to a network once, or name a folder with Menagerie's models by MENAGERIE_ROOT"
        ) from None
    return arms_in(read(path).spec, f"menagerie:{name}").robot()
