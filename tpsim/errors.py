"""The errors that tpsim raises: one root, so that one ``except`` catches them all."""


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


class RenderingError(TpsimError):
    """No offscreen renderer works here; the message names the packages to install."""


def in_one_line(error: BaseException, most: int = 300) -> str:
    """What an error says, or its kind if nothing, in one line of at most so many characters."""
    line = " ".join(str(error).split()) or type(error).__name__
    return line if len(line) <= most else f"{line[: most - 3]}..."


class DataWarning(UserWarning):
    """Data were mended or look wrong: the message says which, where and how to be explicit."""
