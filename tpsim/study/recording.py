"""A study at work leaves a folder: trials as they come, and what standard error says meanwhile."""

import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from tpsim.study.condition import Condition
from tpsim.study.executor import perform_all
from tpsim.study.files.run import Run, open_run, run_folder
from tpsim.study.record import Records
from tpsim.study.study import Study

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


def record_all(
    run: Run,
    study: Study,
    records: Records,
    conditions: Sequence[Condition],
    workers: int = 1,
    tick: Callable[[], object] | None = None,
) -> None:
    """Perform conditions, write every trial as it comes, and add it to the records."""
    trials = perform_all(study, records.models, conditions, workers)
    for condition, trial in zip(conditions, trials, strict=True):
        run.save(len(records), trial)
        records.add(condition, trial)
        if tick is not None:
            tick()
