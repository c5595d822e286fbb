"""Files and folders that are written whole or not at all, and never over what is there."""

import errno
import itertools
import os
import platform
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from tpsim.errors import RecordingError

_count = itertools.count()
_HALF: set[Path] = set()
_TAKEN = (errno.EEXIST, errno.ENOTEMPTY, errno.ENOTDIR, errno.EISDIR)


@contextmanager
def whole_file(path: Path, *, replace: bool = False) -> Iterator[BinaryIO]:
    """Open a temporary file that takes the name ``path`` only when all went well."""
    with whole_path(path, replace=replace) as temporary, temporary.open("wb") as file:
        yield file


@contextmanager
def whole_path(path: Path, *, replace: bool = False) -> Iterator[Path]:
    """Give a temporary name, same suffix, whose file becomes ``path`` when all went well.

    Parameters
    ----------
    path : Path
        Its folder is made where it is missing.
    replace : bool
        Whether a file of that name gives way: for what is drawn anew from what is kept.

    Raises
    ------
    RecordingError
        There is such a file already, also if another process just made it; or it cannot be
        written: no space, no permission, no folder. Nothing is left of it then.
    """
    with _one_line(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.is_dir() or (not replace and os.path.lexists(path)):
            raise _exists(path)
    temporary = _unfinished(path.stem, path, path.suffix)
    try:
        with _one_line(path):
            yield temporary
            _to_disk(temporary)
            if replace:
                temporary.replace(path)
            else:
                _name(temporary, path)
    finally:
        _remove(temporary)


def write_bytes(path: Path, content: bytes, *, replace: bool = False) -> Path:
    """Write ``content`` to ``path``, as :func:`whole_path`."""
    with whole_file(path, replace=replace) as file:
        file.write(content)
    return path


def write_text(path: Path, text: str, *, replace: bool = False) -> Path:
    """Write ``text`` to ``path``, as :func:`whole_path`."""
    return write_bytes(path, text.encode(), replace=replace)


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """Give a new empty folder that becomes ``folder`` when all went well.

    Raises
    ------
    RecordingError
        There is something in ``folder`` already, or it cannot be written.
    """
    check_free(folder)
    with _new_folder(folder) as new:
        yield new
        if not _renamed(new, folder):
            raise _exists(folder)


def numbered_folder(folder: Path, fill: Callable[[Path], object]) -> Path:
    """Make a folder; it becomes ``folder``, or ``folder~2``, ``~3``, ... where there is one.

    ``fill`` is given a new empty folder, which takes its name when all went well: nothing is
    removed, whoever else writes beside. The newest is found by :func:`newest`.
    """
    with _new_folder(folder) as new:
        fill(new)
        place = _after(newest(folder)) if folder.exists() else folder
        while not _renamed(new, place):
            place = _after(place)
    return place


def newest(folder: Path) -> Path:
    """The last of ``folder``, ``folder~2``, ...; ``folder`` itself where there is none."""
    pattern = re.compile(re.escape(folder.name) + r"~([1-9]\d*)")
    try:
        names = os.listdir(folder.parent)
    except OSError:
        return folder
    numbers = [int(match[1]) for name in names if (match := pattern.fullmatch(name))]
    return folder.with_name(f"{folder.name}~{max(numbers)}") if numbers else folder


@contextmanager
def removed_if_nothing_came(folder: Path) -> Iterator[None]:
    """Take a new folder away again if the first thing that should fill it fails."""
    try:
        yield
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def check_free(folder: Path) -> None:
    """Raise RecordingError where ``folder`` is a file, or holds something."""
    with _one_line(folder):
        if os.path.lexists(folder) and (not folder.is_dir() or any(folder.iterdir())):
            raise _exists(folder)


def sweep(folder: Path) -> None:
    """Remove what processes that were killed on this machine left half written in a folder."""
    for path in folder.glob(".*.part*"):
        found = re.search(rf"\.{re.escape(_machine())}-(\d+)-\d+\.part(\.\w+)?$", path.name)
        if found is None or _alive(int(found[1])):
            continue
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


@contextmanager
def _new_folder(beside: Path) -> Iterator[Path]:
    with _one_line(beside):
        beside.parent.mkdir(parents=True, exist_ok=True)
        sweep(beside.parent)
        new = _unfinished(beside.name, beside)
        new.mkdir()
    try:
        with _one_line(beside):
            yield new
    finally:
        _remove(new)


def abandon() -> None:
    """Remove what this process has half written: it ends at once."""
    for path in list(_HALF):
        _remove(path)


def _remove(path: Path) -> None:
    if os.path.isdir(path):
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink()
    _HALF.discard(path)


def _renamed(new: Path, folder: Path) -> bool:
    """Whether a folder could take a name; it cannot where there is something already."""
    try:
        new.rename(folder)
    except OSError as error:
        if error.errno in _TAKEN:
            return False
        raise
    return True


def _after(folder: Path) -> Path:
    stem, mark, number = folder.name.rpartition("~")
    return folder.with_name(f"{stem}~{int(number) + 1}" if mark else f"{folder.name}~2")


def _to_disk(file: Path) -> None:
    """A name must not outlive a power failure that its content does not."""
    with file.open("rb+") as written:
        os.fsync(written.fileno())


def _name(temporary: Path, path: Path) -> None:
    """Give a file its name, which fails where there is one: no moment between look and leap."""
    try:
        os.link(temporary, path)
    except FileExistsError:
        raise _exists(path) from None
    except OSError:  # a file system without links
        try:
            os.close(os.open(path, os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            raise _exists(path) from None
        temporary.replace(path)


def _exists(path: Path) -> RecordingError:
    what = "folder" if path.is_dir() else "name"
    full = " and is not empty" if path.is_dir() else ""
    return RecordingError(f"{path} exists{full}; give a new {what}, nothing is overwritten")


@contextmanager
def _one_line(path: Path) -> Iterator[None]:
    """Say in one line which file could not be written."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or " ".join(str(error).split())
        raise RecordingError(
            f"cannot write {path} ({reason}); make space or give another folder"
        ) from error


def _unfinished(name: str, path: Path, suffix: str = "") -> Path:
    """A hidden name beside ``path`` that says whose it is: machine, process, and which of its."""
    while True:
        owner = f"{_machine()}-{os.getpid()}-{next(_count)}"
        found = path.with_name(f".{name}.{owner}.part{suffix}")
        if not os.path.lexists(found):  # a process of this number may have been killed before
            _HALF.add(found)
            return found


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
