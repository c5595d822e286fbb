"""What a stranger can do: damage a run folder and make all its checksums right again."""

import hashlib
import json
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

from . import tamper


def rehash(folder: Path) -> None:
    """Write the checksums of a run folder anew, as far as run.json still has places for them."""
    file = folder / "run.json"
    try:
        said = json.loads(file.read_text())
        said["scene"] = _sum(folder / "scene.xml")
        said["assets"] = {name: _sum(folder / "assets" / name) for name in said["assets"]}
        whole = said["whole"]
        whole["files"] = {name: _sum(folder / name) for name in whole["files"]}
        whole["record"] = ""
        text = json.dumps(said, indent=2) + "\n"
        whole["record"] = hashlib.sha256(text.encode()).hexdigest()
        text = json.dumps(said, indent=2) + "\n"
    except (ValueError, TypeError, KeyError, AttributeError, OSError, RecursionError):
        return
    file.write_text(text)


def cases(folder: Path) -> tamper.Cases:
    """Every kind of damage to run.json, scene, trials and models, with checksums that agree."""
    for what, text in tamper.in_json((folder / "run.json").read_text()):
        yield f"run.json: {what}", partial(_text, name="run.json", text=text)
    for what, text in tamper.in_scene((folder / "scene.xml").read_text()):
        yield f"scene.xml: {what}", partial(_text, name="scene.xml", text=text)
    trial, model = folder / "trial-000000.npz", next(folder.glob("model-*.npz"))
    for file in (trial, model):
        for what, change in (*tamper.in_archive(file), *tamper.bombs(file)):
            yield f"{file.name}: {what}", partial(_archive, name=file.name, change=change)
    for number, member in ((0, "about"), (1, "about"), (2, "about"), (0, "channels")):
        name = f"trial-{number:06d}.npz"
        with np.load(folder / name) as archive:
            text = str(archive[member])
        for what, wrong in tamper.in_json(text, 120, 2):
            yield f"{name}: {member} {what}", partial(_member, name=name, member=member, text=wrong)
    for what, content in meshes((folder / "assets" / "mark.obj").read_bytes()):
        yield f"mark.obj: {what}", partial(_bytes, name="assets/mark.obj", content=content)


def meshes(content: bytes) -> Iterator[tuple[str, bytes]]:
    """Meshes that claim more than they hold, or hold nonsense."""
    yield "empty", b""
    yield "nan", content.replace(b".02", b"nan")
    yield "huge", content.replace(b".02", b"1e300")
    yield "index", content.replace(b"1 3 2", b"1 3 2000000000")
    yield "negative index", content.replace(b"1 3 2", b"-9 -3 -2")
    yield "noise", np.random.default_rng(1).bytes(3000)
    yield "many faces", content + b"f 1 2 3\n" * 200_000
    yield "a texture", content + b"mtllib /etc/passwd\n"


def _text(folder: Path, name: str, text: str) -> None:
    tamper.write(folder / name, text)
    rehash(folder)


def _bytes(folder: Path, name: str, content: bytes) -> None:
    (folder / name).write_bytes(content)
    rehash(folder)


def _archive(folder: Path, name: str, change: Callable[[Path], None]) -> None:
    change(folder / name)
    rehash(folder)


def _member(folder: Path, name: str, member: str, text: str) -> None:
    path = folder / name
    with np.load(path) as archive:
        members = {each: archive[each] for each in archive.files}
    members[member] = np.array(text.encode(errors="replace").decode())
    path.unlink()
    with path.open("wb") as file:
        np.savez(file, **members)
    rehash(folder)


def _sum(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def of_policy(folder: Path, change: Callable[[Path], None]) -> None:
    """Change the arrays of a policy, and the checksum that it keeps."""
    change(folder / "arrays.npz")
    about = json.loads((folder / "policy.json").read_text())
    about["arrays"] = _sum(folder / "arrays.npz")
    (folder / "policy.json").write_text(json.dumps(about, indent=1))
