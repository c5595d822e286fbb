"""Views of pointing: where an axis of a site looks.

A direction is measured by the angles [rad] between two unit vectors: the logarithm on the unit
sphere, one angle in the plane, two in space.
"""

from dataclasses import dataclass
from math import atan2, hypot
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from tpsim.border import checked
from tpsim.checks import shown
from tpsim.errors import ArgumentError
from tpsim.robot.along import Along
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.robot.views.view import Seen, View

if TYPE_CHECKING:
    from tpsim.robot.views.sites import Object

AXES = "xyz"

NEAR = 0.1
"""Distance [m] to an object below which its direction fades."""

BEHIND = 0.2
"""Sine of the angle to the opposite direction below which sideways turning counts no more."""


@dataclass(frozen=True)
class Direction(View):
    """Direction of a site's axis in the world, Eq. (40): d = number of axes - 1.

    In the plane it is the angle of orientation.

    Parameters
    ----------
    site : str
    axes : str
        The axis that points, then those towards which angles are measured: ``"zxy"``.
    reference : (9,) tuple, optional
        Rotation of the site, row by row, at which the angles are zero; that at home by default.
    """

    site: str
    axes: str
    reference: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        checked(self)
        _check_axes(self.axes)
        if self.reference is not None and len(self.reference) != 9:
            raise ArgumentError(f"reference has {len(self.reference)} numbers; give 9, row by row")

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        return tuple(f"towards {axis} [rad]" for axis in self.axes[1:])

    def towards(self, target: "Object") -> "Bearing":
        """Direction to an object, as the site sees it, Eq. (41)."""
        if not isinstance(name := getattr(target, "name", None), str):
            raise ArgumentError(f"target is {shown(target)}; give an Object")
        return Bearing(self.site, name, self.axes)

    def see(self, state: State) -> Seen:
        """Value and Jacobian at a state."""
        axis = state.pose(self.site).rotation[:, AXES.index(self.axes[0])]
        views = self.resolved(state.robot, self._views)
        y, slope = _angles(views @ axis)
        J = -(slope @ views) @ pin.skew(axis) @ state.jacobian(self.site)[3:]
        return Seen(y, J, np.zeros(len(y)))

    def along(self, movement: Along) -> np.ndarray:
        """Values along a movement."""
        axes = movement.pose(self.site).rotation[..., AXES.index(self.axes[0])]
        return _angles_along(axes @ self.resolved(movement.robot, self._views).T)

    def _views(self, robot: Robot) -> np.ndarray:
        """Axes (d + 1, 3) of the reference, in the rows."""
        if self.reference is None:
            R = robot.at_home.pose(self.site).rotation
        else:
            R = np.reshape(self.reference, (3, 3))
        return R.T[[AXES.index(axis) for axis in self.axes]]


@dataclass(frozen=True)
class Bearing(View):
    """Direction in which a site sees an object, from its own axes, Eq. (41): zero if it points.

    The Jacobian holds the turning of the axis and the travel of the site past the object.

    Parameters
    ----------
    site, target : str
        A site of the robot and an object.
    axes : str
        The axis that points, then those towards which angles are measured.
    """

    site: str
    target: str
    axes: str

    def __post_init__(self) -> None:
        checked(self)
        _check_axes(self.axes)

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        return tuple(f"towards {axis} [rad]" for axis in self.axes[1:])

    def see(self, state: State) -> Seen:
        """Value, Jacobian and drift at a state."""
        R, p = state.pose(self.site)
        views, sight = self._views(R), state.objects[self.target].position - p
        y, slope = _angles(views @ sight)
        slope, J = slope @ views, state.jacobian(self.site)
        drift = slope @ state.objects[self.target].velocity
        return Seen(y, slope @ pin.skew(sight) @ J[3:] - slope @ J[:3], drift)

    def along(self, movement: Along) -> np.ndarray:
        """Values along a movement."""
        R, p = movement.pose(self.site)
        sight = movement.object(self.target).position - p
        return _angles_along((self._views(R) @ sight[..., None])[..., 0])

    def _views(self, R: np.ndarray) -> np.ndarray:
        """Axes (..., d + 1, 3) of the site, in the rows."""
        return R.mT[..., [AXES.index(axis) for axis in self.axes], :]


def _check_axes(axes: str) -> None:
    """Raise an ArgumentError unless these are two or three different axes."""
    if not 2 <= len(axes) <= 3 or set(axes) - set(AXES) or len(set(axes)) < len(axes):
        raise ArgumentError(
            f"axes are {shown(axes)}; give two or three of x, y and z, such as 'zxy'"
        )


def _angles(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles (d,) of a vector v (d + 1,) from its first axis, and their derivative (d, d + 1).

    Both are bounded: close to the opposite direction, where the logarithm is singular, sideways
    turning counts no more; a vector shorter than NEAR has the angles of one that long, scaled down
    in proportion, since its direction means little. In plain numbers: arrays so small cost more.
    """
    found, length, angle, sine, cosine, heading = _polar(*v.tolist())
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
    return np.array(found), np.array(derivative)


def _angles_along(v: np.ndarray) -> np.ndarray:
    """The same angles (T, d) of vectors v (T, d + 1)."""
    return np.array([_polar(*row)[0] for row in v.tolist()])


def _polar(
    ahead: float, *across: float
) -> tuple[list[float], float, float, float, float, list[float]]:
    """Angles (d,) of a vector, its length, the angle with its sine and cosine, and the heading."""
    wide = hypot(*across)
    length = hypot(ahead, wide)
    sine, cosine = (wide / length, ahead / length) if length else (0.0, 1.0)
    # Straight ahead and straight behind, any way around is as good as any other.
    heading = [a / wide for a in across] if wide else [1.0, 0.0][: len(across)]
    angle = atan2(sine, cosine)
    share = length / max(length, NEAR) * angle
    return [share * h for h in heading], length, angle, sine, cosine, heading
