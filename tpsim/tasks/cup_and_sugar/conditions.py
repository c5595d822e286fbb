"""What cup and sugar are tried with: pushes, a pushed elbow, a led hand, beside fixed gains."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tpsim.border import Point
from tpsim.study.condition import Condition, Lead
from tpsim.study.record import Record
from tpsim.study.study import Lab, Phases, Plan
from tpsim.task.task import Situation, Task, draw_situation
from tpsim.tasks.workplace import size_of
from tpsim.world.people.push import Push

DIRECTIONS = np.vstack([np.eye(3), -np.eye(3)])
"""Of the pushes: +x, +y, +z, -x, -y, -z."""

PUSH, ELBOW_PUSH = 20.0, 15.0
"""Forces on the left hand and on the right elbow of arms of size 1 [N], for two seconds."""

ONSET = (0.3, 3.0)
"""Pushes begin at a time drawn from this range [s]: while the arms settle, and long after."""

TRAVEL = 0.15
"""How far the left hand of arms of size 1 is led [m]."""

_HEADING, _ONSET = 2, 3


def conditions(lab: Lab, plan: Plan) -> Phases:
    """Unpushed first; where each then is, the controllers to compare with begin."""
    drawn = [draw_situation(lab.task, plan.seed, i) for i in range(plan.situations)]
    records = yield [Condition("unpushed", situation) for situation in drawn]
    found: list[Condition] = []
    both = "sugar" in lab.task.behaviours()
    for twin in records.select("unpushed"):
        found += _pushed(lab, twin, plan)
        if both:
            found += _elbow(twin.condition.situation, size_of(lab.world.robot))
            found += _led(lab, twin, plan)
    yield found


def _pushed(lab: Lab, twin: Record, plan: Plan) -> Iterator[Condition]:
    situation = twin.condition.situation
    rng, strength = plan.rng(_ONSET, situation.index), PUSH * size_of(lab.world.robot)
    for k in range(plan.pushes):
        onset = float(np.round(rng.uniform(*ONSET), 2))
        force = tuple((strength * DIRECTIONS[k % 6]).tolist())
        push = Push("left_gripper", force, start=onset)
        rest = resting(twin, onset)
        for controller in _performers(lab, situation):
            start = situation if controller == "learned" else rest
            yield Condition("pushed", start, controller, (push,))


def _performers(lab: Lab, situation: Situation) -> list[str]:
    """Who performs in a situation: the whole contest in the first ones, else those measured."""
    contest = lab.study.contest
    if contest is None or situation.index < contest.situations:
        return list(lab.study.performers)
    return [name for name in lab.study.all_controllers if name not in contest.experts]


def resting(twin: Record, time: float) -> Situation:
    """The situation with the posture that an unpushed trial has at a time as its start.

    From there a controller that holds its start is pushed where the learned one is.
    """
    k = int(np.searchsorted(twin.trial.time, time))
    return replace(twin.condition.situation, start=tuple(twin["q"][k].tolist()))


def _elbow(situation: Situation, size: float) -> Iterator[Condition]:
    """Two pushes across the arm, the way in which the elbow is free to swivel."""
    for sign in (1.0, -1.0):
        force = (0.0, sign * size * ELBOW_PUSH, 0.0)
        yield Condition("elbow", situation, push=(Push("right_elbow", force),))


def way_led(task: Task, heading: float) -> Point:
    """How the hand is led along a heading [rad], (3,) [m]."""
    way = TRAVEL * size_of(task.stage.robot) * np.array([np.cos(heading), np.sin(heading), 0.0])
    return float(way[0]), float(way[1]), float(way[2])


def _led(lab: Lab, twin: Record, plan: Plan) -> Iterator[Condition]:
    """The hand led along a line, by every controller: the same way, so that forces compare."""
    situation = twin.condition.situation
    heading = plan.rng(_HEADING, situation.index).uniform(0, 2 * np.pi)
    travel = way_led(lab.task, heading)
    lead = Lead("left_gripper", (0.0, 0.0, 0.0), travel)
    rest = resting(twin, lead.start)
    k = int(np.searchsorted(twin.trial.time, lead.start))
    origin = tuple(twin["left_hand_position"][k].tolist())
    for controller in _performers(lab, situation):
        start = situation if controller == "learned" else rest
        yield Condition("led", start, controller, lead=(replace(lead, origin=origin),))
