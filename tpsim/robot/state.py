"""The robot at one instant: an immutable value from which everything else is computed."""

from typing import TYPE_CHECKING

import numpy as np

from tpsim.pose import Pose
from tpsim.robot.objects import NONE, Objects

if TYPE_CHECKING:
    from tpsim.robot.robot import Robot
    from tpsim.robot.views.view import Seen, View


class State:
    """Joint angles, velocities and objects of one instant, with what follows from them.

    Made by :meth:`tpsim.robot.robot.Robot.at`. Inertia, bias, poses and Jacobians are computed
    when they are first asked for, and kept. A state never changes.

    Attributes
    ----------
    robot : Robot
        The model that these quantities are computed with.
    x : (2 n,)
        Joint angles [rad] over joint velocities [rad/s].
    q, dq : (n,)
        The two halves of ``x``.
    time : float
        [s]
    objects : Objects
        Poses and velocities of the objects that the robot knows of.
    """

    __slots__ = (
        "_bias",
        "_jacobians",
        "_mass",
        "_poses",
        "dq",
        "objects",
        "q",
        "robot",
        "seen",
        "time",
        "x",
    )

    def __init__(self, robot: "Robot", x: np.ndarray, objects: Objects = NONE, time: float = 0.0):
        self.robot, self.x, self.objects, self.time = robot, x, objects, time
        self.q, self.dq = x[: robot.n], x[robot.n :]
        self._bias: np.ndarray | None = None
        self._mass: np.ndarray | None = None
        self._poses: dict[str, Pose] = {}
        self._jacobians: dict[str, np.ndarray] = {}
        self.seen: dict[int, tuple[View, Seen]] = {}

    def __deepcopy__(self, memo: dict) -> "State":
        """Return itself: what never changes need not be copied."""
        return self

    @property
    def bias(self) -> np.ndarray:
        """Coriolis, centrifugal and gravity torque (n,) [Nm]."""
        if self._bias is None:
            self._bias = self.robot.compute_bias(self.q, self.dq)
        return self._bias

    @property
    def mass(self) -> np.ndarray:
        """Inertia M(q) (n, n) with armature [kg m^2]."""
        if self._mass is None:
            self._mass = self.robot.compute_mass(self.q)
        return self._mass

    @property
    def gravity(self) -> np.ndarray:
        """Torque (n,) [Nm] that holds the robot still."""
        return self.robot.compute_gravity(self.q)

    @property
    def potential_energy(self) -> float:
        """Energy [J] of gravity and of the joints' own springs."""
        return self.robot.compute_energy(self.q)

    def pose(self, site: str) -> Pose:
        """Pose of a site in the world."""
        found = self._poses.get(site) if isinstance(site, str) else None
        if found is None:
            found = self.robot.compute_pose(self, site)
            self._poses[site] = found
        return found

    def jacobian(self, site: str) -> np.ndarray:
        """Jacobian (6, n) of a site: linear over angular velocity, world-aligned."""
        found = self._jacobians.get(site) if isinstance(site, str) else None
        if found is None:
            found = self.robot.compute_jacobian(self, site)
            self._jacobians[site] = found
        return found

    def twist(self, site: str) -> np.ndarray:
        """Linear over angular velocity (6,) of a site, world-aligned [m/s], [rad/s]."""
        twist: np.ndarray = self.jacobian(site).dot(self.dq)
        return twist
