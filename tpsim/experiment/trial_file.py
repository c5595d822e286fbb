"""One trial, one file: ``trial-000000.npz``, without pickles.

NumPy stamps the members with the year 1980, not with the clock, so the same trial gives the same
bytes.
"""

import json
import zipfile
import zlib
from pathlib import Path

import numpy as np

from tpsim.errors import RecordingError
from tpsim.experiment.summary import plain
from tpsim.sim.trial import Trial
from tpsim.whole import whole_file

SCHEMA = 1
"""Version of the layout of trials and run folders."""

_TEXT = ("outcome", "about")


def save_trial(path: Path, trial: Trial) -> Path:
    """Write one trial to ``path`` without pickles; the same trial gives the same bytes.

    Raises
    ------
    RecordingError
        Where the signals are not finite numbers on one clock.
    """
    _check(trial, path)
    about = json.dumps(plain(trial.about), sort_keys=True)
    members = dict(sorted(trial.arrays.items())) | {
        "schema": np.array(SCHEMA),
        "outcome": np.array(trial.outcome),
        "about": np.array(about),
    }
    # Not compressed: full mantissas shrink by 6 % only and cost thirty times the time.
    with whole_file(path) as file:
        np.savez(file, allow_pickle=False, **members)
    return path


def load_trial(path: Path) -> Trial:
    """Read one trial.

    Raises
    ------
    RecordingError
        Where the file is missing, truncated, of another schema, or holds NaN.
    """
    members = _members(Path(path))
    schema = members.pop("schema", None)
    if schema is None or any(name not in members for name in (*_TEXT, "time")):
        raise RecordingError(
            f"{path} is no recording of tpsim: schema, outcome, about or time "
            "is missing; give a trial-*.npz of a run folder"
        )
    if int(schema) != SCHEMA:
        raise RecordingError(
            f"{path} has schema {int(schema)}, this tpsim reads {SCHEMA}; record "
            "it again with the command in its run.json"
        )
    outcome, about = (str(members.pop(name)) for name in _TEXT)
    trial = Trial(members, outcome, json.loads(about))
    _check(trial, path)
    return trial


def _members(path: Path) -> dict[str, np.ndarray]:
    if not path.is_file():
        raise RecordingError(f"there is no recording {path}; give a trial-*.npz of a run folder")
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (
        OSError,
        ValueError,
        EOFError,
        KeyError,
        AttributeError,
        TypeError,
        zlib.error,
        zipfile.BadZipFile,
    ) as error:
        raise RecordingError(
            f"{path} is truncated or no recording ({error}); delete it and "
            "record again with the command in its run.json"
        ) from None


def _check(trial: Trial, path: Path) -> None:
    time = np.asarray(trial.arrays.get("time", ()))
    if time.ndim != 1 or not len(time) or np.any(np.diff(time) <= 0):
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
