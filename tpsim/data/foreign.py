"""Errors of other people's readers, in one line."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tpsim.errors import RecordingError, TpsimError, one_line
from tpsim.npz import BYTES

FILES = 100_000
"""Most files of a folder of recordings."""


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
        raise RecordingError(
            f"{path} is truncated or no {what} ({one_line(error, 300)})"
        ) from error


def check_size(path: Path, numbers: int) -> None:
    """Refuse what would fill the memory, before it is read.

    Raises
    ------
    RecordingError
        So many numbers are more than an archive of tpsim may hold.
    """
    if 8 * numbers > BYTES:
        raise RecordingError(f"{path} claims {numbers} numbers, at most {BYTES // 8}; split it")


def check_ordinary(path: Path) -> None:
    """Refuse what is no file, or holds what is none: a pipe or a device would never end.

    Raises
    ------
    RecordingError
        Names it.
    """
    found = [path] if not path.is_dir() else sorted(path.rglob("*"))
    if len(found) > FILES:
        raise RecordingError(f"{path} holds {len(found)} files, at most {FILES}; give a part of it")
    for one in found:
        if not (one.is_file() or one.is_dir()):
            raise RecordingError(f"there is no file {one}, but a pipe, a device or a broken link")
