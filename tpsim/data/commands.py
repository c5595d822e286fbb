"""What the command line does with recordings: look at them, convert them, learn from them."""

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from tpsim.data.build import demonstrations_of
from tpsim.data.columns import Columns, PoseColumns
from tpsim.data.labels import labels_of
from tpsim.data.lesson import learned
from tpsim.data.motion import is_even, step_of
from tpsim.data.poses import poses_in
from tpsim.data.reading import read, recordings
from tpsim.data.recording import Recording
from tpsim.data.writing import write
from tpsim.demonstration import Demonstration
from tpsim.errors import RecordingError, TpsimError
from tpsim.world.threads import one_thread


def info(
    path: str | Path, columns: Columns | None = None, *, format: str | None = None
) -> dict[str, Any]:
    """Look at a file: its columns, the poses found in it, and what ``read`` makes of it.

    Returns
    -------
    dict
        ``format``; ``columns``: range, width and unit of each by name; ``poses``: names to give as
        frames; ``movement``: names of the columns of the demonstrations; ``demonstrations``: name,
        samples, duration [s], rate [Hz], longest gap [s] and whether stamps are even; ``problem``:
        why it cannot be read as it stands, or None.

    Raises
    ------
    RecordingError
        The file cannot be opened at all.
    """
    columns = columns or Columns()
    found = recordings(path, format=format)
    about: dict[str, Any] = {
        "path": str(path),
        "format": found[0].format,
        "columns": _columns(found[0]),
        "poses": [name or "(without a name)" for name in poses_in(found[0])],
        "movement": [],
        "frames": 0,
        "demonstrations": [],
        "problem": None,
    }
    try:
        demonstrations = demonstrations_of(found, columns)
        about["movement"] = labels_of(found[0], columns)
        about["frames"] = len(demonstrations[0].frames)
        about["demonstrations"] = [_timing(d) for d in demonstrations]
    except TpsimError as error:
        about["problem"] = str(error)
    return about


def convert(
    path: str | Path,
    out: str | Path,
    columns: Columns | None = None,
    *,
    format: str | None = None,
) -> dict[str, Any]:
    """Read a file and write its demonstrations in the format that the ending of ``out`` names.

    Raises
    ------
    TpsimError
        As :func:`tpsim.data.read` and :func:`tpsim.data.write`.
    """
    if os.path.lexists(out):
        raise RecordingError(f"{out} exists; give a new name, nothing is overwritten")
    demonstrations = read(path, columns, format=format)
    written = write(out, demonstrations)
    return {
        "demonstrations": len(demonstrations),
        "samples": sum(len(d) for d in demonstrations),
        "paths": {"written": [str(one) for one in written]},
    }


@one_thread()
def learn(
    path: str | Path | Sequence[str | Path],
    frames: Sequence[str | PoseColumns] = (),
    out: str | Path = "learned",
    *,
    columns: Columns | None = None,
    format: str | None = None,
    components: int | None = None,
    samples: int = 100,
    trim: bool = True,
    align: bool = True,
) -> dict[str, Any]:
    """Walk from recordings to a model: read, clean, learn, retrieve, draw, save.

    Parameters
    ----------
    path : file, folder, or several
    frames : sequence of str or PoseColumns
        Objects to see the movement from; default those that the file or ``columns`` describe, else
        the movement's own ``start`` and ``end``.
    out : folder
        New or empty; gets ``model.npz`` (:class:`tpsim.TPGMM`, whose first dimension is time),
        ``retrieved.csv``, ``learned.png`` and ``summary.json``.
    columns : Columns, optional
        What the file does not say.
    format : str, optional
        As in :func:`tpsim.data.read`.
    components : int, optional
        Number of Gaussians; default 3, 5 or 8, whichever errs least in situations left out of
        the learning. The structure of their covariances is chosen in the same way.
    samples : int
        Every movement is brought to so many.
    trim, align : bool
        Whether to cut off stillness at the ends, and to bring movements onto one time line by
        dynamic time warping.

    Returns
    -------
    dict
        Numbers of demonstrations and components, names of frames and columns, root mean square
        errors of the retrieval in the recorded situations (``error``) and in those that were left
        out of the learning (``left_out_error``), and the paths.

    Raises
    ------
    TpsimError
        As :func:`tpsim.data.read`; or recordings of which nothing can be learned.
    """
    columns = columns or Columns()
    found = recordings(path, format=format)
    columns = replace(columns, frames=tuple(frames) or _frames(found[0], columns))
    demonstrations = demonstrations_of(found, columns)
    return learned(
        demonstrations,
        labels_of(found[0], columns),
        _names(columns.frames, demonstrations[0]),
        Path(out),
        components=components,
        samples=samples,
        trim=trim,
        align=align,
    )


def _frames(recording: Recording, columns: Columns) -> tuple[str | PoseColumns, ...] | None:
    if columns.frames:
        return tuple(columns.frames)
    stored = recording.has("A_0") and not columns.says_movement
    return None if stored else ("start", "end")


def _names(frames: Sequence[str | PoseColumns] | None, demonstration: Demonstration) -> list[str]:
    if frames is None:
        return [f"frame {j}" for j in range(len(demonstration.frames))]
    return [frame if isinstance(frame, str) else frame.name for frame in frames]


def _columns(recording: Recording) -> dict[str, dict[str, Any]]:
    columns: dict[str, dict[str, Any]] = {}
    for series in recording.series:
        for name, values in series.columns.items():
            finite = values[np.isfinite(values)]
            columns[name] = {
                "samples": len(values),
                "width": 1 if values.ndim == 1 else values.shape[1],
                "least": float(finite.min()) if finite.size else None,
                "greatest": float(finite.max()) if finite.size else None,
                "unit": series.units.get(name),
                "missing": int(values.size - finite.size),
            }
    return columns


def _timing(demonstration: Demonstration) -> dict[str, Any]:
    timing: dict[str, Any] = {"name": demonstration.name, "samples": len(demonstration)}
    if len(demonstration) > 1:
        time = demonstration.time
        timing |= {
            "duration": float(time[-1] - time[0]),
            "rate": 1 / step_of(demonstration),
            "longest_gap": float(np.diff(time).max()),
            "even": is_even(demonstration),
        }
    return timing
