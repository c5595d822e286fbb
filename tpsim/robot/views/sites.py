"""Views of sites: pose, position, orientation and axes, in the world or from something else."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import pinocchio as pin

from tpsim import rotation
from tpsim.border import border, checked
from tpsim.errors import ArgumentError
from tpsim.manifold.manifold import S3, Manifold
from tpsim.pose import Pose
from tpsim.robot.along import Along
from tpsim.robot.objects import Moving
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.robot.views.direction import AXES, Direction
from tpsim.robot.views.view import Seen, View

LABELS: dict[str, tuple[str, ...]] = {
    "position": ("x [m]", "y [m]", "z [m]"),
    "orientation": ("about x [rad]", "about y [rad]", "about z [rad]"),
    "quaternion": ("w", "x", "y", "z"),
}
LABELS["pose"] = LABELS["position"] + LABELS["orientation"]
"""Names of the dimensions of a pose and of its parts."""

Rotation = tuple[float, ...]
"""Rotation matrix (9,), row by row: a value that can be compared and written to a file."""


@dataclass(frozen=True)
class Object:
    """An object of the scene, by name: what views look from or at."""

    name: str

    def __post_init__(self) -> None:
        checked(self)


@dataclass(frozen=True)
class Site:
    """A site of the robot, by name; its attributes are views.

    ``Site("tool").pose`` is the pose in the world, Eq. (40); ``Site("tool").seen_from(...)`` the
    same from an object or from another site, Eq. (41).

    Parameters
    ----------
    name : str
    """

    name: str

    def __post_init__(self) -> None:
        checked(self)

    @property
    def pose(self) -> "SiteView":
        """Position [m] and rotation vector [rad], d = 6."""
        return SiteView(self.name, None, "pose")

    @property
    def position(self) -> "SiteView":
        """Position [m], d = 3."""
        return SiteView(self.name, None, "position")

    @property
    def orientation(self) -> "SiteView":
        """Rotation vector [rad] from the orientation at home, d = 3."""
        return SiteView(self.name, None, "orientation")

    @property
    def quaternion(self) -> "SiteView":
        """Orientation on its manifold S3: unit quaternion (w, x, y, z), from no base."""
        return SiteView(self.name, None, "quaternion")

    @border
    def axis(
        self, axis: Literal["x", "y", "z"], across: str = "", reference: np.ndarray | None = None
    ) -> Direction:
        """Direction in which an axis of the site points, Eq. (40).

        Parameters
        ----------
        axis : str
            The axis that points.
        across : str
            Axes towards which angles are measured: both others by default, one in a plane.
        reference : (3, 3), optional
            Orientation of the site at which the angles are zero; that at home by default.
        """
        others = across or "".join(AXES[(AXES.index(axis) + k) % 3] for k in (1, 2))
        turned = None if reference is None else as_rotation(reference)
        return Direction(self.name, axis + others, turned)

    def seen_from(self, base: "Object | Site") -> "Sight":
        """The site as it is seen from an object or from another site, Eq. (41)."""
        return Sight(self, base)


@dataclass(frozen=True)
class Sight:
    """A site seen from an object or another site; its attributes are views.

    Parameters
    ----------
    site : Site
    base : Object or Site
    """

    site: Site
    base: Object | Site

    def __post_init__(self) -> None:
        checked(self)

    @property
    def pose(self) -> "SiteView":
        """Position [m] and rotation vector [rad], d = 6."""
        return SiteView(self.site.name, self.base, "pose")

    @property
    def position(self) -> "SiteView":
        """Position [m], d = 3."""
        return SiteView(self.site.name, self.base, "position")

    @property
    def orientation(self) -> "SiteView":
        """Rotation vector [rad], d = 3."""
        return SiteView(self.site.name, self.base, "orientation")

    @property
    def quaternion(self) -> "SiteView":
        """Orientation on its manifold S3: unit quaternion (w, x, y, z), from no base."""
        return SiteView(self.site.name, self.base, "quaternion")


@dataclass(frozen=True)
class SiteView(View):
    """Pose, position or orientation of a site, in the world or from something else.

    Orientation is the world-aligned rotation vector ``log(R C^T)`` [rad] from a reference C, and
    its Jacobian is that of the rotation vector, exact far from the reference too. When the base
    is a site, its own motion is in the Jacobian; when it is an object, in the drift.

    A quaternion needs no reference: it is a point of S3, and its Jacobian (3, n) and drift (3,)
    are of the angular velocity, the tangent vector there.

    Parameters
    ----------
    site : str
    base : Object, Site or None
        From where it is seen; None is the world.
    part : str
        ``"pose"``, ``"position"``, ``"orientation"`` or ``"quaternion"``.
    reference : (9,) tuple, optional
        C: by default the orientation that is seen at home; of an object, its own axes.
    """

    site: str
    base: Object | Site | None
    part: Literal["pose", "position", "orientation", "quaternion"]
    reference: Rotation | None = None

    def __post_init__(self) -> None:
        checked(self)

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        return LABELS[self.part]

    @property
    def curved(self) -> bool:
        """Whether it is a quaternion."""
        return self.part == "quaternion"

    def manifold(self, robot: Robot) -> Manifold:
        """S3 of a quaternion, else R^n."""
        return S3 if self.curved else super().manifold(robot)

    def kinds(self, robot: Robot) -> tuple[str, ...]:
        """Kinds of the dimensions."""
        return ("angle",) * 4 if self.curved else super().kinds(robot)

    def about(self, reference: np.ndarray) -> "SiteView":
        """The same with rotation vectors counted from a rotation (3, 3)."""
        return replace(self, reference=as_rotation(reference))

    def see(self, state: State) -> Seen:
        """Value, Jacobian and drift at a state."""
        base, arm, p = self._place(state)
        J, drift = self._moving(state, base, arm)
        if self.part == "position":
            return Seen(p, J[:3], drift[:3])
        R = self._rotation(state, base)
        if self.part == "quaternion":
            return Seen(_quaternion(R), J[3:], drift[3:])
        error = R.dot(self.resolved(state.robot, self._back))
        turning = pin.Jlog3(error).T
        if self.part == "orientation":
            return Seen(pin.log3(error), turning @ J[3:], turning @ drift[3:])
        # Written into place: for matrices so small, joining them costs more than computing them.
        value, jacobian = np.empty(6), np.empty(J.shape)
        value[:3], value[3:] = p, pin.log3(error)
        jacobian[:3] = J[:3]
        turning.dot(J[3:], out=jacobian[3:])
        if drift is not _STILL:
            drift = np.concatenate((drift[:3], turning @ drift[3:]))
        return Seen(value, jacobian, drift)

    def along(self, movement: Along) -> np.ndarray:
        """Values along a movement."""
        seen = movement.pose(self.site)
        if self.base is not None:
            of = movement.pose if isinstance(self.base, Site) else movement.object
            seen = of(self.base.name).inverse @ seen
        if self.part == "position":
            return seen.position
        if self.part == "quaternion":
            return seen.quaternion
        turned = rotation.log(seen.rotation @ self.resolved(movement.robot, self._back))
        return turned if self.part == "orientation" else np.hstack((seen.position, turned))

    def rows(self, state: State) -> np.ndarray:
        """Jacobian up to an invertible map of its rows."""
        if isinstance(self.base, Site):
            return self(state).jacobian
        return state.jacobian(self.site)[_ROWS[self.part]]

    def _place(self, state: State) -> tuple[Pose | Moving | None, np.ndarray, np.ndarray]:
        """The base, the way (3,) from it to the site in the world, and as the base sees it."""
        p = state.pose(self.site).position
        if self.base is None:
            return None, p, p
        name = self.base.name
        base = state.pose(name) if isinstance(self.base, Site) else state.objects[name]
        arm = p - base.position
        return base, arm, base.rotation.T @ arm

    def _rotation(self, state: State, base: Pose | Moving | None) -> np.ndarray:
        """Rotation (3, 3) of the site as the base sees it."""
        R = state.pose(self.site).rotation
        return R if base is None else base.rotation.T.dot(R)

    def _moving(
        self, state: State, base: Pose | Moving | None, arm: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Jacobian (6, n) of the velocities, and drift (6,), from the base."""
        J, drift = state.jacobian(self.site), _STILL
        if base is None:
            return J, drift
        back = base.rotation.T
        if isinstance(self.base, Site):
            J_base = state.jacobian(self.base.name)
            J = J - J_base
            J[:3] += pin.skew(arm).dot(J_base[3:])
        elif isinstance(base, Moving) and state.objects.twists is not None:
            v, omega = base.velocity, base.angular_velocity
            drift = np.empty(6)
            drift[:3] = back.dot(pin.skew(arm).dot(omega) - v)
            drift[3:] = -back.dot(omega)
        return np.matmul(back, J.reshape(2, 3, -1)).reshape(6, -1), drift

    def _back(self, robot: Robot) -> np.ndarray:
        """Transposed reference rotation (3, 3)."""
        if self.reference is not None:
            return np.reshape(self.reference, (3, 3)).T.copy()
        if isinstance(self.base, Object):
            return np.eye(3)
        home = robot.at_home
        return self._rotation(home, self._place(home)[0]).T.copy()


def _quaternion(R: np.ndarray) -> np.ndarray:
    """Unit quaternion (4,), w first, of a rotation (3, 3)."""
    return np.roll(pin.Quaternion(R).coeffs(), 1)


_STILL = np.zeros(6)
_TURNING = slice(3, 6)
_ROWS = {
    "position": slice(0, 3),
    "orientation": _TURNING,
    "quaternion": _TURNING,
    "pose": slice(0, 6),
}


def as_rotation(matrix: np.ndarray) -> Rotation:
    """Rotation matrix (3, 3) as a value."""
    if matrix.shape != (3, 3):
        raise ArgumentError(f"reference has shape {matrix.shape}; give a rotation (3, 3)")
    return tuple(matrix.reshape(9).tolist())
