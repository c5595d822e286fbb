"""The factors of a manifold: R^n, S1, S2 and S3, in the coordinates in which data are recorded.

Each factor has ``width`` columns of data and ``dim`` tangent coordinates [m], [rad], and five
operations on arrays whose leading axes broadcast. Values are unchecked here: the border is
:class:`tpsim.manifold.manifold.Manifold`.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from tpsim.archive import Part
from tpsim.checks import choice, whole
from tpsim.errors import ArgumentError
from tpsim.manifold.unit import identity

FARTHEST = 1e6
"""Angle [rad] beyond which too few digits are left of where it points."""

Moves = Literal["points", "vectors", "inputs"]


class Space(Part, ABC):
    """One factor of a manifold.

    Attributes
    ----------
    width, dim : int
        Columns of data, and tangent coordinates.
    flat : bool
        Whether it is R^n.
    curved : bool
        Whether its tangent spaces differ.
    """

    width: int
    dim: int
    flat: ClassVar[bool] = False
    curved: ClassVar[bool] = False

    @abstractmethod
    def valid(self, name: str, y: np.ndarray) -> np.ndarray:
        """Points brought onto the manifold, or an ArgumentError."""

    @abstractmethod
    def log(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Tangent vector (..., dim) at x that leads to y."""

    def log_of_columns(self, x: np.ndarray, y: np.ndarray, out: np.ndarray) -> None:
        """Tangent vectors (G, K, dim, N) at x (G, K, width) to many points (G, width, N)."""
        out[...] = self.log(x[..., None, :], y.mT[..., None, :, :]).mT

    @abstractmethod
    def exp(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Point (..., width) to which a tangent vector at x leads."""

    def stepped(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Where :meth:`exp` leads to second order: enough for steps that become none."""
        return self.exp(x, v)

    @abstractmethod
    def transport(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Parallel transport (..., dim, dim) of coordinates at x to those at y."""

    @abstractmethod
    def slope(self, x: np.ndarray, y: np.ndarray, v: np.ndarray) -> np.ndarray:
        """How ``log_y`` of a point changes as it moves from x: (..., dim, dim), v = log_x(y).

        Transport from x to y, stretched across the way by angle over sine.
        """

    def linearised(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """:meth:`slope` and, in the last column, what it makes of v: (..., dim, dim + 1)."""
        v = self.log(x, y)
        slope = self.slope(x, y, v)
        return np.concatenate([slope, slope @ v[..., None]], axis=-1)

    def carrying(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Tangent vectors at x that lead to y, and the inverse of :meth:`slope`."""
        v = self.log(x, y)
        return v, np.linalg.inv(self.slope(x, y, v))

    def departing(self, x: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points to which tangent vectors at x lead, and what carries coordinates at x there."""
        y = self.exp(x, v)
        return y, self.carrying(y, x)[1]

    @abstractmethod
    def lifted(self, A: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray | float]:
        """What a frame of the plane or of space does to the columns: (..., w, w) and (..., w)."""

    def moved(self, A: np.ndarray, b: np.ndarray, x: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Tangent map (..., dim, dim) of a frame of the plane or of space, and images of points."""
        turn, move = self.lifted(A, b)
        out[...] = np.matmul(turn, x[..., None])[..., 0] + move
        return self.turned(turn, x, out)

    @abstractmethod
    def turned(self, A: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Tangent map (..., dim, dim), from x to its image y, of a map of the columns."""

    @abstractmethod
    def wrong(self, A: np.ndarray, b: np.ndarray) -> bool:
        """Whether a map of the columns leads off the manifold."""

    def near_mean(self, weights: np.ndarray, y: np.ndarray, heaviest: np.ndarray) -> np.ndarray:
        """Point (..., width) near the mean of few points (..., K, width): by default a heaviest."""
        return heaviest

    @abstractmethod
    def centre(self, y: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Point (..., width) near the mean of points (N, width), with weights (..., N)."""


@dataclass(frozen=True)
class Euclidean(Space):
    """R^n.

    Parameters
    ----------
    size : int
        n.
    moves : str
        What frames do to it: to ``"points"`` A x + b, to ``"vectors"`` A x, to ``"inputs"``, such
        as time, nothing.
    """

    size: int
    moves: Moves = "points"
    flat: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", whole("size of R", self.size, least=1, most=1000))
        choice("moves", self.moves, ("points", "vectors", "inputs"))

    def __str__(self) -> str:
        return f"R({self.size})" if self.moves == "points" else f"R({self.size}, '{self.moves}')"

    @property
    def width(self) -> int:  # type: ignore[override]
        """N."""
        return self.size

    @property
    def dim(self) -> int:  # type: ignore[override]
        """N."""
        return self.size

    def valid(self, name, y):
        """All points are."""
        return y

    def log(self, x, y):
        """Y - x."""
        return y - x

    def log_of_columns(self, x, y, out):
        """The same."""
        np.subtract(y[..., None, :, :], x[..., None], out=out)

    def exp(self, x, v):
        """X + v."""
        return x + v

    def transport(self, x, y):
        """Identity."""
        return identity(self.size)

    def slope(self, x, y, v):
        """Identity."""
        return identity(self.size)

    def lifted(self, A, b):
        """A and b themselves, A alone, or the identity."""
        if self.moves == "inputs":
            return identity(self.size), 0.0
        if A.shape[-1] != self.size:
            raise ArgumentError(
                f"frames of dimension {A.shape[-1]} do not move R({self.size}); say "
                f"R({self.size}, 'inputs') for what frames leave alone, such as time"
            )
        return A, b if self.moves == "points" else 0.0

    def moved(self, A, b, x, out):
        """Nothing changes inputs."""
        if self.moves != "inputs":
            return super().moved(A, b, x, out)
        out[...] = x
        return identity(self.size)

    def turned(self, A, x, y):
        """A itself."""
        return A

    def wrong(self, A, b):
        """Whether A has no inverse."""
        return bool((np.abs(np.linalg.det(A)) < 1e-12 * np.abs(A).max((-2, -1)) ** self.size).any())

    def near_mean(self, weights, y, heaviest):
        """Weighted mean."""
        return np.matmul(weights[..., None, :], y)[..., 0, :]

    def centre(self, y, weights):
        """Weighted mean."""
        return weights @ y / weights.sum(-1, keepdims=True)


@dataclass(frozen=True)
class Circle(Space):
    """S1: angles [rad], of which whole turns do not count; directions in the plane."""

    width: ClassVar[int] = 1  # type: ignore[misc]
    dim: ClassVar[int] = 1  # type: ignore[misc]

    def __str__(self) -> str:
        return "S1"

    def valid(self, name, y):
        """Angles within half a turn of zero."""
        if y.size and np.abs(y).max() > FARTHEST:
            raise ArgumentError(f"{name} reaches {np.abs(y).max():.1e} rad; give angles in rad")
        return _wrapped(y)

    def log(self, x, y):
        """Difference within half a turn."""
        return _wrapped(y - x)

    def exp(self, x, v):
        """Sum within half a turn."""
        return _wrapped(x + v)

    def transport(self, x, y):
        """Identity."""
        return identity(1)

    def slope(self, x, y, v):
        """Identity."""
        return identity(1)

    def lifted(self, A, b):
        """Turn by the heading of the frame's first axis, mirrored with it."""
        if A.shape[-1] != 2:
            raise ArgumentError(
                f"S1 is turned by frames of the plane, A of (2, 2); A has shape {A.shape}"
            )
        heading = np.arctan2(A[..., 1, 0], A[..., 0, 0])[..., None]
        return np.sign(np.linalg.det(A))[..., None, None], heading

    def turned(self, A, x, y):
        """1, or -1 where mirrored."""
        return A

    def wrong(self, A, b):
        """Whether A is no sign."""
        return bool((np.abs(np.abs(A) - 1) > 1e-6).any())

    def centre(self, y, weights):
        """Direction of the sum of directions."""
        return np.arctan2(weights @ np.sin(y), weights @ np.cos(y))


def _wrapped(angle: np.ndarray) -> np.ndarray:
    return angle - 2 * np.pi * np.round(angle / (2 * np.pi))
