"""Products of quaternions (..., 4), w first, as matrices: many at once, in few calls."""

import numpy as np


def of_matrices(R: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit quaternions (..., 4) of orthonormal matrices (..., 3, 3), and whether these mirror.

    The largest row of ``4 q q'``, which is linear in R; R is turned round where it mirrors.
    """
    mirrored = np.linalg.det(R) < 0
    if mirrored.any():
        R = np.where(mirrored[..., None, None], -R, R)
    outer = (R.reshape(-1, 9) @ _OUTER + _OUTER_OF_NONE).reshape(-1, 4, 4)
    row = outer[np.arange(len(outer)), outer.diagonal(0, -2, -1).argmax(-1)]
    return (row / np.sqrt(np.vecdot(row, row))[:, None]).reshape(*R.shape[:-2], 4), mirrored


def times(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Product of quaternions (..., 4), w first."""
    pairs = p[..., :, None] * q[..., None, :]
    return np.matmul(pairs.reshape(*pairs.shape[:-2], 16), _TIMES)


def left_multiplication(q: np.ndarray) -> np.ndarray:
    """Matrix (..., 4, 4) that multiplies by q from the left."""
    return np.matmul(q, _LEFT).reshape(*q.shape, 4)


def right_multiplication(q: np.ndarray) -> np.ndarray:
    """Matrix (..., 4, 4) that multiplies by q from the right."""
    return np.matmul(q, _RIGHT).reshape(*q.shape, 4)


def over(q: np.ndarray) -> np.ndarray:
    """Matrix (..., 4, 4) that multiplies by the conjugate of q from the right."""
    return np.matmul(q, _OVER).reshape(*q.shape, 4)


def half_times(v: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Product of (0, v / 2) and quaternions (..., 4): how q changes as it turns by v (..., 3)."""
    pairs = v[..., :, None] * q[..., None, :]
    return np.matmul(pairs.reshape(*pairs.shape[:-2], 12), _HALF)


def quotient(y: np.ndarray, x: np.ndarray) -> np.ndarray:
    """What leads from unit quaternions x to y, (..., 4): y times the conjugate of x."""
    pairs = y[..., :, None] * x[..., None, :]
    return np.matmul(pairs.reshape(*pairs.shape[:-2], 16), _QUOTIENT)


def _tables() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Products of unit quaternions as (4, 16): from the left, the right, and the conjugate."""
    product = np.zeros((4, 4, 4))  # e_i e_j = sum_k product[i, j, k] e_k
    for i in range(4):
        product[0, i, i] = product[i, 0, i] = 1.0
    for i in (1, 2, 3):
        product[i, i, 0] = -1.0
        j, k = i % 3 + 1, (i + 1) % 3 + 1
        product[i, j, k], product[j, i, k] = 1.0, -1.0
    left, right = product.transpose(0, 2, 1), product.transpose(1, 2, 0)
    conjugate = right * np.array([1.0, -1.0, -1.0, -1.0])[:, None, None]
    return left.reshape(4, 16), right.reshape(4, 16), conjugate.reshape(4, 16)


_LEFT, _RIGHT, _OVER = _tables()
_TIMES = _LEFT.reshape(4, 4, 4).transpose(0, 2, 1).reshape(16, 4)
_HALF = 0.5 * _TIMES[4:]
_QUOTIENT = _OVER.reshape(4, 4, 4).transpose(2, 0, 1).reshape(16, 4)


def _outer() -> np.ndarray:
    """``4 q q'`` (9, 16) of rotation matrices, but for the identity."""
    found = np.zeros((3, 3, 4, 4))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        found[i, i, 0, 0] = found[i, i, i + 1, i + 1] = 1.0
        found[i, i, j + 1, j + 1] = found[i, i, k + 1, k + 1] = -1.0
        found[k, j, 0, i + 1] = found[k, j, i + 1, 0] = 1.0
        found[j, k, 0, i + 1] = found[j, k, i + 1, 0] = -1.0
        for a, b in ((i, j), (j, i)):
            found[a, b, i + 1, j + 1] = found[a, b, j + 1, i + 1] = 1.0
    return found.reshape(9, 16)


_OUTER, _OUTER_OF_NONE = _outer(), np.eye(4).reshape(16)
