"""Packages that are not there, and errors of other people's readers, in one line."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tpsim.errors import RecordingError, TpsimError, one_line


@contextmanager
def extra(what: str) -> Iterator[None]:
    """Say which extra to install where an import in this block fails."""
    try:
        yield
    except ImportError as error:
        raise RecordingError(
            f"{what} need the package {(error.name or '').partition('.')[0]}, which is not "
            "installed: pip install 'tpsim[data]'"
        ) from error


@contextmanager
def opened(path: Path, what: str) -> Iterator[None]:
    """Turn whatever a foreign reader raises on a broken file into one line about ``path``.

    Readers of other packages raise all kinds of errors on files that are cut or of another kind.
    """
    try:
        yield
    except (TpsimError, ImportError):
        raise
    except MemoryError as error:
        raise RecordingError(f"{path}: needs more memory than there is") from error
    except Exception as error:
        reason = one_line(error)
        raise RecordingError(f"{path} is truncated or no {what} ({reason[:200]})") from error
