"""Joints of a robot that are no arm: which of them move, and what holds them."""

from collections.abc import Mapping, Sequence
from typing import Literal

import mujoco
import numpy as np

from tpsim.robot.kinematic_chain import arm_bodies, objects
from tpsim.robot.removal import drives_joint


def split(
    model: mujoco.MjModel,
    joints: Sequence[str],
    hands: Mapping[str, str],
    mode: Literal["locked", "servo"],
) -> tuple[list[str], list[str]]:
    """Return the joints to lock and those to leave to their servos.

    A mechanism is all that hangs from one body of an arm, or from the world, by joints that are
    no arm. It is locked unless ``mode`` is "servo" and an actuator moves a joint of it; ball
    joints are locked always. Free bodies and what they carry are objects, and neither.
    """
    arms, free = arm_bodies(model, hands), objects(model)
    driven = {
        _carrier(model, int(model.dof_bodyid[dof]), arms)
        for dof in np.flatnonzero(driven_dofs(model).any(axis=0))
        if model.joint(int(model.dof_jntid[dof])).name not in joints
    }
    locked: list[str] = []
    kept: list[str] = []
    for j in range(model.njnt):
        name, body = model.joint(j).name, int(model.jnt_bodyid[j])
        if name in joints or body in free:
            continue
        is_ball = model.jnt_type[j] == mujoco.mjtJoint.mjJNT_BALL
        moves = mode == "servo" and not is_ball and _carrier(model, body, arms) in driven
        (kept if moves else locked).append(name)
    return locked, kept


def controls(
    spec: mujoco.MjSpec,
    model: mujoco.MjModel,
    kept: Sequence[str],
    positions: Mapping[str, float],
    key: int | None,
) -> dict[str, float]:
    """Return the control of each actuator that moves a kept joint.

    It is that of the keyframe, else the position at home for a position servo, else zero.
    """
    held = {}
    dofs = [int(model.jnt_dofadr[model.joint(name).id]) for name in kept]
    moves = np.asarray(driven_dofs(model)[:, dofs].any(axis=1))
    for actuator in (a for a in spec.actuators if moves[model.actuator(a.name).id]):
        a = model.actuator(actuator.name).id
        control = int(model.actuator_ctrladr[a])
        value = 0.0
        if key is not None:
            value = float(model.key_ctrl[key, control])
        elif drives_joint(actuator) and model.actuator_biasprm[a, 1]:
            value = positions[actuator.target] * float(model.actuator_gear[a, 0])
        if model.actuator_ctrllimited[a]:
            value = float(np.clip(value, *model.actuator_ctrlrange[a]))
        held[actuator.name] = value
    return held


def driven_dofs(model: mujoco.MjModel) -> np.ndarray:
    """Return which degrees of freedom (nu, nv) each actuator moves, by whatever transmission."""
    data = mujoco.MjData(model)
    rng = np.random.default_rng(0)
    # Away from the reference, where the moment arm of a tendon may vanish.
    velocity = rng.uniform(0.05, 0.15, model.nv)
    mujoco.mj_integratePos(model, data.qpos, velocity, 1)
    mujoco.mj_fwdPosition(model, data)
    moment = np.zeros((model.nu, model.nv))
    if model.nu:
        mujoco.mju_sparse2dense(
            moment,
            data.actuator_moment,
            data.moment_rownnz,
            data.moment_rowadr,
            data.moment_colind,
        )
    return np.abs(moment) > 1e-9


def _carrier(model: mujoco.MjModel, body: int, arms: set[int]) -> int:
    """Return the nearest body of an arm, or the world, that carries a body."""
    while body not in arms:
        body = int(model.body_parentid[body])
    return body
