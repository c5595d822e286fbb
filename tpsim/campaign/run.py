"""Campaigns at work: what is not done yet is performed, here, in processes or on a cluster."""

import sys
import time
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

from tqdm import tqdm

from tpsim.border import Count, border
from tpsim.campaign import lessons, report
from tpsim.campaign.campaign import Campaign, named
from tpsim.campaign.design import asked, blocks, lessons_of, trials_of
from tpsim.campaign.figures import asked_row, failed_row
from tpsim.campaign.folder import Folder, check_versions, open_folder
from tpsim.campaign.performing import Bench, Done, Job, bench
from tpsim.campaign.progress import NAME, ProgressPage, arrive
from tpsim.campaign.table import FAILED, Row, write_table
from tpsim.errors import ArgumentError
from tpsim.extras import extra
from tpsim.study.lending import Lender
from tpsim.study.recording import Answer, say
from tpsim.study.reference import load_study
from tpsim.study.study import Study
from tpsim.study.workers import Death, Executors, Workers
from tpsim.tasks import STUDIES


@border
def campaign(
    described: Campaign,
    folder: str | Path,
    *,
    workers: Count = 1,
    shard: tuple[int, int] = (0, 1),
    retry: bool = False,
    study: Study | None = None,
    executor: Executors | None = None,
    progress: bool = False,
    command: str = "",
) -> Answer:
    """Perform those trials of a campaign that its folder does not hold yet.

    Parameters
    ----------
    described : Campaign
    folder : Path
        A new or empty one, or that of the same campaign, which goes on where it stopped.
    workers : int
        Processes; their number changes no bit.
    shard : (int, int)
        ``(i, n)``: every n-th block of trials from the i-th on, for the jobs of an array.
    retry : bool
        Whether blocks with failed trials are performed again.
    study : Study, optional
        That of the campaign, where its reference cannot be loaded here.
    executor : callable, optional
        Makes an executor of so many workers, such as :func:`tpsim.campaign.cluster.dask`.
    progress : bool
        Whether to draw a bar on standard error.
    command : str
        What was typed.

    Returns
    -------
    dict
        ``trials``, ``done`` and ``failed`` of the whole campaign so far, ``digest`` over the
        arrays of all that are done, in order; ``performed`` in this call, ``wall_seconds`` and
        ``simulated_seconds_per_second`` of it; ``table`` and ``paths``.

    Raises
    ------
    ArgumentError
        If the study cannot do what is asked.
    RecordingError
        If the folder is of another campaign, of other versions, or cannot be written.
    """
    with extra("Tables of campaigns"):
        import pyarrow.parquet

        assert pyarrow.parquet
    if not (0 <= shard[0] <= shard[1] and shard[1] > 0):
        raise ArgumentError(f"shard {shard[0]}/{shard[1]}: give i/n with i from 0 or 1 up to n")
    base = study_of(described, study)
    described = replace(described, study=named(described.study))
    described.check(base)
    opened = open_folder(Path(folder).absolute(), described, command)
    check_versions(opened)
    began = time.monotonic()
    todo = [k for k in _missing(opened, retry) if k % shard[1] == shard[0] % shard[1]]
    needed = sorted({number for block in todo for number in lessons_of(described, block)})
    with Lender(workers) as lender:
        lessons.prepare(opened, base, needed, workers, lender)
        taught = time.monotonic()
        count = 1 if executor is None and (workers == 1 or len(todo) < 2) else workers
        executor = lender if executor is None and count > 1 else executor
        try:
            done = _performed(opened, base, todo, count, executor, progress)
        except BaseException as error:
            opened.sweep()
            if isinstance(error, KeyboardInterrupt):
                error.add_note(f"finished trials are kept in {opened.path} and not performed again")
            raise
    wall = time.monotonic() - taught
    return {
        **report.standing(opened),
        "performed": sum(one.trials for one in done),
        "teaching_seconds": round(taught - began, 2),
        "wall_seconds": round(wall, 2),
        "simulated_seconds_per_second": round(sum(d.simulated for d in done) / max(wall, 1e-9), 2),
        **finished(opened, base),
    }


def study_of(described: Campaign, study: Study | None = None) -> Study:
    """The study of a campaign, its task with the campaign's fields."""
    found = load_study(named(described.study), STUDIES) if study is None else study
    unknown = described.fields.keys() - {f for f in vars(found.task)}
    if unknown:
        described.check(found)  # which says what there is
    return lessons.with_fields(found, dict(described.fields))


def finished(folder: Folder, study: Study) -> Answer:
    """Write one table of all rows and the report, where all blocks are done; say where they are."""
    paths = {"campaign": str(folder.path)}
    if not folder.complete:
        page = {"progress": str(folder.path / NAME)}
        return {"table": str(folder.path / "table"), "paths": paths | page}
    import pyarrow

    whole = pyarrow.concat_tables(folder.tables(), promote_options="default")
    table = folder.path / "table.parquet"
    write_table(table, whole.replace_schema_metadata(folder.about), replace=True)
    say("reporting")
    written = report.write(folder, study, whole)
    arrive(folder)
    return {"table": str(table), "paths": paths | written}


def _missing(folder: Folder, retry: bool) -> list[int]:
    """Blocks that are not done; with ``retry`` those with failed trials, too."""
    folder.sweep()
    done = set(folder.done())
    if retry:
        for block, table in zip(sorted(done), folder.tables(["outcome"]), strict=True):
            if FAILED in table.column("outcome").to_pylist():
                done.remove(block)
    return [block for block in range(blocks(folder.campaign)) if block not in done]


def _performed(
    folder: Folder,
    study: Study,
    todo: Sequence[int],
    workers: int,
    executor: Executors | None,
    progress: bool,
) -> list[Done]:
    """Perform blocks; what ends its worker twice is tried trial by trial."""
    trials = sum(len(trials_of(folder.campaign, block)) for block in todo)
    if not trials:
        return []
    say(f"{trials} trials in {len(todo)} blocks, {workers} workers: {folder.path}")
    bar = tqdm(total=trials, file=sys.stderr, unit=" trials") if progress else None
    found, deadly, page = [], [], ProgressPage(folder, study)
    with bar or nullcontext(), Workers(workers, bench, (folder, study), executor) as pool:
        jobs = [Job(block) for block in todo]
        for job, done in zip(jobs, pool.map(jobs), strict=True):
            if isinstance(done, Death):
                deadly.append(job.block)
                continue
            found.append(done)
            page.update()
            if bar is not None:
                bar.update(done.trials)
        for block in deadly:
            found.append(_one_by_one(folder, study, block, pool))
    return found


def _one_by_one(folder: Folder, study: Study, block: int, pool: "Workers[Job, Done]") -> Done:
    """Perform the trials of a block alone: those that end their worker are failed rows."""
    numbers = trials_of(folder.campaign, block)
    jobs = [Job(block, (number,)) for number in numbers]
    rows: list[Row] = []
    simulated = 0.0
    for number, done in zip(numbers, pool.map(jobs), strict=True):
        if isinstance(done, Death):
            rows.append(failed_row(asked_row(asked(folder.campaign, number), None), done))
        else:
            rows += done.rows
            simulated += done.simulated
    Bench(folder, study).write(block, rows)
    return Done(len(rows), sum(row["outcome"] == FAILED for row in rows), simulated)
