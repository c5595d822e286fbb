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


class DataWarning(UserWarning):
    """Data were mended or look wrong: the message says which, where and how to be explicit."""
