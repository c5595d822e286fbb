"""How much is compared: families, numbers of demonstrations, teachers, distances, situations."""

import hashlib
import itertools
import json
from dataclasses import asdict, dataclass, replace

from tpsim.section8.families import FAMILIES

Cell = tuple[str, int, int]
"""Family, number of demonstrations, and seed of the teacher."""


@dataclass(frozen=True)
class Plan:
    """What a comparison goes through; every cell of it is one file of results.

    Parameters
    ----------
    families : names out of :data:`tpsim.section8.families.FAMILIES`
    counts : numbers of demonstrations
    seeds : one teacher each
    distances : spreads of the situations; the demonstrations have 1
    situations : number for every distance and teacher
    samples : of every movement
    """

    families: tuple[str, ...] = tuple(FAMILIES)
    counts: tuple[int, ...] = (2, 4, 8)
    seeds: tuple[int, ...] = (0, 1, 2, 3, 4)
    distances: tuple[float, ...] = (0.5, 1.0, 2.0, 4.0)
    situations: int = 30
    samples: int = 100

    def cells(self) -> list[Cell]:
        """Family, number of demonstrations and seed of every cell."""
        return list(itertools.product(self.families, self.counts, self.seeds))

    def from_seed(self, seed: int) -> "Plan":
        """The same with other teachers: ``seed`` is added to their seeds."""
        return replace(self, seeds=tuple(seed + each for each in self.seeds))

    def key(self, cell: Cell, code: str) -> str:
        """Words that change with anything that a cell's results depend on.

        Parameters
        ----------
        cell : Cell
        code : str
            :func:`~tpsim.section8.fingerprint.fingerprint` of what is run, once for all cells.
        """
        settings = asdict(self) | {"families": None, "counts": None, "seeds": None}
        return hashlib.sha256(json.dumps([cell, settings, code]).encode()).hexdigest()


QUICK = Plan(families=("transfer",), counts=(4,), seeds=(0, 1), situations=15, samples=60)
"""A minute's worth: one family, one number of demonstrations, two teachers."""
