"""LeRobot datasets of version 3: Parquet tables and their description, without pictures."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tpsim.border import Positive, border
from tpsim.data.signals import Item, Signals, signals_of
from tpsim.data.writers.parquet import write_episodes, write_frames, write_tasks
from tpsim.errors import ArgumentError
from tpsim.extras import extra
from tpsim.whole import check_free, whole_folder

QUANTILES = (0.01, 0.10, 0.50, 0.90, 0.99)

_COUNTERS = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}


@border
def write_lerobot(
    path: str | Path,
    items: Sequence[Item] | Item,
    *,
    fps: Positive | None = None,
    state: Sequence[str] | None = None,
    action: str | None = None,
    task: str = "movement",
    robot: str | None = None,
) -> Path:
    """Write demonstrations or trials as a LeRobot dataset of version 3.

    Parameters
    ----------
    path : folder
        Must not hold anything yet.
    items : demonstrations, or trials as arrays by name
    fps : float, optional
        Samples per second, a whole number: LeRobot's stamps are even. Default the rate of the
        first item, rounded. Items with other stamps are brought there by straight lines.
    state : sequence of str, optional
        Signals that make ``observation.state``; default ``data``, or ``q`` of a trial. The other
        signals become ``observation.<name>``.
    action : str, optional
        Default ``torque``, else the state of the next sample.
    task : str
        What is done, in words.
    robot : str, optional
        Its type.

    Raises
    ------
    ArgumentError
        Nothing to write, or no such signal.
    RecordingError
        A folder that is not empty, or the package pyarrow is missing.
    """
    with extra("LeRobot datasets"):
        import pyarrow as pyarrow
    path = Path(path)
    check_free(path)
    signals = signals_of(items)
    rate = round(signals[0].rate if fps is None else fps)
    if rate < 1 or (fps is not None and fps != rate):
        raise ArgumentError(f"fps is {fps}; give a whole number of samples per second, >= 1")
    even = [one.at_rate(rate) for one in signals]
    episodes = [_episode(one, i, rate, state, action) for i, one in enumerate(even)]
    first = 0
    for episode in episodes:
        episode["index"] = first + np.arange(len(episode["index"]))
        first += len(episode["index"])
    with whole_folder(path) as folder:
        (folder / "meta").mkdir()
        _write(folder, episodes, rate, task, robot)
    return path


def _episode(
    signals: Signals, number: int, rate: int, state: Sequence[str] | None, action: str | None
) -> dict[str, np.ndarray]:
    T = len(signals.time)
    names = signals.state(state)
    whole = np.hstack([signals.columns[name] for name in names])
    features = {"observation.state": whole, "action": signals.action(action, whole)}
    features |= {
        f"observation.{n.replace('/', '.')}": v
        for n, v in signals.columns.items()
        if n not in names
    }
    return features | {
        "timestamp": np.arange(T) / rate,
        "frame_index": np.arange(T),
        "episode_index": np.full(T, number),
        "index": np.arange(T),
        "task_index": np.zeros(T, int),
    }


def features_of(episode: Mapping[str, np.ndarray]) -> dict[str, dict[str, Any]]:
    """Describe the features of an episode, as ``meta/info.json`` does."""
    return {
        name: {
            "dtype": _COUNTERS.get(name) or _dtype(name),
            "shape": [1 if values.ndim == 1 else values.shape[1]],
            "names": None
            if name in _COUNTERS
            else [f"{name.split('.')[-1]}_{i}" for i in range(values.shape[1])],
        }
        for name, values in episode.items()
    }


def _dtype(name: str) -> str:
    # What policies are trained on is single; frames keep all their digits.
    return "float32" if name in ("observation.state", "action") else "float64"


def _write(
    folder: Path, episodes: Sequence[dict[str, np.ndarray]], rate: int, task: str, robot: str | None
) -> None:
    features = features_of(episodes[0])
    places = write_frames(folder, episodes, features)
    stats = [_stats(episode) for episode in episodes]
    write_episodes(folder, episodes, places, stats, task)
    write_tasks(folder, task)
    joined = {name: np.concatenate([e[name] for e in episodes]) for name in features}
    info = {
        "codebase_version": "v3.0",
        "robot_type": robot,
        "total_episodes": len(episodes),
        "total_frames": len(joined["index"]),
        "total_tasks": 1,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": rate,
        "splits": {"train": f"0:{len(episodes)}"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": None,
        "features": features,
    }
    (folder / "meta" / "info.json").write_text(json.dumps(info, indent=4), encoding="utf-8")
    (folder / "meta" / "stats.json").write_text(
        json.dumps(_stats(joined), indent=4), encoding="utf-8"
    )


def _stats(columns: Mapping[str, np.ndarray]) -> dict[str, dict[str, list[float]]]:
    found = {}
    for name, values in columns.items():
        values = values.reshape(len(values), -1).astype(float)
        about = {
            "min": values.min(0),
            "max": values.max(0),
            "mean": values.mean(0),
            "std": values.std(0),
        }
        about |= {f"q{round(100 * q):02d}": np.quantile(values, q, axis=0) for q in QUANTILES}
        found[name] = {key: value.tolist() for key, value in about.items()}
        found[name]["count"] = [len(values)]
    return found
