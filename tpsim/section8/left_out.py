"""Methods on a user's own demonstrations: each is left out once and predicted by the others."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.retrieval.clock import on_one_clock
from tpsim.section8 import pictures, tables
from tpsim.section8.families import Situation
from tpsim.section8.folder import check_folder
from tpsim.section8.measures import FIGURES
from tpsim.section8.method import Method
from tpsim.section8.methods import METHODS, PICTURED
from tpsim.section8.statistics import bootstrap, ranks
from tpsim.section8.trial import Trial, perform
from tpsim.study.canvas import to_png
from tpsim.study.latex import tabular
from tpsim.study.report import Picture, Section, write_report
from tpsim.whole import write_bytes, write_text
from tpsim.world.threads import one_thread

SHOWN = 4  # columns of the picture


@one_thread()
def leave_one_out(
    demonstrations: Sequence[Demonstration], methods: Mapping[str, Method] = METHODS
) -> list[Trial]:
    """Learn from all demonstrations but one, and retrieve that one, for each of them.

    Parameters
    ----------
    demonstrations
        Two or more, of any lengths, with the same frames; they are brought on one clock.
    methods
        By name.

    Raises
    ------
    ArgumentError
        Fewer than two demonstrations, none with frames, or different frames.
    """
    demonstrations = list(demonstrations)
    if len(demonstrations) < 2:
        raise ArgumentError(
            f"{len(demonstrations)} demonstration was given; to leave one out takes at least 2"
        )
    _check_frames(demonstrations)
    taught = on_one_clock(demonstrations)
    return [
        perform(methods, [d for d in taught if d is not out], [Situation(out.frames, out, out)])
        for out in taught
    ]


def _check_frames(demonstrations: Sequence[Demonstration]) -> None:
    """Refuse demonstrations that are not all seen from the same number of frames."""
    counts = [len(d.frames) for d in demonstrations]
    most = max(counts)
    if not most:
        raise ArgumentError(
            "the demonstrations have no frames, to which every method adapts; name the objects in "
            "the files that the movement is seen from (--frames), or write frames into them"
        )
    fewer = [
        f"{d.name or f'demonstration {m + 1}'} has {count}"
        for m, (d, count) in enumerate(zip(demonstrations, counts, strict=True))
        if count < most
    ]
    if fewer:
        raise ArgumentError(
            f"the demonstrations are not seen from the same frames: {', '.join(fewer)} of {most}; "
            "leave these out, or give the frames that all have"
        )


@one_thread()
def compare_left_out(
    demonstrations: Sequence[Demonstration],
    methods: Mapping[str, Method] = METHODS,
    *,
    folder: Path,
    command: str = "tpsim compare --data ...",
) -> dict[str, object]:
    """Compare methods on demonstrations of one's own, and write tables and pictures.

    Parameters
    ----------
    demonstrations, methods
        As for :func:`leave_one_out`.
    folder
        Where to write: new, empty, or of an earlier comparison, whose tables are drawn anew.
    command
        The command line that repeats it, for the report.

    Returns
    -------
    dict
        ``methods``: figures by name, means over the demonstrations left out (``rms`` is the root
        of the mean square), and ``reason`` where one failed; ``paths`` of what was written.
    """
    check_folder(folder)
    trials = leave_one_out(demonstrations, methods)
    summary = _summary(trials)
    rows = [{"method": name} | _row(figures) for name, figures in summary.items()]
    picture = to_png(_picture(demonstrations, methods), dpi=110)
    drawn = write_bytes(folder / "layout.png", picture, replace=True)
    paths = {
        "folder": folder,
        "table": tables.write_csv(folder / "comparison.csv", rows),
        "latex": write_text(folder / "comparison.tex", tabular(rows), replace=True),
        "pictures": [drawn],
        "json": folder / "comparison.json",
        "report": folder / "report.html",
    }
    result: dict[str, object] = {"methods": summary, "demonstrations": len(trials), "paths": paths}
    tables.write_json(folder / "comparison.json", result)
    write_report(
        folder / "report.html",
        title="Which method predicts a demonstration that was left out",
        command=command,
        sections=[
            Section("Figures", "Means over the demonstrations, each left out once.", (), rows),
            Section("Paths", pictures=[Picture(drawn, "Dashed: the demonstration left out.")]),
        ],
        no_film="",
        about={"demonstrations": len(trials)},
    )
    return result


def _summary(trials: Sequence[Trial]) -> dict[str, dict[str, object]]:
    figures = np.concatenate([trial.figures for trial in trials], axis=1)
    by_name = dict(zip(FIGURES, np.moveaxis(figures, 2, 0), strict=True))
    rank, wins = ranks(by_name["rms"])
    interval = bootstrap(by_name["rms"])
    summary: dict[str, dict[str, object]] = {}
    for m, method in enumerate(trials[0].methods):
        row: dict[str, object] = {
            name: _middle(name, values[m]) for name, values in by_name.items()
        }
        row["rms_interval"] = [float(interval.low[m]), float(interval.high[m])]
        for name in ("train_ms", "adapt_us", "parameters"):
            row[name] = float(np.median([getattr(trial, name)[m] for trial in trials]))
        row |= {"rank": float(rank[m]), "wins": float(wins[m])}
        if reasons := [trial.reasons[m] for trial in trials if trial.reasons[m]]:
            row["reason"] = reasons[0]
        summary[method] = row
    return summary


def _middle(name: str, values: NDArray) -> float:
    if name == "rms":
        return float(np.sqrt(np.mean(values**2)))
    return float(np.median(values) if name == "nll" else np.mean(values))


def _row(figures: Mapping[str, object]) -> dict[str, object]:
    """Figures of a method as a row of a table."""
    return {
        name: tables.rounded(value)
        for name, value in figures.items()
        if isinstance(value, int | float)
    } | {"reason": figures.get("reason", "")}


def _picture(demonstrations: Sequence[Demonstration], methods: Mapping[str, Method]) -> Figure:
    """Draw every method where the first demonstrations are, each left out of its column."""
    taught = on_one_clock(demonstrations)
    shown = {n: m for n, m in methods.items() if n in PICTURED or n not in METHODS} or methods
    columns = [
        ([d for d in taught if d is not out], Situation(out.frames, out, out))
        for out in taught[:SHOWN]
    ]
    titles = [d.name or f"demonstration {m + 1}" for m, d in enumerate(taught[:SHOWN])]
    return pictures.layout(shown, columns, titles)
