"""Poses (x, y, z [m], rotation vector [rad]) seen from objects that are placed and turned anywhere.

A rotation R is the vector ``log(R C')`` from a reference rotation C: a chart in which a movement
is a curve that linear systems can follow. From one chart to another, as from an object's frame to
the common one, the map is smooth but not affine; its affine part near a pose is the frame of Eq. 4.
"""

from typing import NamedTuple

import numpy as np

from tpsim import rotation
from tpsim.checks import finite_array, frozen_array, instance, picked
from tpsim.errors import ArgumentError
from tpsim.frame import Frame


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
                f"position has shape {p.shape} and quaternion {np.shape(quaternion)}; give "
                "(..., 3) and (..., 4)"
            )
        return cls(R, p)


def coordinates(pose: Pose, reference: np.ndarray, seen_from: Pose | None = None) -> np.ndarray:
    """Six coordinates (..., 6) of a pose, in the world or seen from an object.

    Parameters
    ----------
    pose : Pose
    reference : (3, 3)
        Rotation, as seen from there, whose vector is zero.
    seen_from : Pose, optional
        Of an object in the world.
    """
    R, p = pose
    if seen_from is not None:
        R_object, p_object = seen_from
        back = np.swapaxes(R_object, -1, -2)
        R, p = back @ R, (back @ (p - p_object)[..., None])[..., 0]
    return np.concatenate([p, rotation.log(R @ reference.T)], axis=-1)


def object_frame(
    object_pose: Pose, reference: np.ndarray, common_reference: np.ndarray, near: np.ndarray
) -> Frame:
    """Frame (4) of an object: from the coordinates that it sees to the common ones.

    Exact in position; in orientation, exact to first order about the poses ``near``. It is the
    Jacobian of the change of chart, ``A = J(y)^-1 R J(theta)`` with J the left Jacobian of SO(3).

    Parameters
    ----------
    object_pose : Pose
        In the world; leading axes carry time.
    reference, common_reference : (3, 3)
        Rotations whose vectors are zero, as seen from the object and in the world.
    near : (..., 6)
        Common coordinates of the poses about which the map is exact.

    Returns
    -------
    Frame
        A (..., 6, 6), b (..., 6).
    """
    (R, p), y = object_pose, near[..., 3:]
    seen = np.swapaxes(R, -1, -2) @ rotation.exp(y) @ common_reference
    theta = rotation.log(seen @ reference.T)
    A = np.zeros((*near.shape, 6))
    A[..., :3, :3] = R
    A[..., 3:, 3:] = rotation.left_jacobian_inverse(y) @ (R @ rotation.left_jacobian(theta))
    b = np.empty(near.shape)
    b[..., :3] = p
    b[..., 3:] = y - (A[..., 3:, 3:] @ theta[..., None])[..., 0]
    return Frame(A, b)
