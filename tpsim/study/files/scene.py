"""The world of a run: ``scene.xml`` and ``assets/``, written whole, and checked before use."""

from collections.abc import Mapping
from pathlib import Path

import mujoco

from tpsim.errors import RecordingError, TpsimError
from tpsim.robot.description import Description
from tpsim.study.files import limits
from tpsim.study.files.inside import checksum, read_inside, read_text_inside
from tpsim.study.files.scene_check import check_scene
from tpsim.whole import write_bytes, write_text
from tpsim.world.world import World

SCENE, ASSETS = "scene.xml", "assets"


def write_world(folder: Path, world: World) -> tuple[str, dict[str, str]]:
    """Write the scene and its files; return the checksums of the text and of every file.

    Raises
    ------
    RecordingError
        If the scene could not be read back.
    """
    check_scene(world.xml, world.assets, folder / SCENE)
    sums = {}
    for name, content in world.assets.items():
        write_bytes(folder / ASSETS / name, content)
        sums[name] = checksum(content)
    # Its empty file was the claim to the folder.
    write_text(folder / SCENE, world.xml, replace=True)
    return checksum(world.xml.encode()), sums


def read_world(
    folder: Path, description: Description, scene: str, assets: Mapping[str, str]
) -> World:
    """Read the world of a run folder; nothing outside the folder is opened.

    Parameters
    ----------
    folder : Path
    description : Description
        Of the robot in the scene.
    scene : str
        Checksum of the text.
    assets : mapping of str to str
        Checksums of the files, by name.

    Raises
    ------
    RecordingError
        If a file was changed, the scene asks for more than it may, or it does not compile.
    """
    xml = read_text_inside(folder, SCENE, limits.TEXT)
    left, files = limits.ASSETS, {}
    for name in assets:
        files[name] = read_inside(folder / ASSETS, name, left)
        left -= len(files[name])
    found = {SCENE: checksum(xml.encode())} | {n: checksum(c) for n, c in files.items()}
    for name, expected in {SCENE: scene, **assets}.items():
        if found[name] != expected:
            raise RecordingError(
                f"{name} in {folder} was changed after the run; restore it or record again"
            )
    check_scene(xml, files, folder / SCENE)
    world = World(xml, description, files)
    _check_compiled(world, folder / SCENE)
    return world


def _check_compiled(world: World, where: object) -> None:
    try:
        model = world.model
    except (TpsimError, mujoco.FatalError) as error:
        raise RecordingError(f"{where}: {' '.join(str(error).split())}") from None
    if not limits.TIMESTEP[0] <= model.opt.timestep <= limits.TIMESTEP[1]:
        raise RecordingError(f"{where}: a time step of {model.opt.timestep} s")
    _check_description(world.description, model, where)


def _check_description(robot: Description, model: mujoco.MjModel, where: object) -> None:
    """What ``run.json`` says of the robot must be in the scene."""
    names = {
        "joints": (robot.joints, mujoco.mjtObj.mjOBJ_JOINT),
        "hands": (robot.hands.values(), mujoco.mjtObj.mjOBJ_SITE),
        "fixed": (robot.fixed, mujoco.mjtObj.mjOBJ_JOINT),
        "controls": (robot.controls, mujoco.mjtObj.mjOBJ_ACTUATOR),
    }
    for field, (found, kind) in names.items():
        for name in found:
            if mujoco.mj_name2id(model, kind, name) < 0:
                raise RecordingError(f"{where} has no '{name}' that robot.{field} names")
    n = len(robot.joints)
    if n == 0 or {len(robot.velocity_limit), len(robot.home), len(set(robot.joints))} != {n}:
        raise RecordingError(f"{where}: robot has {n} joints, and limits or home do not fit them")
