"""The curved factors of a manifold: directions, S2, and orientations, S3."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tpsim.checks import choice, place
from tpsim.errors import ArgumentError
from tpsim.manifold.quaternion import (
    left_multiplication,
    of_matrices,
    over,
    right_multiplication,
    times,
)
from tpsim.manifold.spaces import Space
from tpsim.rotation import cross_matrix

BEHIND = 0.2
"""Sine of the angle to the opposite direction below which sideways turning grows no more."""

TINY = 1e-30
"""Squared angle [rad^2] that is none."""


@dataclass(frozen=True)
class Sphere(Space):
    """S2: directions in space, unit vectors; tangent vectors along two axes across them.

    The axes at n are x and y, carried from z to n along the shortest arc.
    """

    width: ClassVar[int] = 3  # type: ignore[misc]
    dim: ClassVar[int] = 2  # type: ignore[misc]

    def __str__(self) -> str:
        return "S2"

    def valid(self, name, y):
        """Unit vectors."""
        return _unit(name, y, "directions")

    def log(self, x, y):
        """The arc from x to y, along the axes at x."""
        cosine = np.vecdot(x, y)[..., None]
        across = y - cosine * x
        sine = np.sqrt(np.vecdot(across, across))[..., None]
        angle = np.arctan2(sine, cosine)
        # Straight behind, any way round is as good as any other: along the first axis.
        lost = (sine == 0) & (cosine < 0)
        v = np.matmul(_axes(x), (across * (angle / np.maximum(sine, TINY)))[..., None])[..., 0]
        return np.where(lost, np.array([np.pi, 0.0]), v) if lost.any() else v

    def exp(self, x, v):
        """The point at the end of an arc."""
        angle = np.sqrt(np.vecdot(v, v))[..., None]
        along = np.matmul(v[..., None, :], _axes(x))[..., 0, :]
        y = np.cos(angle) * x + np.sinc(angle / np.pi) * along
        return y / np.sqrt(np.vecdot(y, y))[..., None]

    def transport(self, x, y):
        """The turn from x to y, between the axes at both."""
        return self._carried(x, y, 1.0)

    def slope(self, x, y, v):
        """Transport, stretched across by angle over sine, bounded near the opposite."""
        angle = np.sqrt(np.vecdot(v, v))
        sine = np.where(np.cos(angle) < 0, np.maximum(np.sin(angle), BEHIND), np.sin(angle))
        stretch = np.where(angle > 1e-8, angle / np.maximum(sine, TINY), 1.0)
        u = v / np.sqrt(np.maximum(angle**2, TINY))[..., None]
        u = np.where(angle[..., None] > 1e-8, u, np.array([1.0, 0.0]))
        along = u[..., :, None] * u[..., None, :]
        across = stretch[..., None, None]
        return self._carried(x, y, along + across * (np.eye(2) - along))

    def lifted(self, A, b):
        """A alone."""
        if A.shape[-1] != 3:
            raise ArgumentError(f"S2 is turned by frames of space, A of (3, 3); A is {A.shape}")
        return A, np.zeros(3)

    def turned(self, A, x, y):
        """A between the axes at x and at its image y."""
        return _axes(y) @ A @ _axes(x).mT

    def wrong(self, A, b):
        """Whether A is no rotation or reflection, or b not zero."""
        return not_orthonormal(A) or bool(np.abs(b).max() > 1e-6)

    def centre(self, y, weights):
        """Direction of the sum, or of the widest spread where the sum is none."""
        total = weights @ y
        length = np.sqrt(np.vecdot(total, total))[..., None]
        lost = length < 1e-9 * weights.sum(-1, keepdims=True)
        return np.where(lost, _principal(y, weights), total / np.maximum(length, TINY))

    @staticmethod
    def _carried(x, y, within):
        turn = _shortest_turn(x, y)
        return (
            _axes(y) @ turn @ _axes(x).mT @ within
            if np.ndim(within)
            else (_axes(y) @ turn @ _axes(x).mT)
        )


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
        return _unit(name, y, "quaternions")

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
        return _principal(y, weights)


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


def _axes(n: np.ndarray) -> np.ndarray:
    """Two axes (..., 2, 3) across directions (..., 3), in the rows."""
    x, y, z = n[..., 0], n[..., 1], n[..., 2]
    below = z < 0
    # The turn from +z to n, or, below the equator, the half turn about x and that from -z.
    sign = np.where(below, -1.0, 1.0)
    share = -1.0 / (1.0 + np.abs(z))
    axes = np.empty((*n.shape[:-1], 2, 3))
    axes[..., 0, 0] = 1 + share * x * x
    axes[..., 0, 1] = axes[..., 1, 0] = share * x * y
    axes[..., 0, 2] = -sign * x
    axes[..., 1, 1] = 1 + share * y * y
    axes[..., 1, 2] = -sign * y
    axes[..., 1, :] *= sign[..., None]
    return axes


def _shortest_turn(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Rotation (..., 3, 3) from directions x to y along the shortest arc; half a turn if opposite.

    Of opposite directions about the axis across the way that ``log`` goes.
    """
    axis = np.cross(x, y)
    cosine = np.vecdot(x, y)[..., None, None]
    S = cross_matrix(axis)
    near = 1 + cosine
    turn = np.eye(3) + S + (S @ S) / np.maximum(near, TINY)
    lost = near < 1e-14
    if lost.any():
        across = np.broadcast_to(_axes(x)[..., 1, :], axis.shape)
        half = 2 * across[..., :, None] * across[..., None, :] - np.eye(3)
        turn = np.where(lost, half, turn)
    return turn


def _principal(y: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Direction (..., w) of the widest spread about zero of points (N, w)."""
    spread = np.matmul(y.T * weights[..., None, :], y)
    return np.linalg.eigh(spread)[1][..., :, -1]


def _unit(name: str, y: np.ndarray, what: str) -> np.ndarray:
    length = np.sqrt(np.vecdot(y, y))
    if (length < 1e-9).any():
        raise ArgumentError(
            f"{name} holds {what} of zero length, the first {place(length < 1e-9)}; they point "
            "nowhere: remove these samples"
        )
    # What has unit length but for rounding keeps its bits.
    return np.where(np.abs(length - 1) < 1e-15, 1.0, 1 / length)[..., None] * y


def not_orthonormal(A: np.ndarray) -> bool:
    """Whether A (..., n, n) is neither a rotation nor a reflection."""
    return bool(np.abs(A @ A.mT - np.eye(A.shape[-1])).max() > 1e-6)
