"""A scene that is stepped: MuJoCo state, motors, and wrenches from outside."""

import mujoco
import numpy as np

from tpsim.errors import SimulationError
from tpsim.sim.robot import Robot, as_slice


class Simulation:
    """One compiled scene with its robot and its state.

    Parameters
    ----------
    xml : str
        MJCF text of the scene. It is compiled from the text and from nothing else, so that the
        ``scene.xml`` of a run folder repeats the run bit for bit.

    Attributes
    ----------
    model, data : mujoco.MjModel, mujoco.MjData
    robot : Robot
    objects : dict of str to (position (3,), quaternion (4,))
        Where the movable objects (mocap bodies) are [m]: views of MuJoCo's own arrays, for the
        robot to see and for :mod:`tpsim.sim.objects` to move.
    home : (n,)
        Joint angles of the keyframe ``home`` [rad].
    """

    def __init__(self, xml: str):
        try:
            self.model = mujoco.MjModel.from_xml_string(xml)
        except ValueError as error:
            raise SimulationError(f"the scene does not compile: {error}") from None
        self.xml = xml
        self.data = mujoco.MjData(self.model)
        self.robot = Robot(self.model)
        self.objects = self.robot.objects = self._movable()
        self._qpos, self._dof = as_slice(self.robot.qpos), as_slice(self.robot.dof)
        self._actuator = as_slice(self.robot.actuator)
        self._states = self.data.qpos, self.data.qvel, self.data.ctrl
        key = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_KEY, "home")
        if key < 0:
            raise SimulationError("the scene has no keyframe 'home'; add one to say how it starts")
        self.home = self.model.key_qpos[key][self._qpos].copy()
        self.timestep = float(self.model.opt.timestep)

    def _movable(self):
        pose = self.data.mocap_pos, self.data.mocap_quat
        return {
            self.model.body(body).name: tuple(part[index] for part in pose)
            for body, index in enumerate(self.model.body_mocapid)
            if index >= 0
        }

    def reset(self, q) -> None:
        """Put the robot at rest at q (n,) and the clock at zero."""
        q = np.asarray(q, float)
        robot = self.robot
        if q.shape != (robot.n,) or not np.isfinite(q).all():
            raise SimulationError(
                f"a start posture of shape {q.shape} was given; give {robot.n} finite joint angles"
            )
        outside = (q < robot.lower) | (q > robot.upper)
        if outside.any():
            names = [robot.joints[i] for i in np.flatnonzero(outside)]
            raise SimulationError(f"the start posture is outside the limits of {names}")
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self._qpos] = q
        mujoco.mj_forward(self.model, self.data)

    @property
    def q(self) -> np.ndarray:
        """Joint angles (n,) [rad]."""
        return self._states[0][self._qpos]

    @property
    def dq(self) -> np.ndarray:
        """Joint velocities (n,) [rad/s]."""
        return self._states[1][self._dof]

    @property
    def time(self) -> float:
        """Time [s]."""
        return self.data.time

    def attachment(self, name: str) -> tuple[int, np.ndarray, np.ndarray]:
        """Body index of a body or site called ``name``, and its pose (R, p) in that body."""
        index = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, name)
        if index >= 0:
            return index, np.eye(3), np.zeros(3)
        site = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SITE, name)
        if site < 0:
            bodies = [self.model.body(b).name for b in range(1, self.model.nbody)]
            sites = [self.model.site(s).name for s in range(self.model.nsite)]
            raise SimulationError(
                f"no body or site '{name}' in the scene; it has bodies {bodies} and sites {sites}"
            )
        R = np.empty(9)
        mujoco.mju_quat2Mat(R, self.model.site_quat[site])
        position = self.model.site_pos[site].copy()
        return int(self.model.site_bodyid[site]), R.reshape(3, 3), position

    def clear_wrenches(self) -> None:
        """Take away all wrenches from outside."""
        self.data.xfrc_applied[:] = 0

    def apply_wrench(self, body: int, wrench, point) -> None:
        """Add force and torque (6,) on a body, acting at a point (3,) of the world [m]."""
        # MuJoCo applies at the centre of mass.
        ax, ay, az = point - self.data.xipos[body]
        fx, fy, fz = wrench[:3]
        applied = self.data.xfrc_applied[body]
        applied += wrench
        applied[3] += ay * fz - az * fy
        applied[4] += az * fx - ax * fz
        applied[5] += ax * fy - ay * fx

    def step(self, torque) -> None:
        """Advance one time step with joint torques (n,) [Nm]."""
        self._states[2][self._actuator] = torque
        mujoco.mj_step(self.model, self.data)
