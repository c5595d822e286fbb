"""How a person serves: what both hands do in every phase, and by which poses they pass."""

from dataclasses import dataclass

import numpy as np

from tpsim import rotation
from tpsim.pose import Pose
from tpsim.tasks.serve import scene
from tpsim.tasks.serve.scene import ABOVE, CUP, LIES, POUR, STANDS, SUGAR, Placing
from tpsim.world.people.care import EVERYTHING
from tpsim.world.people.demonstrator import DEMONSTRATORS, TeacherName
from tpsim.world.people.guide import Guide, HandPath
from tpsim.world.people.script import script, steps_in
from tpsim.world.reach import reach
from tpsim.world.teaching import Lesson
from tpsim.world.world import World

PHASES = {
    "begin": 0.3,
    "take": 2.2,
    "grasp": 0.9,
    "lift": 2.6,
    "bring": 1.8,
    "drop": 0.9,
    "carry": 2.8,
    "arrive": 0.4,
    "tilt": 2.0,
    "pour": 1.0,
    "upright": 2.0,
    "settle": 0.4,
    "return": 3.0,
    "put": 0.9,
    "leave": 1.5,
    "end": 0.4,
}
"""The phases, and how long each lasts on average [s]."""

MOVEMENT = sum(PHASES.values())
"""Time of the whole movement [s]."""

PACE = 0.05
"""Share by which the time of a phase differs between lessons."""

SKILL = {"inside": (0.0015, 0.008, 0.008), "outside": (0.006, 0.008, 0.04)}
"""Standard deviations with which the teacher meets a pose that matters, and one on the way:
position [m], tilt and heading [rad]."""

READY = {"cup": (0.59, 0.37, 0.12), "sugar": (0.68, -0.22, 0.15)}
"""Where the hands' places for cup and sugar are at the start, about [m]."""

HEADING = -0.9
"""Heading of the cup's place in the left hand at the start [rad]."""

SPREAD = 0.03
"""Standard deviation of where the hands are at the start, and of where they meet [m]."""

MEET, WAIT, ASIDE = (0.66, 0.14, 0.13), (0.0, -0.13, 0.13), (0.02, -0.30, 0.04)
"""Where the cup is sugared [m]; where the sugar waits, and goes after it, from there [m]."""

AWAY = (0.0, -0.02, 0.05)
"""Where the sugar's hand goes first, once it has let it fall [m]."""

BACK, UP = (-0.10, 0.0, 0.0), (0.0, 0.0, 0.09)
"""From a place of the cup: before it, by the side of its handle, and above it [m]."""

ELBOW = 0.15
"""Standard deviation of the posture [rad] that inverse kinematics prefers at the start."""

MARGIN = 0.1
"""Distance that postures of via poses keep from the joint limits [rad]."""


@dataclass(frozen=True)
class Way:
    """What one hand does: poses that it passes in some phases; it rests in all others.

    Parameters
    ----------
    first : Pose
        Where it begins.
    legs : mapping of str to list of Pose
        By phases.
    """

    first: Pose
    legs: dict[str, list[Pose]]


def ways(placed: Placing, rng: np.random.Generator) -> tuple[Way, Way]:
    """What the two hands do once: poses of the cup's and of the sugar's place in them."""
    dock, sugar, bowl = (placed[name] for name in scene.NAMES)

    def near(pose: Pose, skill: str) -> Pose:
        moved, tilted, turned = SKILL[skill]
        turn = rng.standard_normal(3) * (tilted, tilted, turned)
        return Pose(rotation.exp(turn) @ pose.rotation, pose.position + moved * rng.normal(size=3))

    def somewhere(position: tuple[float, float, float], heading: float) -> Pose:
        turned = rotation.exp([0.0, 0.0, heading + 0.15 * rng.standard_normal()])
        found = near(Pose(turned, np.array(position)), "outside")
        return Pose(found.rotation, found.position + SPREAD * rng.standard_normal(3))

    ready = somewhere(READY["cup"], HEADING)
    taken = near(dock @ _at(STANDS), "inside")
    before = near(dock @ _at(STANDS) @ _at(BACK), "outside")
    above, again = (near(dock @ _at(STANDS) @ _at(UP), "outside") for _ in range(2))
    meet = somewhere(MEET, HEADING)
    level = near(bowl @ _at(scene.POURED), "outside")
    pour = near(bowl @ POUR, "inside")
    put = near(dock @ _at(STANDS), "inside")
    left = near(dock @ _at(STANDS) @ _at(BACK), "outside")
    cup = Way(
        ready,
        {
            "take": [before, taken],
            "lift": [above, meet],
            "carry": [level],
            "tilt": [pour],
            "upright": [level],
            "return": [again, put],
            "leave": [left],
        },
    )
    lies = sugar @ _at(LIES)
    heading = _at_heading(sugar, rng)
    start = somewhere(READY["sugar"], heading)
    over = near(Pose(start.rotation, (meet @ _at(ABOVE)).position), "inside")
    lump = Way(
        start,
        {
            "take": [near(lies @ _at(UP), "outside"), near(lies, "inside")],
            "lift": [near(lies @ _at(UP), "outside"), _moved(over, WAIT, meet)],
            "bring": [over],
            "carry": [
                _moved(over, (0.0, -0.02, 0.05), over),
                somewhere(_sum(MEET, ASIDE), heading),
            ],
        },
    )
    return cup, lump


def _at(position: tuple[float, float, float]) -> Pose:
    return Pose(np.eye(3), np.array(position))


def _sum(one: tuple[float, float, float], other: tuple[float, float, float]):  # type: ignore[no-untyped-def]
    return tuple((np.array(one) + other).tolist())


def _at_heading(pose: Pose, rng: np.random.Generator) -> float:
    return float(rotation.log(pose.rotation)[2] + 0.1 * rng.standard_normal())


def _moved(pose: Pose, by: tuple[float, float, float], about: Pose) -> Pose:
    return Pose(pose.rotation, about.position + by)


def lesson(world: World, rng: np.random.Generator, teacher: TeacherName = "firm") -> Lesson:
    """Draw objects within the taught range, and how a person serves."""
    return lesson_in(world, scene.draw(rng), None, rng, teacher)


def lesson_in(
    world: World,
    placed: Placing,
    start: np.ndarray | None,
    rng: np.random.Generator,
    teacher: TeacherName = "firm",
) -> Lesson:
    """How a person serves where objects are at some places, from a posture where one is given."""
    cup, sugar = ways(placed, rng)
    if start is None:
        start = posture(world, cup, sugar, rng)
    else:
        state = world.robot.at(start)
        hands = (state.pose(scene.LEFT) @ CUP.in_hand, state.pose(scene.RIGHT) @ SUGAR.in_hand)
        cup, sugar = Way(hands[0], cup.legs), Way(hands[1], sugar.legs)
    who, h = DEMONSTRATORS[teacher], world.timestep
    lasting = {name: s * (1 + PACE * rng.uniform(-1, 1)) for name, s in PHASES.items()}
    guides = []
    for side, way, grasp, sight in zip(
        ("left", "right"), (cup, sugar), (CUP, SUGAR), who.sights(rng, 2), strict=True
    ):
        parts, now = [], way.first
        for phase, seconds in lasting.items():
            poses = [now, *way.legs.get(phase, [])]
            hand = [scene.in_hand(grasp, pose) for pose in poses]
            if len(poses) == 1:
                parts.append(_rest(hand[0], steps_in("seconds", seconds, h)))
            else:
                R, p = (np.array(part) for part in zip(*hand, strict=True))
                parts.append(script(R, p, seconds, h, rng, who.variation, EVERYTHING))
            now = poses[-1]
        name, site = f"{side}_guide", f"{side}_gripper"
        guides.append(Guide(name, site, who.grip, _joined(parts), sight=sight, care=EVERYTHING))
    seconds = h * min(len(guide.path) for guide in guides)
    return Lesson(start, tuple(guides), seconds, objects=scene.at_rest(placed))


def _rest(pose: Pose, steps: int) -> HandPath:
    still = np.zeros((steps, 3))
    return HandPath(
        np.tile(pose.position, (steps, 1)), np.tile(pose.rotation, (steps, 1, 1)), still, still
    )


def _joined(parts: list[HandPath]) -> HandPath:
    return HandPath(
        *(
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("position", "rotation", "velocity", "angular_velocity")
        )
    )


def posture(world: World, cup: Way, sugar: Way, rng: np.random.Generator) -> np.ndarray:
    """Posture (n,) in which both hands begin, elbows drawn at random.

    Raises
    ------
    SimulationError
        Where the arms cannot pass where the cup is sugared and poured out.
    """
    robot = world.robot
    preferred = robot.home + ELBOW * rng.standard_normal(robot.n)
    hands = [
        (cup.first, sugar.first),
        (cup.legs["take"][-1], sugar.legs["take"][-1]),
        (cup.legs["lift"][-1], sugar.legs["bring"][-1]),
        (cup.legs["tilt"][-1], sugar.legs["carry"][-1]),
    ]
    found: list[np.ndarray] = []
    for thing, lump in hands:
        wanted = {scene.LEFT: scene.in_hand(CUP, thing), scene.RIGHT: scene.in_hand(SUGAR, lump)}
        start = found[-1] if found else None
        found.append(reach(robot, wanted, start=start, posture=preferred, margin=MARGIN))
        preferred = found[-1]
    return found[0]
