"""The robots of the built-in tasks: Baxter, and two arms in the horizontal plane."""

from collections.abc import Sequence

import numpy as np

from tpsim.paths import MODELS
from tpsim.robot.robot import Robot
from tpsim.scene.compose import Camera, Placed, world
from tpsim.world.world import World

UNTUCKED = (
    *(-0.08, -1.0, -1.19, 1.94, 0.67, 1.03, -0.5),
    *(0.08, -1.0, 1.19, 1.94, -0.67, 1.03, 0.5),
)
"""Baxter's untucked posture: hands ahead, grippers down [rad]."""

FLOOR = -0.93
"""Height of the floor below Baxter's torso [m]."""

TABLE = {"table": Placed("table", (0.7, 0.0, -0.22))}
"""What Baxter stands at."""

CAMERAS = {
    "hero": Camera((2.4, 1.3, 0.75), (0.32, 0.05, 0.2), 30),
    "hands": Camera((1.35, 0.6, 0.4), (0.55, 0.06, 0.19), 32),
    "side": Camera((0.9, 2.9, 0.45), (0.35, 0.0, 0.08), 32),
}
"""From where Baxter is seen."""

_BAXTER_SPEEDS = {".*_[se][01]": 1.5, ".*_w[012]": 4.0}


def baxter(home: Sequence[float] = UNTUCKED) -> Robot:
    """Baxter with two arms of seven joints and hands ``left_hand``, ``right_hand``.

    Kinematics, inertias and limits are Rethink Robotics'; armature is ours.
    """
    return Robot.from_mjcf(
        MODELS / "baxter.xml",
        {"left_hand": "left_gripper", "right_hand": "right_gripper"},
        velocity_limit=_BAXTER_SPEEDS,
        home=home,
    )


def planar3(home: Sequence[float] = (1.8, -0.9, -0.6)) -> Robot:
    """An arm of three links in the horizontal plane, whose hand is ``tip``."""
    return Robot.from_mjcf(MODELS / "planar3.xml", {"tip": "tip"}, velocity_limit=3.0, home=home)


def planar5(home: Sequence[float] = (1.5707963267948966, 0.9, -1.1, -0.9, 1.1)) -> Robot:
    """A trunk with two arms of two links in the horizontal plane: hands ``left``, ``right``."""
    return Robot.from_mjcf(
        MODELS / "planar5.xml",
        {"left": "left_hand", "right": "right_hand"},
        velocity_limit=3.0,
        home=home,
    )


def on_the_floor(robot: Robot, objects: Sequence[str], fovy: float) -> World:
    """A planar robot on the floor, pucks on a half circle before it, cameras above."""
    angles = np.linspace(np.pi, 0, len(objects) + 2)[1:-1]
    pucks = {
        name: Placed("marker", (0.7 * float(np.cos(angle)), 0.7 * float(np.sin(angle)), -0.054))
        for name, angle in zip(objects, angles, strict=True)
    }
    cameras = {
        "hero": Camera((0.0, -0.95, 1.9), (0.0, 0.27, 0.0), fovy),
        "top": Camera((0.0, 0.29, 2.5), (0.0, 0.3, 0.0), fovy),
    }
    return world(robot, objects=pucks, floor=-0.06, cameras=cameras)
