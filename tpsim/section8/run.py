"""Running a plan: cell by cell, in one process or several, going on where it was cut off."""

import os
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from tqdm import tqdm

from tpsim.errors import RecordingError
from tpsim.section8.families import FAMILIES
from tpsim.section8.fingerprint import fingerprint, mathematics
from tpsim.section8.measures import FIGURES, measure
from tpsim.section8.method import Method
from tpsim.section8.plan import Cell, Plan
from tpsim.section8.trial import Trial, perform
from tpsim.study.workers import Death, Workers
from tpsim.world.threads import one_thread

PerformCell = Callable[[Plan, Mapping[str, Method], Cell], Trial]


@one_thread()
def perform_cell(plan: Plan, methods: Mapping[str, Method], cell: Cell) -> Trial:
    """Teach, learn and retrieve: one family, number of demonstrations and teacher."""
    return perform(methods, *drawn(FAMILIES, plan, cell))


def drawn(families: Mapping[str, Any], plan: Plan, cell: Cell) -> tuple[list, list]:
    """Demonstrations of a cell, and its situations at all distances."""
    name, count, seed = cell
    family = families[name]
    situations = [
        situation
        for distance in plan.distances
        for situation in family.situations(plan.situations, distance, plan.samples, seed)
    ]
    return family.demonstrations(count, plan.samples, seed), situations


def run(
    plan: Plan,
    methods: Mapping[str, Method],
    folder: Path,
    workers: int = 1,
    progress: bool = False,
    performed_by: PerformCell = perform_cell,
    code: str | None = None,
    figures: Collection[str] = tuple(FIGURES),
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
    performed_by
        Makes a cell; by default of the retrieved movements alone.
    code
        Fingerprint of all that makes it; by default that of methods, families and measures.
    figures
        Names of what is measured.
    """
    if code is None:
        code = fingerprint([methods, FAMILIES, measure, mathematics()])
    keys = {cell: plan.key(cell, code) for cell in plan.cells()}
    done = {cell: _stored(plan, methods, figures, folder, cell, key) for cell, key in keys.items()}
    todo = [cell for cell, trial in done.items() if trial is None]
    performed = _performed(performed_by, plan, methods, todo, workers)
    kept = len(done) - len(todo)
    for cell, trial in tqdm(
        performed, "compare", len(done), initial=kept, disable=not progress, unit="cell"
    ):
        if isinstance(trial, Death):
            # It is not saved: the next time it is tried again.
            count = len(plan.distances) * plan.situations
            reason = f"the comparison died: {trial}"
            done[cell] = Trial.failed(methods, count, figures, reason)
            continue
        trial.save(_file(folder, cell, keys[cell]), keys[cell])
        done[cell] = trial
    return {cell: trial for cell, trial in done.items() if trial is not None}


def _performed(
    by: PerformCell, plan: Plan, methods: Mapping[str, Method], cells: list[Cell], workers: int
) -> Iterator[tuple[Cell, Trial | Death]]:
    if not cells:
        return
    # Methods may be closures: they travel by value.
    given = by, plan, dict(methods)
    with Workers(min(workers, len(cells)), _open, given) as pool:
        yield from zip(cells, pool.map(cells), strict=True)


def _open(given: tuple[PerformCell, Plan, Mapping[str, Method]]) -> "partial[Trial]":
    by, plan, methods = given
    return partial(by, plan, methods)


def _stored(
    plan: Plan,
    methods: Mapping[str, Method],
    figures: Collection[str],
    folder: Path,
    cell: Cell,
    key: str,
) -> Trial | None:
    path = _file(folder, cell, key)
    if not os.path.lexists(path):
        return None
    trial = Trial.load(path, key)
    shape = len(methods), len(plan.distances) * plan.situations, len(figures)
    if (trial.methods, trial.figures.shape) != (tuple(methods), shape):
        raise RecordingError(f"{path} is damaged: it is of other methods; delete it and run again")
    return trial


def _file(folder: Path, cell: Cell, key: str) -> Path:
    """File of a cell; the results of other plans and methods stand beside it."""
    family, count, seed = cell
    name = f"{family.replace(' ', '-')}-{count}-demonstrations-seed-{seed}-{key[:8]}.npz"
    return folder / "cells" / name
