"""What a real robot senses, checked: joints, and objects as its cameras see them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import read
from tpsim.checks import array_of, entries, finite_array, number
from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.robot.objects import Objects
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.robot.views.direction import Bearing
from tpsim.robot.views.sites import Object

Seen = Pose | Sequence[ArrayLike]
"""A pose; or position (3,) [m] and quaternion (w, x, y, z), and, where the object moves, its
velocity (6,): linear [m/s] over angular [rad/s], in the world's axes."""

UNIT = 1e-6
"""Deviation of a quaternion's length from one up to which it is taken as it is."""

BEYOND = 1e9
"""Angle [rad] and speed [rad/s] of which no encoder speaks the truth."""


def objects_in(value: object) -> Iterator[str]:
    """Names of the objects that the views in a recipe look from or at."""
    if isinstance(value, Object):
        yield value.name
    if isinstance(value, Bearing):
        yield value.target
    if is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            found = getattr(value, field.name)
            if field.name == "objects":
                yield from found
            else:
                yield from objects_in(found)
    elif isinstance(value, Mapping):
        yield from objects_in(tuple(value.values()))
    elif isinstance(value, tuple | list):
        for item in value:
            yield from objects_in(item)


def sensed(
    robot: Robot,
    q: ArrayLike,
    dq: ArrayLike,
    objects: Objects | Mapping[str, Seen],
    time: float,
    needed: Sequence[str],
) -> State:
    """State of a robot from what its sensors say.

    Raises
    ------
    ArgumentError
        Wrong shapes, what is not finite, or an object that is missing; one line.
    """
    read("objects", objects, Mapping)
    if missing := [name for name in needed if name not in objects]:
        raise ArgumentError(
            f"object '{missing[0]}' is missing; the policy needs the poses of {', '.join(needed)}"
        )
    known = objects if isinstance(objects, Objects) else _objects(objects)
    for name, part in (("q", q), ("dq", dq)):
        seen = array_of(name, part)
        if seen.dtype.kind == "f" and seen.shape == (robot.n,):
            plausible = np.abs(seen.astype(float, copy=False)) < BEYOND
            if not plausible.all():
                joint = int(np.argmin(plausible))
                raise ArgumentError(
                    f"{name}: the state of joint '{robot.joints[joint]}' is {seen[joint]:.3g}, not "
                    "finite or beyond all measure; stop the robot"
                )
    return robot.at(q, dq, known, number("time", time, least=0))


def _objects(given: Mapping[str, Seen]) -> Objects:
    rows = {name: row for row, name in enumerate(given)}
    found = [_checked(name, seen) for name, seen in given.items()]
    positions = np.array([f[0] for f in found]).reshape(-1, 3)
    quaternions = np.array([f[1] for f in found]).reshape(-1, 4)
    moves = any(f[2] is not None for f in found)
    twists = np.array([np.zeros(6) if f[2] is None else f[2] for f in found]) if moves else None
    return Objects(rows, positions, quaternions, twists)


def _checked(name: str, seen: Seen) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    if isinstance(seen, Pose):
        known = seen.checked(f"objects[{name!r}]")
        parts: list[np.ndarray] = [known.position, known.quaternion]
    else:
        parts = [
            finite_array(f"objects[{name!r}]", part)
            for part in entries("objects", seen, tables=False)
        ]
    shapes = [part.shape for part in parts]
    if shapes not in ([(3,), (4,)], [(3,), (4,), (6,)]):
        raise ArgumentError(
            f"object '{name}' has parts of shapes {shapes}; give a position (3,), a quaternion "
            "(4,) and, where it moves, a velocity (6,)"
        )
    length = float(np.linalg.norm(parts[1]))
    if not all(np.isfinite(part).all() for part in parts) or not 0.5 < length < 2:
        raise ArgumentError(
            f"object '{name}' is at {parts[0].tolist()} turned by {parts[1].tolist()}: not finite, "
            "or no unit quaternion (w, x, y, z)"
        )
    turned = parts[1] if abs(length - 1) < UNIT else parts[1] / length
    return parts[0], turned, parts[2] if len(parts) == 3 else None
