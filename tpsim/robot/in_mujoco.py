"""A robot found in a compiled MuJoCo model: the mechanism, and where its joints are there."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from tpsim.errors import SimulationError
from tpsim.robot.description import Description
from tpsim.robot.intake import Source
from tpsim.robot.mechanism import Mechanism
from tpsim.robot.pinocchio_model import pinocchio_model


@dataclass(frozen=True, eq=False)
class InMujoco:
    """Where a robot is in a MuJoCo model.

    Parameters
    ----------
    model : mujoco.MjModel
        Compiled scene or robot, in which every arm joint has a motor.
    description : Description
    source : Source or None
        Where the robot comes from, for scenes to be composed with it.
    qpos, dof, actuator : (n,) int
        Addresses of the joints in MuJoCo's qpos, qvel and ctrl.
    """

    model: mujoco.MjModel
    description: Description
    source: Source | None
    qpos: np.ndarray
    dof: np.ndarray
    actuator: np.ndarray


def found_in(
    model: mujoco.MjModel, description: Description, source: Source | None
) -> tuple[Mechanism, InMujoco]:
    """The mechanism of a robot in a compiled model, and where it is in there."""
    joints = description.joints
    built = pinocchio_model(model, joints, description.fixed)
    ids = np.array(built.joints)
    qpos, dof = model.jnt_qposadr[ids].copy(), model.jnt_dofadr[ids].copy()
    limited = model.jnt_limited[ids].astype(bool)
    actuator, torque_limit = _motors(model, ids, joints)
    mechanism = Mechanism(
        model=built.model,
        sites=built.sites,
        joints=joints,
        hands=dict(description.hands),
        lower=np.where(limited, model.jnt_range[ids, 0], -np.inf),
        upper=np.where(limited, model.jnt_range[ids, 1], np.inf),
        velocity_limit=np.array(
            [np.inf if limit is None else limit for limit in description.velocity_limit]
        ),
        torque_limit=torque_limit,
        home=np.array(description.home, float),
        damping=model.dof_damping[dof].copy(),
        friction=model.dof_frictionloss[dof].copy(),
        springs=model.jnt_stiffness[ids].copy(),
        slack=model.qpos_spring[qpos].copy(),
    )
    return mechanism, InMujoco(model, description, source, qpos, dof, actuator)


def _motors(
    model: mujoco.MjModel, ids: np.ndarray, names: Sequence[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Actuator of each joint, and its torque limit."""
    on_joint = model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT
    actuators, limits = [], []
    for joint, name in zip(ids, names, strict=True):
        drives = np.flatnonzero(on_joint & (model.actuator_trnid[:, 0] == joint))
        if len(drives) != 1:
            raise SimulationError(f"joint '{name}' has {len(drives)} motors; it needs one")
        a = int(drives[0])
        actuators.append(a)
        bounded = model.actuator_ctrllimited[a]
        limits.append(model.actuator_ctrlrange[a, 1] if bounded else np.inf)
    return np.array(actuators), np.array(limits, float)
