"""A study at work leaves a folder: trials as they come, and what standard error says meanwhile."""

import shutil
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from tpsim.study.condition import Condition
from tpsim.study.executor import perform_each
from tpsim.study.files.run import Run, open_run, run_folder
from tpsim.study.files.stored import Stub
from tpsim.study.measure import concerns
from tpsim.study.record import Lost, Numbers, Record, Records
from tpsim.study.study import Study
from tpsim.study.workers import Death, Executors
from tpsim.task.task import Models
from tpsim.whole import sweep
from tpsim.world.trial import Trial

Answer = dict[str, object]
"""What came out: plain values by name."""


def say(message: str) -> None:
    """Tell on standard error what is being done."""
    print(f"tpsim: {message}", file=sys.stderr, flush=True)


def open_folder(
    study: Study, command: str, settings: Mapping[str, object], seed: int, folder: Path | None
) -> Run:
    """Make a run folder; a new one in ``recordings/runs`` where none is given."""
    folder = run_folder(study.task.name, seed) if folder is None else folder
    return open_run(folder, study=study, command=command, configuration=settings, seed=seed)


@contextmanager
def kept_or_removed(folder: Path) -> Iterator[None]:
    """Take a new run folder away if the work fails before a trial; say where trials are kept."""
    try:
        yield
    except BaseException as error:
        sweep(folder)
        if not any(folder.glob("trial-*.npz")):
            shutil.rmtree(folder, ignore_errors=True)
        elif isinstance(error, KeyboardInterrupt):
            error.add_note(f"finished trials are kept in {folder}")
        raise


def record_all(
    run: Run,
    study: Study,
    records: Records,
    conditions: Sequence[Condition],
    workers: int = 1,
    tick: Callable[[], object] | None = None,
    executor: Executors | None = None,
) -> None:
    """Perform conditions and add them to the records.

    A trial is written and measured where it was performed. What comes back is small, so that this
    process does not grow with the number of trials; their signals are read when they are asked for.
    """
    first = len(records) + len(records.lost)
    keep = partial(_write_and_measure, run, first)
    kept = perform_each(study, records.models, conditions, keep, workers, executor)
    for number, (condition, found) in enumerate(zip(conditions, kept, strict=True), first):
        if isinstance(found, Death):
            records.lost.append(Lost(number, condition, str(found)))
            say(f"trial {number} ({condition.label}, {condition.controller}) is missing: {found}")
        else:
            stub, numbers = found
            records.add(condition, stub.trial(), numbers)
        if tick is not None:
            tick()


def _write_and_measure(
    run: Run,
    first: int,
    study: Study,
    models: Models,
    number: int,
    condition: Condition,
    trial: Trial,
) -> tuple[Stub, Numbers]:
    # A worker that died may have written it; the folder is this run's alone.
    run.path(first + number).unlink(missing_ok=True)
    path = run.save(first + number, trial)
    record = Record(condition, trial, study.task, models, _Elsewhere(study.task, models))
    return Stub.of(trial, path), _numbers(study, record)


def _numbers(study: Study, record: Record) -> Numbers:
    """What can be measured of one trial alone; what looks at others is measured at the end."""
    found = {}
    for measure in study.all_measures:
        if measure.of is not None and concerns(measure, record.condition.label):
            try:
                found[measure.name] = measure.number(record)
            except Exception:  # it is raised where the figure is asked for
                continue
    return found


class _Elsewhere(Records):
    """The other records of a study, where they are not."""

    def _refuse(self, *_: object, **__: object):  # type: ignore[no-untyped-def]
        raise LookupError("the other records of the study are not in this process")

    select = __iter__ = __getitem__ = __len__ = _refuse  # type: ignore[assignment]
