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
    """

    title: str
    lead: str

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
        """The figures with names in words, units and limits."""
        raise NotImplementedError

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
