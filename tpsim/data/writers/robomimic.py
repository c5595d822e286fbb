"""robomimic's HDF5: ``data/demo_0/{actions, obs, rewards, dones}``."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tpsim.border import border
from tpsim.data.signals import Item, signals_of
from tpsim.extras import extra
from tpsim.whole import write_bytes


@border
def write_robomimic(
    path: str | Path,
    items: Sequence[Item] | Item,
    *,
    action: str | None = None,
    environment: str = "tpsim",
) -> Path:
    """Write demonstrations or trials as a dataset of robomimic.

    Parameters
    ----------
    path : file name
        Usually ends with .hdf5.
    items : demonstrations, or trials as arrays by name
        Every signal becomes an observation ``obs/<name>``; ``time`` stands beside them.
    action : str, optional
        Signal that is the action; default ``torque``, else the state of the next sample.
    environment : str
        Name in ``env_args``, with the control rate by the median step.

    Raises
    ------
    ArgumentError
        Nothing to write, or no such signal.
    RecordingError
        The package h5py is missing.
    """
    with extra("HDF5 files"):
        import h5py
    signals = signals_of(items)
    about = {
        "env_name": environment,
        "env_type": 1,
        "env_kwargs": {"control_freq": signals[0].rate},
    }
    path = Path(path)
    # In memory: on a full disk HDF5 does not fail, it crashes.
    with h5py.File(path.name, "w", driver="core", backing_store=False) as file:
        data = file.create_group("data")
        data.attrs["total"] = sum(len(s.time) for s in signals)
        data.attrs["env_args"] = json.dumps(about)
        for i, one in enumerate(signals):
            demo, T = data.create_group(f"demo_{i}"), len(one.time)
            demo.attrs["num_samples"] = T
            demo["time"] = one.time
            state = None if action or "torque" in one.columns else one.columns[one.state(None)[0]]
            demo["actions"] = one.action(action, np.empty((T, 0)) if state is None else state)
            demo["rewards"] = np.zeros(T)
            demo["dones"] = (np.arange(T) == T - 1).astype(np.int64)
            for name, values in one.columns.items():
                demo[f"obs/{name}"] = values
        file.flush()
        image = file.id.get_file_image()
    return write_bytes(path, image)
