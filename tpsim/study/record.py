"""Records: what was asked for and what happened, and how they are found."""

from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from tpsim.border import Endless, border, checked
from tpsim.checks import shown
from tpsim.errors import ItemError
from tpsim.robot.views.observe import observe
from tpsim.robot.views.view import View
from tpsim.study.condition import Condition
from tpsim.task.task import Models, Task
from tpsim.world.trial import Trial

Numbers = Mapping[str, Endless | None]
"""What a trial comes to, by the names of measures; what never comes is infinite."""

_SEEN = 64
"""Values of views along trials that are kept, the latest; what was seen before is seen again."""


@dataclass(frozen=True, eq=False)
class Record:
    """One trial of a study, with what is needed to measure it.

    Parameters
    ----------
    condition : Condition
    trial : Trial
    task : Task
    models : mapping of str to TPGMM
    all : Records
        The records that it is one of.
    numbers : mapping of str to float
        What is known of it already, by the names of the study's measures.
    """

    condition: Condition
    trial: Trial
    task: Task
    models: Models
    all: "Records" = field(repr=False)
    numbers: Numbers = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        checked(self)

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a signal of the trial."""
        return self.trial[name]

    @border
    def see(self, view: View) -> np.ndarray:
        """Value (T, d) of a view along the trial; the latest are kept."""
        seen, key = self.all.seen, (self, view)
        if key not in seen:
            robot, trial = self.task.stage.robot, self.trial
            (seen[key],) = observe(robot, [view], trial["q"], trial.objects)
            if len(seen) > _SEEN:
                seen.popitem(last=False)
        seen.move_to_end(key)
        return seen[key]

    @border
    def beside(self, label: str = "unpushed", controller: str | None = None) -> "Record | None":
        """The record of another label in the same situation; of the same controller by default.

        A pushed trial's unpushed twin is ``record.beside("unpushed")``.
        """
        wanted = self.condition.controller if controller is None else controller
        index = self.condition.situation.index
        return next(
            (
                other
                for other in self.all.select(label, wanted)
                if other.condition.situation.index == index
            ),
            None,
        )


@dataclass(frozen=True)
class Lost:
    """A trial that could not be performed: its worker died twice.

    Parameters
    ----------
    number : int
        Of the trial in the run.
    condition : Condition
    reason : str
    """

    number: int
    condition: Condition
    reason: str

    def row(self) -> dict[str, object]:
        """What answers and reports say of it."""
        condition = self.condition
        return {
            "trial": self.number,
            "condition": condition.label,
            "controller": condition.controller,
            "situation": condition.situation.index,
            "reason": self.reason,
        }


class Records(Sequence[Record]):
    """Records of a study, in the order in which they were performed.

    Parameters
    ----------
    task : Task
    models : mapping of str to TPGMM
    trials : sequence of (Condition, Trial)

    Attributes
    ----------
    lost : list of Lost
        Trials that are missing.
    """

    @border
    def __init__(self, task: Task, models: Models, trials: Sequence[tuple[Condition, Trial]] = ()):
        self.task, self.models = task, models
        self.seen: OrderedDict[tuple[Record, View], np.ndarray] = OrderedDict()
        self.lost: list[Lost] = []
        self._records = [Record(c, t, task, models, self) for c, t in trials]

    @border
    def add(self, condition: Condition, trial: Trial, numbers: Numbers | None = None) -> Record:
        """Add what happened under a condition, and what was measured of it already."""
        record = Record(condition, trial, self.task, self.models, self, numbers or {})
        self._records.append(record)
        return record

    @border
    def include(self, record: Record) -> Record:
        """Add a record of other records as it is: what was seen of it is not seen again."""
        self._records.append(record)
        return record

    def __getitem__(self, index):  # type: ignore[no-untyped-def]
        """Return a record by its number."""
        try:
            return self._records[index]
        except (IndexError, TypeError) as error:
            raise ItemError(f"index is {shown(index)}; {error}") from None

    def __iter__(self) -> Iterator[Record]:
        """Iterate over the records."""
        return iter(self._records)

    def __len__(self) -> int:
        """Return the number of records."""
        return len(self._records)

    @border
    def select(
        self, label: str | Sequence[str] | None = None, controller: str | None = "learned"
    ) -> list[Record]:
        """The records of some labels and one controller; None means any."""
        labels = (label,) if isinstance(label, str) else label
        return [
            record
            for record in self._records
            if (labels is None or record.condition.label in labels)
            and (controller is None or record.condition.controller == controller)
        ]

    @border
    def groups(self, texts: Mapping[str, str]) -> dict[str, list[Record]]:
        """The learned controller's records under each text, of those labels that have any."""
        found = {text: self.select(label) for label, text in texts.items()}
        return {text: records for text, records in found.items() if records}
