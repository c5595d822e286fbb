"""Frames of reference: affine maps from what an observer sees to the common coordinates."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Stored
from tpsim.checks import (
    LARGEST,
    affordable,
    entries,
    finite_array,
    frozen,
    frozen_array,
    instance,
    picked,
    whole,
)
from tpsim.errors import ArgumentError

WORST_CONDITION = 1e10  # beyond it a square A counts as singular


@dataclass(frozen=True, eq=False, init=False)
class Frame(Stored):
    """Affine map x = A X + b from local coordinates X to common coordinates x, Eq. (4).

    A may be a rotation, a scaling, a reflection, a projection or a Jacobian: not always square,
    rigid, invertible or constant.

    Parameters
    ----------
    A : (..., D, d)
    b : (..., D)
        Leading axes carry time (a moving frame) and broadcast against those of ``A``.

    Both are copied, and read-only from then on.

    Raises
    ------
    ArgumentError
        Wrong shapes, NaN or infinite entries.
    """

    A: np.ndarray
    b: np.ndarray

    def __init__(self, A: ArrayLike, b: ArrayLike):
        A, b = frozen_array("A", A), frozen_array("b", b)
        if A.ndim < 2 or 0 in A.shape[-2:] or b.shape[-1:] != A.shape[-2:-1]:
            raise ArgumentError(
                f"A has shape {A.shape} and b {b.shape}; they must be (..., D, d) and (..., D)"
            )
        try:
            leading = np.broadcast_shapes(A.shape[:-2], b.shape[:-1])
        except ValueError as error:
            raise ArgumentError(
                f"leading axes of A {A.shape} and b {b.shape} do not match"
            ) from error
        object.__setattr__(self, "A", np.broadcast_to(A, (*leading, *A.shape[-2:])))
        object.__setattr__(self, "b", np.broadcast_to(b, (*leading, b.shape[-1])))

    @classmethod
    def trusted(cls, A: np.ndarray, b: np.ndarray) -> "Frame":
        """Build without checks and copies, from arrays of one's own with equal leading axes.

        The trusted path of control loops: the arrays become read-only, the caller gives them away.
        """
        frame = object.__new__(cls)
        frame.__dict__["A"], frame.__dict__["b"] = frozen(A), frozen(b)
        return frame

    __iter__ = None  # one frame is no list of frames

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading axes: () for a constant frame, (T,) for a moving one."""
        return self.b.shape[:-1]

    @property
    def dim(self) -> int:
        """Dimension D of the common coordinates."""
        return self.A.shape[-2]

    @property
    def local_dim(self) -> int:
        """Dimension d of the local coordinates."""
        return self.A.shape[-1]

    @cached_property
    def inverse(self) -> np.ndarray:
        """Pseudo-inverse of A, (..., d, D)."""
        return frozen(pseudoinverse(self.A))

    def __getitem__(self, index: object) -> "Frame":
        """Select along the leading axes, as ``frame[t]`` for the frame at step t."""
        index = index if isinstance(index, tuple) else (index,)
        return Frame.trusted(
            picked(self.A, (*index, Ellipsis, slice(None), slice(None))),
            picked(self.b, (*index, Ellipsis, slice(None))),
        )

    def to_local(self, x: ArrayLike) -> np.ndarray:
        """See common points from the frame, Eq. (4): X = A^+ (x - b), (..., d).

        Where A has no inverse its pseudo-inverse answers: the closest, shortest X.
        """
        x = _points("x", x, self.dim, self.shape)
        return np.matmul(self.inverse, (x - self.b)[..., None])[..., 0]

    def to_common(self, x: ArrayLike) -> np.ndarray:
        """Carry local points (..., d) to common coordinates: A X + b, (..., D)."""
        return (
            np.matmul(self.A, _points("x", x, self.local_dim, self.shape)[..., None])[..., 0]
            + self.b
        )

    def uncertainty(
        self, x: ArrayLike, origin: ArrayLike, orientation: ArrayLike = 0.0
    ) -> np.ndarray:
        """Covariance (..., D, D) of where local points are, if the frame is not known exactly.

        To first order, an error db of the origin and a small turn dw of the axes move the point
        A X + b by db + dw x A X.

        Parameters
        ----------
        x : (..., d)
            Local points X, such as the means (K, d) of a model's components.
        origin : (D, D) or float
            Covariance of b, or its variance in every direction.
        orientation : float or (3, 3)
            Covariance of the turn in common coordinates [rad^2], or its variance about every
            axis; in the plane and in space.

        Raises
        ------
        ArgumentError
            Shapes that do not fit, or a turn of what is neither plane nor space.
        """
        D = self.dim
        b = finite_array("origin", origin)
        turn, moved = finite_array("orientation", orientation), self.to_common(x) - self.b
        axes = {2: 1, 3: 3}.get(D, 0)
        if b.shape not in ((), (D, D)) or turn.shape not in ((), (axes, axes)):
            raise ArgumentError(
                f"origin has shape {b.shape} and orientation {turn.shape}; give numbers, or "
                f"({D}, {D}) and ({axes}, {axes})"
            )
        for name, part in (("x", moved), ("orientation", turn)):
            if part.size and np.abs(part).max() > LARGEST:
                raise ArgumentError(
                    f"{name} reaches {np.abs(part).max():.1e}; give {LARGEST:.0e} at most"
                )
        found = np.broadcast_to(b * np.eye(D) if b.ndim == 0 else b, (*moved.shape, D))
        if not turn.any():
            return found.copy()
        if not axes:
            raise ArgumentError(
                f"orientation is uncertain, and the frame has {D} dimensions; it turns in the "
                "plane and in space: add the covariance of the points yourself"
            )
        lever = np.zeros((*moved.shape, axes))
        if axes == 1:
            lever[..., 0, 0], lever[..., 1, 0] = -moved[..., 1], moved[..., 0]
        else:
            for k, axis in enumerate(np.eye(3)):
                lever[..., k] = np.cross(axis, moved)
        spread = turn * np.eye(axes) if turn.ndim == 0 else turn
        return found + lever @ spread @ lever.mT

    def with_input(self, n: int = 1) -> "Frame":
        """Lift by ``n`` inputs, such as time, that the frame leaves alone, Eq. (20)."""
        n = whole("n", n, least=1)
        affordable("n", n, (n + self.dim) * max(self.b.size // self.dim, 1))
        D, d = self.A.shape[-2:]
        A = np.zeros((*self.shape, n + D, n + d))
        A[..., :n, :n] = np.eye(n)
        A[..., n:, n:] = self.A
        b = np.concatenate([np.zeros((*self.shape, n)), self.b], axis=-1)
        return Frame.trusted(A, b)

    def with_derivatives(self, n: int) -> "Frame":
        """Lift to [x, dx, ddx, ...] with ``n`` derivatives of x, Eq. (32) with n = 2.

        The map applies to every derivative, the offset to x alone: the frame's own motion is
        slow beside the movement.
        """
        n = whole("n", n)
        affordable("n", n, (n + 1) * self.A.size, least=0)
        A = np.kron(np.eye(n + 1), self.A)
        b = np.concatenate([self.b, np.zeros((*self.shape, n * self.dim))], axis=-1)
        return Frame.trusted(A, b)


def frames_or_none(name: str, frames: object) -> list[Frame | None]:
    """Frames, of which None stands for one that is not observed; one alone is a list of one."""
    given = [frames] if isinstance(frames, Frame) else entries(name, frames)
    return [
        None if frame is None else instance(f"{name}[{j}]", frame, Frame, "or None")
        for j, frame in enumerate(given)
    ]


def as_before(A: np.ndarray, before: np.ndarray) -> np.ndarray:
    """The nearest orthonormal matrices (..., D, d), where they were orthonormal before a change."""
    if not np.allclose(before.mT @ before, np.eye(before.shape[-1]), atol=1e-6):
        return A
    U, _, Vt = np.linalg.svd(A, full_matrices=False)
    return U @ Vt


def pseudoinverse(A: np.ndarray) -> np.ndarray:
    """Pseudo-inverse of (..., D, d), the plain inverse where A is square and well conditioned."""
    inverse = plain_inverse(A)
    return np.linalg.pinv(A, rcond=1 / WORST_CONDITION) if inverse is None else inverse


def plain_inverse(A: np.ndarray) -> np.ndarray | None:
    """Inverse of (..., D, d) where all of A is square and well conditioned, else None."""
    if A.shape[-1] != A.shape[-2]:
        return None
    try:
        inverse = np.linalg.inv(A)
    except np.linalg.LinAlgError:
        return None
    return inverse if _well_conditioned(A, inverse) else None


def _well_conditioned(A: np.ndarray, inverse: np.ndarray) -> bool:
    if float(np.abs(A).max()) * float(np.abs(inverse).max()) < WORST_CONDITION:
        return True  # one bound for all leading axes is cheap and mostly enough
    with np.errstate(over="ignore", invalid="ignore"):
        bounds = np.abs(A).max((-2, -1)) * np.abs(inverse).max((-2, -1))
    return bool((bounds < WORST_CONDITION).all())


def _points(name: str, x: ArrayLike, dim: int, shape: tuple[int, ...]) -> np.ndarray:
    x = finite_array(name, x)
    if x.shape[-1:] != (dim,):
        raise ArgumentError(f"{name} has shape {x.shape}; its last axis must be {dim}")
    if shape and x.shape[:-1] != shape:
        try:
            np.broadcast_shapes(x.shape[:-1], shape)
        except ValueError:
            raise ArgumentError(
                f"{name} has leading axes {x.shape[:-1]}, the frame {shape}; they must broadcast"
            ) from None
    return x
