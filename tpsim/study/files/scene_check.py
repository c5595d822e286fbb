"""Scenes of strangers: what opens files, loads code or fills the memory is refused."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Mapping

from tpsim.errors import RecordingError
from tpsim.study.files import limits
from tpsim.study.files.inside import is_plain

_REFUSED = frozenset(
    # What opens files or loads code, and what multiplies: a written scene has none of these.
    ("include", "attach", "model", "plugin", "extension", "replicate", "composite", "flexcomp")
)
_FOLDERS = ("meshdir", "texturedir", "assetdir")

_MOST = {
    "width": 8192,
    "height": 8192,
    "offwidth": 8192,
    "offheight": 8192,
    "shadowsize": 16384,
    "nrow": 4096,
    "ncol": 4096,
    "iterations": 4096,
    "ls_iterations": 4096,
    "noslip_iterations": 4096,
    "ccd_iterations": 4096,
    "sdf_iterations": 4096,
    "sdf_initpoints": 4096,
    "nsample": 4096,
    "actdim": 4096,
    "params": 512,
    "numeric.size": 4096,
    "user.dim": 4096,
    **dict.fromkeys(("size.nkey", "size.njmax", "size.nconmax", "size.nstack"), 10**6),
    **dict.fromkeys((f"size.nuser_{of}" for of in ("body", "jnt", "geom", "site", "cam")), 4096),
    **dict.fromkeys((f"size.nuser_{of}" for of in ("tendon", "actuator", "sensor")), 4096),
}
"""Most of what attributes ask for, by attribute or by element and attribute."""

_ELEMENTS = 100_000
_PNG = b"\x89PNG\r\n\x1a\n"
_PIXELS = 2**26
_UNITS = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30}


def check_scene(xml: str, assets: Mapping[str, bytes], where: object) -> None:
    """Refuse a scene that opens files, loads code or fills the memory.

    Parameters
    ----------
    xml : str
    assets : mapping of str to bytes
        The files that it may use, by name.
    where : object
        Name of the file, for messages.

    Raises
    ------
    RecordingError
        Names file and element.
    """
    for problem in _problems(xml, assets):
        raise RecordingError(f"{where}: {problem}; a recorded scene holds all that it needs")


def _problems(xml: str, assets: Mapping[str, bytes]) -> Iterator[str]:
    for name, content in assets.items():
        if not is_plain(name):
            yield f"its file '{name}' is no plain name"
        if content.startswith(_PNG) and _pixels(content) > _PIXELS:
            yield f"its picture '{name}' has more than {_PIXELS} pixels"
    if "<!DOCTYPE" in xml.upper():
        yield "it has a DOCTYPE"
        return
    try:
        elements = list(ElementTree.fromstring(xml).iter())
    except (ElementTree.ParseError, ValueError) as error:
        yield f"it is no XML ({error})"
        return
    if len(elements) > _ELEMENTS:
        yield f"it has {len(elements)} elements, at most {_ELEMENTS}"
    for element in elements:
        if element.tag in _REFUSED:
            yield f"it has an element <{element.tag}>"
        for key, value in element.attrib.items():
            if problem := _problem(element.tag, key, value, assets):
                yield f"<{element.tag} {key}='{value:.60}'> {problem}"


def _problem(tag: str, key: str, value: str, assets: Mapping[str, bytes]) -> str | None:
    """What is wrong with an attribute."""
    if key.startswith("file"):
        return None if value in assets else "is not among its files"
    if key in _FOLDERS:
        return "names a folder" if value else None
    if (tag, key) == ("option", "timestep"):
        least, most = limits.TIMESTEP
        return None if least <= _number(value) <= most else f"is not in {least:g} to {most:g} s"
    if (tag, key) == ("size", "memory"):
        unit = value[-1:].upper() if value[-1:].isalpha() else ""
        bytes_ = _number(value[: len(value) - len(unit)]) * _UNITS.get(unit, 2**60)
        return None if bytes_ <= 2**30 else "is more than 1 G"
    most = _MOST.get(key, _MOST.get(f"{tag}.{key}", float("inf")))
    asked = [_number(word) for word in value.split()] if most < float("inf") else []
    return f"is more than {most}" if any(not number <= most for number in asked) else None


def _number(text: str) -> float:
    """Not a number where the text is none, which no bound lets pass."""
    try:
        return float(text)
    except ValueError:
        return float("nan")


def _pixels(png: bytes) -> int:
    return int.from_bytes(png[16:20], "big") * int.from_bytes(png[20:24], "big")
