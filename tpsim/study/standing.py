"""What came out of a contest: who errs how much, yields how far, and is dominated by whom."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tpsim.study.pareto import pareto

LEARNED = "learned"
"""How the names of learned controllers begin."""

YIELD, FORCE, WAY = "displacement_mean_mm", "lead_force_mean_N", "lead_way_mm"
"""Figures of every controller beside its errors."""

WAY_LED = 0.9
"""Share of the way that a led hand must have gone for the force to be that of this way."""


@dataclass(frozen=True)
class Standing:
    """What came out of a contest.

    Parameters
    ----------
    points : mapping of str to mapping of str to float or None
        Figures of each controller.
    errors : sequence of str
        Those that are errors, in which controllers are compared beside their yield.
    """

    points: Mapping[str, Mapping[str, float | None]]
    errors: Sequence[str]

    @property
    def dominated(self) -> dict[str, list[str]]:
        """By which other controllers each one is dominated: in errors, yield and contacts."""
        return pareto({name: self._costs(name) for name in self.points})

    @property
    def answer(self) -> dict[str, object]:
        """What a run says: figures of all that are not learned, and who dominates the learned."""
        others = {n: dict(p) for n, p in self.points.items() if not n.startswith(LEARNED)}
        learned = self.points.get(LEARNED, {})
        by = self.dominated.get(LEARNED, [])
        return {
            **{name: learned.get(name) for name in self.errors},
            "experts": others,
            "dominated_by": [name for name in by if not name.startswith(LEARNED)],
        }

    def led(self, name: str) -> bool:
        """Whether a controller's hand came along, so that its force is that of the way."""
        most = max((point[WAY] or 0.0 for point in self.points.values()), default=0.0)
        return (self.points[name][WAY] or 0.0) >= WAY_LED * most

    def _costs(self, name: str) -> list[float]:
        point = self.points[name]
        moved = point[YIELD]
        errors = [point[error] for error in self.errors]
        costs = [*errors, None if moved is None else -moved, point["contacts"]]
        return [np.nan if cost is None else cost for cost in costs]
