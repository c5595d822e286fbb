"""The study of serving: unseen situations, pushed in every phase, and held for a while."""

import numpy as np

from tpsim.study.condition import Condition
from tpsim.study.held import by_progress
from tpsim.study.study import Lab, Phases, Plan, Study
from tpsim.task.task import draw_situation
from tpsim.tasks.serve import pictures, scene
from tpsim.tasks.serve.measures import MEASURES
from tpsim.tasks.serve.task import Serve
from tpsim.tasks.serve.teacher import PHASES
from tpsim.world.people.hold import Hold
from tpsim.world.people.push import Push

PUSH, LASTS = 10.0, 2.0
"""Force of a push [N], and how long it lasts [s]."""

HOLDS = 5.0
"""How long a person holds the hand [s]."""

PARTS = {
    "take": ("take", "grasp"),
    "sugar": ("lift", "bring", "drop"),
    "carry": ("carry", "arrive"),
    "pour": ("tilt", "pour", "upright"),
    "return": ("settle", "return", "put"),
}
"""Phases in which somebody pushes or holds, and those of the teacher in each."""

_PUSHES, _HOLDS = 3, 4


def moments() -> dict[str, tuple[float, float]]:
    """When each part begins and ends, as it was taught on average [s]."""
    ends = dict(zip(PHASES, np.cumsum(list(PHASES.values())).tolist(), strict=True))
    return {
        part: (ends[phases[0]] - PHASES[phases[0]], ends[phases[-1]])
        for part, phases in PARTS.items()
    }


def conditions(lab: Lab, plan: Plan) -> Phases:
    """Every situation unpushed, pushed in one part after the other, and held in one of them."""
    found = []
    for index in range(plan.situations):
        situation = draw_situation(lab.task, plan.seed, index)
        rng = plan.rng(_PUSHES, index)
        found.append(Condition("unpushed", situation))
        for k in range(plan.pushes):
            found.append(Condition("pushed", situation, push=(_push(rng, k),)))
        lasts = lab.task.duration + HOLDS
        hold = (_hold(plan.rng(_HOLDS, index), index),)
        if plan.pushes:
            found.append(Condition("unpushed", situation, "by clock"))
            found += [
                Condition("held", situation, name, hold=hold, duration=lasts)
                for name in ("learned", "by clock")
            ]
    yield found


def _push(rng: np.random.Generator, k: int) -> Push:
    """In one part after the other; the hand that is busy is pushed, while sugar falls either."""
    part = list(PARTS)[k % len(PARTS)]
    begin, end = moments()[part]
    force = rng.standard_normal(3)
    force *= PUSH / np.linalg.norm(force)
    hands = (scene.LEFT, scene.RIGHT) if part in ("take", "sugar") else (scene.LEFT,)
    site = hands[int(rng.integers(len(hands)))]
    start = float(np.round(rng.uniform(begin, max(begin, end - LASTS / 2)), 2))
    return Push(site, tuple(force.tolist()), start=start, duration=LASTS)


def _hold(rng: np.random.Generator, index: int) -> Hold:
    """The hand with the cup is held in one part of situation after situation."""
    begin, end = moments()[list(PARTS)[index % len(PARTS)]]
    return Hold(scene.LEFT, float(np.round(rng.uniform(begin, end), 2)), HOLDS)


serve = Study(
    Serve(),
    MEASURES,
    controllers=by_progress,
    conditions=conditions,
    title="Serve: take, sugar, pour, put back",
    lead=(
        "Both weightless arms were led through a whole scene: the left hand takes the cup from its "
        "dock and carries it level, the right one brings sugar and lets it fall in, the cup is "
        "poured out into the bowl and put back. Where it matters to be level, near, or tilted, and "
        "in which frame, was found in the demonstrations alone. The arms then serve where dock, "
        "sugar and bowl never were, pushed and held in every phase."
    ),
    sections=pictures.sections,
    clips=pictures.clips,
)
