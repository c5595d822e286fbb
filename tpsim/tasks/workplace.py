"""Where arms work: between what, how far and how strongly, by the length of the arms."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from tpsim.border import Point
from tpsim.errors import ArgumentError
from tpsim.robot import anatomy
from tpsim.robot.robot import Robot
from tpsim.robot.views.joints import Spare
from tpsim.robot.views.view import View
from tpsim.scene import furniture
from tpsim.scene.bounds import box
from tpsim.scene.camera import Camera
from tpsim.scene.compose import Placed
from tpsim.scene.framing import framed
from tpsim.world.world import World

DEFAULT = "baxter"
"""The robot that tasks are performed by where nobody names another; its size is 1."""

LENGTH = 1.414
"""Length [m] of an arm of size 1: that for which a task's distances and forces are said."""

STANDS = 1.06
"""Height of the shoulders above the floor, in sizes [m]; a pedestal makes up for the rest."""


HANDS = ("left_hand", "right_hand")
"""Names of two hands."""

AROUND = 0.13
"""What is to be seen around hands and elbows, in sizes [m]: grippers, and what they hold."""

REDUNDANT = 6
"""Joints beyond which an arm has some to spare while its hand has a pose."""


def two_hands(robot: Robot, task: str) -> Robot:
    """The robot, if it has two hands.

    Raises
    ------
    ArgumentError
        If it has another number of them.
    """
    if tuple(robot.hands) != HANDS:
        has = ", ".join(robot.hands)
        raise ArgumentError(
            f"task '{task}' needs two hands, {' and '.join(HANDS)}; this robot has {has}"
        )
    return robot


def with_spare_joints(views: Mapping[str, View], robot: Robot) -> dict[str, View]:
    """Views without the postures of arms that have no joints to spare."""
    return {
        name: view
        for name, view in views.items()
        if not isinstance(view, Spare) or len(robot.index(view.names)) > REDUNDANT
    }


@lru_cache(maxsize=16)
def size_of(robot: Robot) -> float:
    """Size of a robot's arms: their mean length over ``LENGTH``."""
    lengths = [anatomy.length(robot, site) for site in robot.hands.values()]
    return round(float(np.mean(lengths)) / LENGTH, 2)


def size_for(name: str, stage: Callable[[], World]) -> float:
    """Size of the robot of a task by its name; the default one needs not be made for it."""
    return 1.0 if name == DEFAULT else size_of(stage().robot)


def gains_of(module: str, robot: str) -> Path:
    """File beside a module with the gains that were tuned for a robot."""
    name = re.sub(r"[^a-z0-9]+", "-", robot.lower()).strip("-")
    return Path(module).with_name(f"gains-{name}.json")


@dataclass(frozen=True)
class Workplace:
    """A place to work at.

    Distances and the forces of people go with the size, so that friction [Ns/m] and stiffness
    [N/m] mean the same to all.

    Parameters
    ----------
    middle : (3,)
        Between the shoulders [m].
    size : float
        Of the arms, :func:`size_of`.
    floor : float
        Height of the floor [m].
    foot : (3,)
        Lowest point of the robot, where it stands [m].
    """

    middle: Point
    size: float
    floor: float
    foot: Point

    @classmethod
    def of(cls, robot: Robot) -> "Workplace":
        """That of a robot, at both of its hands or its only one."""
        shoulders = np.array([anatomy.shoulder(robot, site) for site in robot.hands.values()])
        x, y, z = (np.round(shoulders.mean(axis=0), 2) + 0.0).tolist()
        size, lowest = size_of(robot), float(box(robot)[0][2])
        floor = min(lowest, z - STANDS * size)
        return cls((x, y, z), size, round(floor, 3), (x, 0.0, lowest))

    def at(self, x: float, y: float, z: float) -> Point:
        """A point (3,) [m] that is so far from between the shoulders of arms of size 1."""
        a, b, c = np.array(self.middle) + self.size * np.array([x, y, z])
        return float(a), float(b), float(c)

    def furniture(self, lowest: float = np.inf) -> dict[str, Placed]:
        """A table before the robot, and what the robot stands on where it has no feet.

        ``lowest`` is the height [m] of what the table has to be well below.
        """
        x, y, z = self.at(0.64, 0.0, -0.35)
        top = x, y, min(z, lowest - 0.4 * self.size)
        depth, width = 0.5 * self.size, 0.9 * self.size
        table = furniture.table(depth, width, round(top[2] - self.floor, 3))
        found = {"table": Placed(table, top)}
        if (height := self.foot[2] - self.floor) > 0.02:
            found["pedestal"] = Placed(furniture.pedestal(0.2 * self.size, height), self.foot)
        return found

    def cameras(self, hands: np.ndarray, shown: np.ndarray | None = None) -> dict[str, Camera]:
        """From where arms of this size are seen, with their hands about a point (3,) [m].

        Films see what is ``shown`` (k, 3) [m] whole, above their caption.
        """
        centre = 0.15 * np.array(self.middle) + 0.85 * hands

        def camera(about: np.ndarray, aim: Point, away: Point, fovy: float) -> Camera:
            target = about + self.size * np.array(aim)
            position = target + self.size * np.array(away)
            return Camera(tuple(position.tolist()), tuple(target.tolist()), fovy)

        hero = camera(centre, (-0.2, 0.03, 0.04), (2.08, 1.25, 0.55), 30)
        return {
            "hero": hero if shown is None else framed(hero, shown, AROUND * self.size),
            "hands": camera(hands, (-0.05, 0.04, 0.02), (0.8, 0.54, 0.21), 32),
            "side": camera(centre, (-0.17, -0.02, -0.08), (0.55, 2.9, 0.37), 32),
        }


def between(robot: Robot) -> np.ndarray:
    """Middle (3,) of a robot's hands at home [m]."""
    positions = [robot.at_home.pose(site).position for site in robot.hands.values()]
    return np.asarray(np.mean(positions, axis=0))
