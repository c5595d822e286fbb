"""What people who know the task would set by hand: both hands at their objects, one of them first.

They know which hand has priority and see the objects and their motion, as the learned controller
does: springs of two strengths, or priorities as such.
"""

from functools import partial
from pathlib import Path
from typing import cast

import numpy as np

from tpsim.controllers.cartesian import CartesianImpedance, Spring
from tpsim.controllers.computed_torque import CLOSING, ComputedTorque, InverseKinematics
from tpsim.controllers.operational_space import Aim, OperationalSpace
from tpsim.robot.views.view import View
from tpsim.study.condition import Lead
from tpsim.study.contest import Contest, Error
from tpsim.study.expert import Expert, Gains, Range, tuned
from tpsim.study.record import Record
from tpsim.task.task import Situation, Task
from tpsim.tasks.tracking.body import SIDES
from tpsim.tasks.tracking.carousel import SECONDS, VIAS
from tpsim.tasks.tracking.measures import both, distance
from tpsim.tasks.tracking.task import HANDS, Tracking, behaviour
from tpsim.world.people.push import Push
from tpsim.world.world import World

GAINS = Path(__file__).with_name("gains.json")
"""Gains as they were tuned on tracking, with the left hand first."""

PUSH, TRAVEL = 10.0, 0.05
"""Force of the pushes on the hands [N], and how far the second one is led aside [m]."""

APART = SECONDS / (VIAS - 1)
"""When the objects are farthest from each other for the first time [s]."""


def _ordered(side: str) -> tuple[View, View]:
    """The hand with priority, and the other one."""
    return HANDS[side], HANDS[_other(side)]


def _other(side: str) -> str:
    return SIDES[1 - SIDES.index(side)]


def _cartesian(side: str, world: World, situation: Situation, gains: Gains) -> CartesianImpedance:
    first, other = _ordered(side)
    return CartesianImpedance(
        [Spring(first, gains["first"]), Spring(other, gains["other"])],
        np.array(situation.start),
        posture_stiffness=gains["posture"],
        damping=gains["damping"],
    )


def _osc(side: str, world: World, situation: Situation, gains: Gains) -> OperationalSpace:
    first, other = _ordered(side)
    ratio, posture = gains["damping"], gains["posture"]
    aims = [Aim(first, gains["first"], damping=ratio), Aim(other, gains["other"], damping=ratio)]
    start = np.array(situation.start)
    return OperationalSpace(aims, start, posture_gain=posture, damping=ratio)


def _computed(side: str, world: World, situation: Situation, gains: Gains) -> ComputedTorque:
    aims = [Aim(hand, CLOSING) for hand in _ordered(side)]
    way = InverseKinematics(aims, np.array(situation.start), np.array(situation.start))
    return ComputedTorque(way, gains["joints"], damping=gains["damping"])


def experts(side: str) -> dict[str, Expert]:
    """Experts who give priority to one hand."""
    damping, posture = Range(0.5, 1.5), Range(0.5, 20.0, "1/s^2")
    inertial = Range(30.0, 10000.0, "1/s^2")
    found = {
        "cartesian": Expert(
            {
                "first": Range(100.0, 20000.0, "N/m"),
                "other": Range(20.0, 5000.0, "N/m"),
                "posture": posture,
                "damping": damping,
            },
            partial(_cartesian, side),
        ),
        "osc": Expert(
            {"first": inertial, "other": inertial, "posture": posture, "damping": damping},
            partial(_osc, side),
        ),
        "computed": Expert({"joints": inertial, "damping": damping}, partial(_computed, side)),
    }
    return tuned(found, GAINS)


def _side(task: Task) -> str:
    return cast(Tracking, task).taught[0]


def _pushes(task: Task, situation: Situation, rng: np.random.Generator) -> list[Push]:
    """One on each hand, in the plane, while the objects are farthest from each other."""
    found = []
    for side in SIDES:
        bearing = rng.uniform(0, 2 * np.pi)
        force = (PUSH * np.cos(bearing), PUSH * np.sin(bearing), 0.0)
        found.append(Push(f"{side}_hand", force, start=APART - 1.0))
    return found


def _lead(task: Task, situation: Situation, rng: np.random.Generator) -> Lead:
    """The second hand off its way, while both objects are in reach."""
    bearing = rng.uniform(0, 2 * np.pi)
    travel = (TRAVEL * np.cos(bearing), TRAVEL * np.sin(bearing), 0.0)
    return Lead(f"{_other(_side(task))}_hand", (0, 0, 0), travel, APART - 1.0, 1.2, 0.5)


def _first(record: Record) -> np.ndarray:
    return 1e3 * distance(record, _side(record.task))


ERRORS = (
    Error("first", _first, "mm", 15.0, "First hand from its object while pushed"),
    Error("both", both, "mm", 8.0, "Hands from objects in reach, rms of a trial"),
)


def contest(task: Tracking) -> Contest | None:
    """The contest of a priority; a compromise has none, since it has no hand that comes first."""
    if _side(task) == "compromise":
        return None
    second = f"{_other(_side(task))}_hand"
    return Contest(
        ERRORS,
        _pushes,
        _lead,
        experts(_side(task)),
        GAINS,
        yielding=YIELDING,
        duration=APART + 1.5,
        tuning_situations=1,
        counts=lambda push: push.body == second,
        without=[behaviour(one) for one in task.taught],
    )


YIELDING = 3.0
"""How far the second hand is to give way at least [mm]."""
