"""The folder of a comparison: it goes on in its own, and touches no other."""

from pathlib import Path

from tpsim.errors import RecordingError
from tpsim.whole import check_free

_OURS = ("comparison.json", "cells")


def check_folder(folder: Path) -> None:
    """Raise RecordingError unless a folder is new, empty, or that of a comparison."""
    if not any((folder / name).exists() for name in _OURS):
        try:
            check_free(folder)
        except RecordingError:
            raise RecordingError(
                f"{folder} holds something else than a comparison; give a new folder"
            ) from None
