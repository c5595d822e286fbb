"""Robots of a user's own file."""

import importlib.util
import sys
from dataclasses import replace
from pathlib import Path

from tpsim.catalogue.arms import Arms, draft_of
from tpsim.catalogue.hands import arms_in
from tpsim.errors import ArgumentError, one_line
from tpsim.robot.robot import Robot


def of_file(name: str) -> Robot:
    """Robot of ``my_arms.py:name``, or of an MJCF or URDF whose hands are found.

    Raises
    ------
    ArgumentError
        If there is no such file or name, it is no robot, or no hands are found.
    """
    path, _, inside = name.partition(".py:")
    if inside or name.endswith(".py"):
        return _of_python(Path(path.removesuffix(".py") + ".py"), inside or "robot")
    file = Path(name)
    if not file.is_file():
        raise ArgumentError(f"there is no file {name}; --robot takes a robot's file or name")
    draft = draft_of(file)
    arms = arms_in(draft.spec, name)
    stated = draft.velocity_limit
    return (replace(arms, velocity_limit=stated) if stated else arms).robot()


def _of_python(path: Path, name: str) -> Robot:
    if not path.is_file():
        raise ArgumentError(f"there is no file {path}; give my_arms.py:name")
    spec = importlib.util.spec_from_file_location(f"_robot_{path.stem}", path.resolve())
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise ArgumentError(
            f"{path} does not import: {type(error).__name__}: {one_line(error)}"
        ) from error
    if not hasattr(module, name):
        kinds = Arms, Robot
        there = [key for key, value in vars(module).items() if isinstance(value, kinds)]
        raise ArgumentError(
            f"there is no '{name}' in {path}; its arms and robots are {', '.join(there) or 'none'}"
        )
    value = getattr(module, name)
    if callable(value):
        value = value()
    if isinstance(value, Arms):
        value = value.robot()
    if not isinstance(value, Robot):
        raise ArgumentError(
            f"{path}:{name} is {type(value).__name__}; name lab.Arms, a Robot, or a function that "
            "returns one"
        )
    return value
