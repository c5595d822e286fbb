"""The plant: MuJoCo state, motors, and wrenches from outside."""

import mujoco
import numpy as np

from tpsim.checks import shown
from tpsim.errors import ArgumentError, SimulationError
from tpsim.robot.home import put
from tpsim.robot.indices import as_slice
from tpsim.robot.objects import Objects
from tpsim.robot.robot import Robot
from tpsim.world.grasp import Grasps

LOOKS = 10
"""Time steps between two looks at contacts whose number stays."""


class Simulation:
    """One scene that is stepped.

    Parameters
    ----------
    model : mujoco.MjModel
        The plant; its joints are those of the robot's model, its masses may differ.
    robot : Robot
        The controller's model.

    Attributes
    ----------
    model, data : mujoco.MjModel, mujoco.MjData
    robot : Robot
    objects : dict of str to int
        Row of each object (mocap body) in ``data.mocap_pos``.
    grasps : Grasps
        Things that hands take and let go.
    timestep : float
        [s]
    """

    def __init__(self, model: mujoco.MjModel, robot: Robot):
        self.model, self.robot = model, robot
        self.data = mujoco.MjData(model)
        self.objects = {
            model.body(body).name: int(row)
            for body, row in enumerate(model.body_mocapid)
            if row >= 0
        }
        found = robot.simulated
        qpos, dof, actuator = (as_slice(i) for i in (found.qpos, found.dof, found.actuator))
        self._qpos, self._actuator = qpos, actuator
        # Views of MuJoCo's own memory where they can be: looking them up costs more than reading.
        data, together = self.data, isinstance(qpos, slice) and isinstance(dof, slice)
        self._seen = (data.qpos[qpos], data.qvel[dof]) if together else None
        self._dof, self._ctrl = dof, data.ctrl
        self._wrenches, self._centres = data.xfrc_applied, data.xipos
        self.timestep = float(model.opt.timestep)
        self.grasps = Grasps(model)
        self._holds = bool(self.grasps)
        self._looks, self._count, self._touch = 0, 0, False

    def copy(self) -> "Simulation":
        """Another simulation in the same state."""
        other = Simulation(self.model, self.robot)
        mujoco.mj_copyData(other.data, self.model, self.data)
        other.grasps.copy_from(self.grasps)
        other._looks, other._count, other._touch = self._looks, self._count, self._touch
        return other

    def reset(self, q: np.ndarray) -> None:
        """Put the robot at rest at q (n,) and the clock at zero.

        Raises
        ------
        SimulationError
            A posture of another shape, not finite, or outside the joint limits.
        """
        robot = self.robot
        try:
            q = robot.posture("q", q)
        except ArgumentError as error:
            raise SimulationError(f"the start posture {error}") from None
        outside = (q < robot.lower) | (q > robot.upper)
        if outside.any():
            names = [robot.joints[i] for i in np.flatnonzero(outside)]
            raise SimulationError(f"the start posture q is outside the limits of {names}")
        mujoco.mj_resetData(self.model, self.data)
        self._looks, self._count, self._touch = 0, 0, False
        put(self.model, self.data.qpos, robot.description.fixed)
        for actuator, control in robot.description.controls.items():
            self.data.ctrl[self.model.actuator(actuator).id] = control
        self.data.qpos[self._qpos] = q
        if self._holds:
            self.grasps.begin(self.data)
        mujoco.mj_forward(self.model, self.data)

    @property
    def q(self) -> np.ndarray:
        """Joint angles (n,) [rad]."""
        angles: np.ndarray = self.data.qpos[self._qpos]
        return angles

    @property
    def x(self) -> np.ndarray:
        """Joint angles over velocities (2 n,) [rad], [rad/s], a copy."""
        if self._seen is not None:
            return np.concatenate(self._seen)
        return np.concatenate((self.data.qpos[self._qpos], self.data.qvel[self._dof]))

    @property
    def time(self) -> float:
        """Time [s]."""
        return float(self.data.time)

    def attachment(self, name: str) -> tuple[int, np.ndarray, np.ndarray]:
        """Body index of a body or site called ``name``, and its pose (R, p) in that body."""
        if not isinstance(name, str):
            raise ArgumentError(f"name is {shown(name)}; give that of a body or a site")
        index = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, name)
        if index >= 0:
            return index, np.eye(3), np.zeros(3)
        site = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SITE, name)
        if site < 0:
            names = (self.model.body(b).name for b in range(1, self.model.nbody))
            bodies = [body for body in names if body]
            sites = [self.model.site(s).name for s in range(self.model.nsite)]
            raise SimulationError(
                f"no body or site {shown(name)} in the scene; it has bodies {bodies} "
                f"and sites {sites}"
            )
        R = np.empty(9)
        mujoco.mju_quat2Mat(R, self.model.site_quat[site])
        position = self.model.site_pos[site].copy()
        return int(self.model.site_bodyid[site]), R.reshape(3, 3), position

    def begin(self) -> None:
        """Put things that hands take on their stands, once the objects are at their places."""
        if self._holds:
            self.grasps.begin(self.data)
            mujoco.mj_forward(self.model, self.data)

    def see(self, objects: Objects) -> Objects:
        """Objects, and the things that hands take where they are now."""
        return self.grasps.see(objects, self.data) if self._holds else objects

    @property
    def contacts(self) -> np.ndarray:
        """Geoms (c, 2) that touch now; what lies on something or is held is not among them."""
        touching: np.ndarray = self.data.contact.geom
        if self._holds and len(touching):
            return touching[~self.grasps.geoms[touching].any(axis=1)]
        return touching

    @property
    def touches(self) -> bool:
        """Whether something touches, beside what lies on something or is held."""
        count = self.data.ncon
        if not count or not self._holds:
            return bool(count)
        # Other contacts come and go with their number; one that takes another's place is seen soon.
        self._looks = self._looks % LOOKS + 1
        if count != self._count or self._looks == LOOKS:
            self._count, self._touch = count, bool(len(self.contacts))
        return self._touch

    @property
    def touching(self) -> str:
        """Two bodies that touch now, such as ``"upper_arm and table"``."""
        (geoms, *_), model = self.contacts, self.model
        return " and ".join(model.body(model.geom_bodyid[g]).name for g in geoms)

    def clear_wrenches(self) -> None:
        """Take away all wrenches from outside."""
        self._wrenches.fill(0.0)

    def apply_wrench(self, body: int, wrench: np.ndarray, point: np.ndarray) -> None:
        """Add force and torque (6,) on a body, acting at a point (3,) of the world [m]."""
        # MuJoCo applies at the centre of mass. In plain numbers: arrays so small cost more.
        (px, py, pz), (cx, cy, cz) = point.tolist(), self._centres[body].tolist()
        ax, ay, az = px - cx, py - cy, pz - cz
        fx, fy, fz, tx, ty, tz = wrench.tolist()
        applied = self._wrenches[body]
        gx, gy, gz, ux, uy, uz = applied.tolist()
        ux, uy, uz = ux + tx, uy + ty, uz + tz
        turned = ux + (ay * fz - az * fy), uy + (az * fx - ax * fz), uz + (ax * fy - ay * fx)
        applied[:] = gx + fx, gy + fy, gz + fz, *turned

    def step(self, torque: np.ndarray) -> None:
        """Advance one time step with joint torques (n,) [Nm]."""
        self._ctrl[self._actuator] = torque
        mujoco.mj_step(self.model, self.data)
        if self._holds:
            self.grasps.act(self.data)
