"""Running a plan: cell by cell, in one process or several, going on where it was cut off."""

import multiprocessing
import os
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from tqdm import tqdm

from tpsim.errors import RecordingError
from tpsim.section8.families import FAMILIES
from tpsim.section8.method import Method
from tpsim.section8.plan import Plan
from tpsim.section8.trial import Trial, perform
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
        Number of processes; more than one needs a system that can fork.
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
) -> Iterator[tuple[Cell, Trial]]:
    workers = min(workers, len(cells))
    if workers < 2 or "fork" not in multiprocessing.get_all_start_methods():
        yield from ((cell, perform_cell(plan, methods, cell)) for cell in cells)
        return
    context = multiprocessing.get_context("fork")  # methods may be closures, which do not pickle
    with ProcessPoolExecutor(workers, context, _start, (plan, methods)) as pool:
        try:
            yield from zip(cells, pool.map(_in_process, cells), strict=True)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


_work: tuple[Plan, Mapping[str, Method]] | None = None


def _start(plan: Plan, methods: Mapping[str, Method]) -> None:
    global _work
    _work = plan, methods


def _in_process(cell: Cell) -> Trial:
    assert _work is not None
    return perform_cell(*_work, cell)


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
