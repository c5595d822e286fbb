"""Conditions performed: the one place where a condition becomes a trial, here or in processes."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.study.condition import Condition
from tpsim.study.files.about import Performed, TaskFile
from tpsim.study.files.checked import plain
from tpsim.study.study import Study
from tpsim.study.workers import Workers
from tpsim.task.task import Models
from tpsim.task.verbs import perform
from tpsim.world.teaching import demonstrate
from tpsim.world.threads import one_thread
from tpsim.world.trial import Trial
from tpsim.world.world import World

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
    if condition.shown is None:
        trial = _perform(study, models, condition)
    else:
        trial = _show(study, condition)
    about = plain(Performed(condition, TaskFile.of(study)))
    assert isinstance(about, dict)
    return trial.with_about(**about)


def _perform(study: Study, models: Models, condition: Condition) -> Trial:
    found, task = study.performers, study.task
    if condition.controller not in found:
        raise ArgumentError(
            f"the study has no controller '{condition.controller}'; it has {', '.join(found)}"
        )
    return perform(
        task,
        models,
        condition.situation,
        controller=found[condition.controller](task.stage, models, condition.situation),
        people=condition.people,
        duration=condition.duration,
        plant=condition.plant,
    )


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
        If a worker dies.
    """
    if workers < 1:
        raise ArgumentError(f"{workers} workers were asked for; ask for at least 1")
    if workers == 1 or len(conditions) < 2:
        yield from (perform_condition(study, models, condition) for condition in conditions)
        return
    world = study.task.stage
    made = study, dict(models), (world.xml, world.description, dict(world.assets))
    with Workers(min(workers, len(conditions)), _open, made) as pool:
        yield from pool.map(conditions)


def _open(made: tuple[Study, Models, tuple]) -> "partial[Trial]":
    study, models, world = made
    task = study.task.in_world(World(*world))
    return partial(perform_condition, replace(study, task=task), models)
