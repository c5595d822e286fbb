"""Behaviour 1: the left hand carries a cup and keeps it level (Fig. 9, first sequence)."""

import numpy as np

from tpsim.pose import Pose
from tpsim.robot.indices import Chain
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Site
from tpsim.task.task import Goal
from tpsim.tasks.cup_and_sugar.hands import Hands, Workspace
from tpsim.world.people.care import Care
from tpsim.world.people.demonstrator import TeacherName
from tpsim.world.teaching import Lesson
from tpsim.world.world import World

CUP, LEFT = Site("cup"), Site("left_gripper")

VIEWS = {
    "cup in base": CUP.pose,
    "left posture": Joints(Chain(LEFT.name)).spare(LEFT.pose),
}
"""Candidate frames: the cup in the robot's base (Eq. 40), and what the arm does with its
redundancy (Eq. 42)."""

LEVEL = CUP.axis("z", reference=np.eye(3))
"""Tilt: angles of the cup's axis from the vertical [rad]."""

GOALS = {"tilt": Goal(LEVEL, float(np.radians(5.0)))}
"""What the teacher keeps to."""

TILT, HEIGHT = Care(rotation=(1, 1, 0)), Care(position=(0, 0, 1))
"""What the teacher sees to: the cup is level; or, one who cares about another thing, its height."""

TAUGHT = Workspace()
"""Where the teacher carries the cup: position and yaw vary freely, tilt does not."""

SECONDS = {"firm": (6.0, 8.0), "human": (10.0, 14.0)}
"""A demonstration lasts a time drawn from this range [s]: people take their time."""

VIAS = 4
"""Poses that the hand passes after the first one."""


def via_poses(
    hands: Hands,
    rng: np.random.Generator,
    workspace: Workspace = TAUGHT,
    *,
    level: float | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Poses of the cup that one demonstration passes: rotations (V, 3, 3), positions (V, 3).

    ``level``, if given, fixes the height [m above home] and lets tilt vary instead: a teacher
    who cares about another thing.
    """
    R_home, p_home = hands.cup
    rotations, positions = [], []
    workspace = hands.within(workspace)
    for _ in range(VIAS + 1):
        offset = workspace.offset(rng)
        if level is not None:
            offset[2] = level
        rotations.append(workspace.turn(rng) @ R_home)
        positions.append(p_home + offset)
    return np.array(rotations), np.array(positions)


def lesson(
    world: World,
    rng: np.random.Generator,
    workspace: Workspace = TAUGHT,
    *,
    level: float | None = None,
    teacher: TeacherName = "firm",
    room: float = 1.0,
) -> Lesson:
    """Draw one demonstration: the left hand is led, the right one waits aside."""
    hands = Hands(world, teacher, room)
    rotations, positions = via_poses(hands, rng, workspace, level=level)
    first = Pose(rotations[0], positions[0])
    start = hands.reach(rng, workspace.elbow, cup=first, sugar=hands.aside)
    seconds = rng.uniform(*SECONDS[teacher])
    care = TILT if level is None else HEIGHT
    guide = hands.guide("cup", rotations, positions, seconds, rng, care=care)
    return Lesson(start, (guide,), seconds, held=hands.right)


def start(hands: Hands, rng: np.random.Generator, workspace: Workspace = TAUGHT) -> np.ndarray:
    """Start posture (n,) of an unseen situation: cup level somewhere, right hand aside."""
    cup = hands.level_cup(rng, workspace)
    return hands.reach(rng, workspace.elbow, cup=cup, sugar=hands.aside)
