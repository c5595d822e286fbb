"""Conditions performed: the one place where a condition becomes a trial, here or in processes."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TypeVar

import numpy as np

from tpsim.errors import ArgumentError, SimulationError
from tpsim.study.condition import Condition
from tpsim.study.files.about import Performed, TaskFile
from tpsim.study.files.checked import plain
from tpsim.study.study import Study
from tpsim.study.workers import Death, Executors, Workers
from tpsim.task.task import Models
from tpsim.task.verbs import perform, perform_beside
from tpsim.world.impedance import Controller
from tpsim.world.teaching import demonstrate
from tpsim.world.threads import one_thread
from tpsim.world.trial import Trial
from tpsim.world.world import World

T = TypeVar("T")

_SHOWN = 2


@one_thread()
def perform_condition(study: Study, models: Models, condition: Condition) -> Trial:
    """Perform one condition; ``about`` of the trial says how to do so again.

    Parameters
    ----------
    study : Study
    models : mapping of str to TPGMM
    condition : Condition

    Raises
    ------
    ArgumentError
        If the study has no such controller, or cannot show behaviours.
    """
    if condition.shown is not None:
        return _told(study, condition, _show(study, condition))
    trial = perform(
        study.task,
        models,
        condition.situation,
        controller=_controller(study, models, condition),
        people=condition.people,
        duration=condition.duration,
        plant=condition.plant,
    )
    return _told(study, condition, trial)


@one_thread()
def perform_pushed(
    study: Study, models: Models, rest: Condition, pushed: Sequence[Condition]
) -> list[Trial]:
    """Perform an undisturbed condition, and the same under pushes, from what they share.

    Parameters
    ----------
    study : Study
    models : mapping of str to TPGMM
    rest : Condition
    pushed : sequence of Condition
        Each with one push, and else as ``rest``.

    Returns
    -------
    list of Trial
        The undisturbed one first; see :func:`~tpsim.task.verbs.perform_beside`.
    """
    trials = perform_beside(
        study.task,
        models,
        rest.situation,
        [condition.push[0] for condition in pushed],
        controller=_controller(study, models, rest),
        duration=rest.duration,
        plant=rest.plant,
    )
    return [_told(study, c, trial) for c, trial in zip([rest, *pushed], trials, strict=True)]


def _told(study: Study, condition: Condition, trial: Trial) -> Trial:
    """A trial that says how to perform it again."""
    about = plain(Performed(condition, TaskFile.of(study)))
    assert isinstance(about, dict)
    return trial.with_about(**about)


def _controller(study: Study, models: Models, condition: Condition) -> Controller:
    found, task = study.performers, study.task
    if condition.controller not in found:
        raise ArgumentError(
            f"the study has no controller '{condition.controller}'; it has {', '.join(found)}"
        )
    return found[condition.controller](task.stage, models, condition.situation)


def _show(study: Study, condition: Condition) -> Trial:
    """Show a behaviour; draws from ``SeedSequence(seed, spawn_key=(2, index))``."""
    if study.show is None:
        raise ArgumentError(
            f"condition '{condition.label}' is to show '{condition.shown}', and the study has no "
            "`show`; give it a function (world, condition, rng) -> Lesson"
        )
    situation, world = condition.situation, study.task.stage
    key = np.random.SeedSequence(situation.seed, spawn_key=(_SHOWN, situation.index))
    lesson = study.show(world, condition, np.random.default_rng(key))
    return demonstrate(world, lesson, study.task.sites())


def perform_all(
    study: Study, models: Models, conditions: Sequence[Condition], workers: int = 1
) -> Iterator[Trial]:
    """Perform conditions; trials come in the order of conditions.

    Each trial starts from its condition alone, so the number of workers changes no bit.

    Parameters
    ----------
    study : Study
    models : mapping of str to TPGMM
    conditions : sequence of Condition
    workers : int
        Processes; with 1 all is performed in this one.

    Raises
    ------
    ArgumentError
        If ``workers`` is less than 1.
    SimulationError
        If a trial ended its worker twice.
    """
    for number, trial in enumerate(perform_each(study, models, conditions, _kept_whole, workers)):
        if isinstance(trial, Death):
            raise SimulationError(f"trial {number} was not performed: {trial}")
        yield trial


Keep = Callable[[Study, Models, int, Condition, Trial], T]
"""What is kept of a trial: ``keep(study, models, number, condition, trial)``."""


def perform_each(
    study: Study,
    models: Models,
    conditions: Sequence[Condition],
    keep: Keep[T],
    workers: int = 1,
    executor: Executors | None = None,
) -> Iterator[T | Death]:
    """Perform conditions, and keep of every trial what ``keep`` makes of it where it was performed.

    Parameters
    ----------
    study, models, conditions, workers
        As for :func:`perform_all`.
    keep : callable
        What it returns travels from the worker to this process.
    executor : callable, optional
        As for :class:`~tpsim.study.workers.Workers`, where there are several.

    Yields
    ------
    object
        What was kept, in the order of conditions; a :class:`~tpsim.study.workers.Death` for a
        trial that ended its worker twice.
    """
    if workers < 1:
        raise ArgumentError(f"{workers} workers were asked for; ask for at least 1")
    count = min(workers, len(conditions)) or 1
    world = study.task.stage
    made: _Made[T] = (study, dict(models), keep, None)
    if count > 1:
        made = (*made[:3], (world.xml, world.description, dict(world.assets)))
    with Workers(count, _open, made, executor if count > 1 else None) as pool:
        yield from pool.map(list(enumerate(conditions)))


_Made = tuple[Study, Models, Keep[T], tuple | None]


def _open(made: _Made[T]) -> "partial[T]":
    study, models, keep, world = made
    if world is not None:
        study = study.in_world(World(*world))
    return partial(_perform_and_keep, study, models, keep)


@one_thread()
def _perform_and_keep(study: Study, models: Models, keep: Keep[T], job: tuple[int, Condition]) -> T:
    number, condition = job
    return keep(study, models, number, condition, perform_condition(study, models, condition))


def _kept_whole(_: Study, __: Models, ___: int, ____: Condition, trial: Trial) -> Trial:
    return trial
