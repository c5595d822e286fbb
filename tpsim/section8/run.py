"""Running a plan: cell by cell, in one process or several, going on where it was cut off."""

import os
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path

from tqdm import tqdm

from tpsim.errors import RecordingError
from tpsim.section8.families import FAMILIES
from tpsim.section8.method import Method
from tpsim.section8.plan import Plan
from tpsim.section8.trial import Trial, perform
from tpsim.study.workers import Death, Workers
from tpsim.world.threads import one_thread

Cell = tuple[str, int, int]


def run(
    plan: Plan,
    methods: Mapping[str, Method],
    folder: Path,
    workers: int = 1,
    progress: bool = False,
) -> dict[Cell, Trial]:
    """Perform every cell of a plan that the folder does not hold yet, and read the others.

    Parameters
    ----------
    plan, methods
        What to do.
    folder
        Where the results of the cells are.
    workers
        Number of processes. A cell that ends its process twice is a row with the reason.
    progress
        Show a bar on standard error.
    """
    done = {cell: _stored(plan, methods, folder, cell) for cell in plan.cells()}
    todo = [cell for cell, trial in done.items() if trial is None]
    performed = _performed(plan, methods, todo, workers)
    kept = len(done) - len(todo)
    for cell, trial in tqdm(
        performed, "compare", len(done), initial=kept, disable=not progress, unit="cell"
    ):
        if isinstance(trial, Death):
            # It is not saved: the next time it is tried again.
            count = len(plan.distances) * plan.situations
            done[cell] = Trial.failed(methods, count, f"the comparison died: {trial}")
            continue
        key = plan.key(cell, methods)
        trial.save(_file(folder, cell, key), key)
        done[cell] = trial
    return {cell: trial for cell, trial in done.items() if trial is not None}


@one_thread()
def perform_cell(plan: Plan, methods: Mapping[str, Method], cell: Cell) -> Trial:
    """Teach, learn and retrieve: one family, number of demonstrations and teacher."""
    name, count, seed = cell
    family = FAMILIES[name]
    situations = [
        situation
        for distance in plan.distances
        for situation in family.situations(plan.situations, distance, plan.samples, seed)
    ]
    return perform(methods, family.demonstrations(count, plan.samples, seed), situations)


def _performed(
    plan: Plan, methods: Mapping[str, Method], cells: list[Cell], workers: int
) -> Iterator[tuple[Cell, Trial | Death]]:
    # Methods may be closures: they travel by value.
    with Workers(min(workers, len(cells)) or 1, _open, (plan, dict(methods))) as pool:
        yield from zip(cells, pool.map(cells), strict=True)


def _open(given: tuple[Plan, Mapping[str, Method]]) -> "partial[Trial]":
    return partial(perform_cell, *given)


def _stored(plan: Plan, methods: Mapping[str, Method], folder: Path, cell: Cell) -> Trial | None:
    key = plan.key(cell, methods)
    path = _file(folder, cell, key)
    if not os.path.lexists(path):
        return None
    trial = Trial.load(path, key)
    situations = len(plan.distances) * plan.situations
    if (trial.methods, trial.figures.shape[1]) != (tuple(methods), situations):
        raise RecordingError(f"{path} is damaged: it is of other methods; delete it and run again")
    return trial


def _file(folder: Path, cell: Cell, key: str) -> Path:
    """File of a cell; the results of other plans and methods stand beside it."""
    family, count, seed = cell
    name = f"{family.replace(' ', '-')}-{count}-demonstrations-seed-{seed}-{key[:8]}.npz"
    return folder / "cells" / name
