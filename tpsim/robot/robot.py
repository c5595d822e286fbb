"""The controller's model of a robot: its arms, their limits, kinematics and dynamics.

Pinocchio computes; its model is built from the compiled MuJoCo model, so there is one source.
Nothing here imports MuJoCo before a robot is taken in from a file: on a real arm there is none.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from tpsim.checks import finite_array, number, shown
from tpsim.errors import ArgumentError, SimulationError
from tpsim.pose import Pose
from tpsim.robot.indices import Indices, Names
from tpsim.robot.mechanism import RUBBING, Mechanism
from tpsim.robot.objects import NONE, Objects
from tpsim.robot.state import State

if TYPE_CHECKING:
    import mujoco

    from tpsim.robot.description import Description
    from tpsim.robot.gripper import Gripper
    from tpsim.robot.home import Home
    from tpsim.robot.in_mujoco import InMujoco
    from tpsim.robot.intake import Source
    from tpsim.robot.limits import Limit

_ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


class Robot:
    """A torque-controlled robot, immutable: arms of hinges and slides, from MJCF or URDF.

    Parameters
    ----------
    mechanism : Mechanism
    simulated : InMujoco, optional
        Where it is in a simulation; a robot that is deployed has none.

    Attributes
    ----------
    joints : tuple of str
        Arm joints, in the order of q (n,); n is their number.
    hands : dict of str to str
        Site of each hand.
    lower, upper, velocity_limit, torque_limit : (n,)
        Limits in rad, rad/s, Nm (m, m/s, N for slides); infinite where there is none.
    home : (n,)
        Home posture [rad].
    damping, friction : (n,)
        Viscous damping [Nms/rad] and Coulomb friction [Nm] of the joints, which controllers
        compensate.
    """

    def __init__(self, mechanism: Mechanism, simulated: "InMujoco | None" = None):
        self.mechanism, self._simulated = mechanism, simulated
        self.joints, self.n = mechanism.joints, len(mechanism.joints)
        self.hands, self.sites = dict(mechanism.hands), mechanism.sites
        self._pin = mechanism.model
        self._dynamics, self._kinematics = self._pin.createData(), self._pin.createData()
        self._placed: State | None = None
        self._indices = Indices(self.joints, self.chain)
        self.lower, self.upper, self.home = mechanism.lower, mechanism.upper, mechanism.home
        self.velocity_limit = mechanism.velocity_limit
        self.torque_limit, self.damping = mechanism.torque_limit, mechanism.damping
        self.friction, self.has_friction = mechanism.friction, bool(mechanism.friction.any())
        self._springs, self._slack = mechanism.springs, mechanism.slack
        self._sprung = bool(self._springs.any())
        self._below = np.tri(self.n, k=-1, dtype=bool)
        for array in (self.lower, self.upper, self.velocity_limit, self.home, self.torque_limit):
            array.flags.writeable = False
        self.at_home = self.at(self.home)

    @classmethod
    def of(
        cls,
        model: "mujoco.MjModel",
        description: "Description",
        source: "Source | None" = None,
    ) -> "Robot":
        """Robot in a compiled scene, in which every arm joint has a motor."""
        from tpsim.robot.in_mujoco import found_in

        return cls(*found_in(model, description, source))

    @classmethod
    def from_mjcf(
        cls,
        source: "str | Path | mujoco.MjSpec",
        hands: "Mapping[str, str | Gripper]",
        *,
        torque_limit: "Limit" = None,
        velocity_limit: "Limit" = None,
        home: "Home" = None,
        others: Literal["locked", "servo"] = "locked",
    ) -> "Robot":
        """Take over a robot from MJCF: any actuators become torque motors.

        Parameters
        ----------
        source : path, MJCF text or MjSpec
            Meshes, includes and defaults are resolved.
        hands : mapping of str to str or Gripper
            Site of each hand, or where it grips: a site called as the hand is then added. The
            joints between the world and these sites are the arms.
        torque_limit, velocity_limit : optional
            [Nm], [rad/s]: a number, one for each joint (n,), or by joint name or regular
            expression; by default what the file says.
        home : (n,) or mapping of joint name to angle, optional
            Home posture [rad]: by default the file's keyframe, or found by optimisation.
        others : str
            Joints that are no arm, such as fingers: ``"locked"`` where they are, or kept under
            their own ``"servo"``.

        Raises
        ------
        SimulationError, ArgumentError
            What cannot be taken over, with what the file has.
        """
        from tpsim.robot.intake import take_in

        limits = {"torque_limit": torque_limit, "velocity_limit": velocity_limit}
        return cls.of_source(take_in(source, hands=hands, home=home, others=others, **limits))

    @classmethod
    def of_source(cls, found: "Source") -> "Robot":
        """Robot of what the intake took over."""
        from tpsim.robot.description import Description
        from tpsim.robot.reading import compiled_text

        model = compiled_text(found.spec.to_xml(), dict(found.assets))
        return cls.of(model, Description.of(found), found)

    @classmethod
    def from_urdf(
        cls,
        path: str | Path,
        hands: "Mapping[str, str | Gripper]",
        *,
        packages: Mapping[str, str | Path] | None = None,
        torque_limit: "Limit" = None,
        velocity_limit: "Limit" = None,
        home: "Home" = None,
    ) -> "Robot":
        """Take over a robot from a URDF; ``hands`` may name links, ``packages`` where meshes are.

        Joints that are no arm are locked. Other arguments and errors are those of
        :meth:`from_mjcf`.
        """
        from tpsim.robot.intake import take_in_urdf

        limits = {"torque_limit": torque_limit, "velocity_limit": velocity_limit}
        return cls.of_source(
            take_in_urdf(path, hands=hands, home=home, packages=packages, **limits)
        )

    @property
    def simulated(self) -> "InMujoco":
        """Where the robot is in MuJoCo: model, description, and addresses of the joints."""
        if self._simulated is None:
            raise SimulationError("this robot belongs to a policy: it cannot be simulated")
        return self._simulated

    @property
    def model(self) -> "mujoco.MjModel":
        """The compiled MuJoCo model."""
        return self.simulated.model

    @property
    def description(self) -> "Description":
        """What a scene file does not say about the robot."""
        return self.simulated.description

    @property
    def changes(self) -> tuple[str, ...]:
        """What the intake changed, in words."""
        source = self.simulated.source
        return () if source is None else source.changes

    @property
    def source(self) -> "Source":
        """Specification and files of the robot alone, for scenes to be composed with it."""
        source = self.simulated.source
        if source is None:
            raise SimulationError(
                "this robot was read from a recorded scene; compose scenes with Robot.from_mjcf"
            )
        return source

    def at(
        self,
        q: ArrayLike,
        dq: ArrayLike | None = None,
        objects: Objects | Mapping[str, Pose] = NONE,
        time: float = 0.0,
    ) -> State:
        """State at joint angles q (n,) [rad] and velocities dq (n,) [rad/s], zero by default."""
        q, dq = self.posture("q", q), np.zeros(self.n) if dq is None else self.posture("dq", dq)
        x = np.concatenate((q, dq))
        x.flags.writeable = False
        known = objects if isinstance(objects, Objects) else Objects.of(objects, "objects")
        return State(self, x, known, number("time", time))

    def posture(self, name: str, q: ArrayLike) -> np.ndarray:
        """One finite number for each joint (n,), or an ArgumentError that calls it ``name``."""
        found = finite_array(name, q)
        if found.shape != (self.n,):
            wanted = f"the robot has {self.n} joints: give {self.n} finite numbers"
            raise ArgumentError(f"{name} has shape {found.shape}; {wanted}")
        return found

    def index(self, joints: Names) -> np.ndarray:
        """Indices (k,) in q of joints: a regular expression of whole names, names, or a chain."""
        return self._indices.find(joints)

    def span(self, joints: Names) -> slice | np.ndarray:
        """The same indices as a slice, where they follow each other."""
        return self._indices.span(joints)

    def chain(self, site: str) -> np.ndarray:
        """Indices (k,) in q of the joints that move a site."""
        frame = self._pin.frames[self.frame_of(site)]
        supports = self._pin.supports[frame.parentJoint]
        return np.array([joint - 1 for joint in supports if joint > 0], int)

    def gravity_torque(self, q: ArrayLike) -> np.ndarray:
        """Torque (n,) [Nm] that holds the robot still at q (n,)."""
        return self.compute_gravity(self.posture("q", q))

    def friction_torque(self, dq: np.ndarray) -> np.ndarray:
        """Torque (n,) [Nm] against friction at dq (n,), smooth, never more than it takes."""
        torque: np.ndarray = self.friction * np.tanh(dq / RUBBING)
        return torque

    def is_comfortable(self, q: np.ndarray, margin: float = 0.15, load: float = 0.8) -> bool:
        """Whether a posture q (n,) keeps off its limits by a margin [rad], with torque to spare.

        ``load`` is the largest share of the motors' torque that gravity may take.
        """
        q, margin, load = self.posture("q", q), number("margin", margin), number("load", load)
        room = np.minimum(q - self.lower, self.upper - q).min()
        weight = np.abs(self.gravity_torque(q)) / self.torque_limit
        return bool(room > margin and weight.max() < load)

    def frame_of(self, site: str) -> int:
        """Frame of a site in Pinocchio's model."""
        if not isinstance(site, str) or site not in self.sites:
            raise SimulationError(f"no site {shown(site)} on the robot, only {sorted(self.sites)}")
        return self.sites[site]

    def compute_gravity(self, q: np.ndarray) -> np.ndarray:
        """Gravity and spring torque (n,) [Nm]."""
        return self._with_springs(pin.computeGeneralizedGravity(self._pin, self._dynamics, q), q)

    def compute_bias(self, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        """Coriolis, centrifugal, gravity and spring torque (n,) [Nm]."""
        return self._with_springs(pin.nonLinearEffects(self._pin, self._dynamics, q, dq), q)

    def compute_torque(self, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> np.ndarray:
        """Torque (n,) [Nm] that accelerates the joints by ddq (n,): ``M ddq`` + bias, at once."""
        return self._with_springs(pin.rnea(self._pin, self._dynamics, q, dq, ddq), q)

    def _with_springs(self, torque: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Torque against the joints' own springs, added; most robots have none."""
        return torque + self._springs * (q - self._slack) if self._sprung else torque

    def compute_energy(self, q: np.ndarray) -> float:
        """Potential energy [J] of gravity and of the joints' own springs."""
        springs = 0.5 * float(self._springs @ (q - self._slack) ** 2) if self._sprung else 0.0
        return springs + float(pin.computePotentialEnergy(self._pin, self._dynamics, q))

    def compute_mass(self, q: np.ndarray) -> np.ndarray:
        """Inertia (n, n) with armature."""
        upper = pin.crba(self._pin, self._dynamics, q)
        # crba fills the upper triangle only.
        return np.where(self._below, upper.T, upper)

    def _place(self, state: State) -> None:
        if self._placed is not state:
            pin.computeJointJacobians(self._pin, self._kinematics, state.q)
            pin.updateFramePlacements(self._pin, self._kinematics)
            self._placed = state

    def compute_pose(self, state: State, site: str) -> Pose:
        """Pose of a site in the world."""
        frame = self.frame_of(site)
        self._place(state)
        placement = self._kinematics.oMf[frame].homogeneous
        return Pose(placement[:3, :3], placement[:3, 3])

    def compute_jacobian(self, state: State, site: str) -> np.ndarray:
        """Jacobian (6, n) of a site, world-aligned."""
        frame = self.frame_of(site)
        self._place(state)
        return pin.getFrameJacobian(self._pin, self._kinematics, frame, _ALIGNED).reshape(6, -1)
