"""The commands: one frozen dataclass each; its fields are the options of the command line.

What is heavy is imported inside the commands, so that ``tpsim --help`` answers at once.
"""

import difflib
import importlib
import math
import os
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import FlagCreatePairsOff, Positional, arg

from tpsim.errors import ArgumentError

TaskName = Annotated[Positional[str], arg(metavar="TASK")]
BENCHES = ("learning", "retrieval", "control", "simulation")


@dataclass(frozen=True, kw_only=True)
class Command:
    """What every command has."""

    json: FlagCreatePairsOff[bool] = False
    """Print one JSON object on stdout and nothing else."""

    def check(self) -> None:
        """Raise ArgumentError for options that make no sense, before anything heavy happens."""

    def execute(self) -> dict:
        """Do the work and return what to print."""
        raise NotImplementedError


@dataclass(frozen=True, kw_only=True)
class TaskCommand(Command):
    """What every command about one task has."""

    task: TaskName
    """Name of the task; an unknown name lists all."""
    folder: Path | None = None
    """Folder to write to (default: a new one in recordings/)."""

    def check(self) -> None:
        """Check the task's name and the folder."""
        from tpsim import tasks

        _known("task", self.task, tasks.names())
        if self.folder is not None and self.folder.is_file():
            raise ArgumentError(f"--folder {self.folder} is a file; give a new or empty folder")


@dataclass(frozen=True, kw_only=True)
class SeededCommand(TaskCommand):
    """What every command that draws random numbers has."""

    seed: int = 0
    """Seed of everything random; the same seed gives the same recordings."""

    def check(self) -> None:
        """Check the seed."""
        super().check()
        _not_negative("--seed", self.seed)


@dataclass(frozen=True, kw_only=True)
class Run(SeededCommand):
    """Teach, learn, reproduce, push, film and report: the whole job of a task."""

    video: bool = True
    """Film the trials (needs an offscreen renderer: see tpsim doctor)."""
    situations: int = 10
    """Number of situations that were never taught."""
    pushes: int = 6
    """Number of pushes in each situation."""
    workers: int | None = None
    """Number of processes (default: one per core)."""

    def check(self) -> None:
        """Check the counts."""
        super().check()
        _positive("--situations", self.situations)
        _positive("--pushes", self.pushes)
        if self.workers is not None:
            _positive("--workers", self.workers)

    def execute(self) -> dict:
        """Run the campaign."""
        from tpsim.experiment import campaign

        return campaign.run(
            self.task,
            seed=self.seed,
            video=self.video,
            situations=self.situations,
            pushes=self.pushes,
            workers=self.workers or len(os.sched_getaffinity(0)),
            folder=self.folder,
            progress=sys.stderr.isatty(),
        )


@dataclass(frozen=True, kw_only=True)
class Teach(SeededCommand):
    """Lead the arms through a task and record the demonstrations."""

    count: int = 5
    """Number of demonstrations."""

    def check(self) -> None:
        """Check the count."""
        super().check()
        _positive("--count", self.count)

    def execute(self) -> dict:
        """Teach."""
        from tpsim.experiment import campaign

        return campaign.teach(self.task, count=self.count, seed=self.seed, folder=self.folder)


@dataclass(frozen=True, kw_only=True)
class Learn(TaskCommand):
    """Fit the task-parameterized model to the recorded demonstrations."""

    components: int = 1
    """Number of Gaussians of the mixture."""

    def check(self) -> None:
        """Check the number of components."""
        super().check()
        _positive("--components", self.components)

    def execute(self) -> dict:
        """Learn."""
        from tpsim.experiment import campaign

        return campaign.learn(self.task, components=self.components, folder=self.folder)


@dataclass(frozen=True, kw_only=True)
class Reproduce(SeededCommand):
    """Repeat the learned task in a situation that was never taught."""

    situation: int = 0
    """Number of the situation."""

    def check(self) -> None:
        """Check the situation's number."""
        super().check()
        _not_negative("--situation", self.situation)

    def execute(self) -> dict:
        """Reproduce."""
        from tpsim.experiment import campaign

        return campaign.reproduce(
            self.task, situation=self.situation, seed=self.seed, folder=self.folder
        )


@dataclass(frozen=True, kw_only=True)
class Push(Reproduce):
    """Repeat the learned task while a force acts on the robot, beside the same trial unpushed."""

    force: tuple[float, float, float] = (0.0, 20.0, 0.0)
    """Force in the world's axes [N]."""
    start: float = 2.0
    """When the push starts [s]."""
    duration: float = 2.0
    """How long it lasts [s]."""
    body: str = "left_gripper"
    """Body or site that is pushed."""

    def check(self) -> None:
        """Check the push."""
        super().check()
        if not all(map(math.isfinite, self.force)) or not any(self.force):
            given = " ".join(map(str, self.force))
            raise ArgumentError(f"--force {given}: give three finite numbers [N], not all zero")
        _not_negative("--start", self.start)
        _positive("--duration", self.duration)

    def execute(self) -> dict:
        """Push."""
        from tpsim.experiment import campaign

        return campaign.push(
            self.task,
            situation=self.situation,
            force=self.force,
            start=self.start,
            duration=self.duration,
            body=self.body,
            seed=self.seed,
            folder=self.folder,
        )


@dataclass(frozen=True, kw_only=True)
class Replay(Command):
    """Repeat a recorded run from its own folder and compare the recordings bit for bit."""

    folder: Annotated[Positional[Path], arg(metavar="FOLDER")]
    """Run folder, with its run.json."""

    def execute(self) -> dict:
        """Replay."""
        from tpsim.experiment import replay

        return replay.replay(self.folder)


@dataclass(frozen=True, kw_only=True)
class Compare(Command):
    """Measure the methods of the tutorial's Section 8 beside each other."""

    def execute(self) -> dict:
        """Compare."""
        from tpsim.experiment import compare

        return compare.compare()


@dataclass(frozen=True, kw_only=True)
class Bench(Command):
    """Measure speeds: learning, retrieval, control, simulation, or all of them."""

    area: Annotated[
        Positional[Literal["learning", "retrieval", "control", "simulation", "all"]],
        arg(metavar="AREA"),
    ] = "all"
    """One of learning, retrieval, control, simulation, all."""
    quick: bool = False
    """Fewer repetitions."""

    def execute(self) -> dict:
        """Run the benchmarks of the chosen areas."""
        areas = BENCHES if self.area == "all" else (self.area,)
        return {
            area: importlib.import_module(f"tpsim.bench.{area}").run(quick=self.quick)
            for area in areas
        }


@dataclass(frozen=True, kw_only=True)
class Demo(Command):
    """Run a demonstration of the tutorial's Table 2, or list them all."""

    name: Annotated[Positional[str | None], arg(metavar="[NAME]")] = None
    """Name of the demonstration; none lists them."""

    def execute(self) -> dict:
        """Run one or list all."""
        from tpsim.experiment import gallery

        if self.name is None:
            return {"demos": gallery.titles()}
        _known("demo", self.name, gallery.titles())
        return gallery.run(self.name)


@dataclass(frozen=True, kw_only=True)
class Doctor(Command):
    """Show versions, rendering, what is missing and the command that mends it."""

    def execute(self) -> dict:
        """Look."""
        from tpsim.experiment import doctor

        return doctor.examine()


COMMANDS = {
    command.__name__.lower(): command
    for command in (Run, Teach, Learn, Reproduce, Push, Replay, Compare, Bench, Demo, Doctor)
}


def _known(kind: str, given: str, allowed: Iterable[str]) -> None:
    names = sorted(allowed)
    if given in names:
        return
    near = difflib.get_close_matches(given, names, n=1, cutoff=0.5)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    raise ArgumentError(f"unknown {kind} {given!r}{hint} (known: {', '.join(names)})")


def _positive(name: str, value: float) -> None:
    if not 0 < value < math.inf:
        raise ArgumentError(f"{name} {value}: give a number greater than zero")


def _not_negative(name: str, value: float) -> None:
    if not 0 <= value < math.inf:
        raise ArgumentError(f"{name} {value}: give zero or a greater number")
