"""The plane of the planar arms: a floor with pucks on a half circle, seen from above."""

from collections.abc import Sequence

import numpy as np

from tpsim.robot.robot import Robot
from tpsim.scene.camera import Camera
from tpsim.scene.compose import Placed, world
from tpsim.world.world import World


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
