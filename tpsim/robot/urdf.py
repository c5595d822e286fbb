"""URDF, read by MuJoCo's own reader after its meshes are found and its links made physical."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Collection, Mapping
from pathlib import Path

import mujoco

from tpsim.errors import ArgumentError
from tpsim.robot.gripper import Gripper
from tpsim.robot.reading import Draft, parsed
from tpsim.robot.urdf_links import make_physical

_READABLE = {".stl", ".obj", ".msh"}
_OPTIONS = {
    "fusestatic": "false",
    "discardvisual": "false",
    "strippath": "false",
    "balanceinertia": "true",
}
_UNSUPPORTED = {"planar", "floating"}


def read_urdf(
    path: str | Path,
    packages: Mapping[str, str | Path] | None = None,
    hands: Collection[str | Gripper] | None = None,
) -> Draft:
    """Read a URDF file.

    Effort limits become ``actuatorfrcrange``, mimic joints equalities; damping and friction are
    taken over. Fixed links stay bodies. The root link is fixed to the world.

    Parameters
    ----------
    path : str or Path
        The URDF file.
    packages : mapping of str to path or None
        Folder of each package that ``package://`` names; without it, folders above the file are
        searched.
    hands : collection of str or Gripper, optional
        Links at whose frames a site is added, called as the link; grippers are left to others. By
        default hands are for others to find.

    Raises
    ------
    ArgumentError
        If the file is no URDF, a mesh is not found, a joint is planar or floating, or a hand is
        no link.
    """
    path = Path(path)
    robot = _root(path)
    changes = _resolve_meshes(robot, path, packages or {})
    for joint in robot.iterfind("joint"):
        if joint.get("type") in _UNSUPPORTED:
            raise ArgumentError(
                f"joint '{joint.get('name')}' of {path} is {joint.get('type')}: a robot has "
                "revolute, continuous, prismatic and fixed joints"
            )
    _set_options(robot)
    changes += make_physical(robot)
    text = ElementTree.tostring(robot, encoding="unicode")
    spec = parsed(lambda: mujoco.MjSpec.from_string(text), str(path))
    if hands is not None:
        _add_hand_sites(spec, hands)
    return Draft(spec, _velocity_limits(robot), tuple(changes))


def _add_hand_sites(spec: mujoco.MjSpec, hands: Collection[str | Gripper]) -> None:
    """Add a site at the frame of each named link, called as the link."""
    links = ", ".join(body.name for body in spec.bodies[1:])
    if not hands:
        raise ArgumentError(
            f"hands is empty: name a link for each hand, hands={{'hand': 'link'}}; they are {links}"
        )
    for name in sorted({hand for hand in hands if isinstance(hand, str)}):
        link = spec.body(name)
        if link is None:
            raise ArgumentError(f"a hand is at '{name}', which is no link: {links} are")
        link.add_site(name=name)


def _root(path: Path) -> ElementTree.Element:
    try:
        robot = ElementTree.parse(path).getroot()
    except OSError:
        raise ArgumentError(f"no file {path}: pass the path of a URDF file") from None
    except ElementTree.ParseError as error:
        raise ArgumentError(f"{path} cannot be read: {error}") from None
    if robot.tag != "robot":
        raise ArgumentError(f"{path} is no URDF: its root is <{robot.tag}>, not <robot>")
    return robot


def _set_options(robot: ElementTree.Element) -> None:
    """Keep fixed links and visuals, and find meshes by their full path."""
    extension = robot.find("mujoco")
    if extension is None:
        extension = ElementTree.SubElement(robot, "mujoco")
    compiler = extension.find("compiler")
    if compiler is None:
        compiler = ElementTree.SubElement(extension, "compiler")
    compiler.attrib.pop("meshdir", None)
    compiler.attrib.update(_OPTIONS)


def _resolve_meshes(
    robot: ElementTree.Element, path: Path, packages: Mapping[str, str | Path]
) -> list[str]:
    """Give every mesh its full path; remove those of formats that MuJoCo cannot read."""
    removed: set[str] = set()
    for link in robot.iterfind("link"):
        for tag in ("visual", "collision"):
            for shape in link.findall(tag):
                mesh = shape.find("geometry/mesh")
                if mesh is None:
                    continue
                file = mesh.get("filename", "")
                if Path(file).suffix.lower() not in _READABLE:
                    removed.add(Path(file).name)
                    link.remove(shape)
                else:
                    mesh.set("filename", str(_mesh_path(file, path, packages)))
    if not removed:
        return []
    return [f"meshes that MuJoCo cannot read: removed ({', '.join(sorted(removed))})"]


def _mesh_path(file: str, path: Path, packages: Mapping[str, str | Path]) -> Path:
    scheme, separator, rest = file.partition("://")
    if not separator:
        candidates = [path.parent / file]
    elif scheme == "file":
        candidates = [Path(rest)]
    else:
        package, _, inside = rest.partition("/")
        candidates = [folder / package / inside for folder in path.resolve().parents]
        candidates += [folder / inside for folder in path.resolve().parents]
        if package in packages:
            candidates = [Path(packages[package]) / inside]
    found = next((candidate for candidate in candidates if candidate.is_file()), None)
    if found is None:
        raise ArgumentError(
            f"mesh {file} of {path} is not found: pass packages={{'name': folder}}, or put the "
            "file there"
        )
    return found.resolve()


def _velocity_limits(robot: ElementTree.Element) -> dict[str, float]:
    limits = {}
    for joint in robot.iterfind("joint"):
        limit = joint.find("limit")
        velocity = 0.0 if limit is None else float(limit.get("velocity", "0"))
        if velocity > 0:
            limits[joint.get("name", "")] = velocity
    return limits
