"""Which columns are the movement, where nobody says: by the names that recorders give."""

import re

from tpsim.data.clock import time_column
from tpsim.data.columns import Columns, PoseColumns, listed
from tpsim.data.poses import pose_named, poses_in
from tpsim.data.recording import Recording

_JOINTS = (
    "state.q",  # libfranka
    "actual_q",  # Universal Robots RTDE
    "field.q",  # rostopic echo -p of franka_ros
    "field.position",  # rostopic echo -p of joint states
    "q",
    "joint_positions",
    "joint_position",
    "joint_pos",
    "joints",
    "positions",
    "panda_joint",
    "fr3_joint",
    "joint",
)
NUMBERS = ("demonstration", "episode", "episode_index", "demo", "demo_id", "trial")
"""Usual names of a column that numbers the demonstrations of one file."""

_JOINT_STATE = re.compile(r".+/[^/]+/position")


def layout_of(recording: Recording, columns: Columns) -> Columns:
    """Describe the movement of a recording by the names of its columns.

    In this order: ``data`` as tpsim writes it, a pose without a name (``x, y, z, qw, ...``), the
    joints of a known recorder or under a usual name, the only pose there is, all columns.
    """
    if recording.has("data"):
        return Columns(other="data")
    poses = {} if _franka_log(recording) else poses_in(recording)
    if "" in poses:
        return _pose(poses[""])
    joints = _joints(recording)
    if joints:
        return Columns(joints=joints, time_unit="ms" if _franka_log(recording) else None)
    framed = {_name_of(recording, frame) for frame in columns.frames or ()}
    free = [pose for name, pose in poses.items() if name not in framed]
    if len(free) == 1:
        return _pose(free[0])
    return Columns(other=_all(recording, columns))


def _franka_log(recording: Recording) -> bool:
    return recording.has("state.q") and recording.has("success_rate")


def _joints(recording: Recording) -> tuple[str, ...]:
    states = [name for name in recording.names() if _JOINT_STATE.fullmatch(name)]
    if states:
        series, _ = recording.find(states[0])
        return tuple(name for name in states if name in series.columns)
    for name in _JOINTS:
        if recording.has(name) and recording.find(name)[1].shape[1] > 1:
            return (name,)
    return ()


def _pose(pose: PoseColumns) -> Columns:
    # The angle of a movement in the plane is a column like others.
    turn = listed(pose.orientation)
    if turn and pose.order == "angle":
        return Columns(position=pose.position, other=pose.orientation)
    return Columns(position=pose.position, orientation=pose.orientation or None, order=pose.order)


def _name_of(recording: Recording, frame: str | PoseColumns) -> str:
    if not isinstance(frame, str) or frame in ("start", "end"):
        return ""
    return pose_named(recording, frame).name


def _all(recording: Recording, columns: Columns) -> tuple[str, ...]:
    series = recording.series[0]
    used = {time_column(series)} if columns.rate is None else set()
    used |= set(NUMBERS)
    used |= {known for name in listed(columns.time) for known in series.names_of(name)}
    for frame in columns.frames or ():
        if frame in ("start", "end"):
            continue
        pose = pose_named(recording, frame) if isinstance(frame, str) else frame
        for name in (*listed(pose.position), *listed(pose.orientation)):
            used |= set(series.names_of(name))
    for name in listed(columns.demonstration):
        used |= set(series.names_of(name))
    return tuple(name for name in series.columns if name not in used)
