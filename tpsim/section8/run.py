"""Running a plan: cell by cell, in one process or several, going on where it was cut off."""

import multiprocessing
import os
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from tqdm import tqdm

from tpsim.errors import RecordingError
from tpsim.section8.families import FAMILIES
from tpsim.section8.fingerprint import fingerprint, mathematics
from tpsim.section8.measures import measure
from tpsim.section8.method import Method
from tpsim.section8.plan import Cell, Plan
from tpsim.section8.trial import Trial, perform

PerformCell = Callable[[Plan, Mapping[str, Method], Cell], Trial]


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


def run(
    plan: Plan,
    methods: Mapping[str, Method],
    folder: Path,
    workers: int = 1,
    progress: bool = False,
    performed_by: PerformCell = perform_cell,
    code: str | None = None,
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
    performed_by
        Makes a cell; by default of the retrieved movements alone.
    code
        Fingerprint of all that makes it; by default that of methods, families and measures.
    """
    if code is None:
        code = fingerprint([methods, FAMILIES, measure, mathematics()])
    keys = {cell: plan.key(cell, code) for cell in plan.cells()}
    done = {cell: _stored(folder, cell, key) for cell, key in keys.items()}
    todo = [cell for cell, trial in done.items() if trial is None]
    performed = _performed(performed_by, plan, methods, todo, workers)
    kept = len(done) - len(todo)
    for cell, trial in tqdm(
        performed, "compare", len(done), initial=kept, disable=not progress, unit="cell"
    ):
        trial.save(_file(folder, cell), keys[cell])
        done[cell] = trial
    return {cell: trial for cell, trial in done.items() if trial is not None}


def _performed(
    by: PerformCell, plan: Plan, methods: Mapping[str, Method], cells: list[Cell], workers: int
) -> Iterator[tuple[Cell, Trial]]:
    workers = min(workers, len(cells))
    if workers < 2 or "fork" not in multiprocessing.get_all_start_methods():
        yield from ((cell, by(plan, methods, cell)) for cell in cells)
        return
    context = multiprocessing.get_context("fork")  # methods may be closures, which do not pickle
    with ProcessPoolExecutor(workers, context, _start, (by, plan, methods)) as pool:
        try:
            yield from zip(cells, pool.map(_in_process, cells), strict=True)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


_work: tuple[PerformCell, Plan, Mapping[str, Method]] | None = None


def _start(by: PerformCell, plan: Plan, methods: Mapping[str, Method]) -> None:
    global _work
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    _work = by, plan, methods


def _in_process(cell: Cell) -> Trial:
    assert _work is not None
    by, plan, methods = _work
    return by(plan, methods, cell)


def _stored(folder: Path, cell: Cell, key: str) -> Trial | None:
    path = _file(folder, cell)
    if not path.is_file():
        return None
    try:
        return Trial.load(path, key)
    except (RecordingError, KeyError):
        return None


def _file(folder: Path, cell: Cell) -> Path:
    family, count, seed = cell
    return folder / "cells" / f"{family.replace(' ', '-')}-{count}-demonstrations-seed-{seed}.npz"
