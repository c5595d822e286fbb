"""Options that many commands share, and the checks that turn a slip into one clear line."""

import difflib
import math
import tempfile
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

SEEDS = 2**32 - 1
"""Greatest seed: recordings hold 32 bits."""

MANY = 1_000_000
"""Most situations, pushes, demonstrations: more would fill the memory before anything starts."""

HOUR = 3600.0
"""Longest push [s], and latest start."""

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

    def exit_code(self, answer: Answer) -> int:
        """0 where the work came out as it should, else 1, or 3 where only a limit was missed."""
        return 0


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
        writable("--folder", self.folder)

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
        number("--seed", self.seed, 0, SEEDS)


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


def writable(name: str, folder: Path | None) -> None:
    """Raise ArgumentError where a folder could not be made or written to; nothing stays there."""
    if folder is None:
        return
    try:
        if folder.exists() and not folder.is_dir():
            raise ArgumentError(f"{name} {folder} is a file; give a new or empty folder")
        there = next(parent for parent in (folder, *folder.absolute().parents) if parent.exists())
        with tempfile.TemporaryDirectory(dir=there):
            pass
    except OSError as error:
        given = shortened(folder)
        raise ArgumentError(f"{name} {given} cannot be written to ({error.strerror})") from None


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


def number(name: str, value: float, least: float, greatest: float) -> None:
    """Raise ArgumentError unless ``value`` is from ``least`` to ``greatest``."""
    if not least <= value <= greatest:
        raise ArgumentError(f"{name} {shortened(value)}: give a number from {least} to {greatest}")


def shortened(value: object) -> str:
    """A value as it was given, cut where it would fill the screen."""
    text = str(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def positive(name: str, value: float) -> None:
    """Raise ArgumentError unless ``value`` is a finite number above zero."""
    if not 0 < value < math.inf:
        raise ArgumentError(f"{name} {value}: give a number greater than zero")
