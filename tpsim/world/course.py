"""How far teaching has come: attempts in their order, until enough of them are good."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tpsim.errors import ArgumentError, SimulationError
from tpsim.world.trial import Trial

if TYPE_CHECKING:
    from tpsim.world.teaching import Attempt

ATTEMPTS = 10
"""Demonstrations tried for each one wanted, before teaching gives up."""


@dataclass(frozen=True)
class Shown:
    """What came of teaching.

    Parameters
    ----------
    trials : tuple of Trial
        The good demonstrations.
    refusals : mapping of str to int
        How many attempts were refused, by reason.
    """

    trials: tuple[Trial, ...]
    refusals: Mapping[str, int]

    @property
    def attempts(self) -> int:
        """Good and refused."""
        return len(self.trials) + sum(self.refusals.values())


class Course:
    """Attempts in their order, until ``count`` demonstrations are good.

    Whoever has several hands may show all that is :attr:`wanted` at once: none of it is in vain.

    Parameters
    ----------
    count : int
        Demonstrations wanted.
    progress : callable, optional
        Told the attempt's number and how it ended: ``"done"``, or why it was refused.
    """

    def __init__(self, count: int, progress: Callable[[int, str], None] | None = None):
        if count < 1:
            raise ArgumentError(f"{count} demonstrations were asked for; ask for at least 1")
        self._count, self._tell = count, progress
        self._trials: list[Trial] = []
        self._refusals: Counter[str] = Counter()
        self._last = ""

    @property
    def wanted(self) -> range:
        """Attempts that come next, as many as demonstrations are missing.

        Raises
        ------
        SimulationError
            If too many demonstrations were useless.
        """
        missing = self._count - len(self._trials)
        tried = len(self._trials) + self._refusals.total()
        if missing and tried >= ATTEMPTS * self._count:
            raise SimulationError(
                f"only {len(self._trials)} of {self._count} demonstrations were good; the others: "
                + ", ".join(f"{times} {why}" for why, times in self._refusals.most_common(3))
                + f"; the last one: {self._last}"
            )
        return range(tried, min(tried + missing, ATTEMPTS * self._count))

    def add(self, attempt: "Attempt") -> None:
        """Take note of the next attempt."""
        number, (trial, refusal) = self.wanted[0], attempt
        if refusal is None and trial is not None:
            self._trials.append(trial)
        elif refusal is not None:
            self._refusals[refusal.reason] += 1
            self._last = refusal.words
        if self._tell is not None:
            self._tell(number, "done" if refusal is None else refusal.words)

    @property
    def shown(self) -> Shown:
        """What came of it."""
        return Shown(tuple(self._trials), dict(self._refusals))
