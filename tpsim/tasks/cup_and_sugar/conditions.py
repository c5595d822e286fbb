"""What cup and sugar are tried with: pushes, a pushed elbow, a led hand, beside fixed gains."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tpsim.study.condition import Condition, Lead
from tpsim.study.record import Record
from tpsim.study.study import Lab, Phases, Plan
from tpsim.task.task import Situation, draw_situation
from tpsim.world.people.push import Push

DIRECTIONS = np.vstack([np.eye(3), -np.eye(3)])
"""Of the pushes: +x, +y, +z, -x, -y, -z."""

PUSH, ELBOW_PUSH = 20.0, 15.0
"""Forces [N] on the left hand and on the right elbow, for two seconds."""

TRAVEL = 0.15
"""How far the left hand is led [m]."""

_HEADING = 2


def conditions(lab: Lab, plan: Plan) -> Phases:
    """Unpushed first; where each then rests, the fixed gains to compare with begin."""
    drawn = [draw_situation(lab.task, plan.seed, i) for i in range(plan.situations)]
    records = yield [Condition("unpushed", situation) for situation in drawn]
    found: list[Condition] = []
    both = "sugar" in lab.task.behaviours()
    for twin in records.select("unpushed"):
        situation = twin.condition.situation
        rest = replace(situation, start=tuple(twin["q"][-1].tolist()))
        found += _pushed(lab, situation, rest, plan.pushes)
        if both:
            found += _elbow(situation)
            found.append(_led(situation, twin, plan))
    yield found


def _pushed(lab: Lab, situation: Situation, rest: Situation, pushes: int) -> Iterator[Condition]:
    for k in range(pushes):
        push = Push("left_gripper", tuple((PUSH * DIRECTIONS[k % 6]).tolist()))
        for controller in lab.study.all_controllers:
            start = situation if controller == "learned" else rest
            yield Condition("pushed", start, controller, (push,))


def _elbow(situation: Situation) -> Iterator[Condition]:
    """Two pushes across the arm, the way in which the elbow is free to swivel."""
    for sign in (1.0, -1.0):
        force = (0.0, sign * ELBOW_PUSH, 0.0)
        yield Condition("elbow", situation, push=(Push("right_elbow", force),))


def _led(situation: Situation, twin: Record, plan: Plan) -> Condition:
    heading = plan.rng(_HEADING, situation.index).uniform(0, 2 * np.pi)
    travel = TRAVEL * np.array([np.cos(heading), np.sin(heading), 0.0])
    origin = twin["left_hand_position"][-1]
    lead = Lead("left_gripper", tuple(origin.tolist()), tuple(travel.tolist()))
    return Condition("led", situation, lead=(lead,))
