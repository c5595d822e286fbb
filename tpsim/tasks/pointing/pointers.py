"""The arms that point: which of their axes points, how they are led, where objects may be."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from tpsim.catalogue.ours import baxter, planar3
from tpsim.robot.views.direction import Bearing, Direction
from tpsim.robot.views.joints import Joints, Spare
from tpsim.robot.views.sites import Object, Site
from tpsim.robot.views.view import View
from tpsim.scene.compose import Held, Placed, world
from tpsim.tasks.planar import on_the_floor
from tpsim.tasks.workplace import Workplace
from tpsim.world.people.care import EVERYTHING, Care
from tpsim.world.world import World

OBJECTS = ("first", "second")
"""The objects, in the order in which they are pointed at."""

APART = 0.4
"""Least angle between the two objects, seen from the site at rest [rad]."""

DAMPING = 1e-3
"""Singular value of the direction's Jacobian below which its nullspace grows [rad/rad]."""


@dataclass(frozen=True)
class Pointer:
    """An arm that points; the robot rests at its home posture.

    Parameters
    ----------
    world : callable
        Makes the robot with the objects ``OBJECTS``.
    joints : str
        The arm's, as a regular expression.
    free : tuple of str
        Joints whose posture is observed: as many as the arm has to spare while it points.
    axis : Direction
        What points.
    grips : mapping of str to bool
        Sites where the teacher's hands take hold, and whether they also turn them.
    sites : mapping of str to str
        Sites that recordings keep, by name.
    place : callable
        Draws the position (3,) [m] of an object by a generator.
    camera : str
        From where a film shows it best.
    seen_to : Care
        What a person who points with it sees to: all that the arm can do.
    """

    world: Callable[[], World]
    joints: str
    free: tuple[str, ...]
    axis: Direction
    grips: Mapping[str, bool]
    sites: Mapping[str, str]
    place: Callable[[np.random.Generator], np.ndarray]
    camera: str
    seen_to: Care = EVERYTHING

    def bearing(self, name: str) -> Bearing:
        """Direction towards an object, zero while the arm points at it, Eq. (41)."""
        return self.axis.towards(Object(name))

    def posture(self, origin: np.ndarray | None = None) -> Spare:
        """Posture of the arm beneath its direction, Eq. (42), from an origin; home by default."""
        return Joints(self.joints).spare(self.axis, origin=origin, free=self.free, damping=DAMPING)

    @property
    def views(self) -> Mapping[str, View]:
        """Candidate frames: posture, direction in the base, direction towards each object."""
        return {
            "posture": self.posture(),
            "direction in base": self.axis,
            **{f"direction to {name}": self.bearing(name) for name in OBJECTS},
        }

    def objects(self, rng: np.random.Generator, origin: np.ndarray) -> dict[str, np.ndarray]:
        """Positions (3,) [m] of both objects, well apart as seen from an origin (3,)."""
        while True:
            first, second = (self.place(rng) for _ in OBJECTS)
            one, other = ((p - origin) / np.linalg.norm(p - origin) for p in (first, second))
            if one @ other < np.cos(APART):
                return dict(zip(OBJECTS, (first, second), strict=True))


def _planar_world() -> World:
    """The planar arm, the first link to the right and the others ahead, as in Fig. 10."""
    return on_the_floor(planar3(home=(-0.3, 2.1, -0.23)), OBJECTS, fovy=27)


def _before_the_arm(rng: np.random.Generator) -> np.ndarray:
    """Somewhere on an arc before the planar arm."""
    bearing, distance = rng.uniform(-0.9, 0.9), rng.uniform(0.35, 0.5)
    return np.array([0.22 - distance * np.sin(bearing), 0.4 + distance * np.cos(bearing), -0.054])


def _baxter_world() -> World:
    """Baxter at its table with a beam in the left gripper, which shows where it points."""
    spots = ((0.6, 0.3, -0.2), (0.6, 0.1, -0.2))
    markers = {n: Placed("marker", spot) for n, spot in zip(OBJECTS, spots, strict=True)}
    place = Workplace.of(robot := baxter())
    return world(
        robot,
        objects=markers | place.furniture(),
        held={"beam": Held("beam", "left_gripper", (0.0, 0.0, 0.006))},
        floor=place.floor,
        cameras=place.cameras(),
    )


def _on_the_table(rng: np.random.Generator) -> np.ndarray:
    """Somewhere on the table under Baxter's left hand."""
    return np.array([*rng.uniform((0.45, -0.05), (0.8, 0.45)), -0.2])


PLANAR = Pointer(
    world=_planar_world,
    joints="joint[123]",
    free=("joint1", "joint2"),
    axis=Site("tip").axis("x", across="y"),
    grips={"tip": True},
    sites={"tip": "tip", "elbow": "joint2", "wrist": "joint3"},
    place=_before_the_arm,
    camera="hero",
    seen_to=Care((1, 1, 0), (0, 0, 1)),
)
"""The planar arm of three links."""

BAXTER = Pointer(
    world=_baxter_world,
    joints="left_.*",
    free=tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w2")),
    axis=Site("left_gripper").axis("z", across="xy"),
    grips={"left_gripper": True, "left_elbow": False},
    sites={"left_hand": "left_gripper", "left_elbow": "left_elbow"},
    place=_on_the_table,
    camera="side",
)
"""Baxter's left arm, whose gripper points along its own axis."""
