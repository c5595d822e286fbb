"""Ways to damage files: bytes, JSON, archives of arrays, XML, and what stands under a name.

Every generator yields ``(what, change)``; ``change(folder)`` damages a copy of a folder.
"""

import io
import itertools
import json
import os
import shutil
import struct
import zipfile
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

Change = Callable[[Path], object]
Cases = Iterator[tuple[str, Change]]

PAGE = 4096
DEEP = "[" * 100_000 + "]" * 100_000
ABSURD = [float("nan"), float("inf"), -1, 10**30, 1e300, -1e-300, 0, "", "x" * 70_000, "\u2028é"]
ABSURD += ["/etc/passwd", "../run.json", [], {}, [[[[]]]], {"a": {"b": []}}, None, True, "@deep"]


def files_of(folder: Path) -> list[Path]:
    return sorted(p.relative_to(folder) for p in folder.rglob("*") if p.is_file())


def spread(items: list, most: int) -> list:
    """At most so many of a list, from its first to its last."""
    if len(items) <= most:
        return items
    return [items[round(i)] for i in np.linspace(0, len(items) - 1, most)]


# What stands under a name


def places(folder: Path, most: int = 16) -> Cases:
    """Every file cut at its pages, flipped, emptied, gone, or replaced by what is no file."""
    for file in files_of(folder):
        size = (folder / file).stat().st_size
        cuts = spread(sorted({*range(0, size, PAGE), size // 2, size - 1} - {size}), most)
        for cut in cuts:
            yield f"{file} cut at {cut}", partial(_cut, file=file, cut=cut)
        rng = np.random.default_rng(size)
        for k in range(4):
            at = rng.integers(0, max(size, 1), 4)
            yield f"{file} with four bytes wrong, {k}", partial(_flip, file=file, at=at)
        for kind in (Path.unlink, _to_folder, _to_fifo, _to_link, _to_zeros, _to_noise, _to_words):
            yield f"{file}: {kind.__name__.strip('_')}", partial(_instead, file=file, make=kind)
    for inner in sorted({f.parent for f in files_of(folder)} - {Path()}):
        yield f"{inner}/ as a link", partial(_link_folder, inner=inner)
        yield f"{inner}/ gone", lambda f, inner=inner: shutil.rmtree(f / inner)


def swaps(folder: Path, other: Path) -> Cases:
    """Files of the same name taken from another folder, and files of one folder exchanged."""
    names = files_of(folder)
    for file in names:
        if (other / file).is_file():
            yield f"{file} of another", lambda f, file=file: shutil.copy(other / file, f / file)
    for one, two in itertools.combinations(names, 2):
        if one.suffix == two.suffix:
            yield f"{one} and {two} exchanged", partial(_exchange, one=one, two=two)


def _cut(folder: Path, file: Path, cut: int) -> None:
    os.truncate(folder / file, cut)


def _flip(folder: Path, file: Path, at: np.ndarray) -> None:
    content = bytearray((folder / file).read_bytes())
    for i in at:
        content[i] ^= 0x55
    (folder / file).write_bytes(content)


def _instead(folder: Path, file: Path, make: Callable) -> None:
    path = folder / file
    if make is not Path.unlink and make is not _to_link:
        path.unlink()
    make(path)


def _to_folder(path: Path) -> None:
    path.mkdir()


def _to_fifo(path: Path) -> None:
    os.mkfifo(path)


def _to_link(path: Path) -> None:
    """The same content, out of the folder."""
    elsewhere = path.parents[1] / f"elsewhere-{path.name}"
    path.rename(elsewhere)
    path.symlink_to(elsewhere)


def _to_zeros(path: Path) -> None:
    path.symlink_to("/dev/zero")


def _to_noise(path: Path) -> None:
    path.write_bytes(np.random.default_rng(0).bytes(5000))


def _to_words(path: Path) -> None:
    path.write_text("these are words, not numbers\n" * 3)


def _link_folder(folder: Path, inner: Path) -> None:
    elsewhere = folder.parent / f"elsewhere-{inner.name}"
    (folder / inner).rename(elsewhere)
    (folder / inner).symlink_to(elsewhere)


def _exchange(folder: Path, one: Path, two: Path) -> None:
    first, second = (folder / one).read_bytes(), (folder / two).read_bytes()
    (folder / one).write_bytes(second)
    (folder / two).write_bytes(first)


# JSON


def leaves(value: object, path: tuple = ()) -> Iterator[tuple]:
    """Paths to everything in a JSON value, but itself."""
    if path:
        yield path
    inner: object = value.items() if isinstance(value, dict) else ()
    inner = enumerate(value) if isinstance(value, list) else inner
    for key, item in inner:  # type: ignore[attr-defined]
        yield from leaves(item, (*path, key))


def in_json(text: str, most: int = 400, each: int = 3) -> Iterator[tuple[str, str]]:
    """Texts with one entry removed, unknown, twice, or of another type or size."""
    value = json.loads(text)
    for number, path in enumerate(spread(list(leaves(value)), most)):
        yield f"{_named(path)} removed", _changed(value, path, None, remove=True)
        for k in range(each):
            wrong = ABSURD[(each * number + k) % len(ABSURD)]
            yield f"{_named(path)} is {wrong!r:.20}", _changed(value, path, wrong)
    yield "an unknown entry", json.dumps({**value, "surplus": 1})
    yield "an entry twice", text.rstrip().removesuffix("}") + ', "surplus": 1, "surplus": 1}'
    yield "a list", json.dumps([value])
    yield "deep", DEEP
    yield "nothing", ""
    yield "not UTF-8", text + "\udcff"
    yield "digits", "9" * 50_000


def _named(path: tuple) -> str:
    return ".".join(map(str, path))


def _changed(value: object, path: tuple, wrong: object, remove: bool = False) -> str:
    copy = json.loads(json.dumps(value))
    inner = copy
    for key in path[:-1]:
        inner = inner[key]
    if remove:
        del inner[path[-1]]
    else:
        inner[path[-1]] = wrong
    return json.dumps(copy).replace('"@deep"', DEEP)


def write(path: Path, text: str) -> None:
    path.write_bytes(text.encode(errors="surrogateescape"))


# Archives of arrays


def in_archive(file: Path) -> Iterator[tuple[str, Callable[[Path], None]]]:
    """Archives that are well made, and of which one array is missing, of another type or absurd."""
    with np.load(file) as archive:
        members = {name: archive[name] for name in archive.files}
    for name, array in members.items():
        rest = {n: a for n, a in members.items() if n != name}
        yield f"{name} removed", partial(_save, arrays=rest)
        for what, wrong in absurd(array):
            yield f"{name} {what}", partial(_save, arrays={**members, name: wrong})
    yield "an array more", partial(_save, arrays={**members, "surplus": np.zeros(3)})
    yield "nothing in it", partial(_save, arrays={})


def absurd(array: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """What may stand in an array's place."""
    if array.dtype.kind in "fiu":
        for value in (np.nan, np.inf, 1e300, -1.0, 0.0):
            yield f"full of {value}", np.full_like(array, value, float)
        yield "of whole numbers", np.nan_to_num(array, posinf=0, neginf=0).astype(np.int64)
        yield (
            "with one NaN",
            np.where(np.arange(array.size).reshape(array.shape) == 0, np.nan, array),
        )
    else:
        yield "another text", np.array("x" * 1000)
        yield "long", np.array("9" * 300_000)
        yield "a number", np.array(3)
        yield "deep", np.array(DEEP)
    yield "of text", np.full(array.shape, "x")
    yield "complex", np.zeros(array.shape, complex)
    yield "objects", np.full(array.shape, None)
    yield "of rank one more", array[None]
    yield "two in a row", np.array([array, array])
    yield "empty", np.zeros((0, *array.shape[1:]), array.dtype)
    if array.ndim:
        yield "shorter", array[:-1]
        yield "transposed", array.T
        yield "backwards", array[::-1]
        yield "a number", array.ravel()[0] if array.size else np.array(0.0)


def _save(path: Path, arrays: dict[str, np.ndarray]) -> None:
    path.unlink()
    with path.open("wb") as file:
        np.savez(file, **arrays)


def bombs(file: Path) -> Iterator[tuple[str, Callable[[Path], None]]]:
    """Archives that ask for far more than they are."""
    with np.load(file) as archive:
        members = {name: archive[name] for name in archive.files}
    name = next(iter(members))
    yield "compressed", lambda path: _write(path, lambda f: np.savez_compressed(f, **members))
    yield "a bomb", lambda path: path.write_bytes(bomb(name))
    yield "a bomb in a bomb", lambda path: path.write_bytes(_zip({f"{name}.npy": bomb(name)}))
    for shape in ((2**44,), (2**30, 2**14), (2**63,), (-1,), (2**62, 4), (2**31, 0)):
        content = _claiming(repr(shape))
        yield f"a header that claims {shape}", partial(_raw, content={f"{name}.npy": content})
    for words in ("(" * 9000, "(" * 90 + ")" * 90, "[" * 50_000, "__import__('os')", "(1,)" * 3000):
        content = _claiming(words)
        yield f"a header of {words[:9]}", partial(_raw, content={f"{name}.npy": content})
    for kind in ("O", "V16", "S8", "M8[s]", "f16", "<U1000000000", ">f8"):
        content = _claiming("(3,)", kind) + bytes(48)
        yield f"an array of {kind}", partial(_raw, content={f"{name}.npy": content})
    yield "100000 arrays", lambda path: path.write_bytes(_many())
    yield "one name twice", lambda path: path.write_bytes(_twice(name, members[name]))
    yield "a directory that claims 4 GB", lambda path: path.write_bytes(_claimed_directory(path))
    yield "names with folders", partial(_raw, content={"../../x.npy": _claiming("(0,)")})
    yield "a name of 60000 parts", partial(_raw, content={"0." * 30_000 + "npy": _claiming("(0,)")})


@cache
def bomb(name: str, size: int = 2**31) -> bytes:
    """An archive of a few MB whose one array is 2 GB of zeros."""
    file = io.BytesIO()
    zeros = bytes(2**24)
    archive = zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=1)
    with archive, archive.open(f"{name}.npy", "w", force_zip64=True) as member:
        member.write(_claiming(repr((size // 8,))))
        for _ in range(size // len(zeros)):
            member.write(zeros)
    return file.getvalue()


def _write(path: Path, fill: Callable) -> None:
    path.unlink()
    with path.open("wb") as file:
        fill(file)


def _zip(content: dict[str, bytes]) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, data in content.items():
            archive.writestr(name, data)
    return file.getvalue()


def _raw(path: Path, content: dict[str, bytes]) -> None:
    path.write_bytes(_zip(content))


def _claiming(shape: str, kind: str = "<f8") -> bytes:
    """The head of an array file, whatever it claims."""
    words = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x02\x00" + struct.pack("<I", len(words)) + words


@cache
def _many() -> bytes:
    return _zip({f"{i}.npy": b"" for i in range(60_000)})


def _twice(name: str, array: np.ndarray) -> bytes:
    one, file = io.BytesIO(), io.BytesIO()
    np.save(one, array)
    with zipfile.ZipFile(file, "w") as archive:
        for _ in range(2):
            archive.NameToInfo.clear()  # or it would warn
            archive.writestr(f"{name}.npy", one.getvalue())
    return file.getvalue()


def _claimed_directory(path: Path) -> bytes:
    content = bytearray(path.read_bytes())
    end = content.rfind(b"PK\x05\x06")
    if end >= 0:
        content[end + 12 : end + 16] = struct.pack("<I", 0xFFFFFFF0)
    return bytes(content)


# XML

ATTACKS = [
    "<asset><mesh name='m' file='/etc/passwd'/></asset>",
    "<asset><mesh name='m' file='../../run.json'/></asset>",
    "<asset><hfield name='h' file='/etc/passwd'/></asset>",
    "<asset><texture name='t' type='2d' file='/etc/passwd'/></asset>",
    "<asset><hfield name='h' nrow='4096' ncol='4096' size='1 1 1 1'/></asset>",
    "<asset><texture name='t' type='2d' builtin='flat' width='100000' height='100000'/></asset>",
    "<include file='/etc/passwd'/>",
    "<include file='scene.xml'/>",
    "<asset><model name='a' file='/etc/passwd'/></asset>",
    "<extension><plugin plugin='mujoco.elasticity.cable'/></extension>",
    "<option timestep='1e-7'/>",
    "<option timestep='nan'/>",
    "<option timestep='-0.002'/>",
    "<option iterations='2000000000'/>",
    "<size memory='1000G'/>",
    "<size nuserdata='2000000000'/>",
    "<size njmax='2000000000'/>",
    "<custom><numeric name='n' size='2000000000'/></custom>",
    "<custom><text name='n' data='" + "x" * 10**6 + "'/></custom>",
    "<worldbody><replicate count='2000000000'><geom size='1'/></replicate></worldbody>",
    "<worldbody><geom name='g' size='nan'/></worldbody>",
    "<worldbody><geom name='g' size='1e300' mass='1e300'/></worldbody>",
    "<worldbody><body><freejoint/><geom size='1e-300' mass='1e-300'/></body></worldbody>",
    "<worldbody>" + "<geom size='.01'/>" * 3000 + "</worldbody>",
    "<worldbody>" + "<body><freejoint/><geom size='.01'/></body>" * 1500 + "</worldbody>",
    "<worldbody>" + "<body><joint/><geom size='.01'/>" * 600 + "</body>" * 600 + "</worldbody>",
    "<!-- " + "-" * 10 + " -->",
]


def in_scene(xml: str, most: int = 60) -> Iterator[tuple[str, str]]:
    """Scenes that ask for what they must not, and scenes with one absurd attribute."""
    for attack in ATTACKS:
        yield f"scene with {attack:.60}", xml.replace("</mujoco>", f"{attack}</mujoco>")
    yield "a DOCTYPE", f"<!DOCTYPE m [<!ENTITY a 'aaaa'>]>{xml}"
    yield (
        "nested elements",
        xml.replace("</mujoco>", "<a>" * 50_000 + "</a>" * 50_000 + "</mujoco>"),
    )
    count = sum(len(element.attrib) for element in ElementTree.fromstring(xml).iter())
    words = ["nan", "1e308", "-1", "x", "", "0", "inf", "1 2 3 4 5 6 7 8 9", "1e-300"]
    for number in spread(list(range(count)), most):
        root, seen = ElementTree.fromstring(xml), 0
        for element in root.iter():
            for key in element.attrib:
                if seen == number:
                    word = words[number % len(words)]
                    element.set(key, word)
                    what = f"<{element.tag} {key}='{word}'>"
                seen += 1
        yield what, ElementTree.tostring(root, encoding="unicode")
