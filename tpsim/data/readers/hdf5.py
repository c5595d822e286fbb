"""HDF5: datasets of robomimic and robosuite, or anybody's arrays by name."""

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tpsim.data.columns import Columns
from tpsim.data.foreign import check_size, opened
from tpsim.data.recording import Recording, by_length
from tpsim.errors import RecordingError
from tpsim.extras import extra

if TYPE_CHECKING:
    import h5py


def recordings(path: Path) -> list[Recording]:
    """Read ``data/demo_0, demo_1, ...``, or all arrays of the file as one recording."""
    with extra("HDF5 files"):
        import h5py
    with opened(path, "HDF5 file"), h5py.File(path, "r") as file:
        _check(path, file)
        data = file.get("data")
        groups = data.items() if isinstance(data, h5py.Group) else ()
        demos = [name for name, item in groups if isinstance(item, h5py.Group)]
        if not demos:
            return [_recording(path, file, path.stem, "hdf5", None)]
        rate = _rate(data.attrs.get("env_args"))
        order = sorted(demos, key=lambda name: [int(n) for n in re.findall(r"\d+", name)] or [0])
        return [_recording(path, data[name], name, "robomimic", rate) for name in order]


def _check(path: Path, group: "h5py.Group") -> None:
    """Refuse links to other files, and more numbers than memory should hold."""
    import h5py

    numbers = 0

    def look(key: str, link: object) -> None:
        nonlocal numbers
        if isinstance(link, h5py.ExternalLink):
            raise RecordingError(f"{path}: {key} leads to another file, {link.filename:.60}")
        item = group.get(key) if isinstance(link, h5py.HardLink) else None
        if isinstance(item, h5py.Dataset):
            if item.external or item.is_virtual:
                raise RecordingError(f"{path}: {key} is kept in another file")
            numbers += item.size if item.ndim in (1, 2) and item.dtype.kind in "fiub" else 0

    group.visititems_links(look)
    check_size(path, numbers)


def _recording(
    path: Path, group: "h5py.Group", name: str, format: str, rate: float | None
) -> Recording:
    import h5py

    columns: dict[str, np.ndarray] = {}

    def collect(key: str, item: "h5py.Group | h5py.Dataset") -> None:
        # robomimic's next_obs are its obs, one sample later; arrays of rank 3 are pictures.
        if isinstance(item, h5py.Group) or key.startswith("next_obs"):
            return
        if item.ndim in (1, 2) and item.size and item.dtype.kind in "fiub":
            columns[key] = np.asarray(item[()], float)

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
    states = columns.get("states", np.empty(0))
    if rate is None and states.ndim == 2 and (np.diff(states[:, 0]) > 0).all():
        return movement.over(Columns(time="states[0]"))  # MuJoCo's flat states begin with time
    return movement.over(Columns(rate=rate))


def _rate(env_args: object) -> float | None:
    try:
        about = json.loads(str(env_args))
        return float(about["env_kwargs"]["control_freq"])
    except (ValueError, KeyError, TypeError):
        return None
