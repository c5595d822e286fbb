"""What came out of a plan: estimates by family, number of demonstrations and distance."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tpsim.section8.measures import FIGURES, Figure
from tpsim.section8.plan import Cell, Plan
from tpsim.section8.statistics import Estimate, bootstrap, ranks
from tpsim.section8.trial import Trial

MEDIAN = ("nll",)  # one overconfident step would outweigh everything else in a mean


@dataclass(frozen=True, eq=False)
class Results:
    """All trials of a plan, and what they say.

    Parameters
    ----------
    plan : Plan
    trials : by family, number of demonstrations and seed
    figures : mapping of str to Figure
        What was measured, in the order of the trials' figures.
    """

    plan: Plan
    trials: dict[Cell, Trial]
    figures: Mapping[str, Figure] = field(default_factory=lambda: FIGURES)

    @cached_property
    def methods(self) -> tuple[str, ...]:
        """Names of the methods."""
        return next(iter(self.trials.values())).methods

    def values(self, family: str, count: int, distance: float | None, figure: str) -> NDArray:
        """Figure (m, n) of m methods in the situations of all teachers at a distance, or at all."""
        column = list(self.figures).index(figure)
        parts = []
        for seed in self.plan.seeds:
            figures = self.trials[family, count, seed].figures[:, :, column]
            if distance is not None:
                at = self.plan.distances.index(distance) * self.plan.situations
                figures = figures[:, at : at + self.plan.situations]
            parts.append(figures)
        return np.concatenate(parts, axis=1)

    def estimate(self, family: str, count: int, distance: float | None, figure: str) -> Estimate:
        """Mean (median of ``nll``) of a figure with its 95 % interval, for every method."""
        values = self.values(family, count, distance, figure)
        return bootstrap(values, median=figure in MEDIAN)

    def ranks(self, family: str, count: int) -> tuple[NDArray, NDArray]:
        """Mean rank by rms, and share of situations won, for every method, all distances."""
        return ranks(self.values(family, count, None, "rms"))

    def costs(self, family: str, count: int, figure: str) -> NDArray:
        """Median over teachers of ``train_ms``, ``adapt_us`` or ``parameters``, (m,)."""
        each = [getattr(self.trials[family, count, seed], figure) for seed in self.plan.seeds]
        return np.median(np.array(each), axis=0)

    def reasons(self, family: str, count: int) -> dict[str, str]:
        """Methods that failed somewhere, and why."""
        failed: dict[str, str] = {}
        for seed in self.plan.seeds:
            trial = self.trials[family, count, seed]
            for name, reason in zip(trial.methods, trial.reasons, strict=True):
                if reason:
                    failed.setdefault(name, reason)
        return failed

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for every family, number of demonstrations, distance, method and figure."""
        for family in self.plan.families:
            for count in self.plan.counts:
                for distance in self.plan.distances:
                    for figure in self.figures:
                        estimate = self.estimate(family, count, distance, figure)
                        for m, name in enumerate(self.methods):
                            yield {
                                "family": family,
                                "demonstrations": count,
                                "distance": distance,
                                "method": name,
                                "figure": figure,
                                "value": float(estimate.mean[m]),
                                "low": float(estimate.low[m]),
                                "high": float(estimate.high[m]),
                            }

    @property
    def headline(self) -> tuple[str, int]:
        """Family and number of demonstrations that a short table shows: the tutorial's own."""
        counts = self.plan.counts
        return self.plan.families[0], 4 if 4 in counts else counts[len(counts) // 2]

    def summary(self) -> dict[str, dict[str, object]]:
        """Figures of every method in the headline's situations, all distances together."""
        family, count = self.headline
        figures = {name: self.estimate(family, count, None, name) for name in self.figures}
        by_distance = {d: self.estimate(family, count, d, "rms") for d in self.plan.distances}
        ends = {d: self.estimate(family, count, d, "end") for d in self.plan.distances}
        costs = {n: self.costs(family, count, n) for n in ("train_ms", "adapt_us", "parameters")}
        rank, wins = self.ranks(family, count)
        reasons = self.reasons(family, count)
        summary: dict[str, dict[str, object]] = {}
        for m, method in enumerate(self.methods):
            summary[method] = {name: float(e.mean[m]) for name, e in figures.items()}
            summary[method] |= {name: float(cost[m]) for name, cost in costs.items()}
            summary[method] |= {"rank": float(rank[m]), "wins": float(wins[m])}
            summary[method]["rms_interval"] = [
                float(figures["rms"].low[m]),
                float(figures["rms"].high[m]),
            ]
            summary[method]["rms_at"] = {f"{d:g}": float(e.mean[m]) for d, e in by_distance.items()}
            summary[method]["end_at"] = {f"{d:g}": float(e.mean[m]) for d, e in ends.items()}
            if method in reasons:
                summary[method]["reason"] = reasons[method]
        return summary
