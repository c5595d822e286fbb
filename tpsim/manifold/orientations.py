"""Orientations, S3: unit quaternions of which the sign does not matter."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tpsim.checks import choice
from tpsim.errors import ArgumentError
from tpsim.manifold.quaternion import (
    half_times,
    left_multiplication,
    of_matrices,
    over,
    quotient,
    right_multiplication,
    times,
)
from tpsim.manifold.spaces import Space
from tpsim.manifold.unit import not_orthonormal, principal, unit
from tpsim.rotation import cross_matrix

TINY = 1e-30
"""Squared angle [rad^2] that is none."""


@dataclass(frozen=True)
class Rotations(Space):
    """S3: orientations, unit quaternions (w, x, y, z), q and -q the same.

    Tangent vectors are rotation vectors [rad], aligned with the frame in which the orientation is
    given, as angular velocity is: ``y = exp(v) x``. Distance is the angle of the rotation.

    Parameters
    ----------
    mirror : str
        Axis of the body, ``"x"``, ``"y"`` or ``"z"``, across which it is mirrored by frames that
        are reflections; they are refused where it is empty.
    """

    mirror: str = ""
    width: ClassVar[int] = 4  # type: ignore[misc]
    dim: ClassVar[int] = 3  # type: ignore[misc]
    curved: ClassVar[bool] = True

    def __post_init__(self) -> None:
        choice("mirror", self.mirror, ("", "x", "y", "z"))

    def __str__(self) -> str:
        return f"S3.mirrored('{self.mirror}')" if self.mirror else "S3"

    def valid(self, name, y):
        """Unit quaternions."""
        return unit(name, y, "quaternions")

    def log(self, x, y):
        """Rotation vector of y x^-1."""
        turn = quotient(y, x)
        w = turn[..., :1]
        # Angle and sine from the same cosine: their ratio is exact though each may not be.
        cosine = np.minimum(np.abs(w), 1 - 1e-16)
        factor = 2 * np.arccos(cosine) / np.sqrt(1 - cosine * cosine)
        return np.copysign(factor, w) * turn[..., 1:]

    def log_of_columns(self, x, y, out):
        """Rotation vectors, of which each coordinate lies together."""
        G, K, _ = x.shape
        rows = over(x).transpose(0, 2, 1, 3).reshape(G, 4 * K, 4)
        turn = (rows @ y).reshape(G, 4, K, -1)
        w = turn[:, 0]
        cosine = np.abs(w)
        np.minimum(cosine, 1 - 1e-16, out=cosine)
        factor = np.arccos(cosine)
        np.multiply(cosine, cosine, out=cosine)
        np.sqrt(np.subtract(1, cosine, out=cosine), out=cosine)
        factor /= cosine
        factor *= np.copysign(2.0, w)
        for i in range(3):
            np.multiply(factor, turn[:, i + 1], out=out[:, :, i])

    def exp(self, x, v):
        """Turned from x by a rotation vector."""
        half = 0.5 * np.sqrt(np.vecdot(v, v))[..., None]
        turn = np.empty((*v.shape[:-1], 4))
        turn[..., :1] = np.cos(half)
        turn[..., 1:] = (0.5 * np.sin(half) / np.maximum(half, TINY)) * v
        return times(turn, x)

    def stepped(self, x, v):
        """The direction of (1, v / 2) x, of which no angles are needed."""
        y = x + half_times(v, x)
        return y / np.sqrt(np.vecdot(y, y))[..., None]

    def transport(self, x, y):
        """The turn by half the rotation vector."""
        return _half_turn(self.log(x, y))[0]

    def linearised(self, x, y):
        """Of :meth:`slope`, v is an eigenvector; both are linear in few numbers."""
        turn = quotient(y, x)
        cosine, square, factor, u = _half_angles(turn)
        along = factor * cosine
        return _stretched(along, factor * u, (1 - along) / square, u, turn.shape)

    def carrying(self, x, y):
        """Left Jacobian of the rotation vector from y to x."""
        turn = quotient(y, x)
        cosine, square, factor, u = _half_angles(turn)
        along = cosine / factor
        found = _stretched(along, u / -factor, (1 - along) / square, u, turn.shape)
        v = (2 * factor * u).T
        return v.reshape(*turn.shape[:-1], 3), found[..., :3]

    def departing(self, x, v):
        """The left Jacobian of the rotation vector."""
        half = np.maximum(0.5 * np.sqrt(np.vecdot(v, v)).reshape(-1), 1e-12)
        sine = np.sin(half)
        turn = np.empty((4, len(half)))
        turn[0], ratio = np.cos(half), sine / half
        u = np.multiply(0.5 * ratio, v.reshape(-1, 3).T, out=turn[1:])
        along = turn[0] * ratio
        carry = _stretched(along, ratio * u, (1 - along) / (sine * sine), u, (*v.shape[:-1], 4))
        return times(turn.T.reshape(*v.shape[:-1], 4), x), carry[..., :3]

    def slope(self, x, y, v):
        """Inverse left Jacobian of the rotation vector -v, that leads from y to x."""
        square = np.vecdot(v, v)
        half = np.maximum(0.5 * np.sqrt(square), 1e-12)
        ratio = (1 - half / np.tan(half)) / np.maximum(square, TINY)
        return _inverse_jacobian(v, ratio[..., None, None])

    def lifted(self, A, b):
        """Left multiplication by the frame's quaternion."""
        if A.shape[-2:] != (3, 3):
            raise ArgumentError(f"S3 is turned by frames of space, A of (3, 3); A is {A.shape}")
        q, mirrored = of_matrices(A)
        B = left_multiplication(q)
        if mirrored.any():
            if not self.mirror:
                raise ArgumentError(
                    "A is a reflection, under which an orientation has no image but that of a body "
                    "which is mirrored, too; say across which of its axes, as in S3.mirrored('y')"
                )
            flip = right_multiplication(np.eye(4)["xyz".index(self.mirror) + 1])
            B = np.where(mirrored[..., None, None], B @ flip, B)
        return B, 0.0

    def moved(self, A, b, x, out):
        """Rotation vectors are turned by A itself."""
        if A.shape[-2:] != (3, 3):
            return super().moved(A, b, x, out)
        q, mirrored = of_matrices(A)
        if mirrored.any():
            return super().moved(A, b, x, out)
        out[...] = times(q, x)
        return A

    def turned(self, A, x, y):
        """Rotation (..., 3, 3) of rotation vectors: the columns of A, seen from the first."""
        return (over(A[..., :, 0]) @ A[..., :, 1:])[..., 1:, :]

    def wrong(self, A, b):
        """Whether A is no multiplication by unit quaternions, or b not zero."""
        turn = over(A[..., :, 0]) @ A[..., :, 1:]
        return (
            not_orthonormal(A)
            or bool(np.abs(turn[..., 0, :]).max() > 1e-6)
            or bool(np.abs(b).max() > 1e-6)
        )

    def near_mean(self, weights, y, heaviest):
        """Direction of the sum, of signs that agree with the heaviest."""
        signed = np.copysign(weights, np.vecdot(y, heaviest[..., None, :]))
        total = np.matmul(signed[..., None, :], y)[..., 0, :]
        return total / np.sqrt(np.vecdot(total, total))[..., None]

    def centre(self, y, weights):
        """Direction of the widest spread: the chordal mean, whatever the signs."""
        return principal(y, weights)


def _half_angles(turn: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Of quaternions: cosine, squared sine, angle over sine (n,) of half angles; vectors (3, n).

    Of either sign the one of less than half a turn; what is alike lies together in memory.
    """
    columns = turn.reshape(-1, 4).T.copy()
    columns *= np.copysign(1.0, columns[0])
    cosine = np.minimum(columns[0], 1 - 1e-16)
    square = 1 - cosine * cosine
    return cosine, square, np.arccos(cosine) / np.sqrt(square), columns[1:]


def _stretched(along, about, across, u, shape) -> np.ndarray:
    """``along I + [about] + across u u'``, and ``2 about`` beside it: (..., 3, 4).

    Of numbers (n,) and vectors (3, n).
    """
    parts = np.empty((13, len(along)))
    parts[0], parts[1:4] = along, about
    np.multiply((across * u)[:, None], u, out=parts[4:].reshape(3, 3, -1))
    return np.matmul(parts.T, _STRETCHED).reshape(*shape[:-1], 3, 4)


def _table() -> np.ndarray:
    """Of :func:`_stretched`, (13, 12)."""
    found = np.zeros((13, 3, 4))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        found[0, i, i], found[i + 1, i, 3] = 1.0, 2.0
        found[i + 1, k, j], found[i + 1, j, k] = 1.0, -1.0
        for j in range(3):
            found[4 + 3 * i + j, i, j] = 1.0
    return found.reshape(13, 12)


_STRETCHED = _table()


def _inverse_jacobian(v: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """``I + S / 2 + ratio S S`` (..., 3, 3) with S the cross-product matrix of v (..., 3)."""
    S = cross_matrix(v)
    found = S @ S
    found *= ratio
    S *= 0.5
    found += S
    found += _EYE
    return found


_EYE = np.eye(3)


def _half_turn(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotation matrices (..., 3, 3) by half of rotation vectors, and their angle (...)."""
    angle = np.sqrt(np.vecdot(v, v))
    half = (0.5 * angle)[..., None, None]
    S = 0.5 * cross_matrix(v)
    first = np.sinc(half / np.pi)
    second = 0.5 * np.sinc(0.5 * half / np.pi) ** 2
    return np.eye(3) + first * S + second * (S @ S), angle
