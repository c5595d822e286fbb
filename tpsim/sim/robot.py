"""One robot, two engines: MuJoCo steps it, Pinocchio gives its kinematics and dynamics.

The Pinocchio model is built from the compiled MjModel, so there is one source for both.
"""

import mujoco
import numpy as np
import pinocchio as pin

from tpsim.errors import SimulationError

_ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


class Robot:
    """Kinematics and dynamics of the articulated part of a scene, cheap enough for 1 kHz.

    Free and mocap bodies are objects, not robot, and are left out. :meth:`update` computes what
    every torque needs; placements, Jacobians and inertia follow when they are first asked for.

    Parameters
    ----------
    model : mujoco.MjModel
        Compiled scene. Joints must be hinges or slides, each with a motor; the first ``user``
        value of a joint is its velocity limit.

    Attributes
    ----------
    joints : tuple of str
        Joint names, in the order of q (n,).
    qpos, dof : (n,) int
        Addresses of the joints in MuJoCo's qpos and qvel.
    lower, upper, velocity_limit, torque_limit : (n,)
        Limits in rad (or m), rad/s, Nm; infinite where the model sets none.
    objects : dict of str to (position (3,), quaternion (4,))
        What the robot sees of the world: where objects are at this moment [m].
    state, q, dq : (2 n,), (n,), (n,)
        Joint angles over velocities, and views of both, of the last update.
    bias : (n,)
        Coriolis and gravity torque of the last update.
    """

    def __init__(self, model: mujoco.MjModel):
        self.model = model
        self.pin_model, ids, self._sites = _pinocchio_model(model)
        self.pin_data = self.pin_model.createData()
        self.joints = tuple(model.joint(j).name for j in ids)
        self.n = len(ids)
        self.qpos = model.jnt_qposadr[ids].copy()
        self.dof = model.jnt_dofadr[ids].copy()
        limited = model.jnt_limited[ids].astype(bool)
        self.lower = np.where(limited, model.jnt_range[ids, 0], -np.inf)
        self.upper = np.where(limited, model.jnt_range[ids, 1], np.inf)
        self.torque_limit = self._motor_limits(ids)
        self.velocity_limit = _velocity_limits(model, ids)
        self.passive_damping = model.dof_damping[self.dof].copy()
        self._mass, self._placed = None, False
        self.bias = np.zeros(self.n)
        self._below = np.tril_indices(self.n, -1)
        self.objects = {}

    def _motor_limits(self, ids) -> np.ndarray:
        """Torque limit of each joint, and ``actuator``: the motor that drives it."""
        limit = np.full(self.n, np.inf)
        self.actuator = np.full(self.n, -1)
        for a in range(self.model.nu):
            joint = int(self.model.actuator_trnid[a, 0])
            where = np.flatnonzero(np.asarray(ids) == joint)
            if where.size:
                self.actuator[where] = a
                if self.model.actuator_ctrllimited[a]:
                    limit[where] = self.model.actuator_ctrlrange[a, 1]
        if (self.actuator < 0).any():
            missing = [self.joints[i] for i in np.flatnonzero(self.actuator < 0)]
            raise SimulationError(f"joints {missing} have no motor; give each a <motor> actuator")
        return limit

    def update(self, q, dq) -> None:
        """Take over a state q (n,), dq (n,), and compute bias(q, dq)."""
        self.state = state = np.concatenate((q, dq))
        self.q, self.dq = state[: self.n], state[self.n :]
        self.bias = pin.nonLinearEffects(self.pin_model, self.pin_data, self.q, self.dq)
        self._mass, self._placed = None, False

    @property
    def mass(self) -> np.ndarray:
        """M(q) (n, n) with armature, of the last update; computed when first asked for."""
        if self._mass is None:
            pin.crba(self.pin_model, self.pin_data, self.q)
            self._mass = self.pin_data.M.copy()
            # crba fills the upper triangle only.
            self._mass[self._below] = self._mass.T[self._below]
        return self._mass

    def update_kinematics(self, q) -> None:
        """Take over a posture q (n,) only."""
        self.q, self._mass, self._placed = q, None, False

    def _place(self):
        pin.computeJointJacobians(self.pin_model, self.pin_data, self.q)
        pin.updateFramePlacements(self.pin_model, self.pin_data)
        self._placed = True

    def gravity_torque(self, q) -> np.ndarray:
        """Torque (n,) [Nm] that holds the robot still at q (n,)."""
        return pin.computeGeneralizedGravity(self.pin_model, self.pin_data, q).copy()

    def site(self, name: str) -> int:
        """Handle of the site called ``name``, for the queries below; look it up once."""
        if name not in self._sites:
            raise SimulationError(f"no site '{name}' on the robot; it has {sorted(self._sites)}")
        return self._sites[name]

    def placement(self, site: int) -> tuple[np.ndarray, np.ndarray]:
        """Rotation (3, 3) and position (3,) [m] of a site in the world."""
        if not self._placed:
            self._place()
        placement = self.pin_data.oMf[site]
        return placement.rotation, placement.translation

    def jacobian(self, site: int) -> np.ndarray:
        """World-aligned Jacobian (6, n) of a site: linear velocity over angular velocity."""
        if not self._placed:
            self._place()
        J = pin.getFrameJacobian(self.pin_model, self.pin_data, site, _ALIGNED)
        return J.reshape(6, -1)


def as_slice(index) -> slice | np.ndarray:
    """Indices (k,) as a slice, where they follow each other: it selects a view, and faster."""
    first = int(index[0])
    if np.array_equal(index, np.arange(first, first + len(index))):
        return slice(first, first + len(index))
    return index


def _velocity_limits(model, ids):
    """First ``user`` value of each joint [rad/s]; infinite where a joint has none."""
    if not model.nuser_jnt:
        return np.full(len(ids), np.inf)
    limits = model.jnt_user[ids, 0]
    return np.where(limits > 0, limits, np.inf)


def _se3(quaternion, position):
    return pin.SE3(pin.Quaternion(*map(float, quaternion)).matrix(), np.array(position))


def _pinocchio_model(m):
    """Pinocchio model, MuJoCo joint ids in its order, and frame ids of the sites by name."""
    model = pin.Model()
    model.gravity.linear = m.opt.gravity.copy()
    # For every body: the Pinocchio joint that carries it and its placement there.
    carrier = {0: (0, pin.SE3.Identity())}
    ids, armature = [], []
    for b in range(1, m.nbody):
        parent = int(m.body_parentid[b])
        first, count = int(m.body_jntadr[b]), int(m.body_jntnum[b])
        kinds = [mujoco.mjtJoint(int(t)) for t in m.jnt_type[first : first + count]]
        is_object = m.body_mocapid[b] >= 0 or mujoco.mjtJoint.mjJNT_FREE in kinds
        if parent not in carrier or is_object:
            continue
        joint, placement = carrier[parent]
        placement = placement * _se3(m.body_quat[b], m.body_pos[b])
        for j, kind in zip(range(first, first + count), kinds, strict=True):
            anchor = pin.SE3(np.eye(3), m.jnt_pos[j].copy())
            axis, reference = m.jnt_axis[j].copy(), float(m.qpos0[m.jnt_qposadr[j]])
            if kind == mujoco.mjtJoint.mjJNT_HINGE:
                motion = pin.JointModelRevoluteUnaligned(axis)
                at_zero = pin.SE3(pin.exp3(-axis * reference), np.zeros(3))
            elif kind == mujoco.mjtJoint.mjJNT_SLIDE:
                motion = pin.JointModelPrismaticUnaligned(axis)
                at_zero = pin.SE3(np.eye(3), -axis * reference)
            else:
                raise SimulationError(
                    f"joint '{m.joint(j).name}' is a {kind.name}; a robot has hinges and slides"
                )
            joint = model.addJoint(joint, motion, placement * anchor * at_zero, m.joint(j).name)
            placement = anchor.inverse()
            ids.append(j)
            armature.append(m.dof_armature[m.jnt_dofadr[j]])
        carrier[b] = joint, placement
        R = pin.Quaternion(*map(float, m.body_iquat[b])).matrix()
        inertia = pin.Inertia(
            float(m.body_mass[b]), m.body_ipos[b].copy(), R @ np.diag(m.body_inertia[b]) @ R.T
        )
        model.appendBodyToJoint(joint, inertia, placement)
    model.armature = np.array(armature)
    sites = {}
    for s in range(m.nsite):
        if (b := int(m.site_bodyid[s])) in carrier:
            joint, placement = carrier[b]
            at = placement * _se3(m.site_quat[s], m.site_pos[s])
            frame = pin.Frame(f"site:{m.site(s).name}", joint, at, pin.FrameType.OP_FRAME)
            sites[m.site(s).name] = model.addFrame(frame)
    if not ids:
        raise SimulationError("the scene has no hinge or slide joint, so there is no robot in it")
    return model, ids, sites
