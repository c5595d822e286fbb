"""Coordinates of pointing: where an axis of a site looks, and the posture that is left free by it.

A direction is measured by the angles [rad] between two unit vectors: the logarithm on the unit
sphere, one angle in the plane, two in space. The axes of the site say which: the first one points,
the angles are those towards the others. ``(0, 1)`` is the x axis of a planar arm, ``(2, 0, 1)``
the z axis of a gripper.
"""

from dataclasses import dataclass
from math import atan2, hypot

import numpy as np
import pinocchio as pin
from scipy.linalg.lapack import dposv

from tpsim.sim.coordinates.coordinate import Coordinate

NEAR = 0.1
"""Distance [m] to an object below which its direction fades."""

BEHIND = 0.2
"""Sine of the angle to the opposite direction below which sideways turning counts no more."""

DAMPING = 1e-3
"""Singular value of a direction's Jacobian below which its nullspace grows [rad/rad]."""


@dataclass(frozen=True)
class Direction(Coordinate):
    """Direction of a site's axis in the robot's frame, Eq. (40): d = number of axes - 1.

    In the plane it is the angle of orientation; its Jacobian is made of the orientation part of
    the site's.

    Parameters
    ----------
    site : str
    axes : tuple of int
        Axes of the site, the one that points first.
    reference : (9,) tuple
        Rotation matrix of the site, row by row, at which the angles are zero.
    """

    site: str
    axes: tuple[int, ...] = (0, 1)
    reference: tuple[float, ...] = (1, 0, 0, 0, 1, 0, 0, 0, 1)

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return _labels(self.axes)

    def bind(self, robot):
        """Return a function that gives y (d,) and J (d, n) of the robot's last update."""
        site, pointing = robot.site(self.site), self.axes[0]
        views = np.reshape(self.reference, (3, 3)).T[list(self.axes)]

        def evaluate():
            R, _ = robot.placement(site)
            axis = R[:, pointing]
            y, slope = _angles(views @ axis)
            return y, -(slope @ views) @ pin.skew(axis) @ robot.jacobian(site)[3:]

        return evaluate


@dataclass(frozen=True)
class DirectionTo(Coordinate):
    """Direction in which a site sees an object, from its own axes, Eq. (41): zero if it points.

    The object's frame moves with the object, and the bearing with the site: the Jacobian holds
    the turning of the axis and the travel of the site past the object.

    Parameters
    ----------
    site : str
    target : str
        A movable object.
    axes : tuple of int
        Axes of the site, the one that points first.
    """

    site: str
    target: str
    axes: tuple[int, ...] = (0, 1)

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return _labels(self.axes)

    def bind(self, robot):
        """Return a function that gives y (d,) and J (d, n) of the robot's last update."""
        site, axes = robot.site(self.site), list(self.axes)
        seen, _ = robot.objects[self.target]

        def evaluate():
            R, p = robot.placement(site)
            J, sight = robot.jacobian(site), seen - p
            views = R.T[axes]
            y, slope = _angles(views @ sight)
            slope = slope @ views
            return y, slope @ pin.skew(sight) @ J[3:] - slope @ J[:3]

        return evaluate


@dataclass(frozen=True)
class PostureBeneath(Coordinate):
    """Posture of an arm in the nullspace of another coordinate, Eq. (42): d = free joints.

    ``N (q - q_0)`` with ``N = I - J^+ J`` is what the arm does with the freedom that the other
    coordinate leaves. It never competes with what comes first. Since N has not full rank, the
    shares of some joints say all: those of the others are left out, for a Gaussian would take the
    lack of freedom for precision.

    Parameters
    ----------
    joints : tuple of str
        Joints of the arm.
    first : Direction or DirectionTo
        What has priority.
    free : tuple of str
        The joints that are observed, as many as the nullspace has dimensions.
    origin : tuple of float
        Posture q_0 from which the joints' angles count [rad]: near it, y does not feel how N
        turns.
    """

    joints: tuple[str, ...]
    first: Direction | DirectionTo
    free: tuple[str, ...]
    origin: tuple[float, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return tuple(f"{joint} [rad]" for joint in self.free)

    def bind(self, robot):
        """Return a function that gives y (d,) and J (d, n) of the robot's last update."""
        index = np.array([robot.joints.index(joint) for joint in self.joints])
        first, origin = self.first.bind(robot), np.array(self.origin)
        free = [self.joints.index(joint) for joint in self.free]
        J, everything = np.zeros((len(free), robot.n)), np.eye(len(index))
        damping = DAMPING**2 * np.eye(len(self.first.axes) - 1)

        def evaluate():
            J_first = first()[1][:, index]
            N = everything - J_first.T @ dposv(J_first @ J_first.T + damping, J_first)[1]
            J[:, index] = N[free]
            return N[free] @ (robot.q[index] - origin), J

        return evaluate


def _angles(v):
    """Angles (d,) of a vector v (d + 1,) from its first axis, and their derivative (d, d + 1).

    Both are bounded: close to the opposite direction, where the logarithm is singular, sideways
    turning counts no more; a vector shorter than NEAR has the angles of one that long, scaled down
    in proportion, since its direction means little. In plain numbers: arrays so small cost more.
    """
    ahead, *across = v.tolist()
    wide = hypot(*across)
    length = hypot(ahead, wide)
    sine, cosine = (wide / length, ahead / length) if length else (0.0, 1.0)
    # Straight ahead and straight behind, any way around is as good as any other.
    heading = [a / wide for a in across] if wide else [1.0, 0.0][: len(across)]
    angle = atan2(sine, cosine)
    stretch = angle / max(sine, BEHIND) if cosine < 0 else angle / sine if sine else 1.0
    grow = max(length, NEAR)
    fade = angle if length < NEAR else 0.0
    derivative = [
        [(fade * cosine - sine) * h / grow]
        + [
            ((cosine - stretch + fade * sine) * h * g + stretch * (i == k)) / grow
            for k, g in enumerate(heading)
        ]
        for i, h in enumerate(heading)
    ]
    return np.array([length / grow * angle * h for h in heading]), np.array(derivative)


def _labels(axes):
    names = "xyz"
    return tuple(f"towards {names[axis]} [rad]" for axis in axes[1:])
