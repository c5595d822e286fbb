"""The arms that point: what of each robot points, how it rests, where its objects may be."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tpsim.sim import scene

OBJECTS = ("first", "second")
"""The objects, in the order in which they are pointed at."""

APART = 0.4
"""Least angle between the two objects, seen from the site at rest [rad]."""


@dataclass(frozen=True)
class Pointer:
    """An arm that points.

    Parameters
    ----------
    scene : callable
        Gives the MJCF text of the robot with the objects ``OBJECTS``.
    joints, free : tuple of str
        The arm's, and those of them that can be chosen when the direction is given.
    site : str
        What points.
    axes : tuple of int
        Of the site: the one that points, then those across it.
    rest : (n,) tuple
        Posture of the whole robot at rest [rad].
    grips : tuple of (str, bool)
        Sites where the teacher's hands take hold, and whether they also turn them.
    sites : dict
        Sites that recordings keep, by name.
    place : callable
        Draws the position (3,) [m] of an object by a generator.
    camera : str
        From where a film shows it best.
    """

    scene: Callable[[], str]
    joints: tuple[str, ...]
    free: tuple[str, ...]
    site: str
    axes: tuple[int, ...]
    rest: tuple[float, ...]
    grips: tuple[tuple[str, bool], ...]
    sites: dict[str, str]
    place: Callable[[np.random.Generator], np.ndarray]
    camera: str

    def objects(self, rng, origin) -> dict[str, np.ndarray]:
        """Positions (3,) [m] of both objects, well apart as seen from an origin (3,)."""
        while True:
            first, second = (self.place(rng) for _ in OBJECTS)
            one, other = ((p - origin) / np.linalg.norm(p - origin) for p in (first, second))
            if one @ other < np.cos(APART):
                return dict(zip(OBJECTS, (first, second), strict=True))


def _on_the_floor(rng):
    """Somewhere on an arc before the planar arm."""
    bearing, distance = rng.uniform(-0.9, 0.9), rng.uniform(0.35, 0.5)
    return np.array([0.22 - distance * np.sin(bearing), 0.4 + distance * np.cos(bearing), -0.054])


def _on_the_table(rng):
    """Somewhere on the table under Baxter's left hand."""
    return np.array([*rng.uniform((0.45, -0.05), (0.8, 0.45)), -0.2])


PLANAR = Pointer(
    scene=scene.planar3,
    joints=("joint1", "joint2", "joint3"),
    free=("joint1", "joint2"),
    site="tip",
    axes=(0, 1),
    rest=(-0.3, 2.1, -0.23),
    grips=(("tip", True),),
    sites={"tip": "tip", "elbow": "joint2", "wrist": "joint3"},
    place=_on_the_floor,
    camera="hero",
)
"""The planar arm of three links: the first to the right, the others ahead, as in Fig. 10."""

BAXTER = Pointer(
    scene=lambda: scene.baxter(dict.fromkeys(OBJECTS, "marker"), held="beam"),
    joints=tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2")),
    free=tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w2")),
    site="left_gripper",
    axes=(2, 0, 1),
    rest=scene.READY,
    grips=(("left_gripper", True), ("left_elbow", False)),
    sites={"left_hand": "left_gripper", "left_elbow": "left_elbow"},
    place=_on_the_table,
    camera="side",
)
"""Baxter's left arm, whose gripper points along its own axis."""
