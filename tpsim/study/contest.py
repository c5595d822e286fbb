"""A contest: what all controllers of a study come to under the same pushes and the same leads."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tpsim.border import Count, Duration, NotNegative, Positive, checked
from tpsim.errors import ArgumentError
from tpsim.study.condition import Condition, Lead
from tpsim.study.expert import Expert
from tpsim.study.leading import led_off
from tpsim.study.metrics import displacement, interval, mean_force, push_interval
from tpsim.study.record import Record, Records
from tpsim.study.standing import Standing
from tpsim.task.task import Situation, Task, draw_situation
from tpsim.world.people.push import Push
from tpsim.world.plant import NOMINAL, Plant

if TYPE_CHECKING:
    from tpsim.study.study import Lab, Phases, Plan

_PUSHES, _LEAD = 5, 6


@dataclass(frozen=True)
class Error:
    """Something that should stay small while the robot is pushed.

    Parameters
    ----------
    name : str
        Such as ``"tilt"``: figures are ``tilt_p95_deg``, ``tilt_max_deg``.
    of : callable
        ``of(record)``: a series (T,), whose largest value while pushed counts, or a number; None
        where a trial has nothing to say. In ``unit``.
    unit : str
    scale : float
        What weighs as much as the scales of the other errors.
    title : str
    """

    name: str
    of: Callable[[Record], np.ndarray | float | None]
    unit: str
    scale: Positive
    title: str = ""

    def __post_init__(self) -> None:
        checked(self)

    def number(self, record: Record) -> float | None:
        """What one trial comes to; infinite where it diverged."""
        if record.trial.outcome == "diverged":
            return np.inf
        series = self.of(record)
        if series is None or np.ndim(series) == 0:
            return None if series is None else float(series)
        return _largest(np.asarray(series), push_interval(record.trial), record)


def _largest(series: np.ndarray, span: tuple[float, float] | None, record: Record) -> float | None:
    if span is None:
        return None
    time = record.trial.time
    return float(series[(time >= span[0]) & (time <= span[1])].max())


def site_of(record: Record) -> str:
    """Name under which the recording keeps the site that is pushed or led."""
    condition = record.condition
    site = condition.push[0].body if condition.push else condition.lead[0].site
    names = {site: name for name, site in record.task.sites().items()}
    if site not in names:
        raise ArgumentError(f"'{site}' is pushed, and the task records {', '.join(names)} only")
    return names[site]


def other_efforts(task: Task) -> dict[str, Task]:
    """A task at four times its effort, and at sixteen: half and a quarter as stiff.

    Stiffer it would hardly be: at its own effort the control loop sets the limit.
    """
    efforts = [share * task.effort for share in (4.0, 16.0)]  # type: ignore[attr-defined]
    return {f"effort {e:.3g}": replace(task, effort=e) for e in efforts}  # type: ignore[type-var]


@dataclass(frozen=True)
class Contest:
    """How controllers are compared: the same situations, pushes and leads for each of them.

    Parameters
    ----------
    errors : sequence of Error
    pushes : callable
        ``pushes(task, situation, rng) -> sequence of Push`` on recorded sites.
    lead : callable, optional
        ``lead(task, situation, rng) -> Lead`` whose origin is of no account: every controller's
        hand is led from where it is by itself.
    experts : mapping of str to Expert
        By hand, with gains that were tuned on other situations.
    gains : Path, optional
        Where ``tpsim tune`` writes the gains.
    yielding : float
        How far the pushed site is to give way at least [mm], mean of the peaks: experts are tuned
        to the least error that goes with it.
    duration : float, optional
        Of a trial [s]; the task's own by default.
    tuned_on : Plant
        On which experts are tuned; what is tuned on the nominal plant alone may count on it.
    situations, tuning_situations : int
        How many of a plan's situations count, and how many experts are tuned in.
    twins : bool
        Whether a trial needs an unpushed twin to tell how far a push moves it: not where the
        robot rests.
    counts : callable
        Whether a push is one to which the robot should give way: ``counts(push)``; all by default.
    without : sequence of str
        Controllers of the study that take no part, since they do something else.
    variants : callable
        ``variants(task)``: the same task with other fields, by what is said of them, whose learned
        controllers are tried, too; four and sixteen times the effort by default.
    apart : bool
        Whether a run performs the contest after the study's own conditions; otherwise those
        perform it, under its labels.
    rest, pushed, led : str
        Labels of the conditions.
    """

    errors: Sequence[Error]
    pushes: Callable[[Task, Situation, np.random.Generator], Sequence[Push]]
    lead: Callable[[Task, Situation, np.random.Generator], Lead] | None = None
    experts: Mapping[str, Expert] = field(default_factory=dict)
    gains: Path | None = None
    yielding: NotNegative = 0.0
    duration: Duration | None = None
    tuned_on: Plant = NOMINAL
    situations: Count = 3
    tuning_situations: Count = 2
    twins: bool = True
    counts: Callable[[Push], bool] = lambda push: True
    without: Sequence[str] = ()
    variants: Callable[[Task], Mapping[str, Task]] = other_efforts
    apart: bool = True
    rest: str = "contest"
    pushed: str = "contest pushed"
    led: str = "contest led"

    def __post_init__(self) -> None:
        checked(self)

    @property
    def softer(self) -> dict[str, Expert]:
        """The experts at softer gains of their own fronts, as the learned at other efforts."""
        return {
            f"{name}, softer": replace(expert, gains=expert.softer, softer=None)
            for name, expert in self.experts.items()
            if expert.softer is not None
        }

    def pushed_in(self, task: Task, situation: Situation, controller: str) -> Iterator[Condition]:
        """Conditions of one controller in one situation."""
        of = np.random.SeedSequence(situation.seed, spawn_key=(_PUSHES, situation.index))
        rest = Condition(self.rest, situation, controller, duration=self.duration)
        pushes = self.pushes(task, situation, np.random.default_rng(of))
        if self.twins and any(map(self.counts, pushes)):
            yield rest
        for push in pushes:
            yield replace(rest, label=self.pushed, push=(push,))

    def conditions(self, lab: "Lab", plan: "Plan") -> "Phases":
        """All controllers in the first situations of a plan, pushed; then each one's hand led."""
        found = []
        for index in range(min(plan.situations, self.situations)):
            situation = draw_situation(lab.task, plan.seed, index)
            for name in (n for n in lab.study.performers if n not in self.without):
                pushed = list(self.pushed_in(lab.task, situation, name))
                if self.lead is not None and pushed[0].label != self.rest:
                    found.append(replace(pushed[0], label=self.rest, push=()))
                found += pushed
        records = yield found
        if self.lead is not None:
            yield [self.led_from(twin) for twin in records.select(self.rest, None)]

    def led_from(self, twin: Record) -> Condition:
        """The condition in which a hand is led off the way that it goes by itself."""
        assert self.lead is not None
        situation = twin.condition.situation
        of = np.random.SeedSequence(situation.seed, spawn_key=(_LEAD, situation.index))
        lead = self.lead(twin.task, situation, np.random.default_rng(of))
        return replace(led_off(twin, lead), label=self.led)

    def standing(self, records: Records) -> Standing:
        """Points of all controllers on the trials that all of them performed."""
        pushed, led = records.select(self.pushed, None), records.select(self.led, None)
        names = list(dict.fromkeys(record.condition.controller for record in pushed))
        points = {}
        for name in names:
            figures = self.figures(_common(pushed, names, name))
            points[name] = figures | self.forces(_common(led, names, name))
        return Standing(points, tuple(f"{e.name}_p95_{e.unit}" for e in self.errors))

    def figures(self, records: Sequence[Record]) -> dict[str, float | None]:
        """Errors while pushed and the mean yield of some trials."""
        found: dict[str, float | None] = {}
        for error in self.errors:
            numbers = [n for record in records if (n := error.number(record)) is not None]
            wide, largest = _p95_and_max(numbers) if numbers else (None, None)
            found[f"{error.name}_p95_{error.unit}"] = wide
            found[f"{error.name}_max_{error.unit}"] = largest
        counted = [r for r in records if all(map(self.counts, r.condition.push))]
        moved = [way for record in counted if (way := self.moved(record)) is not None]
        found["displacement_mean_mm"] = float(np.mean(moved)) if moved else None
        found["pushes"] = len(records)
        found["contacts"] = sum(record.trial.outcome == "contact" for record in records)
        return found

    def moved(self, record: Record) -> float | None:
        """How far [mm] a push moves its site at most: from its unpushed twin, or from its start.

        None where the twin is missing.
        """
        span = push_interval(record.trial)
        if record.trial.outcome == "diverged" or span is None:
            return 0.0
        signal = f"{site_of(record)}_position"
        twin = record.beside(self.rest) if self.twins else None
        if self.twins and twin is None:
            return None
        if twin is None:
            position = record[signal]
            first = int(np.searchsorted(record.trial.time, span[0]))
            way = np.linalg.norm(position - position[first], axis=1)
        else:
            way = displacement(record.trial, twin.trial, signal)
        return 1e3 * float(_largest(way, span, record) or 0.0)

    def forces(self, records: Sequence[Record]) -> dict[str, float | None]:
        """Force that a person feels who leads the hand a given way, and how far it goes."""
        if not records:
            return {"lead_force_mean_N": None, "lead_way_mm": None}
        force = [mean_force(record["lead_wrench"]) for record in records]
        return {
            "lead_force_mean_N": float(np.mean(force)),
            "lead_way_mm": float(np.mean([way_led(record) for record in records])),
        }


def _p95_and_max(numbers: Sequence[float]) -> tuple[float, float]:
    """The 95th percentile, infinite with one that is, and the largest of some numbers."""
    largest = max(numbers)
    return (float(np.percentile(numbers, 95)) if np.isfinite(largest) else largest), largest


def way_led(record: Record) -> float:
    """How far [mm] a led site has gone along the way that it is led, at the end of it."""
    (lead,) = record.condition.lead
    span = interval(record["lead_wrench"], record.trial.time)
    if span is None or record.trial.outcome == "diverged":
        return 0.0
    last = int(np.searchsorted(record.trial.time, span[1]))
    last = min(last, len(record.trial.time) - 1)
    origin = lead.carried[-1] if lead.carried else lead.origin
    travel = np.array(lead.travel)
    way = record[f"{site_of(record)}_position"][last] - np.array(origin)
    return 1e3 * float(way @ travel / np.linalg.norm(travel))


def _common(records: Sequence[Record], names: Sequence[str], name: str) -> list[Record]:
    """Trials of one controller in conditions that all others have met, too."""
    met: dict[object, set[str]] = {}
    for record in records:
        met.setdefault(_met(record), set()).add(record.condition.controller)
    return [
        record
        for record in records
        if record.condition.controller == name and met[_met(record)] >= set(names)
    ]


def _met(record: Record) -> object:
    """What is alike between the trials of several controllers."""
    condition = record.condition
    ways = tuple((lead.site, lead.travel) for lead in condition.lead)
    return condition.situation.index, condition.push, ways, condition.plant
