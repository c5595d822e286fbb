"""The teacher of transfer: carries out of one dock into the other, as fast as joints allow."""

import numpy as np

from tpsim.robot.robot import Robot
from tpsim.tasks.transfer import docks
from tpsim.world.people.demonstrator import TeacherName
from tpsim.world.teaching import Lesson
from tpsim.world.world import World


def lesson(
    world: World,
    rng: np.random.Generator,
    teacher: TeacherName = "firm",
    layout: docks.Layout = docks.STANDARD,
) -> Lesson:
    """Draw docks within the taught range, and how a person carries between them."""
    placed = docks.draw(world.robot, rng, layout=layout)
    start = docks.start_posture(world, placed, rng)
    return lesson_between(world, placed, start, rng, teacher, layout.pace)


def lesson_between(
    world: World,
    placed: docks.Docks,
    start: np.ndarray,
    rng: np.random.Generator,
    teacher: TeacherName = "firm",
    pace: float = 1.0,
) -> Lesson:
    """How a person carries between given docks, ``pace`` times as slowly as is usual."""
    slowly = docks.PACE[teacher] * pace
    seconds, rest = slowly * rng.uniform(*docks.SECONDS), slowly * docks.REST
    guide = docks.guide(world, placed, seconds, rng, teacher, rest)
    carries = arm(world.robot, docks.GRIPPER)
    held = tuple(joint for joint in world.robot.joints if joint not in carries)
    return Lesson(start, (guide,), seconds + 2 * rest, held, docks.at_rest(placed))


def arm(robot: Robot, site: str) -> tuple[str, ...]:
    """Joints of the arm of a hand."""
    return tuple(robot.joints[i] for i in robot.chain(site))
