"""The batch solution Eq. 37 as one banded linear system, linear in time."""

import numpy as np
from scipy.linalg.lapack import dgbsv

from tpsim.control.tracking import TrackingProblem

_PIECE = 512  # steps that are written to the band at a time, to stay in the cache


def solve_optimality(
    problem: TrackingProblem, initial: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """States (T, n) and controls (T, m) from the optimality conditions of Eq. 34.

    Ordered by time they are banded: the dynamics A xi_t + B u_t = xi_{t+1} with multiplier
    lambda_t, and the gradients Λ xi_t + Aᵀ lambda_t - lambda_{t-1} = eta, R u + Bᵀ lambda = 0.
    A definite R eliminates u = -R⁻¹ Bᵀ lambda; a singular one keeps it as an unknown.
    """
    A, B = (_with_last(part) for part in (problem.system.A, problem.system.B))
    n, m = problem.system.size
    if problem.strict:
        lift = np.linalg.solve(problem.R, B.mT)
        inner = {(n, n): -B @ lift}
        size = 2 * n
    else:
        inner = {(n, n): problem.R, (n, n + m): B.mT, (n + m, n): B}
        size = 2 * n + m
    costate = size - n
    blocks = {(0, 0): problem.Lambda, (0, costate): A.mT, (costate, 0): A} | inner
    band = _band_of(blocks, len(problem.eta), size, n)
    right = np.zeros((len(problem.eta), size))
    right[:, :n] = problem.eta
    # The control and multiplier after the horizon act on nothing: they are set to zero.
    _place(band[-1:], np.zeros((n, costate)), costate, 0)
    _place(band[-1:], np.zeros((costate, n)), 0, costate)
    _place(band[-1:], np.eye(costate), n, n)
    if initial is not None:
        _place(band[:1], np.eye(n, size), 0, 0)
        right[0, :n] = initial
    solution = _solve_band(band, right)
    if problem.strict:
        return solution[:, :n], -(lift @ solution[:, n:, None])[..., 0]
    return solution[:, :n], solution[:, n : n + m]


def _with_last(matrices: np.ndarray) -> np.ndarray:
    """Matrices of T - 1 steps with one more for the last state, which acts on nothing."""
    if matrices.ndim == 2:
        return matrices
    return np.concatenate([matrices, np.zeros_like(matrices, shape=(1, *matrices.shape[1:]))])


def _band_of(blocks, T, size, n):
    """Band (T, size, 3 width + 1): every column with its neighbours, as LAPACK's gbsv wants it.

    ``blocks`` are the parts of the diagonal block of a step by their row and column, constant or
    (T, a, b); besides them only -1 stands between lambda_t and xi_{t+1}.
    """
    structure = np.zeros((size, size), bool)
    for (row, column), block in blocks.items():
        a, b = block.shape[-2:]
        used = (block != 0).reshape(-1, a, b).any(axis=0)
        structure[row : row + a, column : column + b] |= used
    rows, columns = np.nonzero(structure)
    width = max(n, np.abs(rows - columns).max())
    step = np.zeros((1, size, 3 * width + 1))
    step[0, size - n :, 2 * width + n] = -1.0  # column lambda_t, row xi_{t+1}
    step[0, :n, 2 * width - n] = -1.0  # column xi_{t+1}, row lambda_t
    for place, block in blocks.items():
        if block.ndim == 2:
            _place(step, block, *place)
    band = np.empty((T, *step.shape[1:]))
    for start in range(0, T, _PIECE):
        part = slice(start, start + _PIECE)
        band[part] = step
        for place, block in blocks.items():
            if block.ndim == 3:
                _place(band[part], block[part], *place)
    return band


def _place(band, block, row, column):
    """Write a block (a, b) or (T, a, b) at its row and column in every step of the band."""
    width = band.shape[-1] // 3
    for i, j in np.ndindex(block.shape[-2:]):
        offset = row + i - column - j
        if abs(offset) <= width:
            band[:, column + j, 2 * width + offset] = block[..., i, j]


def _solve_band(band, right):
    """Solve by LU with pivoting; the arrays are overwritten."""
    T, size, height = band.shape
    width = height // 3
    band = band.reshape(T * size, height).T
    *_, solution, _ = dgbsv(width, width, band, right.ravel(), overwrite_ab=True, overwrite_b=True)
    return solution.reshape(T, size)
