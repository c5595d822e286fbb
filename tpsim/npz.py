"""Archives of arrays (.npz): written whole or not at all, read without pickles and with bounds."""

import math
import os
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import IO

import numpy as np

from tpsim.errors import RecordingError, one_line
from tpsim.whole import whole_file

MEMBERS = 1024
"""Most arrays in an archive."""

BYTES = 2**30
"""Most bytes in an archive."""

TEXT = 2**26
"""Most bytes of a text in an archive; four a character."""

_NUMBERS_AND_TEXT = "biufcU"
_ONE_ARRAY = b"\x93NUMPY"
_DIRECTORY = 2**20
_END = 2**16 + 22


def write_members(
    path: str | Path, arrays: Mapping[str, np.ndarray], *, replace: bool = False
) -> Path:
    """Write named arrays to ``path``, under a temporary name until the file is complete.

    Its folder is made where it is missing. No pickles, no compression; RecordingError where there
    is such a file, unless it is to be replaced.
    """
    path = Path(path)
    with whole_file(path, replace=replace) as file:
        np.savez(file, allow_pickle=False, **dict(arrays))
    return path


def read_members(path: str | Path) -> dict[str, np.ndarray]:
    """Read an uncompressed archive of arrays, whoever wrote it.

    Sizes are checked before anything is allocated: no array is larger than its part of the file.

    Raises
    ------
    RecordingError
        The file is missing, truncated, too large, compressed, or holds pickles.
    """
    path = Path(path)
    if not path.is_file():
        raise RecordingError(f"there is no file {path}; give the name of an .npz that tpsim wrote")
    try:
        with path.open("rb") as file:
            return _members(file, path.stat().st_size)
    # The parsers of zip and npy raise about anything when bytes are tampered with.
    except Exception as error:
        raise RecordingError(
            f"{path} is truncated or no recording ({one_line(error, 300)}); delete it and "
            "record again"
        ) from None


def read_foreign_members(path: Path) -> dict[str, np.ndarray]:
    """Read an archive of arrays that somebody else wrote, or one array; it may be compressed.

    Raises
    ------
    ValueError, and whatever else the parsers of zip and npy raise
        It is damaged, holds pickles, or more than so many bytes when it is unpacked.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        if file.read(6) == _ONE_ARRAY:
            file.seek(0)
            return {"array": _array(file, path.name, size)}
        return _members(file, size, compressed=True)


def _members(file: IO[bytes], size: int, compressed: bool = False) -> dict[str, np.ndarray]:
    if size > BYTES:
        raise ValueError(f"it has {size} bytes, at most {BYTES}")
    _check_directory(file)
    with zipfile.ZipFile(file) as archive:
        infos = archive.infolist()
        _check_sizes(infos, size, compressed)
        return {i.filename.removesuffix(".npy"): _read(archive, i) for i in infos}


def _check_directory(file: IO[bytes]) -> None:
    """The table of contents is unpacked before anything else can be looked at."""
    file.seek(-min(_END, file.seek(0, os.SEEK_END)), os.SEEK_END)
    tail = file.read()
    place = tail.rfind(b"PK\x05\x06")
    length = int.from_bytes(tail[place + 12 : place + 16], "little") if place >= 0 else 0
    if length > _DIRECTORY:
        raise ValueError(f"its table of contents has {length} bytes, at most {_DIRECTORY}")


def _check_sizes(infos: list[zipfile.ZipInfo], size: int, compressed: bool) -> None:
    names = {info.filename for info in infos}
    if len(infos) > MEMBERS or len(names) < len(infos):
        raise ValueError(f"{len(infos)} arrays, {len(names)} names; at most {MEMBERS} arrays")
    if compressed:
        size = BYTES
    elif any(
        i.compress_type != zipfile.ZIP_STORED or i.file_size != i.compress_size for i in infos
    ):
        raise ValueError("it is compressed, tpsim writes plain archives")
    total = sum(info.file_size for info in infos)
    if total > min(size, BYTES):
        raise ValueError(f"it claims {total} bytes; the file has {size}, at most {BYTES}")


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> np.ndarray:
    with archive.open(info) as file:
        array = _array(file, info.filename, info.file_size)
        # The checksum is compared at the end of the file only.
        file.read(1)
    return array


def _array(file: IO[bytes], name: str, size: int) -> np.ndarray:
    shape, dtype = _header(file)
    claimed = file.tell() + math.prod(shape) * dtype.itemsize
    if dtype.kind not in _NUMBERS_AND_TEXT or min(shape, default=0) < 0:
        raise ValueError(f"{name} is {dtype} {shape}; arrays hold numbers or text")
    if claimed != size or size > BYTES:
        raise ValueError(f"{name} claims {claimed} bytes, it has {size}")
    if dtype.kind == "U" and size > TEXT:
        raise ValueError(f"{name} is a text of {size} bytes, at most {TEXT}")
    file.seek(0)
    array: np.ndarray = np.lib.format.read_array(file, allow_pickle=False)
    return array


def _header(file: IO[bytes]) -> tuple[tuple[int, ...], np.dtype]:
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        shape, _, dtype = np.lib.format.read_array_header_1_0(file)
    elif version == (2, 0):
        shape, _, dtype = np.lib.format.read_array_header_2_0(file)
    else:
        raise ValueError(f"version {version} of its format")
    return shape, dtype
