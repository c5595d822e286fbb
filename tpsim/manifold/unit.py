"""Unit vectors: what directions and quaternions have in common."""

import numpy as np

from tpsim.checks import place
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
    return bool(np.abs(A @ A.mT - np.eye(A.shape[-1])).max() > 1e-6)
