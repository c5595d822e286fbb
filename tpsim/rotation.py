"""Rotations: matrices, unit quaternions (w, x, y, z), logarithm and exponential, vectorised.

Rotation vectors are world-aligned: ``log(R)`` is the axis of R times its angle, in [rad].
Leading axes broadcast.
"""

from __future__ import annotations

import re
import warnings
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import finite_array, instance, place, shown
from tpsim.errors import ArgumentError, DataWarning

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

MOST_TURN = 1e8  # [rad]: beyond it rounding decides where a rotation ends
WIDE_TURN = np.pi / 3  # [rad] between neighbouring samples: faster than any recorder should be


_CROSS = np.array(
    [[0, 0, 0, 0, 0, -1, 0, 1, 0], [0, 0, 1, 0, 0, 0, -1, 0, 0], [0, -1, 0, 1, 0, 0, 0, 0, 0]],
    float,
)
"""Cross-product matrices (3, 9) of the three axes."""


def _scipy() -> type[Rotation]:
    """Class of scipy, imported where it is needed: it takes its time."""
    from scipy.spatial.transform import Rotation

    return Rotation


def skew(v: ArrayLike) -> np.ndarray:
    """Cross-product matrix: ``skew(v) @ x = v x x``, shape (..., 3) -> (..., 3, 3)."""
    return cross_matrix(_shaped("v", v, (3,)))


def cross_matrix(v: np.ndarray) -> np.ndarray:
    """Work of :func:`skew` for vectors that are known to be some."""
    return np.matmul(v, _CROSS).reshape(*v.shape, 3)


def exp(w: ArrayLike) -> np.ndarray:
    """Rotation matrices (..., 3, 3) of rotation vectors (..., 3) [rad]."""
    w = _turns(w)
    return (
        _scipy().from_rotvec(_writable(w.reshape(-1, 3))).as_matrix().reshape(*w.shape[:-1], 3, 3)
    )


def log(R: ArrayLike) -> np.ndarray:
    """Rotation vectors (..., 3) [rad] of rotation matrices (..., 3, 3); angle in [0, pi]."""
    R = _shaped("R", R, (3, 3))
    try:
        return (
            _scipy()
            .from_matrix(_writable(R.reshape(-1, 3, 3)))
            .as_rotvec()
            .reshape(*R.shape[:-2], 3)
        )
    except ValueError as error:
        words = " ".join(str(error).split())
        raise ArgumentError(f"R holds a matrix that is none: {words}") from error


def to_quaternion(R: ArrayLike) -> np.ndarray:
    """Unit quaternions (..., 4), w first, of rotation matrices (..., 3, 3)."""
    R = _matrices(R)
    quaternion = _scipy().from_matrix(_writable(R.reshape(-1, 3, 3))).as_quat(scalar_first=True)
    return quaternion.reshape(*R.shape[:-2], 4)


def from_quaternion(quaternion: ArrayLike) -> np.ndarray:
    """Rotation matrices (..., 3, 3) of quaternions (..., 4), w first, of any length but zero."""
    quaternion = _shaped("quaternion", quaternion, (4,))
    lost = np.linalg.norm(quaternion, axis=-1) == 0
    if lost.any():
        raise ArgumentError(
            f"quaternions of zero length, the first {place(lost)}, say nothing about orientation; "
            "remove these samples"
        )
    R = _scipy().from_quat(_writable(quaternion.reshape(-1, 4)), scalar_first=True).as_matrix()
    return R.reshape(*quaternion.shape[:-1], 3, 3)


def quaternions(
    name: str, orientations: ArrayLike, convention: str = "wxyz", degrees: bool = False
) -> np.ndarray:
    """Unit quaternions (T, 4), w first, of orientations as they are recorded.

    Parameters
    ----------
    name : str
        What error messages call them.
    orientations : (T, 4), (T, 3, 3), (T, n) or (T,)
        Quaternions, matrices, or Euler angles.
    convention : str
        ``"wxyz"``, ``"xyzw"``, ``"matrix"``, or scipy's name of Euler angles: one to three of
        ``xyz`` (about fixed axes) or of ``XYZ`` (about turning ones).
    degrees : bool
        Euler angles are in degrees.

    Raises
    ------
    ArgumentError
        An unknown convention, or rows that are no orientations.
    """
    values = finite_array(name, orientations)
    convention = instance("convention", convention, str)
    if convention in ("wxyz", "xyzw"):
        _check_rows(name, values, (4,))
        length = np.linalg.norm(values, axis=-1)
        if (abs(length - 1) > 0.1).any():
            row = int(np.argmax(abs(length - 1) > 0.1))
            raise ArgumentError(
                f"{name} has a quaternion of length {length[row]:.3g} in row {row}; all must be "
                "of length one (zero: the marker was lost; remove the sample)"
            )
        ordered = values if convention == "wxyz" else values[:, [3, 0, 1, 2]]
        return ordered / length[:, None]
    if convention == "matrix":
        _check_rows(name, values, (3, 3))
        return to_quaternion(_matrices(values, name))
    if not re.fullmatch("[xyz]{1,3}|[XYZ]{1,3}", convention) or re.search(r"(.)\1", convention):
        raise ArgumentError(
            f"convention is {shown(convention)}; give 'wxyz', 'xyzw', 'matrix', or Euler axes by "
            "scipy's names, such as 'xyz' (fixed) or 'ZYX' (turning)"
        )
    values = values[:, None] if values.ndim == 1 else values
    _check_rows(name, values, (len(convention),))
    return (
        _scipy()
        .from_euler(convention, _writable(values), degrees=degrees)
        .as_quat(scalar_first=True)
    )


def continuous(quaternions: ArrayLike) -> np.ndarray:
    """Quaternions (T, 4) with signs flipped so that neighbours in time never jump.

    One quaternion (4,) is returned as it is.
    """
    given = _shaped("quaternions", quaternions, (4,))
    if given.ndim > 2:
        raise ArgumentError(f"quaternions have shape {given.shape}; give one recording (T, 4)")
    found = np.array(np.atleast_2d(given))
    flips = np.sum(found[1:] * found[:-1], axis=-1) < 0
    found[1:] *= np.where(np.cumsum(flips) % 2, -1.0, 1.0)[:, None]
    return found.reshape(given.shape)


def warn_of_turns(name: str, quaternions: np.ndarray) -> None:
    """Give a DataWarning where neighbouring quaternions (T, 4) are a wide turn apart."""
    cosine = np.abs(np.sum(quaternions[1:] * quaternions[:-1], axis=-1))
    turns = 2 * np.arccos(np.minimum(cosine, 1.0))
    if (turns > WIDE_TURN).any():
        row = int(np.argmax(turns > WIDE_TURN)) + 1
        warnings.warn(
            f"{name} turn by {np.degrees(turns[row - 1]):.0f} degrees between rows {row - 1} and "
            f"{row}; look for lost samples, or for another convention",
            DataWarning,
            stacklevel=3,
        )


def mean(R: ArrayLike) -> np.ndarray:
    """Mean rotation (3, 3) of rotation matrices (N, 3, 3): least sum of squared chordal errors."""
    given = _matrices(R)
    if given.ndim != 3 or not len(given):
        raise ArgumentError(f"R has shape {given.shape}; give (N, 3, 3), N >= 1")
    return _scipy().from_matrix(_writable(given)).mean().as_matrix()


def left_jacobian_inverse(w: ArrayLike) -> np.ndarray:
    """Map from world angular velocity to the rate of ``log(R)``: (..., 3) -> (..., 3, 3).

    ``d log(R) / dt = left_jacobian_inverse(log(R)) @ omega``. Singular at an angle of 2 pi only.
    """
    w = _turns(w)
    angle = np.linalg.norm(w, axis=-1)[..., None, None]
    S = skew(w)
    half = angle / 2
    small = angle < 1e-4
    safe = np.where(small, 1.0, half)
    c = np.where(small, 1 / 12 + angle**2 / 720, (1 - safe / np.tan(safe)) / (4 * safe**2))
    return np.eye(3) - S / 2 + c * (S @ S)


def left_jacobian(w: ArrayLike) -> np.ndarray:
    """Map from the rate of ``log(R)`` to world angular velocity: (..., 3) -> (..., 3, 3)."""
    w = _turns(w)
    first, second = _about(w)
    S = skew(w)
    return np.eye(3) + first[..., None] * S + second[..., None] * (S @ S)


def angular_velocity(w: ArrayLike, rate: ArrayLike) -> np.ndarray:
    """World angular velocity (..., 3) of ``exp(w)`` whose rotation vector changes at a rate.

    ``left_jacobian(w) @ rate``, without the matrices.
    """
    w, rate = _turns(w), _shaped("rate", rate, (3,))
    if w.shape != rate.shape:
        raise ArgumentError(f"w has shape {w.shape} and rate {rate.shape}; give a rate for each")
    first, second = _about(w)
    across = np.cross(w, rate)
    return rate + first * across + second * np.cross(w, across)


def _about(w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients (..., 1) of the left Jacobian: of the cross-product matrix, and its square."""
    angle = np.linalg.norm(w, axis=-1, keepdims=True)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 0.5 - angle**2 / 24, (1 - np.cos(safe)) / safe**2)
    second = np.where(small, 1 / 6 - angle**2 / 120, (safe - np.sin(safe)) / safe**3)
    return first, second


def tilt(R: ArrayLike, axis: ArrayLike = (0.0, 0.0, 1.0)) -> np.ndarray:
    """Angle (...,) [rad] between the body's own ``axis`` carried by R (..., 3, 3) and the world's.

    The cup's tilt: how far its axis leans from the vertical.
    """
    given = _shaped("axis", axis, (3,))
    length = float(np.linalg.norm(given))
    if not length > 0 or given.ndim != 1:
        raise ArgumentError(f"axis is {shown(given)}; give one direction (3,)")
    up = given / length
    carried = _shaped("R", R, (3, 3)) @ up
    # atan2 keeps its precision near zero, where arccos has none.
    sine = np.linalg.norm(np.cross(carried, up), axis=-1)
    return np.arctan2(sine, carried @ up)


def _turns(w: ArrayLike) -> np.ndarray:
    """Rotation vectors (..., 3) whose angle still means a direction, or an ArgumentError."""
    w = _shaped("w", w, (3,))
    if w.size and np.abs(w).max() > MOST_TURN:
        raise ArgumentError(f"w reaches {np.abs(w).max():.1e} rad; give at most {MOST_TURN:.0e}")
    return w


def _writable(values: np.ndarray) -> np.ndarray:
    """The values, or a copy of read-only ones, which scipy does not take."""
    return values if values.flags.writeable else values.copy()


def _shaped(name: str, values: ArrayLike, last: tuple[int, ...]) -> np.ndarray:
    values = finite_array(name, values)
    if values.shape[-len(last) :] != last:
        raise ArgumentError(
            f"{name} has shape {values.shape}; the last axes must be {last}"
            + (", (w, x, y, z)" if last == (4,) else "")
        )
    return values


def _matrices(R: ArrayLike, name: str = "R") -> np.ndarray:
    """Rotation matrices, or an ArgumentError for what scipy would bend into some."""
    R = _shaped(name, R, (3, 3))
    wrong = np.abs(R.mT @ R - np.eye(3)).max((-1, -2)) > 1e-2
    wrong |= np.linalg.det(R) < 0
    if wrong.any():
        raise ArgumentError(
            f"{name} holds a matrix that is none, the first {place(wrong)}: R'R must be the "
            "identity and det R one"
        )
    return R


def _check_rows(name: str, values: np.ndarray, shape: tuple[int, ...]) -> None:
    if values.ndim != 1 + len(shape) or values.shape[1:] != shape or len(values) == 0:
        wanted = ", ".join(str(n) for n in ("T", *shape))
        raise ArgumentError(
            f"{name} have shape {values.shape}; this convention asks for ({wanted})"
        )
