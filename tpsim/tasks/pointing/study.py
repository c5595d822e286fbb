"""The study of pointing: objects at rest, moving and jumping, with and without pushes."""

from collections.abc import Callable
from dataclasses import replace
from typing import cast

import numpy as np

from tpsim.errors import SimulationError
from tpsim.study.condition import Condition
from tpsim.study.expert import fixed_gains
from tpsim.study.study import Lab, Phases, Plan, Study
from tpsim.task.task import Situation, draw_situation
from tpsim.tasks.pointing import pictures
from tpsim.tasks.pointing.experts import contest
from tpsim.tasks.pointing.measures import measures
from tpsim.tasks.pointing.pointers import OBJECTS, Pointer
from tpsim.tasks.pointing.task import Pointing
from tpsim.tasks.pointing.teacher import APPROACH, PHASES
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.push import Push

PUSH = 10.0
"""Force on what points of an arm of size 1 [N], for two seconds."""

SPEED, JUMP = 0.1, 0.15
"""How fast an object moves [m/s] while an arm of size 1 turns and points to it, and how far it
jumps [m]."""

TRIES = 30
"""Headings that are drawn for an object, at most, until the arm can point wherever it comes."""

_DRAWS = 2


def conditions(lab: Lab, plan: Plan) -> Phases:
    """Every situation at rest, moving and jumping; the same pushes at rest and moving."""
    task = cast(Pointing, lab.task)
    pointer, found = task.pointer, []
    for index in range(plan.situations):
        situation = draw_situation(lab.task, plan.seed, index)
        rng = plan.rng(_DRAWS, index)
        moving, jumping = (_moved(task, situation, rng, how) for how in (_passing, _jumping))
        found += [
            Condition("unpushed", situation),
            Condition("moving", moving),
            Condition("jump", jumping),
        ]
        for k in range(plan.pushes):
            push = _push(pointer, rng, PHASES[OBJECTS[k % 2]][0])
            found.append(Condition("pushed", situation, push=(push,)))
            found.append(Condition("moving pushed", moving, push=(push,)))
    yield found


def _heading(rng: np.random.Generator, dims: int = 2) -> np.ndarray:
    """A direction (3,): in the plane on which the objects lie, or any."""
    heading = np.append(rng.standard_normal(dims), np.zeros(3 - dims))
    return heading / np.linalg.norm(heading)


def _push(pointer: Pointer, rng: np.random.Generator, start: float) -> Push:
    force = PUSH * pointer.size * _heading(rng, len(pointer.axis.axes))
    return Push(pointer.axis.site, tuple(force.tolist()), start=start)


def _moved(
    task: Pointing,
    situation: Situation,
    rng: np.random.Generator,
    move: Callable[[ObjectPath, np.ndarray], ObjectPath],
) -> Situation:
    """The situation with every object moving as ``move`` says, some way that the arm can follow.

    Raises
    ------
    SimulationError
        If there is none among those that were drawn.
    """

    def somewhere(path: ObjectPath) -> ObjectPath:
        for _ in range(TRIES):
            moved = move(path, task.pointer.size * _heading(rng))
            if task.shown_by.can_follow(task.stage, moved):
                return moved
        raise SimulationError(
            f"the arm of this robot cannot point at '{path.name}' wherever it moves from "
            f"{path.first.position.round(2)}, in any of {TRIES} directions; draw other situations"
        )

    return replace(situation, objects=tuple(map(somewhere, situation.objects)))


def _passing(path: ObjectPath, heading: np.ndarray) -> ObjectPath:
    """Past its place at even speed, while the arm turns to it and points; heading of arm's size."""
    place, (start, end) = path.first.position, PHASES[path.name]
    start -= APPROACH
    way = SPEED * (end - start) / 2 * heading
    ends = np.array([place - way, place + way])
    return ObjectPath(path.name, ends.tolist(), (start, end))


def _jumping(path: ObjectPath, heading: np.ndarray) -> ObjectPath:
    """Elsewhere all at once, in the middle of its phase."""
    place, moment = path.first.position, float(np.mean(PHASES[path.name]))
    places = np.array([place, place, place + JUMP * heading])
    return ObjectPath(path.name, places.tolist(), (0.0, moment, moment))


def study(task: Pointing | None = None) -> Study:
    """The study of pointing with any robot."""
    task = Pointing() if task is None else task
    compared = contest(task)
    return Study(
        task,
        measures,
        controllers=fixed_gains(compared.experts["computed"]),
        conditions=conditions,
        contest=compared,
        of=study,
        title="Pointing at two objects",
        lead=(
            "The weightless arm was led to point at one object, at another, and back to rest. What "
            "must be precise when, and in which frame, the posture, the robot or an object, was "
            "found in the demonstrations alone. The arm then points where it was never shown, at "
            "objects that move while it does, and gives way to pushes that do not spoil the "
            "pointing."
        ),
        sections=pictures.sections,
        clips=pictures.clips,
    )


pointing = study()
