"""Objects that move about a trunk: by turns together and too far apart for both hands."""

from dataclasses import dataclass

import numpy as np

from tpsim import rotation
from tpsim.tasks.tracking.body import SIDES, Body
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.script import minimum_jerk

VIAS = 5
"""Moments between which the objects move: together, apart, together, apart, together."""

SECONDS = 15.0
"""How long the objects move [s]."""

FLOOR = -0.054
"""Height of the objects [m]."""

PERIOD = 0.05
"""Time between two points of an object's path [s]."""

Range = tuple[float, float]
"""Least and most of a uniform distribution."""


@dataclass(frozen=True)
class Carousel:
    """Draws paths of the two objects.

    Parameters
    ----------
    heading : float
        Where the middle between the objects may be, about straight ahead, to both sides [rad].
    near : (float, float)
        Distances of objects from the trunk's foot while they are together [m].
    far : (float, float)
        The same while they are apart [m].
    together : (float, float)
        Angle between objects that are together, as a share of what both can be reached with.
    apart : (float, float)
        How much more it is than that while they are apart [rad].
    """

    heading: float = 0.8
    near: Range = (0.55, 0.75)
    far: Range = (0.72, 0.88)
    together: Range = (0.3, 0.7)
    apart: Range = (0.3, 0.6)

    def vias(self, body: Body, rng: np.random.Generator) -> np.ndarray:
        """Heading [rad], angle between the objects [rad], distances of both [m]: (VIAS, 4)."""
        vias = np.empty((VIAS, 4))
        vias[:, 0] = np.pi / 2 + rng.uniform(-self.heading, self.heading, VIAS)
        for k, via in enumerate(vias):
            via[2:] = rng.uniform(*(self.far if k % 2 else self.near), 2)
            both = body.half_width(via[2:]).sum()
            via[1] = (
                both + rng.uniform(*self.apart) if k % 2 else both * rng.uniform(*self.together)
            )
        return vias


def points(vias: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Places of both objects (2, T, 2) [m] at times (T,), minimum jerk through the vias."""
    heading, between, *distances = minimum_jerk(np.linspace(0, SECONDS, VIAS), vias)(times).T
    bearings = heading + between / 2, heading - between / 2
    return np.array(
        [
            np.stack([r * np.cos(bearing), r * np.sin(bearing)], axis=-1)
            for bearing, r in zip(bearings, distances, strict=True)
        ]
    )


def paths(places: np.ndarray) -> tuple[ObjectPath, ...]:
    """Paths of both objects through places (2, V, 2) [m], one every ``PERIOD``.

    The objects turn as on a carousel about the trunk.
    """
    found = []
    for side, place in zip(SIDES, places, strict=True):
        turn = np.zeros((len(place), 3))
        turn[:, 2] = np.unwrap(np.arctan2(place[:, 1], place[:, 0]))
        quaternions = rotation.continuous(rotation.to_quaternion(rotation.exp(turn)))
        positions = np.column_stack([place, np.full(len(place), FLOOR)])
        times = PERIOD * np.arange(len(place))
        arrays = positions.tolist(), times.tolist(), quaternions.tolist()
        found.append(ObjectPath(f"{side}_object", *arrays))
    return tuple(found)
