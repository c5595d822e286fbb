"""Where the joints of a robot are at home: as given, by the file's keyframe, or found."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from tpsim.border import read
from tpsim.checks import finite_array, shown
from tpsim.errors import ArgumentError

Home = Mapping[str, float] | Sequence[float] | np.ndarray | None
"""``None`` for the file's keyframe (else a posture is found), positions by joint name, or one
position per arm joint; rad or m."""


def keyframe(model: mujoco.MjModel) -> int | None:
    """Return the keyframe called "home", else the only one, else None."""
    for key in range(model.nkey):
        if model.key(key).name == "home":
            return key
    return 0 if model.nkey == 1 else None


def known_positions(model: mujoco.MjModel, joints: Sequence[str], home: Home) -> dict[str, float]:
    """Return the positions of hinges and slides that the user or a keyframe gives, rad or m.

    Parameters
    ----------
    model : MjModel
        The compiled robot, as the file has it.
    joints : sequence of str
        The arm joints, n.
    home : mapping, (n,) or None
        What the user gives; it wins over the keyframe.

    Raises
    ------
    ArgumentError
        If what the user gives is no number, not (n,), of no joint, or outside a joint's range.
    """
    given = _given(model, joints, home)
    key = keyframe(model)
    positions = {}
    if key is not None:
        for name, j in scalar_joints(model).items():
            value = float(model.key_qpos[key, model.jnt_qposadr[j]])
            positions[name] = _within(model, j, value)
    for name, value in given.items():
        j = model.joint(name).id
        if abs(_within(model, j, value) - value) > 1e-9:
            low, high = model.jnt_range[j]
            raise ArgumentError(
                f"home puts joint '{name}' at {value:g}, outside its range [{low:g}, {high:g}]"
            )
    return positions | given


def rest(model: mujoco.MjModel, known: Mapping[str, float]) -> dict[str, float]:
    """Return a position of every hinge and slide: the known one, else the reference.

    Joints that follow another one by an equality are where it puts them, and all are within
    their ranges.
    """
    joints = scalar_joints(model)
    positions = {
        name: known.get(name, _within(model, j, float(model.qpos0[model.jnt_qposadr[j]])))
        for name, j in joints.items()
    }
    for e in range(model.neq):
        if model.eq_type[e] == mujoco.mjtEq.mjEQ_JOINT and model.eq_active0[e]:
            follower = model.joint(int(model.eq_obj1id[e])).name
            if follower not in known:
                position = _followed(model, e, positions)
                positions[follower] = _within(model, joints[follower], position)
    return positions


def put(model: mujoco.MjModel, qpos: np.ndarray, positions: Mapping[str, float]) -> None:
    """Write positions of hinges and slides by name, rad or m, into a qpos of the model."""
    for name, position in positions.items():
        qpos[model.joint(name).qposadr[0]] = position


def scalar_joints(model: mujoco.MjModel) -> dict[str, int]:
    """Return the ids of the hinges and slides by name."""
    kinds = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
    return {model.joint(j).name: j for j in range(model.njnt) if int(model.jnt_type[j]) in kinds}


def _followed(model: mujoco.MjModel, equality: int, positions: Mapping[str, float]) -> float:
    """Return the position at which an equality of joints holds the first of them."""
    first, second = int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])
    moved = 0.0
    if second >= 0:
        moved = positions[model.joint(second).name] - model.qpos0[model.jnt_qposadr[second]]
    polynomial = np.polynomial.Polynomial(model.eq_data[equality, :5])
    return float(model.qpos0[model.jnt_qposadr[first]] + polynomial(moved))


def _within(model: mujoco.MjModel, joint: int, position: float) -> float:
    if not model.jnt_limited[joint]:
        return position
    return float(np.clip(position, *model.jnt_range[joint]))


def _given(model: mujoco.MjModel, joints: Sequence[str], home: Home) -> dict[str, float]:
    if home is None:
        return {}
    named = read("home", home, Mapping[str, object]) if isinstance(home, Mapping) else None
    try:
        values = finite_array("home", list(home.values()) if isinstance(home, Mapping) else home)
    except ArgumentError:
        raise ArgumentError(
            f"home is {shown(home)}, but must be finite joint positions, rad or m"
        ) from None
    if named is None and values.shape != (len(joints),):
        raise ArgumentError(
            f"home has shape {values.shape}, but there are {len(joints)} arm joints: "
            f"{', '.join(joints)}"
        )
    names = tuple(joints if named is None else named)
    known = scalar_joints(model)
    if unknown := [name for name in names if name not in known]:
        raise ArgumentError(
            f"home names {', '.join(unknown)}, but the robot's joints are {', '.join(known)}"
        )
    return dict(zip(names, map(float, values), strict=True))
