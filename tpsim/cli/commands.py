"""The commands: one frozen dataclass each; its fields are the options of the command line.

What is heavy is imported inside the commands, so that ``tpsim --help`` answers at once.
"""

import importlib
import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from tyro.conf import FlagCreatePairsOff, Positional, arg

from tpsim.cli.campaign import Campaign
from tpsim.cli.comparison import Compare
from tpsim.cli.export import Export
from tpsim.cli.options import (
    HOUR,
    MANY,
    SEEDS,
    Answer,
    Command,
    Learning,
    SeededCommand,
    StudyCommand,
    number,
    positive,
    writable,
)
from tpsim.cli.play import Play
from tpsim.cli.recordings import Data
from tpsim.cli.replay import Replay
from tpsim.cli.robots import Robots
from tpsim.cli.run import Run
from tpsim.cli.tuning import Tune
from tpsim.errors import ArgumentError

if TYPE_CHECKING:
    from tpsim.study.study import Study

BENCHES = ("learning", "retrieval", "control", "simulation")


@dataclass(frozen=True, kw_only=True)
class Teach(SeededCommand):
    """Lead the arms through a task and record the demonstrations."""

    count: int | None = None
    """Number of demonstrations of each behaviour (default: the task's own)."""

    def check(self) -> None:
        """Check the count."""
        super().check()
        if self.count is not None:
            number("--count", self.count, 1, MANY)

    def execute(self, study: "Study", line: str) -> Answer:
        """Teach all behaviours of the task."""
        from tpsim.study import teaching

        return teaching.teach(
            study, count=self.count, seed=self.seed, folder=self.folder, command=line
        )


@dataclass(frozen=True, kw_only=True)
class Learn(Learning):
    """Fit the task-parameterized models to recorded demonstrations."""

    def execute(self, study: "Study", line: str) -> Answer:
        """Fit the models and say what was learned."""
        from tpsim.study import teaching

        return teaching.learn(study, self.source(), out=self.folder)


@dataclass(frozen=True, kw_only=True)
class Reproduce(Learning, SeededCommand):
    """Repeat the learned task in a situation that was never taught."""

    situation: int = 0
    """Number of the situation."""

    def check(self) -> None:
        """Check the situation's number."""
        super().check()
        number("--situation", self.situation, 0, SEEDS)

    def execute(self, study: "Study", line: str) -> Answer:
        """Perform the task in one situation."""
        from tpsim.study import trying

        return trying.reproduce(
            study,
            self.source(),
            situation=self.situation,
            seed=self.seed,
            folder=self.folder,
            command=line,
        )


@dataclass(frozen=True, kw_only=True)
class Push(Reproduce):
    """Repeat the learned task while a force acts on the robot, beside the same unpushed."""

    force: tuple[float, float, float] = (0.0, 20.0, 0.0)
    """Force in the world's axes [N]."""
    start: float = 2.0
    """When the push starts [s]."""
    duration: float = 2.0
    """How long it lasts [s]."""
    body: str | None = None
    """Body or site that is pushed (default: the first hand); an unknown name lists all."""

    def check(self) -> None:
        """Check the push."""
        super().check()
        if not all(map(math.isfinite, self.force)) or not any(self.force):
            given = " ".join(map(str, self.force))
            raise ArgumentError(f"--force {given}: give three finite numbers [N], not all zero")
        number("--start", self.start, 0, HOUR)
        positive("--duration", self.duration)
        number("--duration", self.duration, 0, HOUR)

    def execute(self, study: "Study", line: str) -> Answer:
        """Perform the task twice, pushed and not."""
        from tpsim.study import trying

        return trying.push(
            study,
            self.source(),
            force=self.force,
            start=self.start,
            duration=self.duration,
            body=self.body,
            situation=self.situation,
            seed=self.seed,
            folder=self.folder,
            command=line,
        )


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

    def execute(self) -> Answer:
        """Run the benchmarks of the chosen areas."""
        areas = BENCHES if self.area == "all" else (self.area,)
        return {
            area: importlib.import_module(f"tpsim.bench.{area}").run(quick=self.quick)
            for area in areas
        }


@dataclass(frozen=True, kw_only=True)
class Demo(Command):
    """Run a row of the tutorial's Table 2, as numbers and a picture, or list them all."""

    name: Annotated[Positional[str | None], arg(metavar="[NAME]")] = None
    """Name of the row; none lists them."""
    all: FlagCreatePairsOff[bool] = False
    """Run all rows."""
    show: FlagCreatePairsOff[bool] = False
    """Open a window with the picture."""
    folder: Path | None = None
    """Folder for the pictures (default: recordings/runs/gallery)."""

    def check(self) -> None:
        """Check that one row, or all, or none is asked for."""
        writable("--folder", self.folder)
        if self.all and (self.name or self.show):
            raise ArgumentError("--all runs every row and opens no window; give it alone")
        if self.show and self.name is None:
            raise ArgumentError("--show needs the name of a row; tpsim demo lists them")

    def execute(self) -> Answer:
        """Run one, run all, or list all."""
        from tpsim import gallery

        if self.all:
            results = gallery.run_all(self.folder, progress=_say)
            return {"rows": results if self.json else [gallery.brief(each) for each in results]}
        if self.name is None:
            return {"demos": [f"{name}: {title}" for name, title in gallery.titles().items()]}
        return dict(gallery.run(self.name, self.folder, show=self.show))


@dataclass(frozen=True, kw_only=True)
class Doctor(Command):
    """Show versions, rendering, what is missing and the command that mends it."""

    def execute(self) -> Answer:
        """Examine this installation."""
        from tpsim.cli import doctor

        return doctor.examine()


def _say(name: str) -> None:
    if sys.stderr.isatty():
        print(name, file=sys.stderr)


COMMANDS: Mapping[str, type[Command | StudyCommand]] = {
    command.__name__.lower(): command
    for command in (
        *(Run, Teach, Learn, Reproduce, Push, Campaign, Tune, Replay, Export, Data),
        *(Compare, Play, Bench, Demo, Robots, Doctor),
    )
}
