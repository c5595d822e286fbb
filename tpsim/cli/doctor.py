"""What is here, what is missing, and the command that mends it."""

import platform
import sys

from tpsim import paths
from tpsim.film import rendering
from tpsim.versions import cores, versions


def examine() -> dict[str, object]:
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
