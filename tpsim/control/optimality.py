"""The batch solution Eq. 37 as one banded linear system, linear in time."""

import numpy as np
from scipy.linalg.lapack import dgbsv

from tpsim.control.tracking import TrackingProblem


def solve_optimality(
    problem: TrackingProblem, initial: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """States (T, n) and controls (T, m) from the optimality conditions of Eq. 34.

    Ordered by time they are banded: the dynamics A xi_t + B u_t = xi_{t+1} with multiplier
    lambda_t, and the gradients Λ xi_t + Aᵀ lambda_t - lambda_{t-1} = eta, R u + Bᵀ lambda = 0.
    A definite R eliminates u = -R⁻¹ Bᵀ lambda; a singular one keeps it as an unknown.
    """
    n, m = problem.system.B.shape
    if problem.strict:
        lift = np.linalg.solve(problem.R, problem.system.B.T)
        blocks = _blocks_of_states(problem, lift)
    else:
        blocks = _blocks_of_states_and_controls(problem)
    right = np.zeros(blocks.shape[:2])
    right[:, :n] = problem.eta
    if initial is not None:
        blocks[0, :n] = np.eye(*blocks.shape[1:])[:n]
        right[0, :n] = initial
    solution = _solve_banded(blocks, right, n)
    if problem.strict:
        return solution[:, :n], -(lift @ solution[:, n:, None])[..., 0]
    return solution[:, :n], solution[:, n : n + m]


def _blocks_of_states(problem, lift):
    """Diagonal blocks (T, 2 n, 2 n) for the unknowns xi_t, lambda_t."""
    A, B = problem.system.A, problem.system.B
    n = len(A)
    blocks = np.empty((len(problem.eta), 2 * n, 2 * n))
    blocks[:, :n, :n] = problem.Lambda
    blocks[:, :n, n:], blocks[:, n:, :n] = A.T, A
    blocks[:, n:, n:] = -B @ lift
    _close(blocks, n)
    return blocks


def _blocks_of_states_and_controls(problem):
    """Diagonal blocks (T, 2 n + m, 2 n + m) for the unknowns xi_t, u_t, lambda_t."""
    A, B = problem.system.A, problem.system.B
    n, m = B.shape
    blocks = np.zeros((len(problem.eta), 2 * n + m, 2 * n + m))
    blocks[:, :n, :n] = problem.Lambda
    blocks[:, n:-n, n:-n] = problem.R
    blocks[:, :n, -n:], blocks[:, n:-n, -n:] = A.T, B.T
    blocks[:, -n:, :n], blocks[:, -n:, n:-n] = A, B
    _close(blocks, n)
    return blocks


def _close(blocks, n):
    """Set the control and multiplier after the horizon, which act on nothing, to zero."""
    blocks[-1, n:, :] = blocks[-1, :, n:] = 0.0
    blocks[-1, n:, n:] = np.eye(blocks.shape[1] - n)


def _solve_banded(blocks, right, n):
    """LU of the band matrix with ``blocks`` on its diagonal and -1 between lambda_t, xi_{t+1}."""
    T, size = right.shape
    entries = np.argwhere(blocks.any(axis=0))
    width = max(n, *np.abs(entries[:, 0] - entries[:, 1]))
    # The layout of LAPACK's gbsv, columns contiguous, with ``width`` more rows for pivoting.
    diagonal = 2 * width
    band = np.zeros((T, size, diagonal + width + 1))
    for start in range(0, T, 512):  # pieces that stay in the cache
        part = slice(start, start + 512)
        for i, j in entries:
            band[part, j, diagonal + i - j] = blocks[part, i, j]
    band[:-1, size - n :, diagonal + n] = -1.0  # column lambda_t, row xi_{t+1}
    band[1:, :n, diagonal - n] = -1.0  # column xi_{t+1}, row lambda_t
    band = band.reshape(T * size, -1).T
    *_, solution, _ = dgbsv(width, width, band, right.ravel(), overwrite_ab=True, overwrite_b=True)
    return solution.reshape(T, size)
