"""What a study is: conditions in phases, figures from trials, a report and a film."""

from collections.abc import Generator, Mapping, Sequence

from tpsim.experiment.conditions import Condition
from tpsim.experiment.metrics import Measure
from tpsim.experiment.report import Section
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim.simulation import Simulation
from tpsim.sim.trial import Trial
from tpsim.sim.video import Clip
from tpsim.tasks.task import Task

Records = Sequence[tuple[Condition, Trial]]
"""What was asked for and what happened."""

Phases = Generator[list[Condition], list[Trial], None]
"""Yields the conditions of a phase, is sent their trials, and may build the next phase on them."""


class Study:
    """An experiment on one task; each subclass is one file of :mod:`tpsim.experiment.studies`.

    Attributes
    ----------
    task : Task
    title, lead : str
        Heading and opening paragraph of the report.
    words : sequence of (name, words, unit, limit or None, at_least)
        What the report says of each figure, in this order.
    """

    title: str
    lead: str
    words: Sequence[tuple[str, str, str, float | None, bool]]

    def __init__(self, task: Task):
        self.task = task

    def phases(
        self,
        simulation: Simulation,
        models: Mapping[str, TPGMM],
        seed: int,
        situations: int,
        pushes: int,
    ) -> Phases:
        """Conditions of the whole experiment, phase by phase."""
        raise NotImplementedError

    def figures(self, records: Records, models: Mapping[str, TPGMM]) -> dict:
        """Figures by name, of all that can be measured in these records."""
        raise NotImplementedError

    def probe(self, simulation: Simulation, models: Mapping[str, TPGMM]) -> dict:
        """Figures that need experiments of their own, beside the trials."""
        return {}

    def measures(self, figures: Mapping) -> list[Measure]:
        """The figures that there are in words, with the limits that the project set itself."""
        return [
            Measure(words, figures[name], unit, limit, at_least)
            for name, words, unit, limit, at_least in self.words
            if name in figures
        ]

    def sections(self, records: Records, models: Mapping[str, TPGMM]) -> list[Section]:
        """Sections of the report."""
        raise NotImplementedError

    def clips(
        self,
        simulation: Simulation,
        models: Mapping[str, TPGMM],
        records: Records,
        demonstrations: Mapping[str, Sequence[Trial]],
    ) -> list[Clip]:
        """Sequences of the film."""
        raise NotImplementedError


def select(records: Records, label: str, controller: str = "learned") -> list[Trial]:
    """The trials of one group of conditions."""
    return [t for c, t in records if c.label == label and c.controller == controller]


def health(trials: Sequence[Trial]) -> dict:
    """What went wrong in some trials: saturated motors, divergence, contact."""
    return {
        "saturated_steps": int(sum(trial["saturated_steps"][-1] for trial in trials)),
        "diverged": sum(trial.outcome == "diverged" for trial in trials),
        "contacts": sum(trial.outcome == "contact" for trial in trials),
    }


def unreachable_samples(trials: Sequence[Trial]) -> int:
    """Number of samples in which a posture beyond the joints' limits was asked for."""
    return int(sum(trial["beyond_limits"].any(1).sum() for trial in trials))
