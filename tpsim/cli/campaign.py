"""The command campaign: thousands of perturbed trials, which go on where they stopped."""

import math
import re
import sys
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from tyro.conf import FlagCreatePairsOff, Positional, arg

from tpsim.cli.options import HOUR, MANY, Answer, Command, Options, SeededCommand, number, writable
from tpsim.errors import ArgumentError
from tpsim.versions import cores

if TYPE_CHECKING:
    from tpsim.campaign.campaign import Campaign as Described
    from tpsim.campaign.campaign import Sweep
    from tpsim.study.study import Study


@dataclass(frozen=True, kw_only=True)
class Work(Options):
    """Where a campaign runs, and how much of it."""

    out: Path | None = None
    """Folder of the campaign: new, or of the same one, which goes on where it stopped."""
    workers: int | None = None
    """Number of processes (default: one per core)."""
    shard: str = "0/1"
    """i/n: every n-th block of trials, from the i-th; one job of an array."""
    cluster: str | None = None
    """Dask workers instead of processes: address of a scheduler (tcp://...), or local."""
    retry: FlagCreatePairsOff[bool] = False
    """Perform trials that failed again."""
    plan: FlagCreatePairsOff[bool] = False
    """Print the campaign, with --json for a file of your own, and perform nothing."""

    def check(self) -> None:
        """Check folder, shard and workers."""
        super().check()
        if self.out is None and not self.plan:
            raise ArgumentError("--out DIR: give the folder of the campaign")
        writable("--out", self.out)
        _shard(self.shard)
        if self.workers is not None:
            number("--workers", self.workers, 1, MANY)

    def exit_code(self, answer: Answer) -> int:
        """1 where a trial failed."""
        return 1 if answer.get("failed") else 0

    def perform(self, described: "Described", study: "Study | None", line: str) -> Answer:
        """Perform what is missing."""
        from tpsim.campaign import run
        from tpsim.study.files.checked import plain

        if self.plan:
            found = plain(described)
            assert isinstance(found, dict)
            return found
        assert self.out is not None
        work = partial(
            run.campaign,
            described,
            self.out,
            shard=_shard(self.shard),
            retry=self.retry,
            study=study,
            progress=sys.stderr.isatty(),
            command=line,
        )
        workers = self.workers or cores()
        if self.cluster is None:
            return work(workers=workers)
        from tpsim.campaign.cluster import dask

        with dask(self.cluster, workers) as (executor, count):
            return work(workers=count, executor=executor)


@dataclass(frozen=True, kw_only=True)
class Campaign(Work, SeededCommand):
    """Try a task thousands of times, pushed, beside undisturbed twins; go on where it stopped.

    Or tpsim campaign FILE.json --out DIR; campaign DIR goes on; campaign compare A B.
    """

    trials: int = 60
    """Number of trials; each controller on each plant counts."""
    duration: float | None = None
    """Of a trial [s] (default: the task's own)."""
    controllers: tuple[str, ...] = ("learned",)
    """Controllers of the study, all under the same pushes."""
    teachers: int = 1
    """Number of teachers, each with demonstrations and situations of its own (see --seed)."""
    plants: tuple[str, ...] = ("nominal",)
    """Plants unlike the model, all under the same pushes: nominal, "friction 0.5 Nm", ..., all."""
    body: tuple[str, ...] = ()
    """Bodies or sites that are pushed (default: the first hand)."""
    direction: Literal["axes", "circle", "sphere"] = "axes"
    """Directions of the pushes: six along the axes, or drawn from a circle or a sphere."""
    force: tuple[str, ...] = ()
    """Forces [N]: values, or a range such as 5..30 (default: 20)."""
    impulse: tuple[str, ...] = ()
    """Force times duration [Ns], instead of --force."""
    onset: tuple[str, ...] = ()
    """When pushes begin [s]: values, or a range."""
    phase: tuple[str, ...] = ()
    """When pushes begin, as a share of the time in which they can (default: 0..1)."""
    push_duration: tuple[str, ...] = ("2",)
    """How long pushes last [s]."""
    lead: tuple[str, ...] = ()
    """Lead a hand so far off its way instead of pushing it [m]: values, or a range."""
    undisturbed: FlagCreatePairsOff[bool] = False
    """Nobody pushes or leads."""
    sweep: tuple[str, ...] = ()
    """Fields of the task to vary: components=1,2,3, taught and learned each time; friction:=2,8 or
    friction:=2..8 for what only the controller sees; demonstrations=2,4,6."""
    design: Literal["grid", "latin-hypercube"] = "grid"
    """Whether values are combined and ranges drawn at random, or all divided evenly."""
    repeats: int | None = None
    """Trials of each combination in a situation; of a hypercube, trials that share a situation
    (default: 1, or 6 of a hypercube)."""
    keep: Literal["figures", "signals", "everything"] = "figures"
    """What is kept of each trial: a row, with it signals at 100 Hz, or its whole recording."""

    def check(self) -> None:
        """Check the counts."""
        super().check()
        if self.folder is not None:
            raise ArgumentError("--folder: a campaign's folder is --out")
        for name in ("trials", "teachers"):
            number(f"--{name}", getattr(self, name), 1, 10 * MANY)
        if self.repeats is not None:
            number("--repeats", self.repeats, 1, MANY)
        if self.duration is not None:
            number("--duration", self.duration, 0, HOUR)
        names = "lead", "undisturbed", "force", "impulse"
        given = [f"--{name}" for name in names if getattr(self, name)]
        if len(given) > 1 and given[0] in ("--lead", "--undisturbed"):
            raise ArgumentError(f"{given[1]} and {given[0]}: give one of them")

    def execute(self, study: "Study", line: str) -> Answer:
        """Perform the campaign."""
        return self.perform(self.described(study), study, line)

    def described(self, study: "Study") -> "Described":
        """The campaign that the options describe."""
        from tpsim.campaign.campaign import Campaign as Described
        from tpsim.study.files.about import task_fields
        from tpsim.study.reference import load_study
        from tpsim.tasks import STUDIES
        from tpsim.world.plant import PLANTS

        own = task_fields(load_study(self.reference, STUDIES).task)
        given = task_fields(study.task)
        hypercube = self.design == "latin-hypercube"
        return Described(
            study.reference,
            self.trials,
            fields={name: value for name, value in given.items() if value != own[name]},
            controllers=self.controllers,
            teachers=self.teachers,
            plants=("nominal", *PLANTS) if self.plants == ("all",) else self.plants,
            **self._people(),  # type: ignore[arg-type]
            sweeps=dict(map(_sweep, self.sweep)),
            design="latin hypercube" if hypercube else "grid",
            repeats=self.repeats or (6 if hypercube else 1),
            duration=self.duration,
            keep=self.keep,
            seed=self.seed,
        )

    def _people(self) -> dict[str, object]:
        from tpsim.campaign.people import AXES, Leads, Pushes

        if self.undisturbed:
            return {}
        common = {
            "body": self.body,
            "direction": AXES if self.direction == "axes" else self.direction,
            "onset": _levels("--onset", self.onset),
            "phase": _levels("--phase", self.phase),
            "duration": _levels("--push-duration", self.push_duration),
        }
        if self.lead:
            travel = _levels("--lead", self.lead)
            return {"leads": Leads(travel=travel, **common)}  # type: ignore[arg-type]
        force, impulse = _levels("--force", self.force), _levels("--impulse", self.impulse)
        return {"pushes": Pushes(force=force, impulse=impulse, **common)}  # type: ignore[arg-type]


@dataclass(frozen=True, kw_only=True)
class CampaignFile(Work, Command):
    """Perform a campaign that a JSON file describes, or go on with one that was begun."""

    file: Annotated[Positional[Path], arg(metavar="FILE.json|DIR")]
    """What tpsim campaign TASK --plan --json printed, changed as you like; or a folder of one."""
    study: str | None = None
    """Study of the campaign, where it is none of the built-in ones: my_task.py:study."""
    status: FlagCreatePairsOff[bool] = False
    """Say how far the campaign of a folder is, also while it runs; perform nothing."""

    def check(self) -> None:
        """Check the options."""
        if self.file.is_dir() and self.out is not None:
            raise ArgumentError(f"{self.file} goes on in its own folder; leave --out out")
        if not (self.file.is_dir() or self.status):
            super().check()

    def execute(self) -> Answer:
        """Perform what is missing."""
        from tpsim.campaign.campaign import read_campaign
        from tpsim.campaign.folder import load_folder
        from tpsim.study.reference import is_ours, load_study

        if self.status:
            from tpsim.campaign.report import status

            return status(load_folder(self.file))
        study = None if self.study is None else load_study(self.study)
        if not self.file.is_dir():
            return self.perform(read_campaign(self.file), study, f"tpsim campaign {self.file}")
        described = load_folder(self.file).campaign
        if study is None and not is_ours(described.study):
            raise ArgumentError(
                f"{self.file} is of the study {described.study}; name it yourself if you trust "
                f"it: --study {described.study}"
            )
        return replace(self, out=self.file).perform(described, study, "")


@dataclass(frozen=True, kw_only=True)
class CampaignCompare(Command):
    """Compare two campaigns: the same trials, cell by cell, with intervals."""

    one: Annotated[Positional[Path], arg(metavar="A")]
    """Folder of a campaign."""
    other: Annotated[Positional[Path], arg(metavar="B")]
    """Folder of another, from which the first is taken."""

    def execute(self) -> Answer:
        """Compare what both have."""
        from tpsim.campaign.compare import compare

        return compare(self.one, self.other)


def _shard(given: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,9})/(\d{1,9})", given)
    if found is None or not int(found[2]) > 0 or int(found[1]) > int(found[2]):
        raise ArgumentError(f"--shard {given}: give i/n, such as 0/4 to 3/4, or 1/4 to 4/4")
    return int(found[1]), int(found[2])


def _levels(option: str, words: tuple[str, ...]) -> object:
    """Values, or a span; None where nothing was given."""
    from tpsim.campaign.people import Span

    if not words:
        return None
    low, dots, high = words[0].partition("..")
    if dots and len(words) == 1:
        return Span(_float(option, low), _float(option, high))
    return tuple(_float(option, word) for word in words)


def _float(option: str, word: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ArgumentError(f"{option} {word}: give numbers, or a range such as 5..30")
    return value


def _sweep(word: str) -> tuple[str, "Sweep"]:
    """A field and its sweep: ``name=1,2`` is learned each time, ``name:=1,2`` is not."""
    from tpsim.campaign.campaign import Sweep

    found = re.fullmatch(r"(\w+)(:?)=(.+)", word)
    if found is None:
        raise ArgumentError(f"--sweep {word}: give field=1,2,3, or field:=1,2,3 or field:=1..3")
    learned, values = not found[2], found[3]
    if ".." in values:
        return found[1], Sweep(span=_levels("--sweep", (values,)), learn=learned)  # type: ignore[arg-type]
    return found[1], Sweep(tuple(map(_value, values.split(","))), learn=learned)


def _value(word: str) -> object:
    """A number where it is one, else a text."""
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            continue
    return {"true": True, "false": False}.get(word, word)
