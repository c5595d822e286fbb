"""Directions in space, S2."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.manifold.spaces import Space
from tpsim.manifold.unit import not_orthonormal, principal, unit
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
    curved: ClassVar[bool] = True

    def __str__(self) -> str:
        return "S2"

    def valid(self, name, y):
        """Unit vectors."""
        return unit(name, y, "directions")

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
        return A, 0.0

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
        return np.where(lost, principal(y, weights), total / np.maximum(length, TINY))

    @staticmethod
    def _carried(x, y, within):
        turn = _shortest_turn(x, y)
        return (
            _axes(y) @ turn @ _axes(x).mT @ within
            if np.ndim(within)
            else (_axes(y) @ turn @ _axes(x).mT)
        )


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
