"""Looking ahead: a person leads an arm only where it can go, and sees that before taking hold."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt

import numpy as np
import pinocchio as pin
from scipy.linalg.lapack import dposv

from tpsim.border import border, checked
from tpsim.errors import SimulationError
from tpsim.robot.state import State
from tpsim.robot.views.nullspace import eye
from tpsim.world.object_path import put_objects
from tpsim.world.people.guide import Guide
from tpsim.world.teaching import Lesson, Teacher
from tpsim.world.weightless import DAMPING
from tpsim.world.world import World

DRAWS = 200
"""Lessons thought of before a person gives up."""

STEP = 0.05
"""Time between the postures of a rehearsal [s]."""

FOLLOWS = 10.0
"""How fast a rehearsed hand makes up for what it is behind [1/s]."""

MARGIN = 0.15
"""Distance from the joint limits [rad] that is kept in rehearsal: elbows will swing."""

BEHIND = (0.01, 0.05)
"""How far [m], [rad] a hand may stay behind: more says that the arm is stretched or locked."""

EASY = 0.5
"""Share of the joints' speeds that a person asks."""

LOCKED = 1e-3
"""Mobility [1/kg], [1/(kg m^2)] below which an arm no longer follows."""

CONTACT_STRIDE = 5
"""Postures of a rehearsal for each one that is looked at for contact."""


@dataclass(frozen=True)
class Rehearsed:
    """A teacher who shows only what the arm can follow: lessons are drawn until one is such.

    The weightless arm is followed as it would be led slowly, without physics: joints share a
    movement by their inertia and damping.

    Parameters
    ----------
    teacher : callable
        Draws lessons.
    """

    teacher: Teacher

    def __post_init__(self) -> None:
        checked(self)

    @border
    def __call__(self, world: World, rng: np.random.Generator) -> Lesson:
        """Draw a lesson that goes well in rehearsal.

        Raises
        ------
        SimulationError
            If none is found in ``DRAWS`` draws; with what was wrong with the last one.
        """
        why = ""
        for _ in range(DRAWS):
            try:
                lesson = self.teacher(world, rng)
            except SimulationError as error:
                why = str(error)
                continue
            why = hindrance(world, lesson)
            if not why:
                return lesson
        raise SimulationError(
            f"the teacher thought of {DRAWS} lessons and the arm can follow none; the last: {why}"
        )


def hindrance(world: World, lesson: Lesson, stride: int = CONTACT_STRIDE) -> str:
    """What keeps the arm from following a lesson; nothing where it can.

    Parameters
    ----------
    world : World
    lesson : Lesson
    stride : int
        Postures for each one that is looked at for contact: a hand in a hurry passes through a thin
        wall between two of few.
    """
    robot, simulation, taught = world.robot, world.simulation(), _taught(world, lesson)
    for count, (q, share, behind) in enumerate(_followed(world, lesson)):
        if behind:
            return "a hand stays behind"
        if share > EASY:
            return "a joint would be too fast"
        room = np.minimum(q - robot.lower, robot.upper - q)
        if room[taught].min() < MARGIN:
            return "a joint comes near its limit"
        if count % stride == 0:
            simulation.reset(q)
            put_objects(lesson.objects, simulation)
            if simulation.touches:
                return f"{simulation.touching} touch"
    return ""


def haste(world: World, lesson: Lesson) -> float:
    """How many times as fast as is easy a lesson asks a joint to be, at most.

    Shown so many times slower, it asks for ``EASY`` of the joints' speeds.
    """
    return max(share for _, share, _ in _followed(world, lesson)) / EASY


def _taught(world: World, lesson: Lesson) -> np.ndarray:
    """Which joints (n,) a lesson moves."""
    return np.array([joint not in lesson.held for joint in world.robot.joints])


def _followed(world: World, lesson: Lesson) -> Iterator[tuple[np.ndarray, float, bool]]:
    """Postures (n,) of the arm that is led slowly, from the first after the start on.

    Beside each the largest share of a joint's speed that it takes, and whether a hand is behind.
    """
    robot, timestep = world.robot, world.timestep
    taught = np.flatnonzero(_taught(world, lesson))
    limit, damping = robot.velocity_limit[taught], DAMPING * np.eye(len(taught))
    # Who drags, has gone already where the arm goes.
    guides = [guide for guide in lesson.guides if isinstance(guide, Guide)]
    q, stride = np.array(lesson.start, float), round(STEP / timestep)
    for k in range(0, round(lesson.duration / timestep), stride):
        state = State(robot, np.concatenate((q, np.zeros_like(q))))
        asked = [_asked(guide, state, k * timestep, timestep) for guide in guides]
        J = np.concatenate([rows for rows, _, _ in asked])[:, taught]
        velocity = np.concatenate([part for _, part, _ in asked])
        sharing = state.mass[taught[:, None], taught] + damping
        eased = dposv(sharing, J.T)[1]
        dq = eased.dot(dposv(J.dot(eased) + LOCKED * eye(len(J)), velocity)[1])
        q[taught] += STEP * dq
        yield q, float((np.abs(dq) / limit).max()), any(behind for _, _, behind in asked)


def _asked(
    guide: Guide, state: State, time: float, timestep: float
) -> tuple[np.ndarray, np.ndarray, bool]:
    """What a hand asks at a time [s]: Jacobian (d, n), velocity (d,), and whether it is behind."""
    k = min(max(round((time - guide.start) / timestep), 0), len(guide.path) - 1)
    pose, other = state.pose(guide.site), guide.relative_to
    frame = None if other is None else (state.pose(other), _STILL)
    (R, p), twist = guide.path.seen_from(frame, k)
    way, turn = p - pose.position, pin.log3(R.dot(pose.rotation.T))
    J = state.jacobian(guide.site)
    if other is not None:
        carried = state.jacobian(other)
        J = J - carried
        J[:3] += pin.skew(pose.position - state.pose(other).position).dot(carried[3:])
    turns = guide.grip.angular_stiffness > 0
    behind = sqrt(way.dot(way)) > BEHIND[0] or (turns and sqrt(turn.dot(turn)) > BEHIND[1])
    rows = 6 if turns else 3
    return J[:rows], (twist + FOLLOWS * np.concatenate((way, turn)))[:rows], behind


_STILL = np.zeros(6)
