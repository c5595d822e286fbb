"""Poses that are recognised by the names of their columns."""

import re
from collections.abc import Mapping

from tpsim.border import border
from tpsim.data.columns import PoseColumns
from tpsim.data.recording import Recording, Series
from tpsim.errors import RecordingError

_POSITION = r"(p|t|pos|position|trans|translation|xyz|p_RS_R)"
_ORIENTATION = r"(q|quat|quaternion|orientation|orient|rot|rotation|q_RS)"
_POSE = r"(pose|transform)"
_SEPARATOR = r"[._/ :-]"
_NO_POSITION = re.compile(
    r"(vel|acc|force|torque|wrench|twist|omega|gyro|linear|angular|rpy|euler|magnet|bias|gravity"
    r"|(^|[._/ ])[vwafrdm][._/ ]?$|[vabw]_RS)",
    re.IGNORECASE,
)
_ANGLES = ("theta", "angle", "yaw", "heading", "phi")


@border
def poses_in(recording: Recording) -> dict[str, PoseColumns]:
    """Poses of a recording by the name of what they are poses of; ``""`` where none is said.

    Recognised are columns such as ``box_x, box_y, box_z, box_qw, ...``, ``tx, ty, tz, qx, ...``,
    ``/box/pose/position/x, ...``, arrays ``box_position (T, 3)`` with ``box_quaternion (T, 4)``,
    and in the plane ``box_x, box_y, box_angle``.
    """
    found: dict[str, PoseColumns] = {}
    for series in recording.series:
        for name, pose in {**_from_arrays(series), **_from_scalars(series)}.items():
            found.setdefault(name, pose)
    return found


def pose_named(recording: Recording, name: str) -> PoseColumns:
    """Find the pose of an object by its name, or by the last part of its name.

    Raises
    ------
    RecordingError
        There is none, or several; the message names those that are there.
    """
    poses = poses_in(recording)
    for same in (
        lambda known: known == name,
        lambda known: known.rstrip("/").endswith((f"/{name}", f".{name}")),
        lambda known: known.strip("/").lower() == name.strip("/").lower(),
    ):
        matches = [known for known in poses if same(known)]
        if len(matches) == 1:
            return poses[matches[0]]
        if matches:
            raise RecordingError(
                f"{recording.source}: {name!r} may be {' or '.join(matches)}; give the whole name"
            )
    there = ", ".join(known or "one without a name" for known in poses) or "none"
    raise RecordingError(
        f"{recording.source}: no pose is called {name!r}; the poses found are {there}; "
        f"{recording.known(name)}"
    )


def _from_scalars(series: Series) -> dict[str, PoseColumns]:
    names = set(series.columns)
    stems = dict.fromkeys(name[:-1] for name in series.columns if name[-1:] in ("x", "X"))
    found: dict[str, PoseColumns] = {}
    turns: dict[str, tuple[str, ...]] = {}
    for stem in stems:
        x, y, z, w = list("XYZW" if stem + "X" in names else "xyzw")
        if {stem + w, stem + y, stem + z} <= names:
            turns[_owner(stem, _ORIENTATION)] = (stem + w, stem + x, stem + y, stem + z)
        elif stem + y not in names or not _may_be_position(stem):
            continue
        elif stem + z in names:
            found.setdefault(
                _owner(stem, _POSITION), PoseColumns(position=(stem + x, stem + y, stem + z))
            )
        else:
            angle = next((stem + word for word in _ANGLES if stem + word in names), None)
            found.setdefault(
                _owner(stem, _POSITION),
                PoseColumns(
                    position=(stem + x, stem + y),
                    orientation=(angle,) if angle else (),
                    order="angle",
                ),
            )
    return _named(found, turns, "wxyz")


def _from_arrays(series: Series) -> dict[str, PoseColumns]:
    found: dict[str, PoseColumns] = {}
    turns: dict[str, tuple[str, ...]] = {}
    order = "wxyz"
    for name, values in series.columns.items():
        if _ends_with(name, _POSITION) and values.shape[1:] in ((2,), (3,)):
            found[_owner(name, _POSITION)] = PoseColumns(position=(name,))
        elif _ends_with(name, _ORIENTATION) and values.shape[1:] == (4,):
            turns[_owner(name, _ORIENTATION)] = (name,)
            order = "xyzw" if name.endswith("_quat") else order  # as robosuite writes it
    return _named(found, turns, order)


def _named(
    found: Mapping[str, PoseColumns], turns: Mapping[str, tuple[str, ...]], order: str
) -> dict[str, PoseColumns]:
    named = {}
    for name, pose in found.items():
        if name in turns and not pose.orientation:
            named[name] = PoseColumns(name, pose.position, turns[name], order)
        else:
            named[name] = PoseColumns(name, pose.position, pose.orientation, pose.order)
    return named


def _may_be_position(stem: str) -> bool:
    bare = re.sub(rf"{_SEPARATOR}+$", "", stem)
    return _ends_with(bare, _POSITION) or not _NO_POSITION.search(stem)


def _ends_with(name: str, word: str) -> bool:
    return re.search(rf"(^|{_SEPARATOR}){word}$", name) is not None


def _owner(stem: str, word: str) -> str:
    """Name of the object in a stem such as ``box_position_`` or ``/box/pose/orientation/``."""
    for what in (word, _POSE):
        stem = re.sub(rf"(^|{_SEPARATOR}){what}{_SEPARATOR}?$", "", stem)
    return re.sub(rf"{_SEPARATOR}+$", "", stem)
