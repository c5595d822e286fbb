"""The errors that tpsim raises: one root, so that one ``except`` catches them all."""

import traceback
from pathlib import Path
from typing import cast


class TpsimError(Exception):
    """Root of all errors raised on purpose. Its message says what was given, allowed, to do."""


class ArgumentError(TpsimError, ValueError):
    """An argument at the border is wrong: its shape, its range or its content."""


class ItemError(ArgumentError, IndexError):
    """An index that is out of range, or none: also what ends a loop over a value's steps."""


class RecordingError(TpsimError):
    """A file or folder of recordings is missing, truncated or of another schema."""


class SimulationError(TpsimError):
    """A scene, a posture or a task cannot be simulated as asked."""


class UnseenError(SimulationError):
    """A view looks from, or at, an object that was not seen yet."""


class RenderingError(TpsimError):
    """No offscreen renderer works here; the message names the packages to install."""


class DataWarning(UserWarning):
    """Data were mended or look wrong: the message says which, where and how to be explicit."""


def one_line(error: object, most: int | None = None) -> str:
    """What an error says, in one line of at most so many letters; its type if it says nothing."""
    line = " ".join(str(error).split()) or type(error).__name__
    return line if most is None or len(line) <= most else f"{line[: most - 3]}..."


def place(error: BaseException) -> str | None:
    """Where a user's own code went wrong; None where it was ours, or a package's."""
    if hasattr(error, "place"):  # it comes from a worker
        return cast(str | None, error.place)
    steps = traceback.extract_tb(error.__traceback__)
    if not steps or Path(steps[-1].filename).is_relative_to(Path(__file__).parent):
        return None
    last = steps[-1]
    if "site-packages" in last.filename or last.filename.startswith("<"):
        return None
    return f"{last.filename}, line {last.lineno}, in {last.name}"
