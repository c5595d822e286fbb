"""What runs here: versions of packages, and processor cores."""

import os
import platform
from collections.abc import Sequence

PACKAGES = (
    "tpsim",
    "numpy",
    "scipy",
    "mujoco",
    "dm-control",
    "pin",
    "mink",
    "tyro",
    "matplotlib",
    "imageio",
    "imageio-ffmpeg",
    "tqdm",
)
"""What tpsim is made of, by the names that pip knows."""


def versions(packages: Sequence[str] = PACKAGES) -> dict[str, str | None]:
    """Python's version and those of ``packages``; None where one is not installed."""
    return {"python": platform.python_version()} | {name: _version(name) for name in packages}


def cores() -> int:
    """Number of processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _version(package: str) -> str | None:
    from importlib import metadata  # slow to import, and rarely needed

    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None
