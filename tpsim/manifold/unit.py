"""Unit vectors: what directions and quaternions have in common."""

from functools import lru_cache

import numpy as np

from tpsim.checks import frozen, place
from tpsim.errors import ArgumentError


def principal(y: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Direction (..., w) of the widest spread about zero of points (N, w)."""
    spread = np.matmul(y.T * weights[..., None, :], y)
    return np.linalg.eigh(spread)[1][..., :, -1]


def unit(name: str, y: np.ndarray, what: str) -> np.ndarray:
    """Vectors (..., w) brought to length one, or an ArgumentError where one has none."""
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
    return off_orthonormal(A) > 1e-6


def off_orthonormal(A: np.ndarray) -> float:
    """Largest entry of A A' - I."""
    square = A @ A.mT
    square -= identity(A.shape[-1])
    return float(np.maximum.reduce(np.abs(square, out=square), None, initial=0.0))


@lru_cache(maxsize=64)
def identity(size: int) -> np.ndarray:
    """Identity (size, size), made once."""
    return frozen(np.eye(size))
