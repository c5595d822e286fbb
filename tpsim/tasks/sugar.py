"""Behaviour 2: the right hand keeps a sugar cube above the cup (Fig. 9, second sequence)."""

import numpy as np

from tpsim.sim.teach import Lesson
from tpsim.tasks import cup
from tpsim.tasks.bimanual import Hands, Workspace, compose

FRAMES = ("cup in base", "sugar in base", "sugar from cup", "left posture", "right posture")
"""Candidate frames: both hands in the base, one seen from the other (Eq. 41), both postures."""

TAUGHT = Workspace(position=(0.10, 0.13, 0.08), yaw=0.5, tilt=0.2)
"""Where the teacher leads the cup meanwhile: tilted too, since only the sugar's place counts."""

GRIP = Workspace(position=(0.0, 0.0, 0.0), yaw=0.5, tilt=0.25)
"""How the teacher turns the sugar about its place: freely."""


def lesson(hands: Hands, rng, workspace: Workspace = TAUGHT) -> Lesson:
    """Draw one demonstration: both hands are led, the right one watches the cup."""
    rotations, positions = cup.via_poses(hands, rng, workspace)
    R_above, p_above = hands.above
    turned = np.array([GRIP.turn(rng) @ R_above for _ in positions])
    places = np.tile(p_above, (len(positions), 1))
    start = hands.reach(
        rng,
        workspace.elbow,
        cup=(rotations[0], positions[0]),
        sugar=compose((rotations[0], positions[0]), (turned[0], p_above)),
    )
    seconds = rng.uniform(*cup.SECONDS)
    left = hands.guide("cup", rotations, positions, seconds, rng)
    right = hands.guide("sugar", turned, places, seconds, rng, relative_to="cup")
    return Lesson(start, (left, right), seconds)


def situation(hands: Hands, rng, workspace: Workspace = TAUGHT) -> np.ndarray:
    """Start posture (n,) of an unseen situation: sugar at its place above a cup that is level."""
    R_cup, p_cup = hands.cup
    level = Workspace(workspace.position, workspace.yaw)
    held = compose((level.turn(rng), p_cup + level.offset(rng)), (R_cup, np.zeros(3)))
    R_above, p_above = hands.above
    return hands.reach(
        rng, workspace.elbow, cup=held, sugar=compose(held, (GRIP.turn(rng) @ R_above, p_above))
    )
