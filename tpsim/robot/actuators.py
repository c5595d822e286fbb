"""Actuators of arm joints turned into torque motors."""

from collections.abc import Sequence

import mujoco
import numpy as np

from tpsim.errors import ArgumentError
from tpsim.robot.force_limits import (
    actuator_id,
    both_ways,
    is_motor,
    is_torque_motor,
    joint_limit,
    stated_limit,
)
from tpsim.robot.others import driven_dofs
from tpsim.robot.removal import drives_joint, remove_actuator


def torque_motors(
    spec: mujoco.MjSpec, model: mujoco.MjModel, joints: Sequence[str], given: np.ndarray
) -> list[str]:
    """Give every arm joint one motor, whose control is the joint torque up to its limit.

    A motor of gear 1 stays; position, velocity, geared and all other actuators of a joint make
    way for a new motor ``<joint>_motor``, and leave it their force limit behind the gear.

    Parameters
    ----------
    spec : MjSpec
        The robot, changed in place.
    model : MjModel
        What the spec compiled to before elements were removed.
    joints : sequence of str
        The arm joints, n.
    given : (n,)
        Torque limits that the user gives, Nm (or N); NaN for what the file says.

    Returns
    -------
    list of str
        What was changed, in words.

    Raises
    ------
    ArgumentError
        If neither the file nor the user states the limit of a joint.
    """
    drives = {joint: _drives(spec, joint) for joint in joints}
    stated = np.array([stated_limit(model, joint, drives[joint]) for joint in joints])
    limits = np.where(np.isnan(given), stated, given)
    if unknown := [j for j, limit in zip(joints, limits, strict=True) if not np.isfinite(limit)]:
        raise ArgumentError(
            f"the file states no torque limit for {', '.join(unknown)}: pass torque_limit=, a "
            "number or a mapping such as {'joint': Nm}"
        )
    changes = _remove_tendon_drives(spec, model, joints)
    for joint, limit in zip(joints, limits, strict=True):
        changes += _drive(spec, model, joint, float(limit), drives[joint])
    return changes


def _drives(spec: mujoco.MjSpec, joint: str) -> list[mujoco.MjsActuator]:
    return [a for a in spec.actuators if a.target == joint and drives_joint(a)]


def _drive(
    spec: mujoco.MjSpec,
    model: mujoco.MjModel,
    joint: str,
    limit: float,
    drives: list[mujoco.MjsActuator],
) -> list[str]:
    changes: list[str] = []
    motor = next((a for a in drives if is_torque_motor(model, actuator_id(model, a))), None)
    for actuator in drives:
        if actuator is not motor:
            kind = _kind(model, actuator_id(model, actuator))
            changes.append(
                f"{kind} '{actuator.name}' of joint '{joint}': replaced by a torque motor of "
                f"{limit:g}"
            )
            changes += _remove(spec, model, actuator, joint)
    if motor is None:
        motor = spec.add_actuator(
            name=f"{joint}_motor", trntype=mujoco.mjtTrn.mjTRN_JOINT, target=joint
        )
        _make_plain(motor)
        if not drives:
            changes.append(f"joint '{joint}' had no actuator: torque motor of {limit:g} added")
        _limit(motor, limit)
    elif not _limits_to(model, actuator_id(model, motor), limit):
        changes.append(f"motor '{motor.name}': control range is now its torque limit, {limit:g}")
        _limit(motor, limit)
    if joint_limit(model, model.joint(joint).id) < limit:
        changes.append(f"joint '{joint}': actuatorfrcrange widened to {limit:g}")
        spec.joint(joint).actfrcrange = (-limit, limit)
    return changes


def _remove_tendon_drives(
    spec: mujoco.MjSpec, model: mujoco.MjModel, joints: Sequence[str]
) -> list[str]:
    """Remove actuators that pull at arm joints through tendons."""
    dofs = [int(model.jnt_dofadr[model.joint(joint).id]) for joint in joints]
    pulls = np.asarray(driven_dofs(model)[:, dofs].any(axis=1))
    changes = []
    for actuator in list(spec.actuators):
        by_tendon = actuator.trntype == mujoco.mjtTrn.mjTRN_TENDON
        if by_tendon and pulls[actuator_id(model, actuator)]:
            changes.append(f"actuator '{actuator.name}' pulled at arm joints by a tendon: removed")
            changes += remove_actuator(spec, actuator)
    return changes


def _make_plain(motor: mujoco.MjsActuator) -> None:
    """Undo what the file's default class would make of a new motor."""
    motor.set_to_motor()
    motor.gear = (1, 0, 0, 0, 0, 0)
    motor.gainprm[0] = 1
    motor.armature = 0
    motor.damping = (0, 0, 0)
    motor.actlimited = mujoco.mjtLimited.mjLIMITED_FALSE


def _limits_to(model: mujoco.MjModel, actuator: int, limit: float) -> bool:
    tight = model.actuator_forcelimited[actuator] and (
        both_ways(model.actuator_forcerange[actuator]) < limit
    )
    control = model.actuator_ctrlrange[actuator]
    exact = model.actuator_ctrllimited[actuator] and np.array_equal(control, (-limit, limit))
    return bool(exact and not tight)


def _limit(motor: mujoco.MjsActuator, limit: float) -> None:
    motor.ctrllimited = mujoco.mjtLimited.mjLIMITED_TRUE
    motor.ctrlrange = (-limit, limit)
    motor.forcelimited = mujoco.mjtLimited.mjLIMITED_FALSE
    motor.forcerange = (0, 0)


def _remove(
    spec: mujoco.MjSpec, model: mujoco.MjModel, actuator: mujoco.MjsActuator, joint: str
) -> list[str]:
    """Remove an actuator; what it added to its joint's armature and damping stays there."""
    number = model.joint(joint).id
    if model.jnt_actuatorid[number] == actuator_id(model, actuator):
        gear = abs(float(model.actuator_gear[actuator_id(model, actuator), 0]))
        element = spec.joint(joint)
        element.armature += gear**2 * actuator.armature
        for power, damping in enumerate(actuator.damping):
            element.damping[power] += gear ** (2 + power) * damping
    return remove_actuator(spec, actuator)


def _kind(model: mujoco.MjModel, actuator: int) -> str:
    """Return what an actuator is called, for messages."""
    if is_motor(model, actuator):
        return f"motor of gear {model.actuator_gear[actuator, 0]:g}"
    if model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_AFFINE:
        _, stiffness, damping = model.actuator_biasprm[actuator, :3]
        if stiffness:
            return "position servo"
        if damping:
            return "velocity servo"
    return "actuator"
