"""NumPy archives: demonstrations and trials of tpsim, or anybody's arrays by name."""

from pathlib import Path

import numpy as np

from tpsim.data.foreign import opened
from tpsim.data.recording import Recording, by_length
from tpsim.errors import RecordingError


def recordings(path: Path) -> list[Recording]:
    """Read the arrays (T, ...) of an archive; text and single numbers are passed over."""
    with opened(path, "archive of arrays"):
        loaded = np.load(path, allow_pickle=False)
        if isinstance(loaded, np.ndarray):
            arrays = {"array": loaded}
        else:
            with loaded:
                arrays = {name: loaded[name] for name in loaded.files}
    name = str(arrays["name"]) if arrays.get("name", np.empty(1)).ndim == 0 else path.stem
    return [Recording(str(path), by_length(numeric(arrays, path)), name, "npz")]


def numeric(arrays: dict[str, np.ndarray], path: Path | str) -> dict[str, np.ndarray]:
    """Arrays of numbers as columns (T,) or (T, d); constant frames of a demonstration repeated.

    Raises
    ------
    RecordingError
        There are none.
    """
    samples = len(arrays["time"]) if np.ndim(arrays.get("time", 0)) == 1 else 0
    columns = {}
    for name, values in arrays.items():
        if values.dtype.kind not in "fiub" or not values.size:
            continue
        if _constant_frame(name, values, samples):
            values = np.broadcast_to(values, (samples, *values.shape))
        if values.ndim:
            flat = values.astype(float).reshape(len(values), -1)
            columns[name] = flat[:, 0] if values.ndim == 1 else flat
    if not columns:
        raise RecordingError(f"{path}: holds no arrays of numbers")
    return columns


def _constant_frame(name: str, values: np.ndarray, samples: int) -> bool:
    return samples > 0 and (
        (name.startswith("A_") and values.ndim == 2) or (name.startswith("b_") and values.ndim == 1)
    )
