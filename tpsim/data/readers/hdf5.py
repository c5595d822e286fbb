"""HDF5: datasets of robomimic and robosuite, or anybody's arrays by name."""

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tpsim.data.columns import Columns
from tpsim.data.foreign import extra, opened
from tpsim.data.recording import Recording, by_length
from tpsim.errors import RecordingError

if TYPE_CHECKING:
    import h5py


def recordings(path: Path) -> list[Recording]:
    """Read ``data/demo_0, demo_1, ...``, or all arrays of the file as one recording."""
    with extra("HDF5 files"):
        import h5py
    with opened(path, "HDF5 file"), h5py.File(path, "r") as file:
        data = file.get("data")
        demos = (
            []
            if not isinstance(data, h5py.Group)
            else [n for n in data if isinstance(data[n], h5py.Group)]
        )
        if not demos:
            return [_recording(path, file, path.stem, "hdf5", None)]
        rate = _rate(data.attrs.get("env_args"))
        order = sorted(demos, key=lambda name: [int(n) for n in re.findall(r"\d+", name)] or [0])
        return [_recording(path, data[name], name, "robomimic", rate) for name in order]


def _recording(
    path: Path, group: "h5py.Group", name: str, format: str, rate: float | None
) -> Recording:
    columns: dict[str, np.ndarray] = {}

    def collect(key: str, item: object) -> None:
        shape, kind = getattr(item, "shape", ()), getattr(getattr(item, "dtype", None), "kind", "")
        if (
            kind in "fiub"
            and kind
            and 1 <= len(shape) <= 2
            and 0 not in shape
            and not key.startswith("next_obs")
        ):
            columns[key] = np.asarray(item[()], float)  # type: ignore[index]

    group.visititems(collect)
    if not columns:
        raise RecordingError(f"{path}: {name} holds no arrays of numbers")
    return Recording(str(path), by_length(columns), name, format, _defaults(columns, rate))


def _defaults(columns: dict[str, np.ndarray], rate: float | None) -> Columns:
    movement = Columns()
    if "obs/robot0_eef_pos" in columns:
        turn = "obs/robot0_eef_quat" if "obs/robot0_eef_quat" in columns else None
        movement = Columns(position="obs/robot0_eef_pos", orientation=turn, order="xyzw")
    elif "obs/robot0_joint_pos" in columns:
        movement = Columns(joints="obs/robot0_joint_pos")
    if "time" in columns or "obs/time" in columns:
        return movement.over(Columns(time="time"))
    states = columns.get("states")
    if (
        rate is None
        and states is not None
        and states.ndim == 2
        and (np.diff(states[:, 0]) > 0).all()
    ):
        return movement.over(Columns(time="states[0]"))  # MuJoCo's flat states begin with time
    return movement.over(Columns(rate=rate))


def _rate(env_args: object) -> float | None:
    try:
        about = json.loads(str(env_args))
        return float(about["env_kwargs"]["control_freq"])
    except (ValueError, KeyError, TypeError):
        return None
