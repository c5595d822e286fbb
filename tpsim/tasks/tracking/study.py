"""The study of tracking: unseen paths of two objects, each followed as each teaching has it."""

from collections.abc import Mapping
from functools import partial
from typing import cast

import numpy as np

from tpsim.study.condition import Condition
from tpsim.study.expert import fixed_gains
from tpsim.study.study import ControllerFactory, Lab, Phases, Plan, Study
from tpsim.task.task import Task, draw_situation
from tpsim.tasks.tracking import experts, pictures
from tpsim.tasks.tracking.body import SIDES
from tpsim.tasks.tracking.carousel import SECONDS, VIAS
from tpsim.tasks.tracking.measures import MEASURES
from tpsim.tasks.tracking.task import Tracking, behaviour
from tpsim.world.people.push import Push

PUSH = 10.0
"""Force [N] on one of the hands, for two seconds."""

EARLIER = (0.5, 1.5)
"""How long before the objects are at a via a push begins, drawn from this range [s]."""

_DRAWS = 4


def controllers(task: Task) -> Mapping[str, ControllerFactory]:
    """One controller for each behaviour, which are performed apart, not together; fixed gains."""
    tracking = cast(Tracking, task)
    found: dict[str, ControllerFactory] = {
        behaviour(one): partial(tracking.follow, one) for one in tracking.taught
    }
    compared = experts.contest(tracking)
    return found if compared is None else found | fixed_gains(compared.experts["computed"])


def conditions(lab: Lab, plan: Plan) -> Phases:
    """Every situation by every behaviour; the pushes go round the behaviours."""
    found, names = [], list(lab.task.behaviours())
    for index in range(plan.situations):
        situation = draw_situation(lab.task, plan.seed, index)
        rng = plan.rng(_DRAWS, index)
        found += [Condition("unpushed", situation, name) for name in names]
        for k in range(plan.pushes):
            name, turn = names[k % len(names)], k // len(names)
            # In turn when the objects are farthest from each other, and when they are not.
            via = 1 + (2 * rng.integers(VIAS // 2) if turn % 2 == 0 else 1)
            found.append(Condition("pushed", situation, name, (_push(rng, int(via)),)))
    yield found


def _push(rng: np.random.Generator, via: int) -> Push:
    """Somewhere in the plane on one of the hands, about the time of a via."""
    bearing = rng.uniform(0, 2 * np.pi)
    force = (PUSH * np.cos(bearing), PUSH * np.sin(bearing), 0.0)
    start = via * SECONDS / (VIAS - 1) - rng.uniform(*EARLIER)
    return Push(f"{SIDES[rng.integers(2)]}_hand", force, start=start)


def study(task: Tracking | None = None) -> Study:
    """The study of all behaviours, or of those that a task names."""
    task = Tracking() if task is None else task
    return Study(
        task,
        MEASURES,
        controllers=controllers,
        conditions=conditions,
        contest=experts.contest(task),
        title="Tracking two objects with priorities",
        lead=(
            "Two hands that share a trunk were led after two moving objects, which at times could "
            "not both be reached. The teacher then gave priority to the left hand, to the right "
            "hand, or to neither. Who gives way was found in the demonstrations alone: it is how "
            "precise they are in four candidate frames, each hand seen from its object, and each "
            "in the nullspace of the other."
        ),
        sections=pictures.sections,
        clips=pictures.clips,
    )


tracking = study()
left = study(Tracking(("left",)))
right = study(Tracking(("right",)))
compromise = study(Tracking(("compromise",)))
