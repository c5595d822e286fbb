"""Where the files that travel with tpsim are: the only module that knows."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def _shipped(name: str) -> Path:
    """Folder ``name`` inside an installed wheel, or beside the package in a checkout."""
    installed = _PACKAGE / name
    return installed if installed.is_dir() else _PACKAGE.parent / name


MODELS = _shipped("models")
"""MJCF files of robots and objects."""

DEMOS = _shipped("demos")
"""Scripts, one per row of the tutorial's Table 2."""


def recordings() -> Path:
    """Folder of recordings: ``recordings/`` of the working directory."""
    return Path.cwd() / "recordings"


def demonstrations(task: str) -> Path:
    """Folder of the demonstrations of one task."""
    return recordings() / "demonstrations" / task


def runs() -> Path:
    """Folder of the run folders."""
    return recordings() / "runs"
