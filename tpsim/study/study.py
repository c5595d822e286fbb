"""What a study is: a task, controllers to compare, conditions, measures, and what is shown."""

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tpsim.border import Number, SeedNumber, border, checked
from tpsim.film.clip import Clip
from tpsim.study.condition import Condition
from tpsim.study.contest import Contest
from tpsim.study.measure import Measure
from tpsim.study.record import Records
from tpsim.study.report import Section
from tpsim.task.task import Models, Situation, Task, draw_situation
from tpsim.task.verbs import Taught
from tpsim.world.impedance import Controller
from tpsim.world.people.push import Push
from tpsim.world.teaching import Lesson
from tpsim.world.world import World

ControllerFactory = Callable[[World, Models, Situation], Controller]
"""Makes a controller for one trial."""

ControllersOf = Callable[[Task], Mapping[str, ControllerFactory]]
"""Makes the controllers of a task, which depend on its fields."""

Phases = Generator[list[Condition], Records, None]
"""Yields the conditions of a phase; is sent all records so far, on which the next may build."""


@dataclass(frozen=True)
class Plan:
    """How many trials a run asks for.

    Parameters
    ----------
    seed : int
        Of everything random.
    situations, pushes : int
        Situations that were never taught, and pushes in each.
    """

    seed: SeedNumber = 0
    situations: Number = 10
    pushes: Number = 6

    def __post_init__(self) -> None:
        checked(self)

    @border
    def rng(self, *key: Number) -> np.random.Generator:
        """Random numbers of their own for a part of the study."""
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=key))


@dataclass(frozen=True)
class Lab:
    """A study at work: what its functions are given.

    Parameters
    ----------
    study : Study
    models : mapping of str to TPGMM
        What was learned.
    taught : mapping of str to sequence of Trial
        What was taught.
    """

    study: "Study"
    models: Models
    taught: Taught = field(default_factory=dict)

    def __post_init__(self) -> None:
        checked(self)

    @property
    def task(self) -> Task:
        """The task."""
        return self.study.task

    @property
    def world(self) -> World:
        """The task's world."""
        return self.study.task.stage


@border
def pushes_all_round(force: float = 20.0, body: str | None = None) -> "ConditionsOf":
    """Conditions of a plain study: every situation unpushed, and pushed along x, y, z, -x, ...

    Parameters
    ----------
    force : float
        [N], for two seconds.
    body : str, optional
        Body or site that is pushed; the first hand by default.
    """

    def conditions(lab: Lab, plan: Plan) -> Phases:
        site = body or next(iter(lab.world.robot.hands.values()))
        directions = np.vstack([np.eye(3), -np.eye(3)])
        found = []
        for index in range(plan.situations):
            situation = draw_situation(lab.task, plan.seed, index)
            for name in lab.study.all_controllers:
                found.append(Condition("unpushed", situation, name))
                for k in range(plan.pushes):
                    push = Push(site, tuple((force * directions[k % 6]).tolist()))
                    found.append(Condition("pushed", situation, name, (push,)))
        yield found

    return conditions


ConditionsOf = Callable[[Lab, Plan], Phases]

MeasuresOf = Callable[[Task], Sequence[Measure]]


@dataclass(frozen=True)
class Study:
    """An experiment on one task.

    Parameters
    ----------
    task : Task
    measures : sequence of Measure, or callable
        Figures, in the order of the report; or ``measures(task)`` that gives them, where the
        task's fields count.
    controllers : mapping of str to callable, or callable, optional
        What to compare with: ``{"mine": lambda world, models, situation: ...}``, or
        ``controllers(task)`` that gives such a mapping, where the task's fields count. The task's
        own is ``"learned"``, and always there.
    conditions : callable
        ``conditions(lab, plan)`` yields lists of conditions, phase by phase: by default every
        situation unpushed and pushed with 20 N on the first hand, by every controller.
    probes : mapping of str to callable
        Figures that need experiments of their own beside the trials: ``probe(lab) -> float``; the
        measure of that name gives title, unit and limit.
    title, lead : str
        Heading and opening paragraph of the report.
    sections : callable, optional
        ``sections(records)``: more of the report.
    clips : callable, optional
        ``clips(lab, records)``: sequences of the film, several in one place side by side; a
        demonstration and the worst trials by
        default.
    show : callable, optional
        ``show(world, condition, rng) -> Lesson``: how the teacher shows a condition whose
        ``shown`` names a behaviour.
    contest : Contest, optional
        How experts and other controllers are compared with what was learned; its experts are
        controllers of the study.
    of : callable, optional
        ``of(task) -> Study``: the study of a task with other fields, where these count for more
        than for its measures and controllers.
    reference : str
        Where it is from, such as ``"my_task.py:study"``; filled in by
        :func:`~tpsim.study.reference.load_study`, and part of ``run.json``.
    """

    task: Task
    measures: Sequence[Measure] | MeasuresOf = ()
    controllers: Mapping[str, ControllerFactory] | ControllersOf = field(default_factory=dict)
    conditions: ConditionsOf = field(default_factory=pushes_all_round)
    probes: Mapping[str, Callable[[Lab], float]] = field(default_factory=dict)
    title: str = ""
    lead: str = ""
    sections: Callable[[Records], list[Section]] | None = None
    clips: Callable[[Lab, Records], Sequence[Clip | Sequence[Clip]]] | None = None
    show: Callable[[World, Condition, np.random.Generator], Lesson] | None = None
    contest: Contest | None = None
    of: "Callable[[Any], Study] | None" = None
    reference: str = ""

    def __post_init__(self) -> None:
        checked(self)

    @property
    def all_measures(self) -> tuple[Measure, ...]:
        """The measures of this task."""
        return tuple(self.measures(self.task) if callable(self.measures) else self.measures)

    @property
    def all_controllers(self) -> Mapping[str, ControllerFactory]:
        """The task's own controller and those to compare with."""
        others = self.controllers(self.task) if callable(self.controllers) else self.controllers
        experts = {} if self.contest is None else self.contest.experts
        return {"learned": self.task.controller, **others, **experts}

    @property
    def performers(self) -> Mapping[str, ControllerFactory]:
        """All controllers, and in a contest softer experts and variants of the learned one."""
        if self.contest is None:
            return self.all_controllers
        variants = {
            f"learned, {name}": task.in_world(self.task.stage).controller
            for name, task in self.contest.variants(self.task).items()
        }
        return {**self.all_controllers, **self.contest.softer, **variants}

    def with_task(self, **fields: object) -> "Study":
        """The same study of a task with other fields, of the kinds that it asks for."""
        task = replace(self.task, **fields)  # type: ignore[type-var]  # subclasses are dataclasses
        checked(task)
        return self.about(task)

    @border
    def in_world(self, world: World) -> "Study":
        """The same study in a world that was read back or handed over."""
        return replace(self, task=self.task.in_world(world))

    def about(self, task: Task) -> "Study":
        """The same study of another task of its kind."""
        if self.of is None:
            return replace(self, task=task)
        return replace(self.of(task), reference=self.reference)
