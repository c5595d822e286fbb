"""What a robot knows of the objects around it at one instant: poses and velocities."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from tpsim.border import read
from tpsim.checks import shown
from tpsim.errors import SimulationError, UnseenError
from tpsim.pose import Pose


class Moving(NamedTuple):
    """Pose of an object and how it moves.

    Parameters
    ----------
    rotation : (3, 3)
    position : (3,)
        [m]
    velocity, angular_velocity : (3,)
        World-aligned [m/s], [rad/s]; zero where the object rests.
    """

    rotation: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    angular_velocity: np.ndarray

    @property
    def pose(self) -> Pose:
        """Pose without the motion."""
        return Pose(self.rotation, self.position)


class Objects(Mapping[str, Moving]):
    """Objects by name; poses are computed when they are asked for.

    Parameters
    ----------
    rows : mapping of str to int
        Row of each object in the arrays.
    positions : (k, 3)
        [m]
    quaternions : (k, 4)
        (w, x, y, z)
    twists : (k, 6), optional
        Linear over angular velocity, world-aligned; at rest by default.
    covariances : (k, 6, 6), optional
        Of position [m] over a small turn about the world's axes [rad]; exactly known by default.
    """

    __slots__ = ("_moving", "_rows", "covariances", "positions", "quaternions", "twists")

    def __init__(
        self,
        rows: Mapping[str, int],
        positions: np.ndarray,
        quaternions: np.ndarray,
        twists: np.ndarray | None = None,
        covariances: np.ndarray | None = None,
    ):
        self._rows, self.covariances = rows, covariances
        self._moving: dict[str, Moving] = {}
        self.positions, self.quaternions, self.twists = positions, quaternions, twists

    @classmethod
    def of(cls, poses: Mapping[str, Pose], name: str = "poses") -> "Objects":
        """Objects at rest at these poses."""
        read(name, poses, Mapping[str, Pose])
        known = [pose.checked(f"{name}[{key!r}]") for key, pose in poses.items()]
        positions = np.array([pose.position for pose in known], float).reshape(-1, 3)
        turned = [pose.quaternion for pose in known]
        rows = {name: row for row, name in enumerate(poses)}
        return cls(rows, positions, np.array(turned, float).reshape(-1, 4))

    @property
    def rotations(self) -> np.ndarray:
        """Rotation matrices (k, 3, 3)."""
        return np.array([self[name].rotation for name in self._rows])

    def moving(self, twists: np.ndarray) -> "Objects":
        """The same objects with other velocities (k, 6)."""
        other = Objects(self._rows, self.positions, self.quaternions, twists, self.covariances)
        for name, row in self._rows.items():
            R, p = self[name][:2]
            other._moving[name] = Moving(R, p, twists[row, :3], twists[row, 3:])
        return other

    def row(self, name: str) -> int:
        """Row of an object in the arrays."""
        if name not in self:
            self._look(name)  # which says why not
        return self._rows[name]

    def covariance(self, name: str) -> np.ndarray | None:
        """Covariance (6, 6) of the pose of an object; None where it is exactly known."""
        row = self.row(name)
        return None if self.covariances is None else self.covariances[row]

    def __getitem__(self, name: str) -> Moving:
        """Return the object called ``name``."""
        found = self._moving.get(name) if isinstance(name, str) else None
        if found is None:
            found = self._moving[name] = self._look(name)
        return found

    def _look(self, name: str) -> Moving:
        if not isinstance(name, str) or name not in self._rows:
            known = sorted(self._rows) or "none"
            if self.covariances is not None:
                raise UnseenError(f"object {shown(name)} was not seen yet; seen are {known}")
            raise SimulationError(f"there is no object {shown(name)} in the scene; it has {known}")
        row = self._rows[name]
        w, x, y, z = self.quaternions[row].tolist()
        twist = _REST if self.twists is None else self.twists[row]
        R = pin.Quaternion(w, x, y, z).matrix()
        return Moving(R, self.positions[row], twist[:3], twist[3:])

    def __contains__(self, name: object) -> bool:
        """Whether there is such an object, and it was seen."""
        return isinstance(name, str) and name in self._rows

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self._rows)

    def __len__(self) -> int:
        """Return the number of objects."""
        return len(self._rows)


_REST = np.zeros(6)
NONE = Objects({}, np.zeros((0, 3)), np.zeros((0, 4)))
"""A world without objects."""
