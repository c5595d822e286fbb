"""All rows of a campaign as arrays, for statistics: 10^5 of them are read in a second."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from tpsim.campaign.table import FAILED
from tpsim.errors import ArgumentError

if TYPE_CHECKING:
    import pyarrow

BINS = 4
"""Into so many equally filled bins numbers go where groups are asked for."""

CONDITIONS = (
    "controller",
    "plant",
    "teacher",
    "body",
    "force_N",
    "travel_mm",
    "onset_s",
    "duration_s",
)
"""What is varied, beside fields of the task and directions."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Columns of a table of trials, those that failed left out.

    Parameters
    ----------
    columns : dict of str to ndarray
        Numbers (N,), NaN where there are none, or texts (N,).
    """

    columns: dict[str, np.ndarray]

    @classmethod
    def of(cls, table: "pyarrow.Table") -> "Rows":
        """Rows of a table."""
        import pyarrow.compute as compute

        table = table.filter(compute.field("outcome") != FAILED)
        found = {}
        for name in table.column_names:
            column = table.column(name)
            if column.type in ("string",) or str(column.type) == "string":
                found[name] = np.array(column.fill_null("").to_pylist(), dtype=np.str_)
            else:
                found[name] = column.to_numpy(zero_copy_only=False).astype(float)
        return cls(found)

    def __len__(self) -> int:
        """Number of trials."""
        return len(next(iter(self.columns.values()), ()))

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a column."""
        if name not in self.columns:
            raise ArgumentError(
                f"the trials have no figure '{name}'; they have {', '.join(self.columns)}"
            )
        return self.columns[name]

    def __contains__(self, name: object) -> bool:
        """Whether there is such a column."""
        return name in self.columns

    def where(self, mask: np.ndarray) -> "Rows":
        """Some of the trials."""
        return Rows({name: column[mask] for name, column in self.columns.items()})

    def values(self, name: str) -> list[str]:
        """Different texts of a column, in the order of the trials."""
        _, first = np.unique(self[name], return_index=True)
        return [str(self[name][k]) for k in np.sort(first)]

    @cached_property
    def units(self) -> np.ndarray:
        """Number (N,) of the independent situation of every trial: its teacher's and its own."""
        pairs = np.stack((self["teacher"], self["situation"]), axis=1)
        return np.unique(pairs, axis=0, return_inverse=True)[1].reshape(-1)

    @cached_property
    def conditions(self) -> dict[str, np.ndarray]:
        """Texts (N,) of every condition that varies; numbers in bins."""
        fields = [name for name in self.columns if name.startswith("task.")]
        found = {name: self[name] for name in (*CONDITIONS, *fields) if name in self}
        if "force_x_N" in self or "travel_x_mm" in self:
            found["direction"] = self._directions()
        texts = {name: _binned(column) for name, column in found.items()}
        return {name: column for name, column in texts.items() if len(np.unique(column)) > 1}

    def _directions(self) -> np.ndarray:
        """The axis (N,) that is nearest to the direction of each push or lead."""
        name, unit = ("force", "N") if "force_x_N" in self else ("travel", "mm")
        vectors = np.stack([self[f"{name}_{axis}_{unit}"] for axis in "xyz"], axis=1)
        largest = np.abs(np.nan_to_num(vectors)).argmax(1)
        sign = vectors[np.arange(len(vectors)), largest] < 0
        return np.array(
            [f"{'-' if s else '+'}{'xyz'[k]}" for s, k in zip(sign, largest, strict=True)]
        )


def _binned(column: np.ndarray) -> np.ndarray:
    """Numbers as texts: as they are where there are few, else by quantiles."""
    if column.dtype.kind == "U":
        return column
    there = column[np.isfinite(column)]
    different = np.unique(there)
    if len(different) <= 2 * BINS:
        return np.array([f"{x:g}" if np.isfinite(x) else "none" for x in column])
    edges = np.quantile(there, np.linspace(0, 1, BINS + 1))
    names = [f"{a:.3g} to {b:.3g}" for a, b in pairwise(edges)]
    which = np.clip(np.searchsorted(edges, column, side="right") - 1, 0, BINS - 1)
    return np.where(np.isfinite(column), np.array(names)[which], "none")


def figures_of(rows: Rows, names: Sequence[str]) -> list[str]:
    """Those of some figures that the trials have."""
    there = [name for name in names if name in rows and rows[name].dtype.kind == "f"]
    return [name for name in there if np.isfinite(rows[name]).any()]
