"""Orientations, S3: unit quaternions of which the sign does not matter."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tpsim.checks import choice
from tpsim.errors import ArgumentError
from tpsim.manifold.quaternion import (
    left_multiplication,
    of_matrices,
    over,
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

    def __post_init__(self) -> None:
        choice("mirror", self.mirror, ("", "x", "y", "z"))

    def __str__(self) -> str:
        return f"S3.mirrored('{self.mirror}')" if self.mirror else "S3"

    def valid(self, name, y):
        """Unit quaternions."""
        return unit(name, y, "quaternions")

    def log(self, x, y):
        """Rotation vector of y x^-1."""
        turn = np.matmul(over(x), y[..., None])[..., 0]
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

    def transport(self, x, y):
        """The turn by half the rotation vector."""
        return _half_turn(self.log(x, y))[0]

    def seen(self, x, y):
        """Both at once, which share their angles."""
        turn = np.matmul(over(x), y[..., None])[..., 0]
        w = turn[..., :1]
        cosine = np.minimum(np.abs(w), 1 - 1e-16)
        half = np.arccos(cosine)
        factor = 2 * half / np.sqrt(1 - cosine * cosine)
        v = np.copysign(factor, w) * turn[..., 1:]
        # (1 - half / tan half) / (2 half)^2
        ratio = (1 - 0.5 * factor * cosine) / np.maximum(4 * half * half, TINY)
        return v, _inverse_jacobian(v, ratio[..., None])

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
        return B, np.zeros(4)

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

    def centre(self, y, weights):
        """Direction of the widest spread: the chordal mean, whatever the signs."""
        return principal(y, weights)


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
