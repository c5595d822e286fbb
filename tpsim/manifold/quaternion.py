"""Products of quaternions (..., 4), w first, as matrices: many at once, in few calls."""

import numpy as np


def times(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Product of quaternions (..., 4), w first."""
    return np.matmul(left_multiplication(p), q[..., None])[..., 0]


def left_multiplication(q: np.ndarray) -> np.ndarray:
    """Matrix (..., 4, 4) that multiplies by q from the left."""
    return np.matmul(q[..., None, :], _LEFT)[..., 0, :].reshape(*q.shape[:-1], 4, 4)


def right_multiplication(q: np.ndarray) -> np.ndarray:
    """Matrix (..., 4, 4) that multiplies by q from the right."""
    return np.matmul(q[..., None, :], _RIGHT)[..., 0, :].reshape(*q.shape[:-1], 4, 4)


def over(q: np.ndarray) -> np.ndarray:
    """Matrix (..., 4, 4) that multiplies by the conjugate of q from the right."""
    return np.matmul(q[..., None, :], _OVER)[..., 0, :].reshape(*q.shape[:-1], 4, 4)


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
