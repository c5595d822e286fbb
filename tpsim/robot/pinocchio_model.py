"""The Pinocchio model of a compiled MuJoCo model: one source for physics and controller."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import pinocchio as pin

from tpsim.errors import SimulationError
from tpsim.robot.kinematic_chain import objects


@dataclass(frozen=True)
class PinocchioModel:
    """Kinematics and dynamics of the moving joints of a MuJoCo model.

    Attributes
    ----------
    model : pinocchio.Model
        Its q (n,) and v (n,) are those of MuJoCo, joint by joint; armature is included.
    joints : tuple of int
        MuJoCo's joint ids, in the order of q.
    sites : dict of str to int
        Pinocchio's frame id of every site that the robot carries, and of those in the world.
    """

    model: pin.Model
    joints: tuple[int, ...]
    sites: dict[str, int]


def pinocchio_model(
    model: mujoco.MjModel, joints: Sequence[str], fixed: Mapping[str, float]
) -> PinocchioModel:
    """Build the Pinocchio model that moves ``joints`` and holds all others still.

    Free and mocap bodies, with what they carry, are objects and left out.

    Parameters
    ----------
    model : mujoco.MjModel
        A compiled scene.
    joints : sequence of str
        Hinge and slide joints that move.
    fixed : mapping of str to float
        Where other hinge and slide joints stand still, rad or m; joints that are neither here
        nor in ``joints`` stand at their reference (``qpos0``).

    Raises
    ------
    SimulationError
        If ``joints`` is empty or names what is no hinge or slide joint of the robot.
    """
    built = pin.Model()
    built.gravity.linear = model.opt.gravity.copy()
    # For every body: the Pinocchio joint that carries it and its placement there.
    carrier = {0: (0, pin.SE3.Identity())}
    ids: list[int] = []
    free = objects(model)
    for b in range(1, model.nbody):
        parent = int(model.body_parentid[b])
        first, count = int(model.body_jntadr[b]), int(model.body_jntnum[b])
        if parent not in carrier or b in free:
            continue
        joint, placement = carrier[parent]
        placement = placement * _se3(model.body_quat[b], model.body_pos[b])
        for j in range(first, first + count):
            name = model.joint(j).name
            if name not in joints:
                placement = placement * _displacement(model, j, fixed)
                continue
            motion, at_zero = _motion(model, j)
            anchor = pin.SE3(np.eye(3), model.jnt_pos[j].copy())
            joint = built.addJoint(joint, motion, placement * anchor * at_zero, name)
            placement = anchor.inverse()
            ids.append(j)
        carrier[b] = joint, placement
        built.appendBodyToJoint(joint, _inertia(model, b), placement)
    _check(model, joints, ids)
    built.armature = np.array([_armature(model, j) for j in ids])
    return PinocchioModel(built, tuple(ids), _add_sites(built, model, carrier))


def _motion(model: mujoco.MjModel, joint: int) -> tuple[pin.JointModel, pin.SE3]:
    """Return Pinocchio's joint and the placement that makes its zero MuJoCo's q = 0."""
    axis, reference = model.jnt_axis[joint].copy(), float(model.qpos0[model.jnt_qposadr[joint]])
    kind = mujoco.mjtJoint(int(model.jnt_type[joint]))
    if kind == mujoco.mjtJoint.mjJNT_HINGE:
        at_zero = pin.SE3(pin.exp3(-axis * reference), np.zeros(3))
        return pin.JointModelRevoluteUnaligned(axis), at_zero
    if kind == mujoco.mjtJoint.mjJNT_SLIDE:
        at_zero = pin.SE3(np.eye(3), -axis * reference)
        return pin.JointModelPrismaticUnaligned(axis), at_zero
    raise SimulationError(
        f"joint '{model.joint(joint).name}' is a {kind.name}; a robot has hinges and slides"
    )


def _displacement(model: mujoco.MjModel, joint: int, fixed: Mapping[str, float]) -> pin.SE3:
    """Return how a joint that stands still displaces its body from the body's own placement."""
    if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_BALL:
        return pin.SE3.Identity()
    axis, reference = model.jnt_axis[joint].copy(), float(model.qpos0[model.jnt_qposadr[joint]])
    displacement = axis * (fixed.get(model.joint(joint).name, reference) - reference)
    if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE:
        return pin.SE3(np.eye(3), displacement)
    anchor = pin.SE3(np.eye(3), model.jnt_pos[joint].copy())
    return anchor * pin.SE3(pin.exp3(displacement), np.zeros(3)) * anchor.inverse()


def _inertia(model: mujoco.MjModel, body: int) -> pin.Inertia:
    R = pin.Quaternion(*map(float, model.body_iquat[body])).matrix()
    return pin.Inertia(
        float(model.body_mass[body]),
        model.body_ipos[body].copy(),
        R @ np.diag(model.body_inertia[body]) @ R.T,
    )


def _armature(model: mujoco.MjModel, joint: int) -> float:
    """Return a joint's armature, with that of its actuator behind the gear."""
    armature = float(model.dof_armature[model.jnt_dofadr[joint]])
    actuator = int(model.jnt_actuatorid[joint])
    if actuator >= 0:
        gear = model.actuator_gear[actuator, 0]
        armature += float(model.actuator_armature[actuator] * gear**2)
    return armature


def _add_sites(
    built: pin.Model, model: mujoco.MjModel, carrier: Mapping[int, tuple[int, pin.SE3]]
) -> dict[str, int]:
    sites = {}
    for s in range(model.nsite):
        if (b := int(model.site_bodyid[s])) in carrier:
            joint, placement = carrier[b]
            at = placement * _se3(model.site_quat[s], model.site_pos[s])
            name = model.site(s).name
            frame = pin.Frame(f"site:{name}", joint, at, pin.FrameType.OP_FRAME)
            sites[name] = built.addFrame(frame)
    return sites


def _check(model: mujoco.MjModel, joints: Sequence[str], ids: Sequence[int]) -> None:
    found = {model.joint(j).name for j in ids}
    if missing := sorted(set(joints) - found):
        known = ", ".join(model.joint(j).name for j in range(model.njnt)) or "none"
        raise SimulationError(
            f"no joints {', '.join(missing)} on the robot; the scene's joints are {known}"
        )
    if not ids:
        raise SimulationError("the scene has no hinge or slide joint, so there is no robot in it")


def _se3(quaternion: np.ndarray, position: np.ndarray) -> pin.SE3:
    return pin.SE3(pin.Quaternion(*map(float, quaternion)).matrix(), np.array(position))
