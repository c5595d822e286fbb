"""Options that many commands share, and the checks that turn a slip into one clear line."""

import difflib
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import FlagCreatePairsOff, Positional, arg

from tpsim.errors import ArgumentError

TaskName = Annotated[Positional[str], arg(metavar="TASK")]


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

        known("task", self.task, tasks.names())
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
        not_negative("--seed", self.seed)


def known(kind: str, given: str, allowed: Iterable[str]) -> None:
    """Raise ArgumentError with the nearest name where ``given`` is not among the allowed."""
    names = sorted(allowed)
    if given in names:
        return
    near = difflib.get_close_matches(given, names, n=1, cutoff=0.5)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    raise ArgumentError(f"unknown {kind} {given!r}{hint} (known: {', '.join(names)})")


def positive(name: str, value: float) -> None:
    """Raise ArgumentError unless ``value`` is a finite number above zero."""
    if not 0 < value < math.inf:
        raise ArgumentError(f"{name} {value}: give a number greater than zero")


def not_negative(name: str, value: float) -> None:
    """Raise ArgumentError unless ``value`` is a finite number of at least zero."""
    if not 0 <= value < math.inf:
        raise ArgumentError(f"{name} {value}: give zero or a greater number")
