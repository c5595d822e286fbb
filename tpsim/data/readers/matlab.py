"""MATLAB files: the layouts of pbdlib, and matrices by name.

pbdlib keeps a demonstration as ``s(n).Data`` (D x T) or ``s(n).Data0`` with the frames
``s(n).p(m).A``, ``s(n).p(m).b``, or all together in a tensor ``Data`` (D x P x N) of what every
frame saw; its letters are cells ``demos{n}.pos`` (2 x T). None says what time it was: its scripts
take 10 ms a sample.
"""

import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np

from tpsim.data.columns import Columns
from tpsim.data.foreign import check_size, opened
from tpsim.data.readers.arrays import numeric
from tpsim.data.recording import Recording, Series, by_length
from tpsim.errors import RecordingError
from tpsim.npz import BYTES

RATE = 100.0
"""Samples per second of pbdlib's data [Hz]."""

_DATA = ("Data", "Data0", "pos", "x")
_TIMES = ("time", "t", "Time")
_COMPRESSED = 15
_PART = 2**20


def recordings(path: Path) -> list[Recording]:
    """Read one of pbdlib's layouts, or matrices with one row or column a sample."""
    from scipy.io import loadmat

    with opened(path, "MATLAB file"):
        check_size(path, _unpacked(path) // 8)
        try:
            found = loadmat(path, struct_as_record=False, squeeze_me=False)
        except NotImplementedError:
            raise RecordingError(
                f"{path} is a MATLAB file of version 7.3; write it with save('-v7', ...)"
            ) from None
        variables = {name: value for name, value in found.items() if not name.startswith("__")}
    with opened(path, "layout of pbdlib"):
        if "demos" in variables:
            return _letters(path, variables["demos"])
        if "s" in variables and _fields(variables["s"].flat[0]):
            return _situations(path, variables["s"].ravel(), variables.get("Data"))
        return [_matrices(path, variables)]


def _unpacked(path: Path) -> int:
    """Bytes of a file when its compressed variables are unpacked, which they are not here."""
    with path.open("rb") as file:
        head = file.read(128)
        order: Literal["little", "big"] = "big" if head[126:128] == b"MI" else "little"
        total = path.stat().st_size
        if head[126:128] not in (b"MI", b"IM"):
            return total
        while len(tag := file.read(8)) == 8:
            kind, size = (int.from_bytes(tag[i : i + 4], order) for i in (0, 4))
            end = file.tell() + size
            if kind == _COMPRESSED:
                for length in _lengths(file, size):
                    total += length
                    if total > BYTES:
                        return total
            file.seek(end)
    return total


def _lengths(file: BinaryIO, size: int) -> Iterator[int]:
    """Lengths of what a compressed variable unpacks to, a part at a time."""
    unpacker, rest = zlib.decompressobj(), b""
    while not unpacker.eof:
        packed = rest or file.read(min(size, _PART))
        if not packed:
            return
        size -= 0 if rest else len(packed)
        yield len(unpacker.decompress(packed, _PART))
        rest = unpacker.unconsumed_tail


def _letters(path: Path, demos: np.ndarray) -> list[Recording]:
    recordings = []
    for n, cell in enumerate(demos.ravel()):
        fields = _fields(cell.flat[0])
        matrices = {name: value.T for name, value in fields.items() if _is_matrix(value)}
        name = next((known for known in _DATA if known in matrices), None)
        if name is None:
            raise RecordingError(
                f"{path}: demos{{{n + 1}}} has no field {' or '.join(_DATA)}; it has "
                f"{', '.join(fields)}"
            )
        recordings.append(_recording(path, n, by_length(matrices), Columns(other=name, rate=RATE)))
    return recordings


def _situations(path: Path, situations: np.ndarray, tensor: Any) -> list[Recording]:
    recordings, first = [], 0
    for n, situation in enumerate(situations):
        fields = _fields(situation)
        frames = _frames(fields.get("p"))
        name = next((known for known in _DATA if _is_matrix(fields.get(known))), None)
        if name is not None:
            data = fields[name].T
        elif frames and _is_tensor(tensor):
            length = _length(fields, tensor, len(situations))
            A, b = frames[0]
            data = tensor[:, 0, first : first + length].T @ A.mT + b
            first += length
        else:
            raise RecordingError(
                f"{path}: s({n + 1}) has no field {' or '.join(_DATA)}; it has {', '.join(fields)}"
            )
        recordings.append(_situation(path, n, data, frames))
    return recordings


def _situation(path: Path, n: int, data: np.ndarray, frames: list) -> Recording:
    rising = data.shape[1] > 1 and bool((np.diff(data[:, 0]) > 0).all())
    timed = rising and _first_is_input(data, frames)
    columns, defaults = {"data": data}, Columns(other="data", rate=RATE)
    if timed:
        columns = {"data": data[:, 1:], "time": data[:, 0]}
        defaults = Columns(other="data", time="time")
        frames = [
            (A[..., -len(data.T) + 1 :, -len(data.T) + 1 :], b[..., 1 - len(data.T) :])
            for A, b in frames
        ]
    for j, (A, b) in enumerate(frames):
        columns[f"A_{j}"] = np.broadcast_to(A, (len(data), *A.shape[-2:])).reshape(len(data), -1)
        columns[f"b_{j}"] = np.broadcast_to(b, (len(data), b.shape[-1]))
    return _recording(path, n, (Series(columns),), defaults)


def _first_is_input(data: np.ndarray, frames: list) -> bool:
    """Whether the first row of the data is time: no frame has it, or all leave it alone."""
    D = data.shape[1]
    if not frames:
        return False
    return all(
        A.shape[-1] == D - 1
        or (
            A.shape[-2:] == (D, D)
            and bool((A[..., 0, :] == np.eye(D)[0]).all() and (b[..., 0] == 0).all())
        )
        for A, b in frames
    )


def _frames(p: Any) -> list[tuple[np.ndarray, np.ndarray]]:
    """Frames ``p(m)``, or ``p(m, t)`` where they move."""
    if p is None or not getattr(p, "size", 0):
        return []
    rows = p.reshape(-1, 1) if 1 in p.shape else p
    frames = []
    for row in rows:
        A = np.stack([np.atleast_2d(_fields(q)["A"]) for q in row])
        b = np.stack([np.ravel(_fields(q)["b"]) for q in row])
        frames.append((A[0], b[0]) if len(row) == 1 else (A, b))
    return frames


def _length(fields: dict, tensor: np.ndarray, count: int) -> int:
    given = fields.get("nbData")
    return int(np.ravel(given)[0]) if given is not None else tensor.shape[2] // count


def _matrices(path: Path, variables: dict) -> Recording:
    time = next((name for name in _TIMES if _is_matrix(variables.get(name))), None)
    matrices = {name: value for name, value in variables.items() if _is_matrix(value)}
    if not matrices:
        raise RecordingError(
            f"{path}: holds no matrices; it has {', '.join(variables) or 'nothing'}"
        )
    samples = variables[time].size if time else max(max(m.shape) for m in matrices.values())
    columns = {}
    for name, value in matrices.items():
        values = value if value.shape[0] == samples else value.T
        columns["time" if name == time else name] = (
            np.ravel(values) if 1 in values.shape else values
        )
    return Recording(str(path), by_length(numeric(columns, path)), path.stem, "mat")


def _recording(path: Path, n: int, series: tuple[Series, ...], defaults: Columns) -> Recording:
    return Recording(str(path), series, f"{path.stem}-{n}", "mat", defaults)


def _fields(struct: Any) -> dict[str, Any]:
    names = getattr(struct, "_fieldnames", None) or ()
    return {name: getattr(struct, name) for name in names}


def _is_matrix(value: Any) -> bool:
    return (
        isinstance(value, np.ndarray)
        and value.ndim == 2
        and value.dtype.kind in "fiu"
        and value.size > 1
    )


def _is_tensor(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.ndim == 3
