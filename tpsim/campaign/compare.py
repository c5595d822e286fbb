"""Two campaigns beside each other: the same trials, cell by cell."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow

from tpsim.campaign.folder import Folder, difference, load_folder
from tpsim.campaign.rows import Rows, figures_of
from tpsim.campaign.statistics import mean
from tpsim.errors import RecordingError
from tpsim.study.recording import Answer

_ASKED = ("situation", "force_x_N", "force_y_N", "force_z_N", "onset_s", "duration_s")
_NOT = {
    *_ASKED,
    *("trial", "point", "lesson", "teacher", "travel_mm", "force_N", "simulated_s"),
    *(f"travel_{axis}_mm" for axis in "xyz"),
}


def compare(one: Path, other: Path) -> Answer:
    """Compare trials of two campaigns that have the same controller, plant, situation and push.

    Parameters
    ----------
    one, other : Path
        Folders; the first is taken from the second.

    Returns
    -------
    dict
        ``trials`` that both have, ``identical`` (the same bits), ``cells``: a row for every
        controller on every plant, with the mean difference of every figure and its 95 % interval,
        and ``differs`` (what is said differently of the two campaigns).

    Raises
    ------
    RecordingError
        If a folder is no campaign's, or they have no trial in common.
    """
    first, second = load_folder(one), load_folder(other)
    a, b = _rows(first), _rows(second)
    ka, kb = _keys(a), _keys(b)
    _, i, j = np.intersect1d(ka, kb, return_indices=True)
    if not len(i):
        raise RecordingError(
            f"{one} and {other} have no trial in common: no controller on the same plant in the "
            "same situation under the same push"
        )
    order = np.argsort(i)
    a, b = a.where(i[order]), b.where(j[order])
    figures = [n for n in figures_of(a, list(a.columns)) if n in b and n not in _NOT]
    figures = [n for n in figures if a[n].dtype.kind == "f" and not n.startswith("task.")]
    figures = [n for n in figures if not n.startswith(("twin_", "stiffness_"))]
    return {
        "trials": len(a),
        "identical": int(np.sum(a["digest"] == b["digest"])),
        "cells": _cells(a, b, figures),
        "differs": _differs(first, second),
        "paths": {"one": str(one), "other": str(other)},
    }


def _rows(folder: Folder) -> Rows:
    tables = list(folder.tables())
    if not tables:
        raise RecordingError(f"{folder.path} holds no trials yet")
    return Rows.of(pyarrow.concat_tables(tables, promote_options="default"))


def _keys(rows: Rows) -> np.ndarray:
    """What is the same (N,) of trials that may be compared, as text."""
    parts = [rows["controller"], rows["plant"], *(_text(rows, n) for n in ("teacher", *_ASKED))]
    found: np.ndarray = parts[0]
    for part in parts[1:]:
        found = np.char.add(np.char.add(found, "|"), part)
    # Sweeps over the same field are compared value by value.
    for name in sorted(n for n in rows.columns if n.startswith("task.")):
        if len(np.unique(rows[name])) > 1:
            found = np.char.add(np.char.add(found, f"|{name} "), _text(rows, name))
    return found


def _text(rows: Rows, name: str) -> np.ndarray:
    if name not in rows:
        return np.full(len(rows), "")
    return rows[name].astype("U")


def _cells(a: Rows, b: Rows, figures: Sequence[str]) -> list[dict[str, object]]:
    found = []
    for plant in a.values("plant"):
        for controller in a.values("controller"):
            mask = (a["plant"] == plant) & (a["controller"] == controller)
            if not mask.any():
                continue
            row: dict[str, object] = {"controller": controller, "plant": plant}
            row["trials"] = int(mask.sum())
            for name in figures:
                row[name] = str(mean((b[name] - a[name])[mask], a.units[mask]))
            found.append(row)
    return found


def _differs(one: Folder, other: Folder) -> list[str]:
    said = difference(one.campaign, other.campaign)
    versions = [
        f"{name} {version}, {other.file.versions.get(name)}"
        for name, version in one.file.versions.items()
        if other.file.versions.get(name) != version
    ]
    return [*filter(None, said.split("; ")), *versions]
