"""The report of a campaign: figures with intervals, pairs, what fails together, what moves what."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tpsim.campaign.figures import DISTURBED, measures_of
from tpsim.campaign.folder import Folder
from tpsim.campaign.performing import Bench
from tpsim.campaign.pictures import compliance, force_displacement
from tpsim.campaign.rows import Rows, figures_of
from tpsim.campaign.statistics import Cluster, clusters, explained, mean, paired, share
from tpsim.campaign.table import FAILED, write_rows
from tpsim.study.clips import clip_of
from tpsim.study.embedded import embedded
from tpsim.study.latex import tabular
from tpsim.study.measure import Measure
from tpsim.study.recording import Answer
from tpsim.study.report import Picture, Section, write_report
from tpsim.study.study import Study
from tpsim.whole import write_text

if TYPE_CHECKING:
    import pyarrow

Table = list[dict[str, object]]

_FIGURES = (
    "Mean over trials with its 95 % interval: situations are resampled with all their trials, "
    "since trials of one situation are not independent. Success has a Wilson interval: {kept}."
)
_PAIRED = (
    "Differences between trials of the same situation under the same push, which differ in "
    "controller or plant alone: mean and 95 % interval. Where the interval leaves zero out, the "
    "difference is one."
)
_TWINS = "Each trial beside its undisturbed twin: how much more a figure is, while disturbed."
_CLUSTERS = (
    "Combinations of conditions that fail more often than all trials do ({base:.1f} %), and than "
    "each of their parts: share that fails with its Wilson interval, and lift over the base rate. "
    "{looked} combinations were looked at; of so many, some lie above by chance."
)
_NONE = "No combination of conditions fails above the base rate of {base:.1f} %."
_SENSITIVITY = (
    "Share of a figure's variance that lies between the values of a condition (correlation "
    "ratio), numbers in four equally filled bins: 1 means that the condition decides."
)
_EXTREMES = "Worst, median and best trial by {name}. `tpsim replay {folder} --trial N` repeats one."


def standing(folder: Folder) -> Answer:
    """How far a campaign is: ``trials``, ``done``, ``failed``, ``digest``."""
    done, failed, found = 0, 0, hashlib.sha256()
    for table in folder.tables(["trial", "outcome", "digest"]):
        for row in table.to_pylist():
            done += row["outcome"] != FAILED
            failed += row["outcome"] == FAILED
            found.update(f"{row['trial']} {row.get('digest') or row['outcome']}\n".encode())
    return {
        "trials": folder.campaign.trials,
        "done": done,
        "failed": failed,
        "digest": found.hexdigest(),
    }


def status(folder: Folder) -> Answer:
    """How far a campaign is, with a row for every controller on every plant so far."""
    needed = ["outcome", "controller", "plant", "teacher", "situation", "success", *DISTURBED]
    tables = list(folder.tables(needed))
    if not tables:
        return standing(folder)
    import pyarrow

    rows = Rows.of(pyarrow.concat_tables(tables, promote_options="default"))
    return {**standing(folder), "cells": cells(rows, figures_of(rows, list(DISTURBED)))}


def label_of(folder: Folder) -> str:
    """Label of the campaign's trials."""
    campaign = folder.campaign
    return "pushed" if campaign.pushes else "led" if campaign.leads else "unpushed"


def write(folder: Folder, study: Study, table: "pyarrow.Table") -> Answer:
    """Write report and tables of a campaign that is done; return where they are."""
    rows, label = Rows.of(table), label_of(folder)
    measures = list(measures_of(study, label))
    figures = figures_of(rows, [*(m.name for m in measures), *DISTURBED])
    summary = cells(rows, figures)
    failed = clustered(rows)
    sections = [
        Section(
            "By controller and plant", _FIGURES.format(kept=_kept(folder, measures)), table=summary
        ),
        *_tables("Pairs", _PAIRED, pairs(rows, figures)),
        *_tables("Beside the undisturbed twins", _TWINS, beside_twins(rows, figures)),
        _failures(failed, rows),
        *_tables("What moves what", _SENSITIVITY, sensitivity(rows, figures)),
        *_pictures(rows),
        *_extremes(folder, rows, measures),
    ]
    at = folder.path
    paths = {
        "report": write_report(
            at / "report.html",
            title=f"{study.title or study.task.name}: {folder.campaign.trials} trials",
            lead=study.lead,
            command=folder.file.command,
            sections=sections,
            no_film="Films are made of single trials: tpsim replay FOLDER --trial N.",
            in_3d=_in_3d(folder, study, rows, measures),
            about={
                "trials": len(table),
                "failed": len(table) - len(rows),
                "independent situations": len(np.unique(rows.units)) if len(rows) else 0,
                "teachers": folder.campaign.teachers,
                "seed": folder.campaign.seed,
            },
        )
    }
    if summary:
        paths["figures_csv"] = _csv(at / "figures.csv", summary)
        paths["figures_latex"] = write_text(at / "figures.tex", tabular(summary), replace=True)
        paths["figures_parquet"] = write_rows(
            at / "figures.parquet", summary, folder.about, replace=True
        )
    return {name: str(path) for name, path in paths.items()}


def cells(rows: Rows, figures: Sequence[str]) -> Table:
    """A row for every controller on every plant: success, and every figure."""
    found: Table = []
    for controller, plant, own in _groups(rows):
        row: dict[str, object] = {"controller": controller, "plant": plant, "trials": len(own)}
        row["success"] = str(share(own["success"] > 0))
        row |= {name: str(mean(own[name], own.units)) for name in figures}
        found.append(row)
    return found


def pairs(rows: Rows, figures: Sequence[str]) -> Table:
    """A row for every controller beside the first, and every plant beside the first."""
    found: Table = []
    for by in ("controller", "plant"):
        first, *others = rows.values(by) if len(rows) else [""]
        for other in others:
            row: dict[str, object] = {"difference": f"{other} − {first}"}
            for name in ("success", *figures):
                row[name] = str(mean(*paired(rows, name, by, other, first)))
            found.append(row)
    return found


def beside_twins(rows: Rows, figures: Sequence[str]) -> Table:
    """How much more every figure is than in the undisturbed twin, by controller and plant."""
    twins = [name for name in figures if f"twin_{name}" in rows]
    if not twins:
        return []
    found: Table = []
    for controller, plant, own in _groups(rows):
        more = {name: str(mean(own[name] - own[f"twin_{name}"], own.units)) for name in twins}
        found.append({"controller": controller, "plant": plant, **more})
    return found


def clustered(rows: Rows) -> tuple[list[Cluster], int]:
    """Conditions that fail together."""
    return clusters(rows.conditions, rows["success"] == 0) if len(rows) else ([], 0)


def sensitivity(rows: Rows, figures: Sequence[str]) -> Table:
    """A row for every condition: the share of each figure's variance that it explains."""
    return [
        {"condition": condition}
        | {
            name: round(ratio, 3) if np.isfinite(ratio := explained(rows[name], groups)) else "–"
            for name in ("success", *figures)
        }
        for condition, groups in rows.conditions.items()
    ]


def extremes(rows: Rows, measures: Sequence[Measure]) -> tuple[str, dict[str, int]]:
    """Figure by which trials are ranked, and numbers of the worst, median and best one."""
    limits = [m for m in measures if m.limit and not m.at_least and m.name in rows]
    if limits:
        name = limits[0].name
        key = np.fmax.reduce([rows[m.name] / m.limit for m in limits])  # type: ignore[operator]
        name = name if len(limits) == 1 else "the measure that is nearest to its limit"
    elif "displacement_max_mm" in rows:
        name = "displacement_max_mm"
        key = rows[name]
    else:
        return "", {}
    order = np.argsort(key[np.isfinite(key)], kind="stable")
    trials = rows["trial"][np.isfinite(key)][order].astype(int)
    if not len(trials):
        return "", {}
    chosen = {"worst": trials[-1], "median": trials[len(trials) // 2], "best": trials[0]}
    return name, {said: int(number) for said, number in chosen.items()}


def _groups(rows: Rows) -> "list[tuple[str, str, Rows]]":
    if not len(rows):
        return []
    return [
        (controller, plant, own)
        for plant in rows.values("plant")
        for controller in rows.values("controller")
        if len(own := rows.where((rows["controller"] == controller) & (rows["plant"] == plant)))
    ]


def _kept(folder: Folder, measures: Sequence[Measure]) -> str:
    """What a success is, in words."""
    success = folder.campaign.success
    counted = [m for m in measures if m.limit is not None]
    counted = [m for m in counted if (m.name in success if success else not m.at_least)]
    limits = [f"{m.name} {'at least' if m.at_least else 'at most'} {m.limit:g}" for m in counted]
    return "no divergence, no contact" + "".join(f", {limit}" for limit in limits)


def _tables(title: str, text: str, table: Table) -> list[Section]:
    return [Section(title, text, table=table)] if table else []


def _failures(found: tuple[list[Cluster], int], rows: Rows) -> Section:
    base = 100 * float(np.mean(rows["success"] == 0)) if len(rows) else 0.0
    ranked, looked = found
    text = (_CLUSTERS if ranked else _NONE).format(base=base, looked=looked)
    return Section("What fails together", text, table=[cluster.row() for cluster in ranked])


def _pictures(rows: Rows) -> list[Section]:
    if not len(rows):
        return []
    found = []
    for by in ("controller", "plant"):
        if by == "controller" or len(rows.values(by)) > 1:
            drawn = [force_displacement(rows, by), compliance(rows, by)]
            pictures = [Picture(figure) for figure in drawn if figure is not None]
            if pictures:
                found.append(Section(f"How it gives way, by {by}", pictures=pictures))
    return found


def _extremes(folder: Folder, rows: Rows, measures: Sequence[Measure]) -> list[Section]:
    name, chosen = extremes(rows, measures) if len(rows) else ("", {})
    if not chosen:
        return []
    text = _EXTREMES.format(name=name, folder=folder.path.name)
    shown = ["trial", "controller", "plant", "teacher", "situation", "outcome"]
    figures = figures_of(rows, [*(m.name for m in measures), *DISTURBED])
    table = []
    for said, number in chosen.items():
        (k,) = np.flatnonzero(rows["trial"] == number)
        row: dict[str, object] = {"": said}
        row |= {column: _plain(rows[column][k]) for column in (*shown, *figures)}
        table.append(row)
    return [Section("Worst, median, best", text, table=table)]


def _in_3d(folder: Folder, study: Study, rows: Rows, measures: Sequence[Measure]) -> str:
    """The same trials, performed again."""
    chosen = extremes(rows, measures)[1] if len(rows) else {}
    bench = Bench(folder, study, same=False)
    shown = {
        f"{said}: trial {number}": clip_of(bench.lab(number), bench.trial(number), said)
        for said, number in chosen.items()
    }
    return embedded(shown)


def _plain(value: object) -> object:
    return str(value) if isinstance(value, str) else float(value)  # type: ignore[arg-type]


def _csv(path: Path, table: Table) -> Path:
    import csv
    import io

    text = io.StringIO()
    writer = csv.DictWriter(text, list(table[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(table)
    return write_text(path, text.getvalue(), replace=True)
