"""CSV: one row a sample, one column a number."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tpsim.border import border
from tpsim.data.signals import Item, parts_of, signals_of
from tpsim.whole import whole_file


@border
def write_csv(path: str | Path, items: Sequence[Item] | Item) -> Path:
    """Write demonstrations or trials to one CSV file.

    Columns are ``time`` [s] and ``data[0], data[1], ...``; frames are ``A_0[0], ...`` (row by row)
    and ``b_0[0], ...``; a trial's arrays have their own names. Several are told apart by the column
    ``demonstration``. Numbers are written so that :func:`tpsim.data.read` gives back the same bits.

    Raises
    ------
    ArgumentError
        Nothing to write, or items that hold different signals.
    """
    signals = signals_of(items)
    names = ["time"]
    for name, values in signals[0].columns.items():
        names += parts_of(name, values.shape[1])
    tables = [np.column_stack([s.time, *s.columns.values()]) for s in signals]
    if len(signals) > 1:
        names.insert(0, "demonstration")
        tables = [np.insert(table, 0, i, axis=1) for i, table in enumerate(tables)]
    path = Path(path)
    with whole_file(path) as file:
        header = ",".join(names)
        np.savetxt(
            file, np.vstack(tables), "%.17g", ",", header=header, comments="", encoding="utf-8"
        )
    return path
