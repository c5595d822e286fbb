"""LeRobot datasets: Parquet tables of all episodes, described by ``meta/info.json``."""

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tpsim.data.columns import Columns
from tpsim.data.foreign import check_size, opened
from tpsim.data.recording import Recording, Series
from tpsim.errors import RecordingError
from tpsim.extras import extra

if TYPE_CHECKING:
    import pyarrow

_NUMBERS = re.compile(r"(float|u?int)\d+|bool")
_BOOKKEEPING = {"timestamp", "frame_index", "episode_index", "index", "task_index"}


def recordings(path: Path) -> list[Recording]:
    """Read every episode of a dataset (v3, and v2 with one file for each)."""
    with extra("LeRobot datasets"):
        import pyarrow
        import pyarrow.parquet as parquet
    with opened(path, "LeRobot dataset"):
        info = json.loads((path / "meta" / "info.json").read_text(encoding="utf-8"))
        rate, features = float(info["fps"]), dict(info["features"])
        files = sorted((path / "data").rglob("*.parquet"))
        if not files:
            raise RecordingError(f"{path}: holds no data/**/*.parquet")
        names = [name for name, about in features.items() if _NUMBERS.match(about["dtype"])]
        check_size(path, sum(_numbers_in(file) for file in files))
        table = pyarrow.concat_tables([parquet.read_table(file, columns=names) for file in files])
        columns = {name: _values(path, table, name) for name in names}
        if not columns or "episode_index" not in columns:
            raise RecordingError(f"{path}: there is no episode_index; there are {', '.join(names)}")
        if len(table) != info.get("total_frames", len(table)):
            raise RecordingError(
                f"{path}: has {len(table)} rows of the {info['total_frames']} that meta/info.json "
                "promises; some files are missing"
            )
        columns |= _named(features, columns)
    episodes = columns["episode_index"]
    return [
        _episode(path, columns, episodes == number, int(number), rate)
        for number in np.unique(episodes)
    ]


def _numbers_in(file: Path) -> int:
    """How many numbers a table holds, as its description says."""
    import pyarrow.parquet as parquet

    about = parquet.read_metadata(file)
    groups = (about.row_group(i) for i in range(about.num_row_groups))
    return sum(g.column(j).num_values for g in groups for j in range(g.num_columns))


def _episode(
    path: Path, columns: dict[str, np.ndarray], rows: np.ndarray, number: int, rate: float
) -> Recording:
    # timestamp is a single float32; frame_index over fps is the same stamp without rounding.
    frames = columns["frame_index"][rows] if "frame_index" in columns else np.arange(rows.sum())
    kept = {name: v[rows] for name, v in columns.items() if name not in _BOOKKEEPING}
    if not kept:
        raise RecordingError(f"{path}: there are no features of numbers")
    state = "observation.state" if "observation.state" in kept else None
    return Recording(
        str(path),
        (Series(kept, time=frames / rate),),
        f"episode_{number:06d}",
        "lerobot",
        Columns(other=state),
    )


def _values(path: Path, table: "pyarrow.Table", name: str) -> np.ndarray:
    """Values (T,) or (T, d) of a column of numbers or of lists of them."""
    from pyarrow import types

    column = table[name].combine_chunks()
    if column.null_count:
        row = int(np.flatnonzero(column.is_null().to_numpy(zero_copy_only=False))[0])
        raise RecordingError(f"{path}: {name} is empty in row {row}")
    flat = column
    while types.is_nested(flat.type):
        flat = flat.flatten()
    values = np.asarray(flat.to_numpy(zero_copy_only=False), float)
    if not len(column) or len(values) % len(column):
        raise RecordingError(f"{path}: rows of {name} are empty or of different lengths")
    return values if flat is column else values.reshape(len(column), -1)


def _named(features: dict, columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Columns of their own for what the features name: ``observation.state.x``."""
    named: dict[str, np.ndarray] = {}
    for feature, about in features.items():
        names = about.get("names")
        if isinstance(names, dict):
            names = next(iter(names.values()), None)
        values = columns.get(feature)
        if isinstance(names, list) and values is not None and values.shape[1:] == (len(names),):
            named |= {f"{feature}.{n}": values[:, i] for i, n in enumerate(names)}
    return named
