"""From demonstrations to a model, what it retrieves, a picture and a summary, in one folder."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from tpsim.data.choice import choose, retrieve
from tpsim.data.cleaning import aligned, resampled, trimmed
from tpsim.data.figure import draw
from tpsim.data.labels import POSITION, QUATERNION
from tpsim.data.writers.table import write_csv
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.whole import check_free, whole_folder, write_bytes, write_text


def learned(
    demonstrations: Sequence[Demonstration],
    labels: Sequence[str],
    frames: Sequence[str],
    out: Path,
    *,
    components: int | None,
    samples: int,
    trim: bool,
    align: bool,
) -> dict[str, Any]:
    """Clean, learn, retrieve, draw and save; see :func:`tpsim.data.commands.learn`."""
    check_free(out)
    movements = prepared(demonstrations, samples=samples, trim=trim, align=align)
    choice, unseen = choose(movements, components)
    model = choice.fit(movements)
    retrieved = [retrieve(model, movement) for movement in movements]
    about: dict[str, Any] = {
        "demonstrations": len(movements),
        "samples": samples,
        "duration": float(movements[0].time[-1]),
        "columns": list(labels),
        "frames": list(frames),
        "components": model.components,
        "covariance": str(choice.covariance),
        "error": errors_of(list(zip(movements, retrieved, strict=True)), labels),
        "left_out_error": errors_of(unseen, labels),
    }
    names = {
        "model": "model.npz",
        "retrieved": "retrieved.csv",
        "plot": "learned.png",
        "summary": "summary.json",
    }
    about["paths"] = {what: str(out / name) for what, name in names.items()}
    with whole_folder(out) as new:
        model.save(new / names["model"])
        write_csv(new / names["retrieved"], _as_demonstrations(movements, retrieved, labels))
        write_bytes(new / names["plot"], draw(movements, retrieved, labels, frames))
        write_text(new / names["summary"], json.dumps(about, indent=2) + "\n")
    return about


def prepared(
    demonstrations: Sequence[Demonstration], *, samples: int, trim: bool, align: bool
) -> list[Demonstration]:
    """Cut off stillness, bring to ``samples`` even samples from time 0, and onto one time line."""
    if samples < 10:
        raise ArgumentError(f"samples is {samples}; give at least 10 for each movement")
    if trim:
        demonstrations = [trimmed(d) for d in demonstrations]
    movements = [
        replace(r, time=r.time - r.time[0]) for r in (resampled(d, samples) for d in demonstrations)
    ]
    if not align or len(movements) < 2:
        return movements
    # The same number of samples for every movement: warped by progress, not by clock.
    shared = movements[0].time / movements[0].time[-1]
    duration = float(np.median([m.time[-1] for m in movements]))
    paced = [replace(m, time=duration * shared) for m in movements]
    return aligned(paced, band=duration / 4, by="frames")


def errors_of(
    pairs: Sequence[tuple[Demonstration, Gaussian]], labels: Sequence[str]
) -> dict[str, float]:
    """Root mean square error of positions [m], orientations [deg] and every other column."""
    if not pairs:
        return {}
    given = np.stack([movement.data for movement, _ in pairs])
    mean = np.stack([gaussian.mean for _, gaussian in pairs])
    errors: dict[str, float] = {}
    position = [i for i, label in enumerate(labels) if label in POSITION]
    turn = [i for i, label in enumerate(labels) if label in QUATERNION]
    if position:
        errors["position [m]"] = _rms(np.linalg.norm((given - mean)[..., position], axis=-1))
    if len(turn) == 4:
        unit = mean[..., turn] / np.linalg.norm(mean[..., turn], axis=-1, keepdims=True)
        cosine = np.abs(np.sum(given[..., turn] * unit, axis=-1))
        errors["orientation [deg]"] = _rms(np.degrees(2 * np.arccos(np.minimum(cosine, 1.0))))
    rest = [i for i in range(len(labels)) if i not in (*position, *turn)]
    return errors | {labels[i]: _rms((given - mean)[..., i]) for i in rest}


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _as_demonstrations(
    movements: Sequence[Demonstration], retrieved: Sequence[Gaussian], labels: Sequence[str]
) -> list[Demonstration]:
    turn = [i for i, label in enumerate(labels) if label in QUATERNION]
    found = []
    for movement, path in zip(movements, retrieved, strict=True):
        mean = path.mean.copy()
        mean[:, turn] /= np.linalg.norm(mean[:, turn], axis=1, keepdims=True) if turn else 1.0
        found.append(Demonstration(movement.time, mean, movement.frames, name=movement.name))
    return found
