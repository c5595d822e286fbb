"""The robots that tpsim brings: Baxter, and two arms in the horizontal plane."""

from collections.abc import Sequence

from tpsim.paths import MODELS
from tpsim.robot.robot import Robot

UNTUCKED = (
    *(-0.08, -1.0, -1.19, 1.94, 0.67, 1.03, -0.5),
    *(0.08, -1.0, 1.19, 1.94, -0.67, 1.03, 0.5),
)
"""Baxter's untucked posture: hands ahead, grippers down [rad]."""

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
