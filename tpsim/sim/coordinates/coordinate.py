"""Task coordinates y(q) and their Jacobians: what Table 3 projects into joint space.

Each candidate frame of a task is one coordinate of the robot. Around the present posture it is
an affine map from coordinates to joints, Eqs (39)-(41), ``q = J^+ mu + q - J^+ y``; in
information form its precision W enters joint space as ``J^T W J``. Orientation is observed as a
world-aligned rotation vector [rad] from a reference orientation, and the Jacobian is that of the
rotation vector, so it is exact far from the reference too.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import sqrt

import numpy as np
import pinocchio as pin
from scipy.linalg.lapack import dposv

from tpsim.errors import ArgumentError
from tpsim.sim.robot import Robot, as_slice

DAMPING = 0.01
"""Singular value of a hand's Jacobian below which its nullspace is no longer told apart [m/rad]."""

Evaluation = tuple[np.ndarray, np.ndarray]

Poses = tuple[np.ndarray, np.ndarray]
"""Positions (T, 3) [m] and quaternions (T, 4)."""


@dataclass(frozen=True)
class Coordinate:
    """A function y(q) of the robot; :meth:`bind` looks its names up once.

    Parameters
    ----------
    name : str
        What reports call it.
    """

    name: str

    def bind(self, robot: Robot) -> Callable[[], Evaluation]:
        """Return a function that gives y (d,) and J (d, n) of the robot's last update."""
        raise TypeError("a coordinate is one of HandPose, RelativePose, Posture")

    def observe(self, robot: Robot, q, objects: Mapping[str, Poses] | None = None) -> Evaluation:
        """Values (T, d) and Jacobians (T, d, n) along a movement.

        Parameters
        ----------
        robot : Robot
            Its state is lost.
        q : (T, n)
            Postures [rad].
        objects : mapping of str to (positions (T, 3), quaternions (T, 4)), optional
            Where the robot sees objects meanwhile [m].
        """
        evaluate = self.bind(robot)
        values, jacobians = [], []
        for t, posture in enumerate(np.ascontiguousarray(q)):
            for name, poses in (objects or {}).items():
                for seen, pose in zip(robot.objects[name], poses, strict=True):
                    seen[:] = pose[t]
            robot.update_kinematics(posture)
            y, J = evaluate()
            values.append(y.copy())
            jacobians.append(J.copy())
        return np.array(values), np.array(jacobians)


@dataclass(frozen=True)
class HandPose(Coordinate):
    """Position [m] and orientation [rad] of a site in the world, Eq. (40): d = 6.

    Parameters
    ----------
    site : str
        Point that is observed.
    reference : (9,) tuple
        Rotation matrix, row by row, at which the orientation is zero.
    """

    site: str
    reference: tuple[float, ...] = (1, 0, 0, 0, 1, 0, 0, 0, 1)

    labels = ("x [m]", "y [m]", "z [m]", "about x [rad]", "about y [rad]", "about z [rad]")

    def bind(self, robot):
        """Return a function that gives y (6,) and J (6, n) of the robot's last update."""
        site, R0 = robot.site(self.site), np.reshape(self.reference, (3, 3)).T.copy()
        y = np.zeros(6)

        def evaluate():
            R, p = robot.placement(site)
            error = R @ R0
            y[:3], y[3:] = p, pin.log3(error)
            J = robot.jacobian(site)
            J[3:] = pin.Jlog3(error).T @ J[3:]
            return y, J

        return evaluate


@dataclass(frozen=True)
class RelativePose(Coordinate):
    """Pose of a site seen from another site that moves too, Eq. (41): d = 6.

    Both depend on q, so the Jacobian is the relative one of both chains: "object" and hand
    move together.

    Parameters
    ----------
    site, other : str
        Point that is observed and the moving frame it is observed from.
    reference : (9,) tuple
        Relative rotation matrix, row by row, at which the orientation is zero.
    """

    site: str
    other: str
    reference: tuple[float, ...] = (1, 0, 0, 0, 1, 0, 0, 0, 1)

    labels = HandPose.labels

    def bind(self, robot):
        """Return a function that gives y (6,) and J (6, n) of the robot's last update."""
        site, other = robot.site(self.site), robot.site(self.other)
        R0 = np.reshape(self.reference, (3, 3)).T.copy()
        y = np.zeros(6)

        def evaluate():
            R, p = robot.placement(site)
            R_other, p_other = robot.placement(other)
            J_other = robot.jacobian(other)
            J = robot.jacobian(site) - J_other
            arm = p - p_other
            J[:3] += pin.skew(arm) @ J_other[3:]
            back = R_other.T
            error = back @ R @ R0
            y[:3], y[3:] = back @ arm, pin.log3(error)
            J[:3] = back @ J[:3]
            J[3:] = (pin.Jlog3(error).T @ back) @ J[3:]
            return y, J

        return evaluate


@dataclass(frozen=True)
class Posture(Coordinate):
    """Joint angles [rad] of some joints in a fixed frame, Eq. (39): d = number of joints.

    Parameters
    ----------
    joints : tuple of str
        Joint names.
    """

    joints: tuple[str, ...] = ()

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return tuple(f"{joint} [rad]" for joint in self.joints)

    def bind(self, robot):
        """Return a function that gives y (d,) and J (d, n) of the robot's last update."""
        index = np.array([robot.joints.index(joint) for joint in self.joints])
        J = np.eye(robot.n)[index]
        return lambda: (robot.q[index], J)


@dataclass(frozen=True)
class SelfMotion(Coordinate):
    """Posture seen through the nullspace of its hand, Eq. (42), for one redundant joint: d = 1.

    ``N = I - J^+ J`` of the hand's pose is then ``n n^T``, and the frame is observed along n:
    ``y = n^T (q - origin)`` [rad], what the arm does with its redundancy, the swivel of its elbow.
    It adds ``n W n^T`` in joint space and never competes with the hand. Angles are counted from a
    neutral posture, where the turning of n, which the Jacobian n^T leaves out, has no effect.

    Parameters
    ----------
    joints : tuple of str
        Joints of the arm: seven.
    site : str
        Hand whose pose has priority.
    origin : tuple of float
        Neutral posture of the arm [rad].
    """

    joints: tuple[str, ...] = ()
    site: str = ""
    origin: tuple[float, ...] = ()

    labels = ("along the nullspace [rad]",)

    def bind(self, robot):
        """Return a function that gives y (1,) and J (1, n) of the robot's last update."""
        if len(self.joints) != 7:
            raise ArgumentError(f"{len(self.joints)} joints given; an arm of 7 has one to spare")
        index = np.array([robot.joints.index(joint) for joint in self.joints])
        site, origin = robot.site(self.site), np.array(self.origin)
        posture = np.zeros(robot.n)
        posture[index] = origin
        robot.update_kinematics(posture)
        # Null vector at the neutral posture: it gives n its sign everywhere.
        towards = np.linalg.svd(robot.jacobian(site)[:, index])[2][-1]
        arm, J, damping = as_slice(index), np.zeros((1, robot.n)), DAMPING**2 * np.eye(6)

        def evaluate():
            J_hand = robot.jacobian(site)[:, arm]
            # n is what N leaves of it, by the normal equations: an SVD costs ten times as much.
            n = towards - J_hand.T @ dposv(J_hand @ J_hand.T + damping, J_hand @ towards)[1]
            n /= sqrt(n @ n)
            J[0, arm] = n
            return np.array([n @ (robot.q[arm] - origin)]), J

        return evaluate
