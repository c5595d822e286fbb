"""Orientations of files as unit quaternions (w, x, y, z) whose signs agree."""

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from tpsim.data.rows import usable
from tpsim.errors import ArgumentError

WIDTH = {"wxyz": 4, "xyzw": 4, "rotvec": 3, "matrix": 9, "pose": 16, "angle": 1}
"""Number of columns of every order; Euler angles have one for each letter."""


def width(order: str) -> int:
    """Number of columns of an order.

    Raises
    ------
    ArgumentError
        The order is unknown.
    """
    if order in WIDTH:
        return WIDTH[order]
    if 1 <= len(order) <= 3 and (set(order) <= set("xyz") or set(order) <= set("XYZ")):
        return len(order)
    raise ArgumentError(
        f"order is {order!r}; give one of {', '.join(WIDTH)}, or Euler angles such as 'xyz', 'ZYX'"
    )


def quaternions(values: np.ndarray, order: str, factor: float = 1.0) -> np.ndarray:
    """Unit quaternions (T, 4), w first, of orientations (T, n) in any order.

    Rows that hold NaN or a quaternion of zero length become NaN. ``factor`` makes radians of the
    angles.
    """
    result = np.full((len(values), 4), np.nan)
    good = usable(values)
    if order in ("wxyz", "xyzw"):
        norm = np.linalg.norm(np.where(good[:, None], values, 1.0), axis=1)
        good &= norm > 1e-6
        scaled = values[good] / norm[good, None]
        result[good] = scaled if order == "wxyz" else np.roll(scaled, 1, axis=1)
        return result
    rows = values[good]
    if order == "rotvec":
        rotations = Rotation.from_rotvec(rows * factor)
    elif order == "matrix":
        rotations = Rotation.from_matrix(rows.reshape(-1, 3, 3))
    elif order == "pose":
        rotations = Rotation.from_matrix(rows.reshape(-1, 4, 4).mT[:, :3, :3])
    else:
        letters = "z" if order == "angle" else order
        rotations = Rotation.from_euler(letters, (rows * factor).reshape(-1, len(letters)))
    if len(rows):
        result[good] = rotations.as_quat(scalar_first=True)
    return result


def agreeing(quaternion: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Quaternions (T, 4) or their negatives, whichever are nearer to (S, 4) ``like`` on average."""
    return -quaternion if like.mean(0) @ quaternion.mean(0) < 0 else quaternion


def interpolated(time: np.ndarray, quaternion: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Quaternions (S, 4) at other times, by spherical interpolation; held at both ends."""
    if len(time) == 1:
        return np.repeat(quaternion, len(times), axis=0)
    between = Slerp(time, Rotation.from_quat(quaternion, scalar_first=True))
    return between(np.clip(times, time[0], time[-1])).as_quat(scalar_first=True)


def left_multiplication(quaternion: np.ndarray) -> np.ndarray:
    """Orthogonal matrices (..., 4, 4) with ``left_multiplication(p) @ q = p q``."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion, float), -1, 0)
    rows = ((w, -x, -y, -z), (x, w, -z, y), (y, z, w, -x), (z, -y, x, w))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
