"""The teacher of tracking: leads both hands after their objects, as one of the teachings has it."""

from dataclasses import dataclass

import numpy as np

from tpsim.tasks.tracking.body import SIDES, Body, Teaching
from tpsim.tasks.tracking.carousel import PERIOD, SECONDS, Carousel, paths, points
from tpsim.world.people.guide import Grip, Guide, HandPath
from tpsim.world.people.script import Variation, wandering
from tpsim.world.teaching import Lesson
from tpsim.world.world import World

SHORT, SMOOTH = 0.003, 0.003
"""How much of an arm's length the teacher keeps it from being stretched, and how softly [m]."""

FADE = 0.5
"""Time [s] over which a teacher's hand begins to wander."""


@dataclass(frozen=True)
class TrackingTeacher:
    """Draws lessons.

    Parameters
    ----------
    teaching : str
        Whose object counts more.
    carousel : Carousel
        How the objects move.
    """

    teaching: Teaching
    carousel: Carousel

    def __call__(self, world: World, rng: np.random.Generator) -> Lesson:
        """Draw paths of the objects, and how a person leads both hands after them."""
        body, h = Body.of(world.robot), world.timestep
        places = points(self.carousel.vias(body, rng), h * np.arange(round(SECONDS / h)))
        angle, _ = body.lean(places[0], places[1], self.teaching)
        guides = tuple(
            _guide(side, body.led(angle, place, SHORT, SMOOTH), h, rng)
            for side, place in zip(SIDES, places, strict=True)
        )
        start = body.posture(angle[0], *places[:, 0])
        return Lesson(start, guides, SECONDS, objects=paths(places[:, :: round(PERIOD / h)]))


def _guide(side: str, places: np.ndarray, timestep: float, rng: np.random.Generator) -> Guide:
    """A person's hand that leads one of the robot's along places (T, 2) [m]."""
    steps = len(places)
    strayed, _ = wandering(steps, timestep, rng, Variation())
    fade = np.minimum(timestep / FADE * np.arange(steps), 1.0)[:, None]
    positions, velocities = np.zeros((2, steps, 3))
    positions[:, :2] = places + fade * strayed[:, :2]
    velocities[:, :2] = np.gradient(places, timestep, axis=0)
    path = HandPath(
        positions,
        np.broadcast_to(np.eye(3), (steps, 3, 3)),
        velocities,
        np.zeros((steps, 3)),
    )
    grip = Grip(angular_stiffness=0.0, angular_damping=0.0)
    return Guide(f"{side}_guide", f"{side}_hand", grip, path)
