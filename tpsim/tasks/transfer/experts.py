"""What people who know the task would set by hand: the way out of one dock into the other.

They know the poses that the teacher passes, in the docks and before them, and the teacher's
timing, and see where the docks are, as the learned controller does: the hand follows a
minimum-jerk path through these poses, which the docks carry along.
"""

from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any, cast

import numpy as np
import pinocchio as pin

from tpsim.controllers.cartesian import CartesianImpedance, Spring
from tpsim.controllers.computed_torque import CLOSING, ComputedTorque, InverseKinematics
from tpsim.controllers.operational_space import Aim, OperationalSpace
from tpsim.pose import Pose
from tpsim.robot.state import State
from tpsim.robot.views.timed import OnPath
from tpsim.study.condition import Lead
from tpsim.study.contest import Contest, Error
from tpsim.study.expert import Expert, Gains, Range, tuned
from tpsim.study.record import Record
from tpsim.task.task import Situation, Task
from tpsim.tasks.transfer import docks
from tpsim.tasks.transfer.task import SEEN, Transfer
from tpsim.tasks.workplace import gains_of, size_of
from tpsim.world.people.push import Push
from tpsim.world.people.script import minimum_jerk
from tpsim.world.world import World

PUSH, TRAVEL = 10.0, 0.05
"""Force of the pushes on the hand of an arm of size 1 [N], and how far it is led aside [m]."""

BEFORE = 1.0
"""Time [s] before the middle of the movement at which the hand is pushed half way."""

LASTS = 1.4
"""How long a push lasts [s]: that in the dock to the end of the trial."""

_STEP = 1e-4


@cache
def _shares(movement: float) -> Any:
    """Share (4,) of each via pose in the minimum-jerk curve through them, over time."""
    times = np.linspace(docks.REST, movement - docks.REST, 4)
    return minimum_jerk(times, np.eye(4))


def place(
    placed: docks.Docks,
    time: float,
    size: float = 1.0,
    movement: float = docks.STANDARD.movement,
) -> Pose:
    """Where the hand of an arm of some size is to be at a time [s], for docks at some places."""
    rotations, positions = docks.via_poses(placed, size)
    within = min(max(time, docks.REST), movement - docks.REST)
    share = _shares(movement)(within)
    turns = [pin.log3(turned) for turned in rotations @ rotations[0].T]
    return Pose(pin.exp3(share @ np.array(turns)) @ rotations[0], share @ positions)


@dataclass(frozen=True)
class Way:
    """The way between two docks, wherever they are and go, in a ``movement`` [s]."""

    movement: float = docks.STANDARD.movement

    def __call__(self, state: State) -> tuple[Pose, np.ndarray]:
        """Pose and twist at a state's time: the twist by a small step of time and docks."""
        now = {name: state.objects[name].pose for name in docks.NAMES}
        soon = {}
        for name in docks.NAMES:
            R, p, v, w = state.objects[name]
            soon[name] = Pose(pin.exp3(_STEP * w) @ R, p + _STEP * v)
        size = size_of(state.robot)
        here = place(now, state.time, size, self.movement)
        there = place(soon, state.time + _STEP, size, self.movement)
        turned = pin.log3(there.rotation @ here.rotation.T)
        return here, np.concatenate([there.position - here.position, turned]) / _STEP


def view(movement: float) -> OnPath:
    """How far the gripper is from its way in a movement of some time [s]."""
    return OnPath(docks.GRIPPER, Way(movement))


def _cartesian(way: OnPath, world: World, situation: Situation, gains: Gains) -> CartesianImpedance:
    stiffness = np.repeat([gains["position"], gains["orientation"]], 3)
    return CartesianImpedance(
        [Spring(way, stiffness)],
        np.array(situation.start),
        posture_stiffness=gains["posture"],
        damping=gains["damping"],
    )


def _osc(way: OnPath, world: World, situation: Situation, gains: Gains) -> OperationalSpace:
    aims = [
        Aim(way, np.repeat([gains["position"], gains["orientation"]], 3), None, gains["damping"])
    ]
    start = np.array(situation.start)
    return OperationalSpace(aims, start, posture_gain=gains["posture"], damping=gains["damping"])


def _computed(way: OnPath, world: World, situation: Situation, gains: Gains) -> ComputedTorque:
    start = np.array(situation.start)
    joints = InverseKinematics([Aim(way, CLOSING)], start, start)
    return ComputedTorque(joints, gains["joints"], damping=gains["damping"])


def experts(gains: Path, movement: float) -> dict[str, Expert]:
    """Experts for the way between the docks in a time [s], with the gains of a file."""
    way = view(movement)
    damping, posture = Range(0.5, 1.5), Range(1.0, 30.0, "1/s^2")
    inertial = Range(20.0, 4000.0, "1/s^2")
    found = {
        "cartesian": Expert(
            {
                "position": Range(50.0, 10000.0, "N/m"),
                "orientation": Range(5.0, 300.0, "Nm/rad"),
                "posture": posture,
                "damping": damping,
            },
            partial(_cartesian, way),
        ),
        "osc": Expert(
            {
                "position": inertial,
                "orientation": Range(100.0, 20000.0, "1/s^2"),
                "posture": posture,
                "damping": damping,
            },
            partial(_osc, way),
        ),
        "computed": Expert({"joints": inertial, "damping": damping}, partial(_computed, way)),
    }
    return tuned(found, gains)


def _pushes(task: Task, situation: Situation, rng: np.random.Generator) -> list[Push]:
    """One half way, one in the second dock to the end."""
    found = []
    for start in _pushed(task):
        force = rng.standard_normal(3)
        force *= PUSH * size_of(task.stage.robot) / np.linalg.norm(force)
        found.append(Push(docks.GRIPPER, tuple(force.tolist()), start=start, duration=LASTS))
    return found


def _lead(task: Task, situation: Situation, rng: np.random.Generator) -> Lead:
    """The hand off its way, half way between the docks."""
    travel = rng.standard_normal(3)
    travel *= TRAVEL * size_of(task.stage.robot) / np.linalg.norm(travel)
    return Lead(docks.GRIPPER, (0, 0, 0), tuple(travel.tolist()), _pushed(task)[0], 1.2, 0.5)


def _pushed(task: Task) -> tuple[float, float]:
    """When the hand is pushed: half way between the docks, and in the second one [s]."""
    movement = cast(Transfer, task).layout.movement
    return movement / 2 - BEFORE, movement


def _is_underway(task: Transfer, push: Push) -> bool:
    """Whether a push is one that the hand may give way to: in the dock it should not."""
    return push.start < task.layout.movement


def _at_the_end(part: str, scale: float):  # type: ignore[no-untyped-def]
    def error(record: Record) -> float:
        value = np.linalg.norm(record.see(SEEN["end", part]), axis=1)
        arrived = cast(Transfer, record.task).layout.movement
        return scale * float(value[record.trial.time >= arrived].max())

    return error


ERRORS = (
    Error("end", _at_the_end("position", 1e3), "mm", 5.0, "From its place in the second dock"),
    Error("end", _at_the_end("orientation", 180 / np.pi), "deg", 3.0, "The same, orientation"),
)


def contest(task: Transfer) -> Contest:
    """The contest of transfer: pushed half way and in the second dock, led aside half way."""
    gains = gains_of(__file__, task.robot)
    return Contest(
        ERRORS,
        _pushes,
        _lead,
        experts(gains, task.layout.movement),
        gains,
        yielding=YIELDING * task.size,
        tuning_situations=1,
        counts=partial(_is_underway, task),
    )


YIELDING = 10.0
"""How far the hand of an arm of size 1 is to give way half way between the docks at least [mm]."""
