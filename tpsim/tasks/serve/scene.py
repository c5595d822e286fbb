"""The scene of the task: where dock, sugar and bowl may be, and where the cup is to be at each.

A situation is a displacement of the three from home: four numbers each, three of position and one
of heading, all within -1 and 1 of the taught range.
"""

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np

from tpsim import rotation
from tpsim.catalogue.ours import baxter
from tpsim.pose import Pose
from tpsim.scene.compose import Placed, world
from tpsim.tasks.cup_and_sugar.home import KNOWN
from tpsim.tasks.workplace import Workplace, between
from tpsim.world.grasp import Grasp
from tpsim.world.object_path import ObjectPath
from tpsim.world.world import World

LEFT, RIGHT = "left_gripper", "right_gripper"
"""Sites of the hands: the left one carries the cup, the right one brings the sugar."""

NAMES = ("dock", "sugar_dock", "bowl")
"""The objects: where the cup stands, where the sugar lies, into what the cup is poured out."""

HOME = {
    "dock": ((0.66, 0.29, 0.02), -0.85),
    "sugar_dock": ((0.68, -0.24, 0.04), -2.2),
    "bowl": ((0.72, 0.07, -0.01), -1.05),
}
"""Position [m] and heading [rad] of each object, in Baxter's torso frame."""

RANGE = np.array([0.04, 0.04, 0.02, 0.25])
"""Where an object may be about home in taught situations, to both sides: [m] and [rad]."""

STANDS, LIES = (0.0, 0.0, 0.045), (0.0, 0.0, 0.009)
"""Middle of the cup in the dock, and of the sugar in its own [m]."""

RIM = 0.045
"""Height of the cup's rim above its middle [m]."""

RADIUS = 0.034
"""Within the cup's walls [m]."""

ABOVE = (0.0, 0.0, 0.095)
"""Place of the sugar above the cup from which it is let fall, in the cup's frame [m]."""

TILTED = 2.0
"""Angle by which the cup is tilted to be poured out [rad]."""

POURED = (0.0, -0.075, 0.135)
"""Place of the cup's middle in the bowl's frame while it is poured out [m]."""

POUR = Pose(rotation.exp([-TILTED, 0.0, 0.0]), np.array(POURED))
"""Pose of the cup in the bowl's frame while it is poured out: it tilts about its handle."""

CUP = Grasp(
    "mug",
    LEFT,
    (0.0, 0.0, 0.056),
    ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0)),
    stand="dock",
    on_stand=(0.0, 0.0, 0.045),
    target="dock",
    at_target=STANDS,
    opens=(0.008, 0.008, 0.07),
)
"""By its handle; it is let go where it stood."""

SUGAR = Grasp(
    "lump",
    RIGHT,
    (0.0, 0.0, 0.006),
    ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0)),
    stand="sugar_dock",
    on_stand=LIES,
    target="cup",
    at_target=ABOVE,
    closes=(0.008, 0.008, 0.2),
    opens=(0.02, 0.03, 3.2),
)
"""From above; it is let fall over the cup."""

GRASPS = {"cup": CUP, "sugar": SUGAR}

Placing = Mapping[str, Pose]
"""Where each object is in the world."""


def home() -> Placing:
    """Objects in the middle of the taught range."""
    return {
        name: Pose(rotation.exp([0.0, 0.0, heading]), np.array(position))
        for name, (position, heading) in HOME.items()
    }


def draw(rng: np.random.Generator) -> Placing:
    """Draw objects within the taught range."""
    placed = {}
    for name, (R, p) in home().items():
        *moved, turned = rng.uniform(-1, 1, 4) * RANGE
        placed[name] = Pose(rotation.exp([0.0, 0.0, turned]) @ R, p + moved)
    return placed


def at_rest(placed: Placing) -> tuple[ObjectPath, ...]:
    """The objects, standing still."""
    return tuple(ObjectPath.at(name, p.position, p.quaternion) for name, p in placed.items())


def at_start(paths: Sequence[ObjectPath]) -> Placing:
    """Where the objects are at the start."""
    return {path.name: path.first for path in paths}


def in_hand(grasp: Grasp, thing: Pose) -> Pose:
    """Pose of the hand that holds a thing at a pose."""
    return thing @ grasp.in_hand.inverse


@cache
def stage() -> World:
    """Baxter at a table, with dock, sugar and bowl."""
    robot = baxter()
    place = Workplace.of(robot)
    objects = {
        name: Placed(model, tuple(home()[name].position.tolist()))
        for name, model in zip(NAMES, ("saucer", "saucer", "bowl"), strict=True)
    }
    made = world(
        robot,
        objects=objects | place.furniture(),
        taken=GRASPS,
        floor=place.floor,
        cameras=place.cameras(between(robot)),
    )
    return made.with_home(np.array(KNOWN["baxter"]))
