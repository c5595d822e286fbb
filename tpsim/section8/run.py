"""Running a plan: cell by cell, in one process or several, going on where it was cut off."""

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path

from threadpoolctl import threadpool_limits
from tqdm import tqdm

from tpsim.errors import RecordingError
from tpsim.section8.families import FAMILIES
from tpsim.section8.method import Method
from tpsim.section8.plan import Plan
from tpsim.section8.trial import Trial, perform
from tpsim.study.workers import Death, Workers

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
        trial.save(_file(folder, cell), plan.key(cell, methods))
        done[cell] = trial
    return {cell: trial for cell, trial in done.items() if trial is not None}


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
    return partial(_limited, *given)


def _limited(plan: Plan, methods: Mapping[str, Method], cell: Cell) -> Trial:
    with threadpool_limits(1):
        return perform_cell(plan, methods, cell)


def _stored(plan: Plan, methods: Mapping[str, Method], folder: Path, cell: Cell) -> Trial | None:
    path = _file(folder, cell)
    if not path.is_file():
        return None
    try:
        return Trial.load(path, plan.key(cell, methods))
    except (RecordingError, KeyError):
        return None


def _file(folder: Path, cell: Cell) -> Path:
    family, count, seed = cell
    return folder / "cells" / f"{family.replace(' ', '-')}-{count}-demonstrations-seed-{seed}.npz"
