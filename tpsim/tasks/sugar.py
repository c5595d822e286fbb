"""Behaviour 2: the right hand keeps a sugar cube above the cup (Fig. 9, second sequence)."""

import numpy as np

from tpsim.sim.teach import Lesson
from tpsim.tasks.bimanual import Hands, Workspace, compose
from tpsim.tasks.cup import SECONDS, via_poses

FRAMES = ("cup in base", "sugar in base", "sugar from cup", "left posture", "right posture")
"""Candidate frames: both hands in the base, one seen from the other (Eq. 41), both postures."""

TAUGHT = Workspace(position=(0.13, 0.16, 0.12), yaw=0.5, tilt=0.2)
"""Where the teacher leads the cup meanwhile: tilted too, since only the sugar's place counts."""

GRIP = Workspace(position=(0.0, 0.0, 0.0), yaw=0.5, tilt=0.25)
"""How the teacher turns the sugar about its place: freely."""


def lesson(hands: Hands, rng, workspace: Workspace = TAUGHT) -> Lesson:
    """Draw one demonstration: both hands are led, the right one watches the cup."""
    rotations, positions = via_poses(hands, rng, workspace)
    R_above, p_above = hands.above
    turned = np.array([GRIP.turn(rng) @ R_above for _ in positions])
    places = np.tile(p_above, (len(positions), 1))
    start = hands.reach(
        rng,
        workspace.elbow,
        cup=(rotations[0], positions[0]),
        sugar=compose((rotations[0], positions[0]), (turned[0], p_above)),
    )
    seconds = rng.uniform(*SECONDS)
    left = hands.guide("cup", rotations, positions, seconds, rng)
    right = hands.guide("sugar", turned, places, seconds, rng, relative_to="cup")
    return Lesson(start, (left, right), seconds)


def situation(hands: Hands, rng, workspace: Workspace = TAUGHT) -> np.ndarray:
    """Start posture (n,) of an unseen situation: sugar at its place above a cup that is level."""
    cup = hands.level_cup(rng, workspace)
    R_above, p_above = hands.above
    sugar = compose(cup, (GRIP.turn(rng) @ R_above, p_above))
    return hands.reach(rng, workspace.elbow, cup=cup, sugar=sugar)
