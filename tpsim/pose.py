"""Poses of bodies and objects: a rotation and a place, one seen from the other."""

from typing import NamedTuple

import numpy as np

from tpsim import rotation
from tpsim.checks import finite_array, frozen_array, instance, picked
from tpsim.errors import ArgumentError


class Pose(NamedTuple):
    """Rotation matrix and position of a body or an object in some frame.

    Parameters
    ----------
    rotation : (..., 3, 3)
    position : (..., 3)
        [m]
    """

    rotation: np.ndarray
    position: np.ndarray

    def __matmul__(self, other: "Pose") -> "Pose":  # type: ignore[override]
        """Pose ``other``, given in this frame, in the frame in which this one is given."""
        instance("other", other, Pose)
        turned = (self.rotation @ other.position[..., None])[..., 0]
        return Pose(self.rotation @ other.rotation, self.position + turned)

    def checked(self, name: str) -> "Pose":
        """The pose of one body, (3, 3) and (3,), its rotation exact; or an ArgumentError."""
        R, p = finite_array(f"{name} rotation", self.rotation), finite_array(name, self.position)
        if R.shape != (3, 3) or p.shape != (3,):
            raise ArgumentError(
                f"{name} has a rotation of shape {R.shape} and a position of {p.shape}; give "
                "(3, 3) and (3,)"
            )
        return Pose(rotation.from_quaternion(rotation.to_quaternion(R)), p)

    @property
    def inverse(self) -> "Pose":
        """The outer frame as seen from this one."""
        back = np.swapaxes(self.rotation, -1, -2)
        return Pose(back, -(back @ self.position[..., None])[..., 0])

    @property
    def quaternion(self) -> np.ndarray:
        """Unit quaternion (..., 4), (w, x, y, z)."""
        return rotation.to_quaternion(self.rotation)

    def at(self, index: int) -> "Pose":
        """One of several poses: ``pose[0]`` is the rotation, since a pose is a pair."""
        return Pose(picked(self.rotation, index), picked(self.position, index))

    @classmethod
    def of_quaternion(cls, position: np.ndarray, quaternion: np.ndarray) -> "Pose":
        """Pose of a position (..., 3) [m] and a unit quaternion (..., 4), (w, x, y, z)."""
        p, R = frozen_array("position", position), rotation.from_quaternion(quaternion)
        if p.shape[-1:] != (3,) or p.shape[:-1] != R.shape[:-2]:
            raise ArgumentError(
                f"position has shape {p.shape} and rotation {R.shape}; give (..., 3) and (..., 4)"
            )
        return cls(R, p)
