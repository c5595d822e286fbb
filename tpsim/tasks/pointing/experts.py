"""What people who know the task would set by hand: point at the first object, the second, rest.

They know what points and the teacher's timing, see where the objects are, as the learned
controller does, and turn from one to the other with minimum jerk. The arm's posture at rest is the
one that they prefer.
"""

from functools import partial
from pathlib import Path
from typing import cast

import numpy as np

from tpsim.controllers.cartesian import CartesianImpedance, Spring
from tpsim.controllers.computed_torque import CLOSING, ComputedTorque, InverseKinematics
from tpsim.controllers.operational_space import Aim, OperationalSpace
from tpsim.robot.views.timed import Handover
from tpsim.robot.views.view import View
from tpsim.study.condition import Lead
from tpsim.study.contest import Contest, Error
from tpsim.study.expert import Expert, Gains, Range, tuned
from tpsim.task.task import Situation, Task
from tpsim.tasks.pointing.measures import angle
from tpsim.tasks.pointing.pointers import OBJECTS, Pointer
from tpsim.tasks.pointing.task import Pointing
from tpsim.tasks.pointing.teacher import SCHEDULE
from tpsim.tasks.workplace import gains_of
from tpsim.world.people.push import Push
from tpsim.world.world import World

PUSH, TRAVEL = 10.0, 0.05
"""Force of the pushes on what points [N], and how far it is led aside [m], for arms of size 1."""

SETTLED = 0.2
"""Time [s] after the arm has come to point at the first object when it is pushed or led."""

LEAVES, AT_FIRST, LEFT_FIRST, AT_SECOND, LEFT_SECOND, HOME = SCHEDULE[1:7]
"""The teacher's timing [s]."""


def view(pointer: Pointer) -> View:
    """Direction that is to be zero: as at rest, to each object in its time, as at rest again."""
    first, second = (pointer.bearing(name) for name in OBJECTS)
    turned = Handover(pointer.axis, first, LEAVES, AT_FIRST)
    turned = Handover(turned, second, LEFT_FIRST, AT_SECOND)
    return Handover(turned, pointer.axis, LEFT_SECOND, HOME)


def _cartesian(
    pointer: Pointer, world: World, situation: Situation, gains: Gains
) -> CartesianImpedance:
    return CartesianImpedance(
        [Spring(view(pointer), gains["direction"])],
        world.robot.home,
        posture_stiffness=gains["posture"],
        damping=gains["damping"],
    )


def _osc(pointer: Pointer, world: World, situation: Situation, gains: Gains) -> OperationalSpace:
    aim = Aim(view(pointer), gains["direction"], damping=gains["damping"])
    home, posture = world.robot.home, gains["posture"]
    return OperationalSpace([aim], home, posture_gain=posture, damping=gains["damping"])


def _computed(pointer: Pointer, world: World, situation: Situation, gains: Gains) -> ComputedTorque:
    start = np.array(situation.start)
    way = InverseKinematics([Aim(view(pointer), CLOSING)], start, world.robot.home)
    return ComputedTorque(way, gains["joints"], damping=gains["damping"])


def experts(pointer: Pointer, gains: Path) -> dict[str, Expert]:
    """Experts for one arm."""
    damping, posture = Range(0.5, 1.5), Range(1.0, 400.0, "1/s^2")
    inertial = Range(30.0, 3000.0, "1/s^2")
    found = {
        "cartesian": Expert(
            {
                "direction": Range(2.0, 1000.0, "Nm/rad"),
                "posture": posture,
                "damping": damping,
            },
            partial(_cartesian, pointer),
        ),
        "osc": Expert(
            {"direction": inertial, "posture": posture, "damping": damping},
            partial(_osc, pointer),
        ),
        "computed": Expert({"joints": inertial, "damping": damping}, partial(_computed, pointer)),
    }
    return tuned(found, gains)


def _pushes(task: Task, situation: Situation, rng: np.random.Generator) -> list[Push]:
    """Two on what points while it points at the first object, across each other."""
    pointer = cast(Pointing, task).pointer
    axis, force = pointer.axis, PUSH * pointer.size
    way = np.append(rng.standard_normal(2), 0.0)
    if len(axis.axes) > 2:
        way[2] = rng.standard_normal()
    way *= force / np.linalg.norm(way)
    other = np.array([-way[1], way[0], 0.0])
    other *= force / np.linalg.norm(other)
    return [
        Push(axis.site, tuple(one.tolist()), start=AT_FIRST + SETTLED, duration=1.5)
        for one in (way, other)
    ]


def _lead(task: Task, situation: Situation, rng: np.random.Generator) -> Lead:
    heading = rng.uniform(0, 2 * np.pi)
    pointer = cast(Pointing, task).pointer
    travel = TRAVEL * pointer.size * np.array([np.cos(heading), np.sin(heading), 0.0])
    return Lead(pointer.axis.site, (0, 0, 0), tuple(travel.tolist()), AT_FIRST + SETTLED, 1.0, 0.5)


ANGLE = Error("angle", partial(angle, name="first"), "deg", 3.0, "Angle to the object")


def contest(task: Pointing) -> Contest:
    """The contest of one arm: it is pushed, and led aside, while it points at the first object."""
    gains = gains_of(__file__, task.robot)
    return Contest(
        [ANGLE],
        _pushes,
        _lead,
        experts(task.pointer, gains),
        gains,
        yielding=YIELDING * task.pointer.size,
        duration=AT_FIRST + SETTLED + 1.6,
        twins=False,
    )


YIELDING = 12.0
"""How far an arm of size 1 is to give way at least [mm]."""
