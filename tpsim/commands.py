"""The commands: one frozen dataclass each; its fields are the options of the command line.

What is heavy is imported inside the commands, so that ``tpsim --help`` answers at once.
"""

import dataclasses
import importlib
import math
import shlex
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro
from tyro.conf import Positional, arg

from tpsim.errors import ArgumentError
from tpsim.options import Command, SeededCommand, TaskCommand, known, not_negative, positive

BENCHES = ("learning", "retrieval", "control", "simulation")


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
        positive("--situations", self.situations)
        positive("--pushes", self.pushes)
        if self.workers is not None:
            positive("--workers", self.workers)

    def execute(self) -> dict:
        """Run the campaign."""
        from tpsim.experiment import campaign
        from tpsim.experiment.doctor import cores

        return campaign.run(
            self.task,
            seed=self.seed,
            video=self.video,
            situations=self.situations,
            pushes=self.pushes,
            workers=self.workers or cores(),
            folder=self.folder,
            progress=sys.stderr.isatty(),
        )


@dataclass(frozen=True, kw_only=True)
class Teach(SeededCommand):
    """Lead the arms through a task and record the demonstrations."""

    count: int = 6
    """Number of demonstrations."""

    def check(self) -> None:
        """Check the count."""
        super().check()
        positive("--count", self.count)

    def execute(self) -> dict:
        """Teach."""
        from tpsim.experiment import campaign

        return campaign.teach(self.task, count=self.count, seed=self.seed, folder=self.folder)


@dataclass(frozen=True, kw_only=True)
class Learn(TaskCommand):
    """Fit the task-parameterized model to the recorded demonstrations."""

    components: int | None = None
    """Number of Gaussians of the mixture (default: the task's own)."""

    def check(self) -> None:
        """Check the number of components."""
        super().check()
        if self.components is not None:
            positive("--components", self.components)

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
        not_negative("--situation", self.situation)

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
    body: str | None = None
    """Body that is pushed (default: the task's hand); an unknown name lists all."""

    def check(self) -> None:
        """Check the push."""
        super().check()
        if not all(map(math.isfinite, self.force)) or not any(self.force):
            given = " ".join(map(str, self.force))
            raise ArgumentError(f"--force {given}: give three finite numbers [N], not all zero")
        not_negative("--start", self.start)
        positive("--duration", self.duration)

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
        from tpsim.experiment.recording import load_run
        from tpsim.experiment.replay import compare_runs, replay

        run = load_run(self.folder)
        line = run.description["command"]
        command = parse(shlex.split(line)[1:])
        if not isinstance(command, Teach):
            return {"command": line, **replay(run)}
        with tempfile.TemporaryDirectory() as folder:
            again = dataclasses.replace(command, folder=Path(folder)).execute()
            where = again["paths"]["demonstrations"][0]
            return {"command": line, **compare_runs(run, load_run(Path(where)))}


@dataclass(frozen=True, kw_only=True)
class Compare(Command):
    """Measure the methods of the tutorial's Section 8, and yours, on the same situations."""

    quick: bool = False
    """One task, four demonstrations, two teachers: a minute instead of many."""
    method: Annotated[tuple[str, ...], arg(metavar="FILE.PY:FUNCTION")] = ()
    """Methods of your own beside the others: from demonstrations to a function of frames."""
    data: Path | None = None
    """Demonstrations of your own: each is left out once and predicted by the others."""
    seed: int = 0
    """Seed of the first teacher."""
    workers: int | None = None
    """Number of processes (default: one per core)."""
    folder: Path | None = None
    """Folder to write to, and to go on from (default: one in recordings/runs)."""

    def check(self) -> None:
        """Check the numbers, the folder and the file of demonstrations."""
        not_negative("--seed", self.seed)
        if self.workers is not None:
            positive("--workers", self.workers)
        if self.folder is not None and self.folder.is_file():
            raise ArgumentError(f"--folder {self.folder} is a file; give a new or empty folder")
        if self.data is not None and not self.data.exists():
            raise ArgumentError(f"--data {self.data} does not exist; give a file or a folder")

    def execute(self) -> dict:
        """Compare."""
        from tpsim import paths
        from tpsim.experiment.doctor import cores
        from tpsim.section8 import compare, compare_left_out
        from tpsim.section8.methods import with_methods_from
        from tpsim.section8.plan import QUICK, Plan
        from tpsim.section8.tables import short

        methods = with_methods_from(self.method)
        kind = "data" if self.data else "quick" if self.quick else "full"
        folder = self.folder or paths.runs() / f"compare-{kind}-seed-{self.seed}"
        if self.data is not None:
            taught = _demonstrations(self.data)
            result = compare_left_out(taught, methods, folder=folder, command=self._line())
        else:
            result = compare(
                methods,
                QUICK if self.quick else Plan(),
                seed=self.seed,
                folder=folder,
                workers=self.workers or cores(),
                progress=sys.stderr.isatty(),
                command=self._line(),
            )
        return result if self.json else short(result)

    def _line(self) -> str:
        """Return the command line that repeats the comparison."""
        words = ["tpsim", "compare", *(["--quick"] if self.quick else [])]
        words += ["--method", *self.method] if self.method else []
        words += ["--data", str(self.data)] if self.data else []
        words += ["--seed", str(self.seed)] if self.seed else []
        return shlex.join(words)


def _demonstrations(path: Path) -> list:
    """Read a user's demonstrations, of any format that tpsim.data knows."""
    try:
        from tpsim.data import read
    except ImportError as error:
        raise ArgumentError("--data needs tpsim.data, which is not installed here") from error
    return list(read(path))


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
            return {"demos": list(gallery.titles().values())}
        known("demo", self.name, gallery.titles())
        return gallery.run(self.name)


@dataclass(frozen=True, kw_only=True)
class Doctor(Command):
    """Show versions, rendering, what is missing and the command that mends it."""

    def execute(self) -> dict:
        """Look."""
        from tpsim.experiment import doctor

        return doctor.examine()


def parse(arguments: Sequence[str]) -> Command:
    """Return the command that ``arguments`` name; exit with 2 where they name none."""
    return tyro.extras.subcommand_cli_from_dict(
        COMMANDS,
        prog="tpsim",
        description="Task-parameterized movement learning on torque-controlled robots.",
        args=list(arguments),
    )


COMMANDS = {
    command.__name__.lower(): command
    for command in (Run, Teach, Learn, Reproduce, Push, Replay, Compare, Bench, Demo, Doctor)
}
