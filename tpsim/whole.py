"""Files that are written whole or not at all."""

import os
import platform
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO


@contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """Open a temporary file that takes the name ``path`` only when all went well."""
    with whole_path(path) as temporary, temporary.open("wb") as file:
        yield file


@contextmanager
def whole_path(path: Path) -> Iterator[Path]:
    """Give a temporary name, same suffix, whose file becomes ``path`` when all went well."""
    temporary = path.with_name(f".{path.stem}.{_owner()}.part{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        temporary.replace(path)
    except OSError as error:
        # A full disk names no file, and the temporary name is nobody's concern.
        if error.filename in (None, str(temporary)):
            error.filename, error.filename2 = str(path), None
        raise
    finally:
        with suppress(OSError):
            temporary.unlink()


def write_bytes(path: Path, content: bytes) -> Path:
    """Write ``content`` to ``path``."""
    with whole_file(path) as file:
        file.write(content)
    return path


def write_text(path: Path, text: str) -> Path:
    """Write ``text`` to ``path``."""
    return write_bytes(path, text.encode())


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """Give a new empty folder that becomes ``folder`` when all went well."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    sweep(folder.parent)
    new = folder.with_name(f".{folder.name}.{_owner()}.part")
    new.mkdir()
    try:
        yield new
        new.rename(folder)
    except OSError as error:
        error.filename = error.filename or str(folder)
        raise
    finally:
        shutil.rmtree(new, ignore_errors=True)


def sweep(folder: Path) -> None:
    """Remove what processes that were killed on this machine left half written in a folder."""
    for path in folder.glob(".*.part*"):
        found = re.search(rf"\.{re.escape(_machine())}-(\d+)\.part(\.\w+)?$", path.name)
        if found is None or _alive(int(found[1])):
            continue
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


def _owner() -> str:
    return f"{_machine()}-{os.getpid()}"


def _machine() -> str:
    # Folders may be shared: processes of other machines are not seen from here.
    return re.sub(r"\W", "", platform.node()) or "here"


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
