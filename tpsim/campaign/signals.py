"""Signals of trials at 100 Hz as a table: a row for each sample, in single precision."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from tpsim.campaign.table import write_table
from tpsim.extras import extra
from tpsim.world.trial import Trial


def write_signals(
    path: Path, trials: Sequence[tuple[int, Trial]], about: Mapping[str, str]
) -> Path:
    """Write signals of trials, in place of earlier ones of the same block.

    Columns are ``trial`` and the signals of recordings; those with several parts are numbered,
    as ``q_0``, ``q_1``. What a trial lacks is empty.
    """
    with extra("Tables of campaigns"):
        import pyarrow

    tables = []
    for number, trial in trials:
        columns: dict[str, np.ndarray] = {"trial": np.full(len(trial.time), number)}
        for name, array in sorted(trial.arrays.items()):
            flat = array.reshape(len(array), -1)
            if flat.dtype.kind == "f":
                flat = flat.astype(np.float32)
            for values, part in zip(flat.T, np.ndindex(array.shape[1:]), strict=True):
                columns["_".join([name, *map(str, part)])] = values
        tables.append(pyarrow.table(columns))
    whole = pyarrow.concat_tables(tables, promote_options="default")
    return write_table(path, whole.replace_schema_metadata(dict(about)), replace=True)
