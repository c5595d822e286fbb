"""Behaviour 1: the left hand carries a cup and keeps it level (Fig. 9, first sequence)."""

import numpy as np

from tpsim.sim.teach import Lesson
from tpsim.tasks.bimanual import Hands, Workspace

FRAMES = ("cup in base", "left posture")
"""Candidate frames: the hand in the robot's base (Eq. 40), and the arm's posture (Eq. 39)."""

TAUGHT = Workspace()
"""Where the teacher carries the cup: position and yaw vary freely, tilt does not."""

SECONDS = (6.0, 8.0)
"""A demonstration lasts a time drawn from this range [s]."""

VIAS = 4
"""Poses that the hand passes after the first one."""

ASIDE = np.array([-0.08, -0.42, 0.12])
"""Where the right hand waits, from its home [m]."""


def via_poses(hands: Hands, rng, workspace: Workspace = TAUGHT, *, level=None):
    """Poses of the cup that one demonstration passes: rotations (V, 3, 3), positions (V, 3).

    ``level``, if given, fixes the height [m above home] and lets tilt vary instead: a teacher
    who cares about another thing.
    """
    R_home, p_home = hands.cup
    rotations, positions = [], []
    for _ in range(VIAS + 1):
        offset = workspace.offset(rng)
        if level is not None:
            offset[2] = level
        rotations.append(workspace.turn(rng) @ R_home)
        positions.append(p_home + offset)
    return np.array(rotations), np.array(positions)


def lesson(hands: Hands, rng, workspace: Workspace = TAUGHT, *, level=None) -> Lesson:
    """Draw one demonstration: the left hand is led, the right one waits aside."""
    rotations, positions = via_poses(hands, rng, workspace, level=level)
    R_sugar, p_sugar = hands.sugar
    start = hands.reach(
        rng, workspace.elbow, cup=(rotations[0], positions[0]), sugar=(R_sugar, p_sugar + ASIDE)
    )
    seconds = rng.uniform(*SECONDS)
    guide = hands.guide("cup", rotations, positions, seconds, rng)
    return Lesson(start, (guide,), seconds, held=hands.right)


def situation(hands: Hands, rng, workspace: Workspace = TAUGHT) -> np.ndarray:
    """Start posture (n,) of an unseen situation: cup level somewhere, right hand aside."""
    cup = hands.level_cup(rng, workspace)
    R_sugar, p_sugar = hands.sugar
    return hands.reach(rng, workspace.elbow, cup=cup, sugar=(R_sugar, p_sugar + ASIDE))
