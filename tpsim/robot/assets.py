"""The files that a model refers to, taken into memory."""

import tempfile
import xml.etree.ElementTree as ElementTree
import zipfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import cast

import mujoco

_MODEL = "model.xml"
_CUBE = ("fileright", "fileleft", "fileup", "filedown", "filefront", "fileback")


def embed(spec: mujoco.MjSpec, model: mujoco.MjModel) -> dict[str, bytes]:
    """Take every file of a spec into memory, and refer to it by a plain name.

    Afterwards the spec and its text compile in any folder: the spec by itself, its text with the
    returned files. MuJoCo's own archive format finds the files, also those of attached specs.

    Parameters
    ----------
    spec : MjSpec
        Changed in place: ``file`` of its meshes, textures, height fields and skins, and folders.
    model : MjModel
        What the spec compiles to.

    Returns
    -------
    dict of str to bytes
        Content of every file by the name that the spec uses for it; empty without files.
    """
    if not any(_files(element) for element in _elements(spec)):
        return {}
    text, archive = _archive(spec, model)
    names = _plain_names(archive)
    compiler = text.find("compiler")
    folders: dict[str, str] = {} if compiler is None else dict(compiler.attrib)
    written = _written(text)
    for element in _elements(spec):
        tag, node = next(written)
        folder = folders.get("texturedir" if tag == "texture" else "meshdir", "")
        if file := node.get("file"):
            element.file = names[_key(folder, file, archive)]
        for i, side in enumerate(_CUBE):
            if file := node.get(side):
                element.cubefiles[i] = names[_key(folder, file, archive)]
    spec.meshdir = spec.texturedir = spec.modelfiledir = ""
    files = {name: archive[key] for key, name in names.items()}
    spec.assets = files
    return files


def _elements(spec: mujoco.MjSpec) -> list:
    """Return the elements of a spec that may refer to files, in the order of the MJCF text."""
    return [*spec.textures, *spec.meshes, *spec.hfields, *spec.skins]


def _files(element: object) -> list[str]:
    sides = getattr(element, "cubefiles", ())
    return [file for file in (getattr(element, "file", ""), *sides) if file]


def _archive(
    spec: mujoco.MjSpec, model: mujoco.MjModel
) -> tuple[ElementTree.Element, dict[str, bytes]]:
    """Return the text that MuJoCo writes for a spec beside its files, and the files by path."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.mjz"
        spec.encode(str(path), model)
        with zipfile.ZipFile(path) as archive:
            files = {name: archive.read(name) for name in archive.namelist()}
    return ElementTree.fromstring(files.pop(_MODEL)), files


def _written(text: ElementTree.Element) -> Iterator[tuple[str, ElementTree.Element]]:
    for tag in ("texture", "mesh", "hfield", "skin"):
        for node in text.iterfind(f"asset/{tag}"):
            yield tag, node


def _key(folder: str, file: str, archive: dict[str, bytes]) -> str:
    """Return the path in the archive of a file that the text names."""
    candidates = (str(PurePosixPath(folder, file)), file, file.lstrip("/"))
    return cast(str, next(key for key in candidates if key in archive))


def _plain_names(archive: dict[str, bytes]) -> dict[str, str]:
    """Return a unique name without folders for every path."""
    names: dict[str, str] = {}
    for path in sorted(archive):
        name = PurePosixPath(path).name
        taken = set(names.values())
        names[path] = name if name not in taken else path.strip("/").replace("/", "_")
    return names
