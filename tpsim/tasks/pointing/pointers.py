"""The arms that point: which of their axes points, how they are led, where objects may be."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from tpsim.catalogue.ours import planar3
from tpsim.catalogue.robots import find
from tpsim.robot import anatomy
from tpsim.robot.indices import Chain, Names
from tpsim.robot.robot import Robot
from tpsim.robot.views.direction import Bearing, Direction
from tpsim.robot.views.joints import Joints, Spare
from tpsim.robot.views.sites import Object, Site
from tpsim.robot.views.view import View
from tpsim.scene.compose import Held, Placed
from tpsim.tasks.one_hand import GRIPPER, furnished, one_handed
from tpsim.tasks.planar import on_the_floor
from tpsim.tasks.workplace import size_of
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
    joints : str or Chain
        The arm's.
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
    size : float
        Of the arm, with which go the forces of pushes, and how far it is led aside.
    """

    joints: Names
    free: tuple[str, ...]
    axis: Direction
    grips: Mapping[str, bool]
    sites: Mapping[str, str]
    place: Callable[[np.random.Generator], np.ndarray]
    camera: str
    seen_to: Care = EVERYTHING
    size: float = 1.0

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


def planar_world() -> World:
    """The planar arm, the first link to the right and the others ahead, as in Fig. 10."""
    return on_the_floor(planar3(home=(-0.3, 2.1, -0.23)), OBJECTS, fovy=27)


def _before_the_arm(rng: np.random.Generator) -> np.ndarray:
    """Somewhere on an arc before the planar arm."""
    bearing, distance = rng.uniform(-0.9, 0.9), rng.uniform(0.35, 0.5)
    return np.array([0.22 - distance * np.sin(bearing), 0.4 + distance * np.cos(bearing), -0.054])


PLANAR = Pointer(
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

SPOTS = {"first": (0.54, 0.04, -0.33), "second": (0.54, -0.16, -0.33)}
"""Where objects are at first, from the shoulder of an arm of size 1 [m]."""

NEAREST, FARTHEST = (0.39, -0.31, -0.33), (0.74, 0.19, -0.33)
"""Corners of the rectangle in which objects are put, likewise: on the table under the hand."""


@lru_cache(maxsize=4)
def spatial_world(name: str) -> World:
    """A robot at its table with a beam in its left gripper, which shows where it points."""
    robot = one_handed(find(name), name)
    size, shoulder = size_of(robot), _shoulder(robot)
    markers = {
        each: Placed("marker", tuple((shoulder + size * np.array(spot)).tolist()))
        for each, spot in SPOTS.items()
    }
    return furnished(robot, name, markers, {"beam": Held("beam", GRIPPER, (0.0, 0.0, 0.006))})


@lru_cache(maxsize=4)
def spatial(robot: Robot) -> Pointer:
    """The left arm of a robot, or its only one, whose gripper points along its own axis."""
    size, shoulder = size_of(robot), _shoulder(robot)

    def place(rng: np.random.Generator) -> np.ndarray:
        # Drawn in the plane alone.
        x, y = rng.uniform(*((shoulder + size * np.array(c))[:2] for c in (NEAREST, FARTHEST)))
        return np.array([x, y, shoulder[2] + size * NEAREST[2]])

    axis = Site(GRIPPER).axis("z", across="xy")
    return Pointer(
        joints=Chain(GRIPPER),
        free=_free(robot, axis),
        axis=axis,
        grips={GRIPPER: True, "left_elbow": False},
        sites={"left_hand": GRIPPER, "left_elbow": "left_elbow"},
        place=place,
        camera="side",
        size=size,
    )


def _shoulder(robot: Robot) -> np.ndarray:
    return np.round(anatomy.shoulder(robot, GRIPPER), 2)


def _free(robot: Robot, axis: Direction) -> tuple[str, ...]:
    """Joints of an arm but the last two that turn what points, each its own way."""
    chain = robot.chain(axis.site)
    turned = axis(robot.at_home).jacobian[:, chain]
    pairs = [(i, j) for j in range(len(chain)) for i in range(j)]
    apart = [abs(float(np.linalg.det(turned[:, pair]))) for pair in pairs]
    enough = [pair for pair, sine in zip(pairs, apart, strict=True) if sine > 0.5 * max(apart)]
    last = max(enough, key=lambda pair: pair[::-1])
    return tuple(robot.joints[i] for k, i in enumerate(chain) if k not in last)
