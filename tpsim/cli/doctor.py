"""What is here, what is missing, and the command that mends it."""

import os
import platform
import sys
from importlib import metadata

from tpsim import paths
from tpsim.sim import rendering

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


def versions(packages: tuple[str, ...] = PACKAGES) -> dict[str, str | None]:
    """Return Python's version and those of ``packages``; None where one is not installed."""
    return {"python": platform.python_version()} | {name: _version(name) for name in packages}


def cores() -> int:
    """Return the number of processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def examine() -> dict:
    """Return versions, machine, folders, and what is missing with the command that mends it."""
    found = versions()
    renderer, encoder = rendering.backend(), _encoder()
    return {
        "versions": found,
        "machine": {
            "system": platform.platform(),
            "cores": cores(),
            "renderer": renderer,
            "film_encoder": encoder,
        },
        "folders": {
            "models": paths.MODELS,
            "demos": paths.DEMOS,
            "recordings": paths.recordings(),
        },
        "missing": [
            *_missing_packages(found),
            *_missing_film(renderer, encoder),
            *_missing_files(),
        ],
    }


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _encoder() -> str | None:
    """FFmpeg's path, None where there is none."""
    try:
        import imageio_ffmpeg

        return imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError):
        return None


def _missing_packages(found: dict[str, str | None]) -> list[dict[str, str]]:
    return [
        _mend(f"package {name}", f"{sys.executable} -m pip install {name}")
        for name, version in found.items()
        if version is None
    ]


def _missing_film(renderer: str | None, encoder: str | None) -> list[dict[str, str]]:
    missing = []
    if renderer is None:
        missing.append(_mend("offscreen rendering, for films", rendering.HINT.split(": ")[-1]))
    if encoder is None:
        missing.append(
            _mend("FFmpeg, for films", f"{sys.executable} -m pip install 'imageio[ffmpeg]'")
        )
    return missing


def _missing_files() -> list[dict[str, str]]:
    return [
        _mend(f"the files of {folder}", f"{sys.executable} -m pip install --force-reinstall tpsim")
        for folder, kind in ((paths.MODELS, "*.xml"), (paths.DEMOS, "*.py"))
        if not any(folder.glob(kind))
    ]


def _mend(missing: str, command: str) -> dict[str, str]:
    return {"missing": missing, "command": command}
