"""Rotations: matrices, unit quaternions (w, x, y, z), logarithm and exponential, vectorised.

Rotation vectors are world-aligned: ``log(R)`` is the axis of R times its angle, in [rad].
Leading axes broadcast.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from tpsim.errors import ArgumentError


def skew(v):
    """Cross-product matrix: ``skew(v) @ x = v x x``, shape (..., 3) -> (..., 3, 3)."""
    v = np.asarray(v, float)
    S = np.zeros((*v.shape[:-1], 3, 3))
    S[..., 0, 1], S[..., 0, 2], S[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    return S - np.swapaxes(S, -1, -2)


def exp(w):
    """Rotation matrices (..., 3, 3) of rotation vectors (..., 3) [rad]."""
    w = np.asarray(w, float)
    return Rotation.from_rotvec(w.reshape(-1, 3)).as_matrix().reshape(*w.shape[:-1], 3, 3)


def log(R):
    """Rotation vectors (..., 3) [rad] of rotation matrices (..., 3, 3); angle in [0, pi]."""
    R = np.asarray(R, float)
    return Rotation.from_matrix(R.reshape(-1, 3, 3)).as_rotvec().reshape(*R.shape[:-2], 3)


def to_quaternion(R):
    """Unit quaternions (..., 4), w first, of rotation matrices (..., 3, 3)."""
    R = np.asarray(R, float)
    quaternion = Rotation.from_matrix(R.reshape(-1, 3, 3)).as_quat(scalar_first=True)
    return quaternion.reshape(*R.shape[:-2], 4)


def from_quaternion(quaternion):
    """Rotation matrices (..., 3, 3) of quaternions (..., 4), w first."""
    quaternion = np.asarray(quaternion, float)
    if quaternion.shape[-1:] != (4,):
        raise ArgumentError(
            f"quaternions have shape {quaternion.shape}; the last axis must be (w, x, y, z)"
        )
    R = Rotation.from_quat(quaternion.reshape(-1, 4), scalar_first=True).as_matrix()
    return R.reshape(*quaternion.shape[:-1], 3, 3)


def continuous(quaternions):
    """Quaternions (T, 4) with signs flipped so that neighbours in time never jump."""
    quaternions = np.array(quaternions, float)
    flips = np.sum(quaternions[1:] * quaternions[:-1], axis=-1) < 0
    quaternions[1:] *= np.where(np.cumsum(flips) % 2, -1.0, 1.0)[:, None]
    return quaternions


def mean(R):
    """Mean rotation (3, 3) of rotation matrices (N, 3, 3): least sum of squared chordal errors."""
    return Rotation.from_matrix(np.asarray(R, float)).mean().as_matrix()


def left_jacobian_inverse(w):
    """Map from world angular velocity to the rate of ``log(R)``: (..., 3) -> (..., 3, 3).

    ``d log(R) / dt = left_jacobian_inverse(log(R)) @ omega``. Singular at an angle of 2 pi only.
    """
    w = np.asarray(w, float)
    angle = np.linalg.norm(w, axis=-1)[..., None, None]
    S = skew(w)
    half = angle / 2
    small = angle < 1e-4
    safe = np.where(small, 1.0, half)
    c = np.where(small, 1 / 12 + angle**2 / 720, (1 - safe / np.tan(safe)) / (4 * safe**2))
    return np.eye(3) - S / 2 + c * (S @ S)


def left_jacobian(w):
    """Map from the rate of ``log(R)`` to world angular velocity: (..., 3) -> (..., 3, 3)."""
    w = np.asarray(w, float)
    angle = np.linalg.norm(w, axis=-1)[..., None, None]
    S = skew(w)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 0.5 - angle**2 / 24, (1 - np.cos(safe)) / safe**2)
    second = np.where(small, 1 / 6 - angle**2 / 120, (safe - np.sin(safe)) / safe**3)
    return np.eye(3) + first * S + second * (S @ S)


def tilt(R, axis=(0.0, 0.0, 1.0)):
    """Angle (...,) [rad] between the body's own ``axis`` carried by R (..., 3, 3) and the world's.

    The cup's tilt: how far its axis leans from the vertical.
    """
    axis = np.asarray(axis, float)
    carried = np.asarray(R, float) @ axis
    # atan2 keeps its precision near zero, where arccos has none.
    sine = np.linalg.norm(np.cross(carried, axis), axis=-1)
    return np.arctan2(sine, carried @ axis)
