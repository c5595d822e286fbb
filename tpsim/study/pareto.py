"""Pareto fronts: which of several points are dominated, and by which."""

from collections.abc import Mapping, Sequence

import numpy as np

from tpsim.errors import ArgumentError


def pareto(points: Mapping[str, Sequence[float]]) -> dict[str, list[str]]:
    """By which others each point is dominated; nothing for those on the Pareto front.

    A point dominates another one if no cost of it is larger and one is smaller. Points that are
    alike dominate each other not. What could not be measured (NaN) is infinite.

    Parameters
    ----------
    points : mapping of str to sequence of float
        Costs of each, the smaller the better, in the same order.

    Raises
    ------
    ArgumentError
        If the points have not the same number of costs.
    """
    if len({len(costs) for costs in points.values()}) > 1:
        raise ArgumentError(
            f"the points have {[len(costs) for costs in points.values()]} costs; give each as many"
        )
    found = {name: np.nan_to_num(costs, nan=np.inf) for name, costs in points.items()}
    return {
        name: [
            other
            for other, its in found.items()
            if other != name and (its <= mine).all() and (its < mine).any()
        ]
        for name, mine in found.items()
    }


def least_that_yields(errors: Sequence[float], yields: Sequence[float], asked: float) -> int:
    """Number of the point of least error among those that yield at least as much as asked.

    Where none does: of the one that yields most. Of errors alike, the first.
    """
    error, way = np.array(errors, float), np.array(yields, float)
    if not (enough := way >= asked).any():
        return int(np.argmax(way))
    return int(np.argmin(np.where(enough, error, np.inf)))
