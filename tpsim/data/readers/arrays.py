"""NumPy archives: demonstrations and trials of tpsim, or anybody's arrays by name."""

from pathlib import Path

import numpy as np

from tpsim.data.foreign import opened
from tpsim.data.recording import Recording, Series, by_length
from tpsim.data.signals import signals_of
from tpsim.demonstration import Demonstration
from tpsim.errors import RecordingError
from tpsim.npz import read_foreign_members


def recordings(path: Path) -> list[Recording]:
    """Read the arrays (T, ...) of an archive; text and single numbers are passed over."""
    with opened(path, "archive of arrays"):
        arrays = read_foreign_members(path)
    if str(arrays.get("kind", "")).lower() == "demonstration":
        return [_demonstration(path)]
    return [Recording(str(path), by_length(numeric(arrays, path)), path.stem, "npz")]


def _demonstration(path: Path) -> Recording:
    demonstration = Demonstration.load(path)
    (signals,) = signals_of(demonstration)
    series = Series({"time": signals.time, **signals.columns})
    return Recording(str(path), (series,), demonstration.name or path.stem, "npz")


def numeric(arrays: dict[str, np.ndarray], path: Path | str) -> dict[str, np.ndarray]:
    """Arrays of numbers as columns (T,) or (T, d).

    Raises
    ------
    RecordingError
        There are none.
    """
    columns = {}
    for name, values in arrays.items():
        if values.dtype.kind in "fiub" and values.size and values.ndim:
            flat = values.astype(float).reshape(len(values), -1)
            columns[name] = flat[:, 0] if values.ndim == 1 else flat
    if not columns:
        raise RecordingError(f"{path}: holds no arrays of numbers")
    return columns
