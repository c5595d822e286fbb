"""Behaviour 2: the right hand keeps a sugar cube above the cup (Fig. 9, second sequence)."""

import numpy as np

from tpsim.pose import Pose
from tpsim.robot.indices import Chain
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Site
from tpsim.task.task import Goal
from tpsim.tasks.cup_and_sugar import cup
from tpsim.tasks.cup_and_sugar.hands import Hands, Workspace
from tpsim.world.people.care import Care
from tpsim.world.people.demonstrator import TeacherName
from tpsim.world.teaching import Lesson
from tpsim.world.world import World

SUGAR, RIGHT = Site("sugar"), Site("right_gripper")

ABOVE = SUGAR.seen_from(cup.CUP)
"""The sugar as the cup sees it."""

VIEWS = {
    "cup in base": cup.VIEWS["cup in base"],
    "sugar in base": SUGAR.pose,
    "sugar from cup": ABOVE.pose,
    "left posture": cup.VIEWS["left posture"],
    "right posture": Joints(Chain(RIGHT.name)).spare(RIGHT.pose),
}
"""Candidate frames: both hands in the base, one seen from the other (Eq. 41), both postures."""

TAUGHT = Workspace(position=(0.13, 0.16, 0.12), yaw=0.5, tilt=0.2)
"""Where the teacher leads the cup meanwhile: tilted too, since only the sugar's place counts."""

GRIP = Workspace(position=(0.0, 0.0, 0.0), yaw=0.5, tilt=0.25)
"""How the teacher turns the sugar about its place: freely."""


PLACE = Care(position=(1, 1, 1))
"""What the teacher sees to: where the sugar is above the cup, however it is turned."""


def goals(place: np.ndarray) -> dict[str, Goal]:
    """What the teacher keeps to: the sugar at its place (3,) above the cup [m]."""
    return {"offset": Goal(ABOVE.position.minus(place), 0.015)}


def lesson(
    world: World,
    rng: np.random.Generator,
    workspace: Workspace = TAUGHT,
    *,
    teacher: TeacherName = "firm",
    room: float = 1.0,
) -> Lesson:
    """Draw one demonstration: both hands are led, the right one watches the cup."""
    hands = Hands(world, teacher, room)
    rotations, positions = cup.via_poses(hands, rng, workspace)
    R_above, p_above = hands.above
    turned = np.array([hands.within(GRIP).turn(rng) @ R_above for _ in positions])
    places = np.tile(p_above, (len(positions), 1))
    first = Pose(rotations[0], positions[0])
    start = hands.reach(rng, workspace.elbow, cup=first, sugar=first @ Pose(turned[0], p_above))
    seconds = rng.uniform(*cup.SECONDS[teacher])
    left = hands.guide("cup", rotations, positions, seconds, rng)
    right = hands.guide("sugar", turned, places, seconds, rng, care=PLACE, relative_to="cup")
    return Lesson(start, (left, right), seconds)


def start(hands: Hands, rng: np.random.Generator, workspace: Workspace = TAUGHT) -> np.ndarray:
    """Start posture (n,) of an unseen situation: sugar at its place above a cup that is level."""
    level = hands.level_cup(rng, workspace)
    R_above, p_above = hands.above
    sugar = level @ Pose(hands.within(GRIP).turn(rng) @ R_above, p_above)
    return hands.reach(rng, workspace.elbow, cup=level, sugar=sugar)
