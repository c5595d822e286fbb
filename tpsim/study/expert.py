"""Experts: controllers whose gains people who know the task set by hand, within stated ranges."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from tpsim.border import Positive, checked
from tpsim.errors import ArgumentError, RecordingError
from tpsim.study.pareto import least_that_yields
from tpsim.task.task import Models, Situation
from tpsim.world.impedance import Controller
from tpsim.world.world import World

Gains = Mapping[str, float]
"""Gains by name, in their units."""


@dataclass(frozen=True)
class Range:
    """Within which an expert looks for a gain, on a logarithmic scale.

    Parameters
    ----------
    low, high : float
    unit : str
    """

    low: Positive
    high: Positive
    unit: str = ""

    def __post_init__(self) -> None:
        checked(self)
        if self.low > self.high:
            raise ArgumentError(f"a range from {self.low} to {self.high}; give 0 < low <= high")

    @property
    def middle(self) -> float:
        """Geometric mean."""
        return float(np.sqrt(self.low * self.high))


@dataclass(frozen=True)
class Expert:
    """A way to control a task by hand: what its gains are, and how they make a controller.

    Called with ``(world, models, situation)`` it makes the controller of one trial; what was
    learned it never looks at.

    Parameters
    ----------
    ranges : mapping of str to Range
        Of each gain.
    make : callable
        ``make(world, situation, gains) -> Controller``.
    gains : mapping of str to float, optional
        As they were tuned; the middle of each range before.
    softer : mapping of str to float, optional
        Other gains on the front that tuning found, which yield ``SOFTER`` times as much.
    """

    ranges: Mapping[str, Range]
    make: Callable[[World, Situation, Gains], Controller]
    gains: Gains = field(default_factory=dict)
    softer: Gains | None = None

    def __post_init__(self) -> None:
        checked(self)
        if unknown := set(self.gains) - set(self.ranges):
            raise ArgumentError(
                f"there is no gain {', '.join(sorted(unknown))} in the ranges of "
                f"{', '.join(self.ranges) or 'nothing'}"
            )
        middle = {name: one.middle for name, one in self.ranges.items()}
        object.__setattr__(self, "gains", {**middle, **self.gains})

    def __call__(self, world: World, models: Models, situation: Situation) -> Controller:
        """Make the controller of one trial."""
        return self.make(world, situation, self.gains)


SOFTER = 1.25
"""How many times the yield of its tuned gains an expert is tried with, too, at least."""

FIXED = {"stiff": 2000.0, "soft": 40.0}
"""Joint gains [1/s^2] of controllers that nobody tuned, to compare with."""


def fixed_gains(computed: Expert) -> dict[str, Expert]:
    """An expert's computed torque at those joint gains, critically damped."""
    return {
        name: replace(computed, gains={"joints": gain, "damping": 1.0})
        for name, gain in FIXED.items()
    }


def tuned(experts: Mapping[str, Expert], file: Path) -> dict[str, Expert]:
    """The experts with the gains that :func:`tpsim.study.tuning.tune` wrote, if it did.

    Raises
    ------
    RecordingError
        Names the file, if it is not what ``tpsim tune`` writes for these experts.
    """
    if not file.is_file():
        return dict(experts)
    try:
        found = json.loads(file.read_text(encoding="utf-8"))["experts"]
        return {
            name: _with_gains(expert, found[name]) if name in found else expert
            for name, expert in experts.items()
        }
    except (ValueError, KeyError, TypeError) as error:
        reason = " ".join(str(error).split())
        raise RecordingError(
            f"{file}: no gains of these experts ({reason}); write it anew with tpsim tune"
        ) from error


def _with_gains(expert: Expert, found: Mapping[str, Any]) -> Expert:
    """An expert with the gains that were found, and with the next softer ones on the front."""
    front, moved = found["front"], found["figures"]["displacement_mean_mm"]
    errors, yields = ([one[key] for one in front] for key in ("error", "yield_mm"))
    k = least_that_yields(errors, yields, SOFTER * moved)
    softer = front[k]["gains"] if yields[k] > moved else None
    return replace(expert, gains=found["gains"], softer=softer)
