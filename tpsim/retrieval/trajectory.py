"""Trajectory models: smooth paths from statistics of position and its derivatives (Section 5.2)."""

from __future__ import annotations

from math import comb
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from tpsim.checks import FASTEST, affordable, choice, felt, finite_array, number, whole
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.markov import visited

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from tpsim.learning.gmm import GMM
    from tpsim.learning.hmm import HiddenStates

Differences = Literal["forward", "backward"]
Border = Literal["free", "zero"]

_BLOCK = 12  # rows per block of the selected inverse: fastest between 8 and 24 in numpy


def derivative_operator(
    steps: int,
    dt: float,
    derivatives: int = 2,
    dim: int = 1,
    *,
    differences: Differences = "forward",
) -> csr_array:
    """Operator Phi with zeta = Phi x, Eqs 21-25.

    Parameters
    ----------
    steps
        Number of time steps T.
    dt
        Time step [s].
    derivatives
        Number C-1 of derivatives; 2 is velocity and acceleration.
    dim
        Dimension D of the position.
    differences
        "forward" as the tutorial prints, "backward" as its code computes.

    Returns
    -------
    Sparse (T*C*D, T*D). A derivative that would reach over the border has a zero row.
    """
    from scipy.sparse import coo_array, eye_array, kron

    dt = _check_grid(steps, dt, derivatives, differences)
    steps, derivatives = int(steps), int(derivatives)
    dim = affordable("dim", dim, steps * (derivatives + 1))
    order = derivatives + 1
    windows = _windows(steps, dt, order, differences)
    start = np.arange(steps) - (order - 1 if differences == "backward" else 0)
    columns = np.broadcast_to((start[:, None] + np.arange(order))[:, None], windows.shape)
    rows = np.broadcast_to(np.arange(steps * order).reshape(steps, order, 1), windows.shape)
    used = windows != 0
    operator = coo_array((windows[used], (rows[used], columns[used])), (steps * order, steps))
    return kron(operator, eye_array(dim), format="csr")


def trajectory(
    means: ArrayLike,
    covariances: ArrayLike,
    dt: float,
    *,
    derivatives: int = 2,
    differences: Differences = "forward",
    border: Border = "free",
    scale: float = 1.0,
) -> Gaussian:
    """Most likely trajectory and its covariance, Eqs 28-31, in time linear in T.

    Parameters
    ----------
    means
        (T, C*D), position first, then its derivatives [m, m/s, ...].
    covariances
        (T, C*D, C*D), positive definite.
    dt
        Time step [s].
    derivatives
        Number C-1 of derivatives; 2 is velocity and acceleration.
    differences
        "forward" (Eqs 21-22) or "backward" (the tutorial's code).
    border
        What happens to derivatives that reach over the border. "free" leaves them out of
        the likelihood; "zero" takes them as zero, as the tutorial's code does.
    scale
        The factor sigma of Eq. 31.

    Returns
    -------
    Gaussian with mean (T, D) and covariance (T, D, D), the diagonal blocks of Eq. 31.

    Raises
    ------
    ArgumentError
        Shapes that do not fit, values that are not finite, a covariance that is not
        positive definite.
    """
    means, covariances = _check_statistics(means, covariances, derivatives)
    steps, size = means.shape
    dt = _check_grid(steps, dt, derivatives, differences)
    choice("border", border, ("free", "zero"))
    scale = number("scale", scale, above=0)
    order = derivatives + 1
    dim = size // order
    windows = _windows(steps, dt, order, differences)
    if border == "free":
        means, covariances = _leave_out_undefined(means, covariances, windows)
    local = _local_normal_equations(means, covariances, windows)
    band, right = _assemble(local, order, dim, trim_front=differences == "backward")
    try:
        factor = cholesky_banded(band, overwrite_ab=True, check_finite=False)
    except LinAlgError:
        raise ArgumentError(
            "The trajectory is not determined: position covariances are too large next to those "
            "of the derivatives for this dt. Give smaller position covariances or a larger dt"
        ) from None
    mean = cho_solve_banded((factor, False), right, check_finite=False).reshape(steps, dim)
    return Gaussian.trusted(mean, scale * _diagonal_blocks_of_inverse(factor, dim))


def trajectory_of_states(
    model: GMM | HiddenStates, states: ArrayLike, dt: float, **options
) -> Gaussian:
    """Trajectory of a sequence of states s_1..s_T of a mixture, Eqs 26-31.

    Parameters
    ----------
    model
        GMM, HMM or HSMM over position and derivatives, gaussians (K, C*D), or (T, K, C*D) when its
        frames move.
    states
        (T,) integers in 0..K-1, from responsibilities, an HMM path or an HSMM sample.
    dt
        Time step [s].
    options
        Keywords of :func:`trajectory`.
    """
    if not isinstance(getattr(model, "gaussians", None), Gaussian):
        raise ArgumentError(f"model is a {type(model).__name__}; give a GMM, HMM or HSMM")
    mean, covariance = model.gaussians.mean, model.gaussians.covariance
    components = mean.shape[-2]
    states = visited("states", states, components)
    if mean.ndim == 2:
        return trajectory(mean[states], covariance[states], dt, **options)
    if len(mean) != len(states):
        raise ArgumentError(f"The mixture has {len(mean)} time steps, states has {len(states)}")
    steps = np.arange(len(states))
    return trajectory(mean[steps, states], covariance[steps, states], dt, **options)


def _windows(steps: int, dt: float, order: int, differences: Differences) -> NDArray:
    """Difference coefficients (T, C, C) on the C positions around each step, zero if undefined."""
    step = np.arange(steps)[:, None]
    backward = differences == "backward"
    stencil = np.zeros((order, order))
    for c in range(order):
        first = order - 1 - c if backward else 0
        for k in range(c + 1):
            stencil[c, first + k] = (-1) ** (c - k) * comb(c, k) / dt**c
    reach = np.arange(order)
    defined = step >= reach if backward else step + reach < steps
    return np.where(defined[..., None], stencil, 0.0)


def _leave_out_undefined(means, covariances, windows):
    """Replace undefined derivatives by independent noise, which leaves no trace on the rest."""
    order = windows.shape[1]
    dim = means.shape[1] // order
    undefined = np.repeat(~windows.any(axis=2), dim, axis=1)
    at_border = undefined.any(axis=1)
    undefined = undefined[at_border]
    means, covariances = means.copy(), covariances.copy()
    means[at_border] = np.where(undefined, 0.0, means[at_border])
    coupled = undefined[:, :, None] | undefined[:, None, :]
    identity = np.eye(means.shape[1])
    covariances[at_border] = np.where(coupled, identity, covariances[at_border])
    return means, covariances


def _local_normal_equations(means, covariances, windows) -> NDArray:
    """[M | mu]^T Sigma^-1 [M | mu] of every step (T, CD+1, CD+1), M the local difference rows."""
    steps, size = means.shape
    dim = size // windows.shape[1]
    rows = np.zeros((steps, size, size + 1))
    for d in range(dim):
        rows[:, d::dim, d:size:dim] = windows
    rows[:, :, size] = means
    try:
        whitened = np.linalg.solve(np.linalg.cholesky(covariances), rows)
    except np.linalg.LinAlgError:
        smallest = np.linalg.eigvalsh(covariances)[:, 0]
        raise ArgumentError(
            f"The covariance of step {smallest.argmin()} is not positive definite (smallest "
            f"eigenvalue {smallest.min():.3g}). Add a ridge to the covariances"
        ) from None
    return whitened.swapaxes(1, 2) @ whitened


def _assemble(local: NDArray, order: int, dim: int, *, trim_front: bool) -> tuple:
    """Sum the local equations into an upper band (C*D, T*D) and a right side (T*D,)."""
    steps, size = len(local), order * dim
    padded = (steps + order - 1) * dim
    band, right = np.zeros((size, padded)), np.zeros(padded)
    for j in range(size):
        column = slice(j, j + steps * dim, dim)
        right[column] += local[:, j, size]
        for i in range(j + 1):
            band[size - 1 + i - j, column] += local[:, i, j]
    inside = slice(padded - steps * dim, None) if trim_front else slice(steps * dim)
    return band[:, inside], right[inside]


def _diagonal_blocks_of_inverse(factor: NDArray, dim: int) -> NDArray:
    """Diagonal blocks (T, D, D) of (R^T R)^-1 for an upper banded factor R.

    R is read as block bidiagonal with blocks R_k and E_k. Then, from the last block to the
    first, S_k = R_k^-1 R_k^-T + G_k S_{k+1} G_k^T with G_k = R_k^-1 E_k.
    """
    reach, size = len(factor) - 1, factor.shape[1]
    width = dim * -(-max(reach, _BLOCK) // dim)
    count = -(-size // width)
    i, j = np.arange(width)[:, None], np.arange(width + reach)
    offset = j - i
    column = np.arange(count)[:, None, None] * width + j
    inside = (offset >= 0) & (offset <= reach) & (column < size)
    blocks = np.where(
        inside, factor[np.clip(reach - offset, 0, reach), np.minimum(column, size - 1)], 0.0
    )
    blocks[-1, (outside := np.arange(size - (count - 1) * width, width)), outside] = 1.0

    inverse = np.linalg.inv(blocks[:, :, :width])
    gain = inverse @ blocks[:, :, width:]
    block = inverse @ inverse.swapaxes(1, 2)
    corner = np.zeros((count, reach, reach))
    for k in range(count - 1, 0, -1):
        G = gain[k, :reach]
        corner[k - 1] = block[k, :reach, :reach] + G @ corner[k] @ G.T
    block += gain @ corner @ gain.swapaxes(1, 2)

    per_block = width // dim
    steps = block.reshape(count, per_block, dim, per_block, dim)
    diagonal = np.einsum("kiaib->kiab", steps)
    return diagonal.reshape(-1, dim, dim)[: size // dim]


def _check_grid(steps: int, dt: float, derivatives: int, differences: str) -> float:
    """The time step, where all fit together; else an ArgumentError."""
    derivatives = whole("derivatives", derivatives)
    affordable("steps", steps, (derivatives + 1) ** 2)
    dt = number("dt", dt, above=0, what="time step [s]")
    if not FASTEST <= dt ** max(derivatives, 1) <= 1 / FASTEST:
        raise ArgumentError(
            f"dt is {dt} s and derivatives {derivatives}; such rates of change leave floating point"
        )
    choice("differences", differences, ("forward", "backward"))
    return dt


def _check_statistics(
    means: ArrayLike, covariances: ArrayLike, derivatives: int
) -> tuple[NDArray, NDArray]:
    derivatives = whole("derivatives", derivatives)
    means, covariances = finite_array("means", means), felt("covariances", covariances)
    if means.ndim != 2 or covariances.shape != (*means.shape, means.shape[-1]):
        raise ArgumentError(
            f"means {means.shape} and covariances {covariances.shape} do not fit; give (T, C*D) "
            "and (T, C*D, C*D)"
        )
    if means.shape[1] == 0 or means.shape[1] % (derivatives + 1 or 1):
        raise ArgumentError(
            f"means has {means.shape[1]} columns, which position and {derivatives} derivatives "
            "cannot share equally; give derivatives=1 if there is a velocity only"
        )
    return means, covariances
