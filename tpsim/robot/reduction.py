"""Joints that are no arm, locked at a position."""

from collections.abc import Mapping

import mujoco
import numpy as np

from tpsim.errors import ArgumentError
from tpsim.robot.removal import Names, drives_joint, remove_references, remove_tendon


def lock(
    spec: mujoco.MjSpec, model: mujoco.MjModel, positions: Mapping[str, float | None]
) -> list[str]:
    """Remove joints; the bodies that they moved stay where the joints put them.

    Equalities, tendons, actuators, sensors and tuples that need these joints go with them.

    Parameters
    ----------
    spec : MjSpec
        The robot, changed in place.
    model : MjModel
        What the spec compiled to.
    positions : mapping of str to float or None
        Where each hinge (rad) or slide (m) is locked; None for a ball joint, at its reference.

    Returns
    -------
    list of str
        What was removed, in words.

    Raises
    ------
    ArgumentError
        If a tendon couples a locked joint with one that stays.
    """
    if not positions:
        return []
    gone: Names = {(mujoco.mjtObj.mjOBJ_JOINT, name) for name in positions}
    changes = [_described(name, position) for name, position in positions.items()]
    for equality in list(spec.equalities):
        if equality.type == mujoco.mjtEq.mjEQ_JOINT and (
            {equality.name1, equality.name2} & set(positions)
        ):
            changes.append(f"equality of joints '{equality.name1}', '{equality.name2}': removed")
            spec.delete(equality)
    for tendon in _locked_tendons(spec, set(positions)):
        gone.add((mujoco.mjtObj.mjOBJ_TENDON, tendon.name))
        changes += remove_tendon(spec, tendon)
    for actuator in list(spec.actuators):
        if drives_joint(actuator) and actuator.target in positions:
            gone.add((mujoco.mjtObj.mjOBJ_ACTUATOR, actuator.name))
            changes.append(f"actuator '{actuator.name}' of joint '{actuator.target}': removed")
            spec.delete(actuator)
    changes += remove_references(spec, gone)
    _displace_bodies(spec, model, positions)
    for joint in [j for j in spec.joints if j.name in positions]:
        spec.delete(joint)
    return changes


def _locked_tendons(spec: mujoco.MjSpec, locked: set[str]) -> list[mujoco.MjsTendon]:
    found = []
    for tendon in spec.tendons:
        wrapped = {w.target.name for w in tendon.path if w.type == mujoco.mjtWrap.mjWRAP_JOINT}
        if free := wrapped - locked:
            if wrapped & locked:
                raise ArgumentError(
                    f"tendon '{tendon.name}' couples {', '.join(sorted(wrapped & locked))}, which "
                    f"would be locked, with {', '.join(sorted(free))}: pass others='servo' or "
                    "remove the tendon"
                )
        elif wrapped:
            found.append(tendon)
    return found


def _displace_bodies(
    spec: mujoco.MjSpec, model: mujoco.MjModel, positions: Mapping[str, float | None]
) -> None:
    """Move every body as its locked joints, the first one first, displace it."""
    for body in spec.bodies[1:]:
        pos, quat = np.zeros(3), np.array([1.0, 0, 0, 0])
        for j in (model.joint(joint.name).id for joint in body.joints):
            angle = positions.get(model.joint(j).name)
            reference = model.qpos0[model.jnt_qposadr[j]]
            if angle is not None and angle != reference:
                pos, quat = _displaced(model, j, angle - reference, pos, quat)
        if pos.any() or quat[0] != 1:
            own = (
                spec.resolve_orientation(
                    degree=body.compiler.degree,
                    sequence=body.compiler.eulerseq,
                    orientation=body.alt,
                )
                if body.alt.type != mujoco.mjtOrientation.mjORIENTATION_QUAT
                else body.quat
            )
            body.pos, body.quat = _composed(np.array(body.pos), np.array(own), pos, quat)
            body.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT


def _displaced(
    model: mujoco.MjModel, joint: int, by: float, pos: np.ndarray, quat: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Append the motion of a joint to a pose, both in coordinates of the joint's body."""
    axis, anchor = model.jnt_axis[joint], model.jnt_pos[joint]
    if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE:
        return _composed(pos, quat, axis * by, np.array([1.0, 0, 0, 0]))
    turn, turned = np.empty(4), np.empty(3)
    mujoco.mju_axisAngle2Quat(turn, axis, by)
    mujoco.mju_rotVecQuat(turned, anchor, turn)
    return _composed(pos, quat, anchor - turned, turn)


def _composed(
    pos: np.ndarray, quat: np.ndarray, inner_pos: np.ndarray, inner_quat: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the pose of an inner frame in the coordinates in which the outer one is given."""
    out_pos, out_quat = np.empty(3), np.empty(4)
    mujoco.mju_mulPose(out_pos, out_quat, pos, quat, inner_pos, inner_quat)
    return out_pos, out_quat


def _described(joint: str, position: float | None) -> str:
    at = "its reference" if position is None else f"{position:.4g}"
    return f"joint '{joint}' is no arm joint: locked at {at}"
