"""The teacher of tracking: leads both hands after their objects, as one of the teachings has it."""

from dataclasses import dataclass, replace

import numpy as np

from tpsim.tasks.tracking.body import SIDES, Body, Teaching
from tpsim.tasks.tracking.carousel import PERIOD, SECONDS, Carousel, paths, points
from tpsim.world.people.care import Care
from tpsim.world.people.demonstrator import DEMONSTRATORS, Demonstrator, TeacherName
from tpsim.world.people.guide import Guide, HandPath
from tpsim.world.people.script import wandering
from tpsim.world.people.sight import Sight, foreseen
from tpsim.world.teaching import Lesson
from tpsim.world.world import World

SHORT, SMOOTH = 0.003, 0.003
"""How much of an arm's length the teacher keeps it from being stretched, and how softly [m]."""

PACE = {"firm": 1.0, "human": 2.0}
"""How many times longer the objects take while a person shows than in the task: one who sees late
follows slowly."""

FADE = 0.5
"""Time [s] over which a teacher's hand begins to wander."""

SECOND = 0.5
"""How much a hand matters to the teacher while the other one comes first."""


@dataclass(frozen=True)
class TrackingTeacher:
    """Draws lessons.

    Parameters
    ----------
    teaching : str
        Whose object counts more.
    carousel : Carousel
        How the objects move.
    teacher : str
        Whose hands lead the robot's.
    """

    teaching: Teaching
    carousel: Carousel
    teacher: TeacherName = "firm"

    def __call__(self, world: World, rng: np.random.Generator) -> Lesson:
        """Draw paths of the objects, and how a person leads both hands after them."""
        body, h, pace = Body.of(world.robot), world.timestep, PACE[self.teacher]
        clock = h * np.arange(round(pace * SECONDS / h))
        places = points(self.carousel.vias(body, rng), clock / pace)
        who = DEMONSTRATORS[self.teacher]
        sights = who.sights(rng, 2)
        expected = [
            place if sight is None else foreseen(place, h, sight.delay)
            for place, sight in zip(places, sights, strict=True)
        ]
        angle, _ = body.lean(expected[0], expected[1], self.teaching)
        guides = tuple(
            _guide(
                side, body.led(angle, place, SHORT, SMOOTH), h, rng, who, sight, self._care(side)
            )
            for side, place, sight in zip(SIDES, expected, sights, strict=True)
        )
        start = body.posture(angle[0], *places[:, 0])
        return Lesson(start, guides, pace * SECONDS, objects=paths(places[:, :: round(PERIOD / h)]))

    def _care(self, side: str) -> Care:
        """A hand matters in the plane, fully unless the other one comes first."""
        matters = 1.0 if self.teaching in (side, "compromise") else SECOND
        return Care((matters, matters, 0.0))


def _guide(
    side: str,
    places: np.ndarray,
    timestep: float,
    rng: np.random.Generator,
    who: Demonstrator,
    sight: Sight | None,
    care: Care,
) -> Guide:
    """A person's hand that leads one of the robot's along places (T, 2) [m]."""
    steps = len(places)
    positions, velocities = np.zeros((2, steps, 3))
    velocities[:, :2] = np.gradient(places, timestep, axis=0)
    twist = np.hstack([velocities, np.zeros((steps, 3))])
    strayed, _ = wandering(twist, timestep, rng, who.variation, care)
    fade = np.minimum(timestep / FADE * np.arange(steps), 1.0)[:, None]
    positions[:, :2] = places + fade * strayed[:, :2]
    path = HandPath(
        positions,
        np.broadcast_to(np.eye(3), (steps, 3, 3)),
        velocities,
        np.zeros((steps, 3)),
    )
    grip = replace(who.grip, angular_stiffness=0.0, angular_damping=0.0)
    return Guide(f"{side}_guide", f"{side}_hand", grip, path, sight=sight, care=care)
