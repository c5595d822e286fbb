"""Archives of arrays (.npz): written whole or not at all, read without pickles and with bounds."""

import math
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

_NUMBERS_AND_TEXT = "biufcU"


def write_members(path: str | Path, arrays: Mapping[str, np.ndarray]) -> Path:
    """Write named arrays to ``path``, under a temporary name until the file is complete.

    Its folder is made where it is missing. No pickles, no compression.
    """
    path = Path(path)
    with whole_file(path) as file:
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
        with zipfile.ZipFile(path) as archive:
            infos = archive.infolist()
            _check_sizes(infos, path.stat().st_size)
            return {i.filename.removesuffix(".npy"): _read(archive, i) for i in infos}
    # The parsers of zip and npy raise about anything when bytes are tampered with.
    except Exception as error:
        reason = one_line(error)
        raise RecordingError(
            f"{path} is truncated or no recording ({reason:.200}); delete it and record again"
        ) from None


def _check_sizes(infos: list[zipfile.ZipInfo], size: int) -> None:
    names = {info.filename for info in infos}
    if len(infos) > MEMBERS or len(names) < len(infos):
        raise ValueError(f"{len(infos)} arrays, {len(names)} names; at most {MEMBERS} arrays")
    if any(i.compress_type != zipfile.ZIP_STORED or i.file_size != i.compress_size for i in infos):
        raise ValueError("it is compressed, tpsim writes plain archives")
    total = sum(info.file_size for info in infos)
    if total > min(size, BYTES):
        raise ValueError(f"it claims {total} bytes; the file has {size}, at most {BYTES}")


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> np.ndarray:
    with archive.open(info) as file:
        shape, dtype = _header(file)
        claimed = file.tell() + math.prod(shape) * dtype.itemsize
        if dtype.kind not in _NUMBERS_AND_TEXT or min(shape, default=0) < 0:
            raise ValueError(f"{info.filename} is {dtype} {shape}; arrays hold numbers or text")
        if claimed != info.file_size:
            raise ValueError(f"{info.filename} claims {claimed} bytes, it has {info.file_size}")
        file.seek(0)
        array: np.ndarray = np.lib.format.read_array(file, allow_pickle=False)
        # The checksum is compared at the end of the file only.
        file.read(1)
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
