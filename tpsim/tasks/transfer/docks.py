"""The two docks of the transfer task: where they may be, and how a teacher leaves and enters one.

A situation is a displacement of both docks from home in units of the taught range: twelve numbers,
three of position and three of rotation for each dock, all within -1 and 1 where it was taught.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from tpsim import rotation
from tpsim.border import Point, Positive, checked
from tpsim.pose import Pose
from tpsim.robot import anatomy
from tpsim.robot.robot import Robot
from tpsim.tasks.workplace import size_of
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.care import Care
from tpsim.world.people.demonstrator import DEMONSTRATORS, TeacherName
from tpsim.world.people.guide import Guide, HandPath
from tpsim.world.people.script import script
from tpsim.world.reach import reach
from tpsim.world.world import World

NAMES = ("start", "end")
"""The docks: what is carried leaves the first and enters the second."""

GRIPPER = "left_gripper"
"""Site of the hand that carries."""

HOME = {"start": ((0.54, 0.22, 0.0), 2.83), "end": ((0.54, -0.12, 0.0), 0.45)}
"""Position from the shoulder, for an arm of size 1 [m], and heading [rad] of each dock: they open
towards each other and the robot."""

MIDDLE = np.mean([position for position, _ in HOME.values()], axis=0)
"""Between both of them."""

RANGE = np.array([0.045, 0.045, 0.035, 0.08, 0.08, 0.2])
"""Where a dock may be about home in taught situations, to both sides, for an arm of size 1: [m]
and [rad]."""

FAR = np.sqrt(7.0)
"""Displacements so many times as large (rms) as the taught ones are twice as far from these as
these from each other: with t, t' taught and z far, E|t - t'|^2 = 2 E|t|^2 and
E|z - t|^2 = |z|^2 + E|t|^2."""

WOBBLE = 0.3
"""Spread of the axis about which docks are turned far, which is the gripper's but for it."""

HELD = {"start": rotation.exp([np.pi, 0.0, 0.0]), "end": rotation.exp([0.0, np.pi, 0.0])}
"""Rotation of the gripper in each dock, pointing down. Errors are from there."""

TILT, OUT = rotation.exp([-0.3, 0.0, 0.0]), np.array([0.0, 0.12, 0.03])
"""From inside a dock to the pose that the teacher passes before and after it, for an arm of size 1:
tilted, out of the open side and higher."""

SKILL = {"inside": (0.0015, 0.01), "outside": (0.005, 0.03)}
"""Standard deviations [m], [rad] with which the teacher meets a pose in a dock and before it."""

SECONDS = (4.5, 5.5)
"""The way between the docks lasts a time drawn from this range [s], where joints are fast."""

REST = 0.5
"""Time [s] that the teacher's hand rests in each dock, where joints are fast: heavy arms need more
to come to rest in a hand, as they need more for the way."""

PACE = {"firm": 1.0, "human": 2.0}
"""How many times longer than in the task all takes while a person shows: people take their time,
and a hand as soft as theirs needs it to come to rest."""

ELBOW = 0.25
"""Standard deviation of the posture [rad] that inverse kinematics prefers at the start."""

ASIDE = -0.7
"""Angle [rad] by which the other arm is turned out of the way."""

UPRIGHT = 0.9
"""Cosine of the angle to the vertical from which on a joint turns about it."""

MARGIN = 0.15
"""Distance that the teacher's poses keep from the joint limits [rad]."""

Docks = Mapping[str, Pose]
"""Where each dock is in the world."""


@dataclass(frozen=True)
class Layout:
    """Where both docks are for a robot's arm, beside ``HOME``, and how it is led between them.

    Parameters
    ----------
    shift : (3,)
        Of both docks, for an arm of size 1 [m].
    tilt : float
        Of both about the axis to the left, through their middle [rad]: the hand points down at
        zero, and ahead at a right angle.
    pace : float
        How many times as long as ``SECONDS`` the way lasts, and ``REST``, since joints are slow.
    """

    shift: Point = (0.0, 0.0, 0.0)
    tilt: float = 0.0
    pace: Positive = 1.0

    def __post_init__(self) -> None:
        checked(self)

    @property
    def rotation(self) -> np.ndarray:
        """Of both docks (3, 3)."""
        return rotation.exp([0.0, -self.tilt, 0.0])

    @property
    def movement(self) -> float:
        """Time of the movement [s], as it is taught on average; its end then lasts."""
        return self.pace * (sum(SECONDS) / 2 + 2 * REST)

    def middle(self, robot: Robot) -> np.ndarray:
        """Point (3,) between the docks [m]."""
        shoulder = np.round(anatomy.shoulder(robot, GRIPPER), 2)
        return np.asarray(shoulder + size_of(robot) * (np.array(self.shift) + MIDDLE))


STANDARD = Layout()
"""That of the default robot."""


def home(robot: Robot, layout: Layout = STANDARD) -> Docks:
    """Docks in the middle of the taught range of a robot's arm."""
    size, shoulder = size_of(robot), np.round(anatomy.shoulder(robot, GRIPPER), 2)
    R, found = layout.rotation, {}
    for name, (position, heading) in HOME.items():
        turned = (R - np.eye(3)) @ (np.array(position) - MIDDLE)
        p = shoulder + size * (np.array(position) + turned + layout.shift)
        found[name] = Pose(R @ rotation.exp([0.0, 0.0, heading]), p)
    return found


def draw(
    robot: Robot, rng: np.random.Generator, far: bool = False, layout: Layout = STANDARD
) -> Docks:
    """Draw docks within the taught range; or ``FAR`` from it, in a direction drawn so."""
    displacement = rng.uniform(-1, 1, 12)
    if far:
        taught = np.sqrt(displacement.size / 3)
        displacement *= FAR * taught / np.linalg.norm(displacement)
    docks, size = {}, size_of(robot)
    for (name, (R, p)), offset in zip(
        home(robot, layout).items(), displacement.reshape(2, 6) * RANGE, strict=True
    ):
        turn, move = rotation.exp(layout.rotation @ offset[3:]), layout.rotation @ offset[:3]
        docks[name] = Pose(turn @ R, p + size * move)
    return docks


def draw_turned(
    robot: Robot, rng: np.random.Generator, most: float, layout: Layout = STANDARD
) -> Docks:
    """Draw docks between which the hand must turn by half of an angle [rad] to all of it.

    Either way round, about an axis that is nearly the gripper's: about others few arms can.
    """
    docks = dict(draw(robot, rng, layout=layout))
    axis = np.array([0.0, 0.0, rng.choice([-1.0, 1.0])]) + WOBBLE * rng.standard_normal(3)
    turn = rng.uniform(most / 2, most) * axis / np.linalg.norm(axis)
    held = rotation.exp(layout.rotation @ turn) @ docks["start"].rotation @ HELD["start"]
    docks["end"] = Pose(held @ HELD["end"].T, docks["end"].position)
    return docks


def at_rest(docks: Docks) -> tuple[ObjectPath, ...]:
    """The docks as objects that stand still."""
    return tuple(ObjectPath.at(name, p.position, p.quaternion) for name, p in docks.items())


def at_start(paths: Sequence[ObjectPath]) -> Docks:
    """Where the docks are when they begin to move along their paths."""
    return {path.name: path.first for path in paths}


def via_poses(docks: Docks, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Poses of the gripper that the teacher passes: rotations (4, 3, 3), positions (4, 3)."""
    (R, p), (R_end, p_end) = (docks[name] for name in NAMES)
    out = size * OUT
    rotations = (
        R @ HELD["start"],
        R @ TILT @ HELD["start"],
        R_end @ TILT @ HELD["end"],
        R_end @ HELD["end"],
    )
    return np.array(rotations), np.array([p, p + R @ out, p_end + R_end @ out, p_end])


def start_posture(world: World, docks: Docks, rng: np.random.Generator) -> np.ndarray:
    """Posture (n,) with the gripper in the first dock, the elbow drawn at random.

    Raises
    ------
    SimulationError
        Where the arm cannot follow the teacher through all via poses.
    """
    robot = world.robot
    carries = np.zeros(robot.n)
    carries[robot.chain(GRIPPER)] = 1.0
    preferred = robot.home + ELBOW * carries * rng.standard_normal(carries.size)
    preferred += aside(robot)
    postures: list[np.ndarray] = []
    for R, p in zip(*via_poses(docks, size_of(robot)), strict=True):
        start = postures[-1] if postures else None
        postures.append(
            reach(robot, {GRIPPER: Pose(R, p)}, start=start, posture=preferred, margin=MARGIN)
        )
        preferred = postures[-1]
    return postures[0]


def aside(robot: Robot) -> np.ndarray:
    """By which angles (n,) [rad] the other arm, if there is one, is turned out of the way.

    Its first joint is, where it turns about the vertical.
    """
    turned = np.zeros(robot.n)
    for site in robot.hands.values():
        if site != GRIPPER:
            first = robot.chain(site)[0]
            upright = float(robot.at_home.jacobian(site)[5, first])
            turned[first] = ASIDE * np.sign(upright) * (abs(upright) > UPRIGHT)
    return turned


def guide(
    world: World,
    docks: Docks,
    seconds: float,
    rng: np.random.Generator,
    teacher: TeacherName = "firm",
    rest: float = REST,
) -> Guide:
    """A teacher's hand on the gripper that carries it from one dock into the other.

    ``seconds`` is the time of the way between them; the hand rests for ``rest`` [s] before and
    after it.
    """
    rotations, positions = via_poses(docks, size_of(world.robot))
    skill = [SKILL["inside"], SKILL["outside"], SKILL["outside"], SKILL["inside"]]
    moved, turned = np.array(skill).T[..., None]
    positions = positions + moved * rng.standard_normal((4, 3))
    rotations = rotation.exp(turned * rng.standard_normal((4, 3))) @ rotations
    who, h = DEMONSTRATORS[teacher], world.timestep
    (sight,) = who.sights(rng)
    way = script(rotations, positions, seconds, h, rng, who.variation, _care(round(seconds / h), 0))
    still = round(rest / h)
    care = _care(round(seconds / h), still)
    grip = who.grip
    if teacher == "firm":
        # A firm hand is so whatever it holds: in one of usual damping a heavy arm swings.
        grip = grip.braking(*anatomy.felt(world.robot.at_home, GRIPPER))
    return Guide("left_guide", GRIPPER, grip, _with_rest(way, still), sight=sight, care=care)


def _care(steps: int, rest: int) -> Care:
    """Leaving and entering a dock matters fully in it, and not at all before and after it.

    The poses outside the docks are passed after a third and two thirds of the way, about.
    """
    nearer = np.abs(2 * np.arange(steps) / max(steps - 1, 1) - 1)
    matters = np.pad(np.clip(3 * nearer - 1, 0, 2) / 2, rest, "edge")
    both = np.repeat(matters[:, None], 3, 1)
    return Care(both, both)


def _with_rest(way: HandPath, steps: int) -> HandPath:
    """The same path with rest before and after it."""

    def rested(poses: np.ndarray, mode: Literal["edge", "constant"]) -> np.ndarray:
        return np.pad(poses, [(steps, steps)] + [(0, 0)] * (poses.ndim - 1), mode)

    return HandPath(
        rested(way.position, "edge"),
        rested(way.rotation, "edge"),
        rested(way.velocity, "constant"),
        rested(way.angular_velocity, "constant"),
    )
