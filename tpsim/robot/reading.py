"""MJCF of a user, read and compiled: what fails is one line."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import mujoco

from tpsim import checks
from tpsim.errors import ArgumentError, one_line


@dataclass(frozen=True)
class Draft:
    """A robot as its file has it.

    Attributes
    ----------
    spec : MjSpec
        A spec that no one else holds.
    velocity_limit : mapping of str to float
        Velocity limits that the file states, rad/s or m/s, by joint.
    changes : tuple of str
        What reading changed or left out, in words.
    """

    spec: mujoco.MjSpec
    velocity_limit: Mapping[str, float] = field(default_factory=dict)
    changes: tuple[str, ...] = ()


def read(source: str | Path | mujoco.MjSpec) -> Draft:
    """Read a file or MJCF text, or copy a spec.

    Raises
    ------
    ArgumentError
        If there is no such file, or MuJoCo cannot parse it.
    """
    if isinstance(source, mujoco.MjSpec):
        return Draft(source.copy())
    if isinstance(source, str) and source.lstrip().startswith("<"):
        return Draft(parsed(lambda: mujoco.MjSpec.from_string(source), "the MJCF text"))
    path = checks.path("source", source)
    if path.suffix.lower() == ".urdf":
        raise ArgumentError(f"{path} is a URDF: read it by from_urdf")
    if not path.is_file():
        raise ArgumentError(
            f"no file {path}: pass the path of an MJCF file, MJCF text, or an MjSpec"
        )
    return Draft(parsed(lambda: mujoco.MjSpec.from_file(str(path)), str(path)))


def compiled(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Compile a spec.

    Raises
    ------
    ArgumentError
        If it does not compile; MuJoCo's reason, on one line.
    """
    try:
        return spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        raise ArgumentError(f"the robot does not compile: {_line(error)}") from None


def compiled_text(xml: str, assets: dict[str, bytes]) -> mujoco.MjModel:
    """Compile MJCF text; an ArgumentError with MuJoCo's reason where it does not."""
    try:
        return mujoco.MjModel.from_xml_string(xml, assets)
    except (ValueError, mujoco.FatalError) as error:
        raise ArgumentError(f"the robot does not compile with its limits: {_line(error)}") from None


def name_elements(spec: mujoco.MjSpec) -> None:
    """Give every joint, actuator and tendon without a name one that is not taken."""
    for kind, elements in (
        ("joint", spec.joints),
        ("actuator", spec.actuators),
        ("tendon", spec.tendons),
    ):
        names = {element.name for element in elements}
        free = (
            name
            for i in range(1, len(names) + len(elements) + 1)
            if (name := f"{kind}{i}") not in names
        )
        for element in elements:
            if not element.name:
                element.name = next(free)


def parsed(parse: Callable[[], mujoco.MjSpec], what: str) -> mujoco.MjSpec:
    """Return what ``parse`` reads, or say in one line why it cannot.

    Raises
    ------
    ArgumentError
        If MuJoCo cannot parse it; ``what`` names it.
    """
    try:
        return parse()
    except (ValueError, mujoco.FatalError) as error:
        raise ArgumentError(f"{what} cannot be read: {_line(error)}") from None


def _line(error: Exception) -> str:
    return one_line(error).removeprefix("Error: ")
