"""Files of a folder that may come from a stranger: nothing outside it is opened."""

import hashlib
from pathlib import Path

from tpsim.errors import RecordingError


def is_plain(name: str) -> bool:
    """Whether a name is that of a file in a folder: no path, no drive, not hidden."""
    return bool(name) and not (set(name) & set("/\\:\0") or name.startswith("."))


def inside(folder: Path, name: str) -> Path:
    """Path of the file ``name`` in ``folder``.

    Raises
    ------
    RecordingError
        If it is missing, no ordinary file, or leads elsewhere.
    """
    path = folder / name
    if not is_plain(name) or path.is_symlink() or folder.is_symlink():
        raise RecordingError(f"{path} leads out of its folder; recordings are ordinary files")
    if not path.is_file():
        raise RecordingError(f"there is no file {path}; give the folder of a run")
    return path


def inside_folder(folder: Path, inner: Path) -> None:
    """Raise RecordingError where a folder below ``folder`` is reached by a link."""
    for part in (inner, *inner.parents):
        if part == folder:
            return
        if part.is_symlink():
            raise RecordingError(f"{part} leads out of its folder; recordings are ordinary folders")


def read_inside(folder: Path, name: str, most: int) -> bytes:
    """Content of a file of at most ``most`` bytes.

    Raises
    ------
    RecordingError
        If it is missing, leads elsewhere, cannot be read, or is larger.
    """
    path = inside(folder, name)
    try:
        with path.open("rb") as file:
            content = file.read(most + 1)
    except OSError as error:
        raise RecordingError(f"cannot read {path} ({error.strerror})") from None
    if len(content) > most:
        raise RecordingError(f"{path} is larger than {most} bytes: it is no recording of tpsim")
    return content


def read_text_inside(folder: Path, name: str, most: int) -> str:
    """Text of a file, as :func:`read_inside`."""
    try:
        return read_inside(folder, name, most).decode()
    except UnicodeDecodeError as error:
        raise RecordingError(f"{folder / name} is no text ({error.reason})") from None


def checksum(content: bytes) -> str:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def checksum_inside(folder: Path, name: str, most: int) -> str:
    """SHA-256 of a file of at most ``most`` bytes; errors are those of :func:`read_inside`."""
    path = inside(folder, name)
    if path.stat().st_size > most:
        raise RecordingError(f"{path} is larger than {most} bytes: it is no recording of tpsim")
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
