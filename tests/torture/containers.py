"""Files of other people's formats that ask for far more than they are, or for other files."""

import json
import struct
import zlib
from functools import partial
from pathlib import Path

import numpy as np

from . import tamper

HUGE = 2**33
"""Numbers that a file claims to hold: 64 GiB."""


def cases(path: Path) -> tamper.Cases:
    """Bombs of the format that a file's name says."""
    makers = {".npz": _npz, ".hdf5": _hdf5, ".mat": _mat, ".mcap": _mcap, ".csv": _text}
    makers |= {".tum": _text, "": _folder}
    return makers.get(path.suffix, lambda path: iter(()))(path)


def _npz(path: Path) -> tamper.Cases:
    for what, change in (*tamper.in_archive(path), *tamper.bombs(path)):
        yield what, lambda f, change=change: change(f / path.name)
    # The ending may say npz, and the content be one array.
    for shape in ("(1099511627776,)", "(-3,)", "(3,"):
        content = tamper._claiming(shape)
        yield f"an array that claims {shape}", partial(_write, name=path.name, content=content)


def _text(path: Path) -> tamper.Cases:
    lines = path.read_text().splitlines()
    for word in ("nan", "1e400", "9" * 5000, '"', "\0", "-", "x" * 70_000):
        wrong = [*lines[:5], lines[5].replace(lines[5].split(",")[0], word), *lines[6:]]
        text = "\n".join(wrong).encode()
        yield f"a cell is {word[:9]!r}", partial(_write, name=path.name, content=text)
    wide = ",".join(["1"] * 200_000).encode() + b"\n"
    yield "very wide", partial(_write, name=path.name, content=wide * 3)
    yield "one line", partial(_write, name=path.name, content=b"1," * 2_000_000)


def _hdf5(path: Path) -> tamper.Cases:
    import h5py

    def in_file(folder, fill):
        with h5py.File(folder / path.name, "a") as file:
            fill(file)

    def huge(file):
        file["data/demo_2"].create_dataset("big", (HUGE,), "f8", chunks=(2**16,), fillvalue=1.0)

    def packed(file):
        made = file["data/demo_2"].create_dataset(
            "packed", (2**28,), "f8", chunks=(2**20,), compression="gzip"
        )
        made[: 2**22] = 0

    def outside(file):
        (Path(file.filename).parent / "outside.h5").unlink(missing_ok=True)
        file["data"]["demo_9"] = h5py.ExternalLink("/etc/outside.h5", "/")

    def in_another(file):
        with h5py.File(Path(file.filename).parents[1] / "outside.h5", "w") as other:
            other["x"] = np.arange(60.0)
        del file["data"]
        file["data"] = h5py.ExternalLink("../outside.h5", "/")

    def raw(file):
        file["data/demo_2"].create_dataset("secret", (10,), "u1", external=[("/etc/passwd", 0, 10)])

    def virtual(file):
        layout = h5py.VirtualLayout((60,), "f8")
        layout[:] = h5py.VirtualSource("/etc/outside.h5", "x", (60,))
        file["data/demo_2"].create_virtual_dataset("secret", layout)

    def loop(file):
        file["data/demo_2/again"] = file["data"]

    for fill in (huge, packed, outside, in_another, raw, virtual, loop):
        yield fill.__name__, partial(in_file, fill=fill)


def _mat(path: Path) -> tamper.Cases:
    content = path.read_bytes()

    def bomb(folder):
        packer = zlib.compressobj(1)
        body = b"".join(packer.compress(bytes(2**24)) for _ in range(96)) + packer.flush()
        (folder / path.name).write_bytes(content[:128] + struct.pack("<II", 15, len(body)) + body)

    yield "a bomb", bomb
    # A matrix of double precision that claims 2^28 x 2^28 numbers.
    dims = struct.pack("<IIii", 5, 8, 2**28, 2**28)
    name = struct.pack("<II", 1, 1) + b"a" + bytes(7)
    inner = struct.pack("<IIII", 6, 8, 6, 0) + dims + name + struct.pack("<II", 9, 2**31)
    claim = content[:128] + struct.pack("<II", 14, len(inner)) + inner
    yield "a matrix that claims 2^56", partial(_write, name=path.name, content=claim)


def _mcap(path: Path) -> tamper.Cases:
    """A chunk of a few bytes that claims, or is, far more, and nothing else."""
    import zstandard
    from mcap.writer import Writer

    def bomb(folder, size, claimed):
        packer = zstandard.ZstdCompressor(level=1).compressobj()
        parts = [packer.compress(bytes(2**24)) for _ in range(size // 2**24)]
        data = b"".join([*parts, packer.flush()])
        with (folder / path.name).open("wb") as file:
            out = Writer(file)
            out.start()
            out.finish()
        head = struct.pack("<QQQI", 0, 1, claimed, 0) + struct.pack("<I", 4) + b"zstd"
        body = head + struct.pack("<Q", len(data)) + data
        content = (folder / path.name).read_bytes()
        record = bytes([6]) + struct.pack("<Q", len(body)) + body
        end = content.index(bytes([15]))
        (folder / path.name).write_bytes(content[:end] + record + content[end:])

    for size, claimed in ((2**31, 2**31), (2**31, 2**20), (2**24, 2**50)):
        what = f"a chunk of {size} bytes that claims {claimed}"
        yield what, partial(bomb, size=size, claimed=claimed)


def _folder(path: Path) -> tamper.Cases:
    """A LeRobot data set, or a ROS 2 bag."""
    about = path / "meta" / "info.json"
    if about.exists():
        for what, text in tamper.in_json(about.read_text(), 60, 2):
            where = f"{path.name}/meta/info.json"
            yield f"info.json: {what}", partial(_write_text, name=where, text=text)
        yield "a bomb", partial(_parquet_bomb, name=path.name, about=json.loads(about.read_text()))
    else:
        text = (path / "metadata.yaml").read_text()
        for old in ("/joint_states", ".db3", "sqlite3", "message_count: "):
            for new in ("/etc/passwd", "../../outside", "9" * 40, "&a [*a, *a]", ""):
                wrong = text.replace(old, new)
                where = f"{path.name}/metadata.yaml"
                yield f"{old} is {new}", partial(_write_text, name=where, text=wrong)


def _parquet_bomb(folder: Path, name: str, about: dict) -> None:
    import pyarrow
    import pyarrow.parquet as parquet

    (file,) = (folder / name / "data").rglob("*.parquet")
    schema = parquet.read_schema(file)
    rows = 2**22
    with parquet.ParquetWriter(file, schema, compression="zstd") as writer:
        table = pyarrow.table(
            {
                f.name: pyarrow.array([[0.0] * 3], f.type).take(pyarrow.array(np.zeros(rows, int)))
                if pyarrow.types.is_nested(f.type)
                else pyarrow.array(np.zeros(rows), f.type)
                for f in schema
            },
            schema=schema,
        )
        for _ in range(12):
            writer.write_table(table)
    about["total_frames"] = 12 * rows
    (folder / name / "meta" / "info.json").write_text(json.dumps(about))


def _write(folder: Path, name: str, content: bytes) -> None:
    (folder / name).write_bytes(content)


def _write_text(folder: Path, name: str, text: str) -> None:
    tamper.write(folder / name, text)
