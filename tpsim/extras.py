"""Packages that come with an extra: where one is missing, the line that installs it."""

from collections.abc import Iterator
from contextlib import contextmanager

from tpsim.errors import RecordingError


@contextmanager
def extra(what: str, name: str = "data") -> Iterator[None]:
    """Say which extra to install where an import in this block fails."""
    try:
        yield
    except ImportError as error:
        raise RecordingError(
            f"{what} need the package {(error.name or '').partition('.')[0]}, which is not "
            f"installed: pip install 'tpsim[{name}]'"
        ) from error
