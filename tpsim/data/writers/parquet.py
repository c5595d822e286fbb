"""The Parquet tables of a LeRobot dataset: frames, episodes and tasks."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tpsim.errors import ArgumentError

LARGEST = 100_000_000
"""Size of a data file beyond which the next episode goes to another [bytes]."""

Place = tuple[int, int]
"""Chunk and file of an episode."""


def write_frames(
    folder: Path, episodes: Sequence[Mapping[str, np.ndarray]], features: Mapping[str, Any]
) -> list[Place]:
    """Write all samples, one row group an episode; return where every episode is."""
    import pyarrow
    import pyarrow.parquet as parquet

    schema = pyarrow.schema([pyarrow.field(name, _type(about)) for name, about in features.items()])
    places = _places(episodes)
    for place in dict.fromkeys(places):
        file = folder / f"data/chunk-{place[0]:03d}/file-{place[1]:03d}.parquet"
        file.parent.mkdir(parents=True, exist_ok=True)
        with parquet.ParquetWriter(file, schema, compression="snappy") as writer:
            for episode, own in zip(episodes, places, strict=True):
                if own == place:
                    columns = [_column(episode[name], schema.field(name).type) for name in features]
                    writer.write_table(pyarrow.table(columns, schema=schema))
    return places


def write_episodes(
    folder: Path,
    episodes: Sequence[Mapping[str, np.ndarray]],
    places: Sequence[Place],
    stats: Sequence[Mapping[str, Mapping[str, list[float]]]],
    task: str,
) -> None:
    """Write one row an episode: its rows, its place and its statistics."""
    import pyarrow
    import pyarrow.parquet as parquet

    rows = [
        {
            "episode_index": i,
            "tasks": [task],
            "length": len(episode["index"]),
            "data/chunk_index": chunk,
            "data/file_index": file,
            "dataset_from_index": int(episode["index"][0]),
            "dataset_to_index": int(episode["index"][-1]) + 1,
            "meta/episodes/chunk_index": 0,
            "meta/episodes/file_index": 0,
            **{f"stats/{n}/{key}": v for n, about in own.items() for key, v in about.items()},
        }
        for i, (episode, (chunk, file), own) in enumerate(zip(episodes, places, stats, strict=True))
    ]
    path = folder / "meta/episodes/chunk-000/file-000.parquet"
    path.parent.mkdir(parents=True)
    parquet.write_table(pyarrow.Table.from_pylist(rows), path)


def write_tasks(folder: Path, task: str) -> None:
    """Write the tasks, indexed by their words as pandas reads them."""
    import pyarrow
    import pyarrow.parquet as parquet

    table = pyarrow.table({"task_index": pyarrow.array([0], pyarrow.int64()), "task": [task]})
    kinds = (("task_index", "int64", "int64"), ("task", "unicode", "object"))
    about = {
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": [
            {"name": n, "field_name": n, "pandas_type": p, "numpy_type": k, "metadata": None}
            for n, p, k in kinds
        ],
        "pandas_version": "2.2.0",
    }
    table = table.replace_schema_metadata({"pandas": json.dumps(about)})
    parquet.write_table(table, folder / "meta" / "tasks.parquet")


def _type(about: Mapping[str, Any]) -> Any:
    import pyarrow

    number = pyarrow.type_for_alias(about["dtype"])
    return number if about["shape"] == [1] else pyarrow.list_(number, about["shape"][0])


def _column(values: np.ndarray, kind: Any) -> Any:
    import pyarrow

    number = getattr(kind, "value_type", kind).to_pandas_dtype()
    if number is np.float32 and values.size and np.abs(values).max() > np.finfo(number).max:
        raise ArgumentError(
            f"items reach {np.abs(values).max():.1e}, which the format's float32 cannot hold; "
            "change their unit"
        )
    flat = pyarrow.array(values.ravel().astype(number))
    if not hasattr(kind, "list_size"):
        return flat.cast(kind)
    return pyarrow.FixedSizeListArray.from_arrays(flat, kind.list_size)


def _places(episodes: Sequence[Mapping[str, np.ndarray]]) -> list[Place]:
    places, size, number = [], 0, 0
    for episode in episodes:
        own = sum(values.nbytes for values in episode.values())
        if size and size + own > LARGEST:
            number, size = number + 1, 0
        size += own
        places.append(divmod(number, 1000))
    return places
