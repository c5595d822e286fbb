"""The verbs reproduce and push: one situation that was never taught."""

from dataclasses import asdict, replace
from pathlib import Path

from tpsim.study import figures
from tpsim.study.condition import Condition
from tpsim.study.record import Records
from tpsim.study.recording import Answer, kept_or_removed, open_folder, record_all
from tpsim.study.study import Study
from tpsim.study.teaching import Source, models_of
from tpsim.task.task import draw_situation
from tpsim.world.people.push import Push
from tpsim.world.threads import one_thread


def reproduce(
    study: Study,
    demonstrations: Source | None = None,
    *,
    situation: int = 0,
    seed: int = 0,
    folder: Path | None = None,
    command: str = "",
) -> Answer:
    """Perform a task once in a situation that was never taught.

    ``demonstrations`` are as for :func:`tpsim.study.teaching.learn`; the models of a run are taken
    as they are, and nothing is learned.
    """
    return _try(study, demonstrations, situation, seed, folder, command, None)


def push(
    study: Study,
    demonstrations: Source | None = None,
    *,
    force: tuple[float, float, float] = (0.0, 20.0, 0.0),
    start: float = 2.0,
    duration: float = 2.0,
    body: str | None = None,
    situation: int = 0,
    seed: int = 0,
    folder: Path | None = None,
    command: str = "",
) -> Answer:
    """Perform a task in a situation that was never taught, pushed and, beside it, not.

    ``body`` is a body or site, the first hand by default; ``force`` [N] acts from ``start`` for
    ``duration`` [s].
    """
    world = study.task.stage
    body = next(iter(world.robot.hands.values())) if body is None else body
    world.simulation().attachment(body)
    pushed = Push(body, (force[0], force[1], force[2]), start, duration)
    return _try(study, demonstrations, situation, seed, folder, command, pushed)


@one_thread()
def _try(
    study: Study,
    demonstrations: Source | None,
    index: int,
    seed: int,
    folder: Path | None,
    command: str,
    push: Push | None,
) -> Answer:
    task = study.task
    models = models_of(study, demonstrations)
    situation = draw_situation(task, seed, index)
    conditions = [Condition("unpushed", situation)]
    if push is not None:
        after = push.start + push.duration + 1.0
        conditions = [replace(conditions[0], duration=max(task.duration, after))]
        conditions.append(replace(conditions[0], label="pushed", push=(push,)))
    settings = {"situation": asdict(situation), "push": push and asdict(push)}
    run = open_folder(study, command, settings, seed, folder)
    with kept_or_removed(run.folder):
        run.save_models(models)
        records = Records(task, models)
        record_all(run, study, records, conditions)
        run.finish()
    return {
        "task": task.name,
        "seed": seed,
        "situation": index,
        "outcome": records[-1].trial.outcome,
        "figures": figures.of_trials(study, records),
        "paths": {"run": str(run.folder)},
    }
