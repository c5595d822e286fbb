"""One trial, one file: ``trial-000000.npz``, without pickles.

NumPy stamps the members with the year 1980, not with the clock, so the same trial gives the same
bytes.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tpsim.errors import RecordingError
from tpsim.npz import read_members, write_members
from tpsim.study.files.checked import from_json, to_json
from tpsim.world.trial import Channels, Trial

SCHEMA = 2
"""Version of the layout of trials."""

_TEXT = ("outcome", "channels", "about")


def save_trial(path: Path, trial: Trial, *, replace: bool = False) -> Path:
    """Write one trial to ``path`` without pickles; the same trial gives the same bytes.

    With ``replace`` a file of that name gives way.

    Raises
    ------
    RecordingError
        If the file exists and is to stay, the signals are not finite numbers on one clock, or
        ``about`` is not made of plain values.
    """
    path = Path(path)
    _check(trial, path)
    members = dict(sorted(trial.arrays.items())) | {
        "schema": np.array(SCHEMA),
        "outcome": np.array(trial.outcome),
        "channels": np.array(to_json(trial.channels)),
        "about": np.array(to_json(dict(trial.about))),
    }
    # Not compressed: full mantissas shrink by 6 % only and cost thirty times the time.
    return write_members(path, members, replace=replace)


def load_trial(path: Path) -> Trial:
    """Read one trial.

    Raises
    ------
    RecordingError
        If the file is missing, truncated, too large, of another schema, or holds NaN.
    """
    path = Path(path)
    members = read_members(path)
    schema = members.pop("schema", None)
    if schema is None or schema.shape != () or schema.dtype.kind not in "iu":
        raise RecordingError(
            f"{path} is no recording of tpsim: it has no schema; give a trial-*.npz of a run folder"
        )
    if int(schema) != SCHEMA:
        raise RecordingError(
            f"{path} has schema {int(schema)}, this tpsim reads {SCHEMA}; record it again with "
            "the command in its run.json"
        )
    texts = {name: _text(members, name, path) for name in _TEXT}
    channels = from_json(texts["channels"], Channels, f"{path}: channels")
    about = from_json(texts["about"], dict, f"{path}: about")
    trial = Trial(members, texts["outcome"], channels, about)
    _check(trial, path)
    return trial


def _text(members: dict[str, np.ndarray], name: str, path: Path) -> str:
    array = members.pop(name, None)
    if array is None or array.shape != () or array.dtype.kind != "U":
        raise RecordingError(f"{path} has no text '{name}'; record it again")
    return str(array)


def _check(trial: Trial, path: Path) -> None:
    time = np.asarray(trial.arrays.get("time", ()))
    if time.ndim != 1 or time.dtype.kind != "f" or not len(time) or not np.all(np.diff(time) > 0):
        raise RecordingError(
            f"{path}: time must be a growing row of seconds (T,), shape given {time.shape}"
        )
    for name, array in trial.arrays.items():
        array = np.asarray(array)
        if array.dtype.kind not in "fiub" or array.shape[:1] != time.shape:
            raise RecordingError(
                f"{path}: {name} is {array.dtype} {array.shape}; signals are "
                f"numbers ({len(time)}, ...), one row per time"
            )
        if not np.all(np.isfinite(array)):
            row = np.argwhere(~np.isfinite(array))[0, 0]
            raise RecordingError(
                f"{path}: {name} is not finite from row {row}; cut the trial "
                "at its last good state and record why it ended"
            )
    for name, shape in _named(trial.channels):
        found = np.shape(trial.arrays[name]) if name in trial.arrays else None
        wanted = (len(time), *shape)
        if found != wanted:
            raise RecordingError(
                f"{path}: channels name a signal {name} {wanted}; it is {found or 'missing'}"
            )


def _named(channels: Channels) -> Iterator[tuple[str, tuple[int, ...]]]:
    """Signals that there must be, and shapes of their rows."""
    for name in (*channels.sites, *channels.objects):
        yield f"{name}_position", (3,)
        yield f"{name}_quaternion", (4,)
    for name in channels.hands:
        yield f"{name}_stiffness", (3, 3)
    for name in channels.people:
        yield f"{name}_wrench", (6,)
        yield f"{name}_point", (3,)
