"""A campaign: what is tried, as a value of which each trial is a pure function."""

import dataclasses
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import prod
from pathlib import Path
from typing import Literal

from tpsim.border import Count, Duration, SeedNumber, border, checked
from tpsim.campaign.people import Leads, Levels, Pushes, Span
from tpsim.errors import ArgumentError
from tpsim.study.files.checked import from_json
from tpsim.study.files.inside import read_text_inside
from tpsim.study.files.limits import TEXT
from tpsim.study.study import Study
from tpsim.tasks import STUDIES
from tpsim.world.plant import NOMINAL, PLANTS, Plant

DEMONSTRATIONS = "demonstrations"
"""May be swept as fields of the task are: how often each behaviour is taught."""

_PLANTS = {"nominal": NOMINAL, **PLANTS}

Kept = Literal["figures", "signals", "everything"]


@dataclass(frozen=True)
class Sweep:
    """Values of a field of the task that a campaign tries.

    Parameters
    ----------
    values : tuple
        Each is tried.
    span : Span, optional
        Or the range from which numbers are drawn; nothing is learned anew then.
    learn : bool
        Whether each value is taught and learned afresh, as ``tpsim run`` would; otherwise the
        models of the task's own value perform, as for gains of a controller.
    """

    values: tuple = ()
    span: Span | None = None
    learn: bool = True

    def __post_init__(self) -> None:
        checked(self)
        if (self.span is None) == (not self.values):
            raise ArgumentError("a sweep has values or a span; give one of them")
        if self.span is not None and self.learn:
            raise ArgumentError(
                "a sweep over a span cannot be learned for every trial; give learn = false, or "
                "a few values"
            )


@dataclass(frozen=True)
class Campaign:
    """Thousands of trials of one study, described.

    Every trial is performed by each controller on each plant in the same situation under the same
    push, and beside its undisturbed twin. Trials come situation by situation, so that any number
    of them is a campaign.

    Parameters
    ----------
    study : str
        A built-in task, ``my_task.py:study`` or ``package.module:study``.
    trials : int
    fields : mapping
        Fields of the task that differ from the study's own.
    controllers : tuple of str
        Of the study, by name; ``"learned"`` is the task's own.
    teachers : int
        Teacher k shows and is tried with the seed ``seed + k``, as ``tpsim run --teachers``.
    plants : tuple of str, or mapping of str to Plant
        ``"nominal"`` and names of :data:`~tpsim.world.plant.PLANTS`, or plants of your own.
    pushes : Pushes, optional
    leads : Leads, optional
        With neither, trials are undisturbed.
    sweeps : mapping of str to Sweep
        Over fields of the task, or ``"demonstrations"``.
    design : "grid" or "latin hypercube"
        Whether levels are combined and spans drawn at random, or both are divided evenly.
    repeats : int
        How often each combination is tried in a situation, with spans drawn anew; of a Latin
        hypercube, how many trials share a situation.
    duration : float, optional
        Of a trial [s]; the task's own by default.
    keep : "figures", "signals" or "everything"
        Of each trial: a row of figures, with them its signals at 100 Hz in single precision, or
        with them its whole recording.
    success : tuple of str
        Measures whose limits a trial has to keep to be a success; by default all that have an
        upper limit.
    seed : int
        Of everything random.
    """

    study: str
    trials: Count = 60
    fields: Mapping[str, object] = field(default_factory=dict)
    controllers: tuple[str, ...] = ("learned",)
    teachers: Count = 1
    plants: tuple[str, ...] | Mapping[str, Plant] = ("nominal",)
    pushes: Pushes | None = None
    leads: Leads | None = None
    sweeps: Mapping[str, Sweep] = field(default_factory=dict)
    design: Literal["grid", "latin hypercube"] = "grid"
    repeats: Count = 1
    duration: Duration | None = None
    keep: Kept = "figures"
    success: tuple[str, ...] = ()
    seed: SeedNumber = 0

    def __post_init__(self) -> None:
        checked(self)
        if self.pushes is not None and self.leads is not None:
            raise ArgumentError("a campaign has pushes and leads; give one of them")
        for name in ("controllers", "plants"):
            given = tuple(getattr(self, name))
            if not given or len(set(given)) < len(given):
                raise ArgumentError(f"campaign {name} are {given}; name each once, at least one")
        if not isinstance(self.plants, Mapping):
            _known("plant", self.plants, _PLANTS)

    @property
    def people(self) -> Pushes | Leads | None:
        """What disturbs the trials."""
        return self.leads if self.pushes is None else self.pushes

    @property
    def all_plants(self) -> dict[str, Plant]:
        """Plants by name."""
        if isinstance(self.plants, Mapping):
            return dict(self.plants)
        return {name: _PLANTS[name] for name in self.plants}

    @property
    def crossed(self) -> int:
        """Trials that differ in controller and plant alone."""
        return len(self.controllers) * len(self.plants)

    @property
    def learned_sweeps(self) -> dict[str, Sweep]:
        """Sweeps over what is taught and learned afresh."""
        return {name: sweep for name, sweep in self.sweeps.items() if sweep.learn}

    @property
    def labs(self) -> int:
        """How often is taught and learned: by every teacher, for each value of such sweeps."""
        return self.teachers * prod(len(s.values) for s in self.learned_sweeps.values())

    @border
    def check(self, study: Study) -> None:
        """Look whether a study can do what is asked.

        Raises
        ------
        ArgumentError
            A controller, a field, a measure or a body that is not there.
        """
        task = study.task
        _known("controller", self.controllers, study.performers)
        own: list[str] = (
            [f.name for f in dataclasses.fields(task)] if dataclasses.is_dataclass(task) else []
        )
        _known("field of the task", self.fields, own)
        _known("field of the task", self.sweeps, [*own, DEMONSTRATIONS])
        if both := self.fields.keys() & self.sweeps.keys():
            raise ArgumentError(f"'{min(both)}' is in fields and in sweeps; give one of them")
        if (late := self.sweeps.get(DEMONSTRATIONS)) and not late.learn:
            raise ArgumentError("demonstrations are swept by learning: give learn = true")
        limited = [m.name for m in study.all_measures if m.limit is not None and m.of is not None]
        _known("measure with a limit", self.success, limited)
        if self.people is not None:
            _check_fits(self.people, self.duration or task.duration)
            simulation = task.stage.simulation()
            for body in self.people.body:
                simulation.attachment(body)
                if self.leads is not None and body not in task.sites().values():
                    raise ArgumentError(
                        f"'{body}' is to be led; the task records "
                        f"{', '.join(task.sites().values())}: give one of them"
                    )


def _check_fits(people: Pushes | Leads, duration: float) -> None:
    """Refuse pushes and leads that would last beyond the end of the trial."""
    rest = people.rest if isinstance(people, Leads) else 0.0
    last = _most(people.duration) + rest + (0.0 if people.onset is None else _most(people.onset))
    if last > duration:
        kind = type(people).__name__.lower()
        raise ArgumentError(
            f"{kind} last until {last:g} s, and a trial {duration:g} s; give a longer trial, or "
            f"shorter and earlier {kind}"
        )


def _most(levels: Levels) -> float:
    return levels.high if isinstance(levels, Span) else max(levels)


def _known(kind: str, given: Iterable[str], allowed: Iterable[str]) -> None:
    names = list(allowed)
    for name in given:
        if name not in names:
            raise ArgumentError(f"there is no {kind} '{name}'; there are {', '.join(names)}")


def read_campaign(file: Path) -> Campaign:
    """Read a campaign that somebody wrote as JSON; what is missing has its default.

    Raises
    ------
    RecordingError
        If there is no such file, or it is no campaign: the field is named.
    """
    text = read_text_inside(file.parent, file.name, TEXT)
    return from_json(text, Campaign, file, defaults=True)


def named(study: str) -> str:
    """A study's reference, built-in ones by their full names."""
    return STUDIES.get(study, study)
