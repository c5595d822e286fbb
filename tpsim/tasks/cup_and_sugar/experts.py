"""What people who know the task would set by hand: a level cup, and the sugar above it.

They know the level, the sugar's place above the cup, and that the cup may go anywhere: they hold
it where it starts, as softly as it takes. What was learned they do not know.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from tpsim.controllers.cartesian import CartesianImpedance, Spring
from tpsim.controllers.computed_torque import ComputedTorque
from tpsim.controllers.operational_space import Aim, OperationalSpace
from tpsim.robot.views.view import View
from tpsim.study.condition import Lead
from tpsim.study.contest import Contest, Error
from tpsim.study.expert import Expert, Gains, Range, tuned
from tpsim.study.record import Record
from tpsim.task.task import Situation, Task
from tpsim.tasks.cup_and_sugar import cup, sugar
from tpsim.tasks.cup_and_sugar.conditions import DIRECTIONS, PUSH, way_led
from tpsim.tasks.cup_and_sugar.hands import Hands
from tpsim.tasks.cup_and_sugar.measures import tilt
from tpsim.tasks.cup_and_sugar.task import CupAndSugar
from tpsim.tasks.workplace import gains_of, size_of
from tpsim.world.people.push import Push
from tpsim.world.world import World

_POSTURE, _DAMPING = Range(1.0, 30.0, "1/s^2"), Range(0.5, 1.5)


def _place(world: World) -> View:
    """The sugar from its place above the cup: zero while it is there."""
    return sugar.ABOVE.position.minus(Hands(world).above.position)


def _cartesian(taught: Sequence[str], world: World, situation: Situation, gains: Gains):  # type: ignore[no-untyped-def]
    start = world.robot.at(situation.start)
    here = cup.CUP.position(start).value
    springs = [Spring(cup.CUP.position, gains["hand"], here)]
    if "cup" in taught:
        springs.append(Spring(cup.LEVEL, gains["tilt"]))
    if "sugar" in taught:
        springs.append(Spring(_place(world), gains["between"]))
    return CartesianImpedance(
        springs, start.q, posture_stiffness=gains["posture"], damping=gains["damping"]
    )


def _osc(taught: Sequence[str], world: World, situation: Situation, gains: Gains):  # type: ignore[no-untyped-def]
    start = world.robot.at(situation.start)
    aims, ratio = [], gains["damping"]
    if "cup" in taught:
        aims.append(Aim(cup.LEVEL, gains["tilt"], damping=ratio))
    if "sugar" in taught:
        aims.append(Aim(_place(world), gains["between"], damping=ratio))
    aims.append(Aim(cup.CUP.position, gains["hand"], cup.CUP.position(start).value, ratio))
    return OperationalSpace(aims, start.q, posture_gain=gains["posture"], damping=ratio)


def _computed(world: World, situation: Situation, gains: Gains) -> ComputedTorque:
    """The start is the trajectory: cup level and sugar in its place, it is the goal already."""
    return ComputedTorque(np.array(situation.start), gains["joints"], damping=gains["damping"])


def experts(taught: Sequence[str], gains: Path) -> dict[str, Expert]:
    """Experts for one or both behaviours, with the gains of a file."""

    def cartesian(world: World, situation: Situation, gains: Gains) -> CartesianImpedance:
        return _cartesian(taught, world, situation, gains)

    def osc(world: World, situation: Situation, gains: Gains) -> OperationalSpace:
        return _osc(taught, world, situation, gains)

    found = {
        "cartesian": Expert(
            {
                "hand": Range(30.0, 500.0, "N/m"),
                "tilt": Range(10.0, 400.0, "Nm/rad"),
                "between": Range(500.0, 20000.0, "N/m"),
                "posture": _POSTURE,
                "damping": _DAMPING,
            },
            cartesian,
        ),
        "osc": Expert(
            {
                "hand": Range(15.0, 400.0, "1/s^2"),
                "tilt": Range(300.0, 20000.0, "1/s^2"),
                "between": Range(300.0, 20000.0, "1/s^2"),
                "posture": _POSTURE,
                "damping": _DAMPING,
            },
            osc,
        ),
        "computed": Expert(
            {"joints": Range(10.0, 4000.0, "1/s^2"), "damping": _DAMPING}, _computed
        ),
    }
    return tuned(found, gains)


def _pushes(task: Task, situation: Situation, rng: np.random.Generator) -> list[Push]:
    """The left hand along each axis: one way or the other, in turn with the situations."""
    ways = PUSH * size_of(task.stage.robot) * DIRECTIONS[situation.index % 2 :: 2]
    return [Push("left_gripper", tuple(way.tolist()), start=0.3) for way in ways]


def _lead(task: Task, situation: Situation, rng: np.random.Generator) -> Lead:
    travel = way_led(task, rng.uniform(0, 2 * np.pi))
    return Lead("left_gripper", (0, 0, 0), travel, 0.3, 1.5, 0.5)


def _offset(record: Record) -> np.ndarray:
    return 1e3 * np.linalg.norm(record.see(_place(record.task.stage)), axis=1)


TILT = Error("tilt", tilt, "deg", 3.0, "Cup tilt")
OFFSET = Error("offset", _offset, "mm", 6.0, "Sugar from its place")


def variants(task: Task) -> dict[str, Task]:
    """Half and twice the friction of a free hand."""
    frictions = [share * task.friction for share in (0.5, 2.0)]  # type: ignore[attr-defined]
    return {f"friction {f:g} Ns/m": replace(task, friction=f) for f in frictions}  # type: ignore[type-var]


YIELDING = 130.0
"""How far the pushed hand of arms of size 1 is to give way [mm]."""


def contest(task: CupAndSugar) -> Contest:
    """The contest of one or both behaviours: pushes on the left hand, which then is led."""
    errors = [error for error, name in ((TILT, "cup"), (OFFSET, "sugar")) if name in task.taught]
    gains = gains_of(__file__, task.robot)
    return Contest(
        errors,
        _pushes,
        _lead,
        experts(task.taught, gains),
        gains,
        yielding=YIELDING * task.size,
        duration=2.4,
        twins=False,
        apart=False,
        rest="unpushed",
        pushed="pushed",
        led="led",
        variants=variants,
    )
