"""Who teaches: how firm, how steady, how fast and how attentive a person's hands are.

Where the numbers are from is said in ``docs/teacher.md``.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from tpsim.border import NotNegative, Range, border, checked
from tpsim.errors import ArgumentError
from tpsim.world.people.guide import Grip
from tpsim.world.people.script import Variation
from tpsim.world.people.sight import Sight

TeacherName = Literal["human", "firm"]
"""Whose hands teach a task: people's as they are measured, or hands firmer than any person's."""


@dataclass(frozen=True)
class Demonstrator:
    """A person who teaches by leading the arm.

    Parameters
    ----------
    grip : Grip
        Impedance and strength of a hand.
    variation : Variation
        How the hand differs from its intention.
    reaction : (float, float)
        Delay of what is seen, drawn from this range [s]; (0, 0) sees and corrects nothing late,
        since it needs no correction: a hand as firm as a machine.
    looks : str
        Two hands are looked at ``"in turn"``, or ``"together"``: whether one look serves both.

    Raises
    ------
    ArgumentError
        A reaction out of its range, or other looks.
    """

    grip: Grip = Grip()  # noqa: RUF009 - a frozen value
    variation: Variation = Variation()  # noqa: RUF009 - a frozen value
    reaction: tuple[NotNegative, NotNegative] = (0.0, 0.0)
    looks: Literal["in turn", "together"] = "in turn"

    def __post_init__(self) -> None:
        checked(self)
        low, high = self.reaction
        if not low <= high < 1:
            raise ArgumentError(f"reaction is {self.reaction} s; give two rising times below 1 s")

    @border
    def sights(
        self, rng: np.random.Generator, hands: Annotated[int, Range(least=1, most=100)] = 1
    ) -> tuple[Sight | None, ...]:
        """How this person sees ``hands`` hands of one lesson; None for one that needs no sight."""
        if not self.reaction[1]:
            return (None,) * hands
        delay, between = float(rng.uniform(*self.reaction)), Sight.interval
        if self.looks == "together":
            return (Sight(delay),) * hands
        return tuple(Sight(delay, hands * between, i * between) for i in range(hands))


FIRM = Demonstrator()
"""Hands of 2000 N/m without delay: firmer than any person's, for what learning does at best."""

HUMAN = Demonstrator(
    Grip(600.0, 60.0, 20.0, 1.2, 30.0, 5.0),
    Variation(
        drift=0.004,
        tremor=0.0002,
        angular_drift=0.03,
        angular_tremor=0.002,
        drift_time=0.7,
        tremor_band=(8.0, 12.0),
        speed_noise=0.01,
        angular_speed_noise=0.01,
        attention=0.35,
    ),
    reaction=(0.15, 0.25),
)
"""Hands as they are measured in people."""

CUTOFF: Mapping[str, float | None] = {"human": 4.0, "firm": None}
"""Frequency [Hz] up to which their movements are learned from, :func:`tpsim.low_pass`."""

DEMONSTRATORS: Mapping[str, Demonstrator] = {"human": HUMAN, "firm": FIRM}
"""Who can teach, by name."""
