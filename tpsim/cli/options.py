"""Options that many commands share, and the checks that turn a slip into one clear line."""

import difflib
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tyro.conf import FlagCreatePairsOff, Positional, arg

from tpsim.errors import ArgumentError

if TYPE_CHECKING:
    from tpsim.study.study import Study
    from tpsim.study.teaching import Source

Answer = Mapping[str, object]
"""What a command has to say: plain values and paths by name."""

Reference = Annotated[Positional[str], arg(metavar="TASK")]


@dataclass(frozen=True, kw_only=True)
class Options:
    """What every command has."""

    json: FlagCreatePairsOff[bool] = False
    """Print one JSON object on stdout and nothing else."""

    def check(self) -> None:
        """Raise ArgumentError for options that make no sense, before anything heavy happens."""

    def succeeded(self, answer: Answer) -> bool:
        """Whether the work came out as it should; the exit code says so."""
        return True


@dataclass(frozen=True, kw_only=True)
class Command(Options, ABC):
    """A command that is about no study."""

    @abstractmethod
    def execute(self) -> Answer:
        """Do the work and return what to print."""


@dataclass(frozen=True, kw_only=True)
class StudyCommand(Options, ABC):
    """What every command about one study has."""

    reference: Reference
    """A built-in task, my_task.py:study or package.module:study; after it, --help lists the fields
    of the task, which are options too."""
    folder: Path | None = None
    """Folder to write to (default: a new one in recordings/)."""

    def check(self) -> None:
        """Check the folder."""
        if self.folder is not None and self.folder.is_file():
            raise ArgumentError(f"--folder {self.folder} is a file; give a new or empty folder")

    @abstractmethod
    def execute(self, study: "Study", line: str) -> Answer:
        """Do the work on a study and return what to print.

        Parameters
        ----------
        study : Study
        line : str
            The command line, which recordings keep for people to read.
        """


@dataclass(frozen=True, kw_only=True)
class SeededCommand(StudyCommand):
    """What every command that draws random numbers has."""

    seed: int = 0
    """Seed of everything random; the same seed gives the same recordings."""

    def check(self) -> None:
        """Check the seed."""
        super().check()
        not_negative("--seed", self.seed)


@dataclass(frozen=True, kw_only=True)
class Learning(StudyCommand):
    """What every command has that starts from recorded demonstrations."""

    demonstrations: Path | None = None
    """Folder that tpsim teach wrote (default: recordings/demonstrations)."""
    run: Annotated[Path | None, arg(name="from", metavar="RUN")] = None
    """Run folder to start from: its demonstrations, models, scene and task's fields."""

    def check(self) -> None:
        """Check the demonstrations' folder."""
        super().check()
        if self.run is not None and self.demonstrations is not None:
            raise ArgumentError("--from and --demonstrations: give one of them")
        if self.demonstrations is not None and not self.demonstrations.is_dir():
            raise ArgumentError(
                f"--demonstrations {self.demonstrations}: give a folder that tpsim teach wrote"
            )

    def source(self) -> "Source | None":
        """What to start from."""
        if self.run is None:
            return self.demonstrations
        from tpsim.study.files.run import load_run

        return load_run(self.run)


def nearest(given: str, names: Iterable[str]) -> str:
    """``"; did you mean 'x'?"``, or nothing where no name is near."""
    near = difflib.get_close_matches(given, list(names), n=1, cutoff=0.5)
    return f"; did you mean {near[0]!r}?" if near else ""


def known(kind: str, given: str, allowed: Iterable[str]) -> None:
    """Raise ArgumentError with the nearest name where ``given`` is not among the allowed."""
    names = sorted(allowed)
    if given not in names:
        hint = nearest(given, names)
        raise ArgumentError(f"unknown {kind} {given!r}{hint} (known: {', '.join(names)})")


def positive(name: str, value: float) -> None:
    """Raise ArgumentError unless ``value`` is a finite number above zero."""
    if not 0 < value < math.inf:
        raise ArgumentError(f"{name} {value}: give a number greater than zero")


def not_negative(name: str, value: float) -> None:
    """Raise ArgumentError unless ``value`` is a finite number of at least zero."""
    if not 0 <= value < math.inf:
        raise ArgumentError(f"{name} {value}: give zero or a greater number")
