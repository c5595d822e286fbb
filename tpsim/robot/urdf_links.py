"""Links of a URDF, made physical: what moves has mass, and what states none has none."""

import xml.etree.ElementTree as ElementTree
from collections import defaultdict

from tpsim.errors import ArgumentError

_MASS = 1e-3  # kg, of a moving link without any
_INERTIA = 1e-6  # kg m^2


def make_physical(robot: ElementTree.Element) -> list[str]:
    """Give links without inertia what MuJoCo needs, and say so.

    MuJoCo would weigh the shapes of a link without inertia as if they were of water. Such links
    get no mass where they are fixed to others, and 1 g where a joint moves them alone.

    Raises
    ------
    ArgumentError
        If no link has a mass.
    """
    links = {link.get("name", ""): link for link in robot.iterfind("link")}
    if not any(_mass(link) for link in links.values()):
        raise ArgumentError("no link of the URDF has a mass: add <inertial> to its links")
    fixed = defaultdict(list)
    moving = set()
    for joint in robot.iterfind("joint"):
        parent, child = _end(joint, "parent"), _end(joint, "child")
        if joint.get("type") == "fixed":
            fixed[parent].append(child)
        else:
            moving.add(child)
    light = []
    for name, link in links.items():
        if _mass(link):
            continue
        is_light = name in moving and not any(_mass(links[n]) for n in _rigid(name, fixed))
        _set_inertia(link, _MASS if is_light else 0, _INERTIA if is_light else 0)
        if is_light:
            light.append(name)
    return [f"links {', '.join(light)} move but have no mass: 1 g given"] if light else []


def _end(joint: ElementTree.Element, tag: str) -> str:
    element = joint.find(tag)
    name = None if element is None else element.get("link")
    if name is None:
        raise ArgumentError(f"joint '{joint.get('name')}' of the URDF has no <{tag} link=...>")
    return name


def _mass(link: ElementTree.Element) -> float:
    mass = link.find("inertial/mass")
    return 0.0 if mass is None else float(mass.get("value", "0"))


def _rigid(name: str, fixed: dict[str, list[str]]) -> list[str]:
    """Return a link and all that is fixed to it."""
    found = [name]
    for link in found:
        found.extend(fixed[link])
    return found


def _set_inertia(link: ElementTree.Element, mass: float, inertia: float) -> None:
    for old in link.findall("inertial"):
        link.remove(old)
    inertial = ElementTree.SubElement(link, "inertial")
    ElementTree.SubElement(inertial, "mass", value=str(mass))
    diagonal = {name: str(inertia) for name in ("ixx", "iyy", "izz")}
    products = {name: "0" for name in ("ixy", "ixz", "iyz")}
    ElementTree.SubElement(inertial, "inertia", diagonal | products)
