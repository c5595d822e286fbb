"""Decompositions of tensors, data with several axes (Section 9): Tucker's, and CP's.

After T. Kolda and B. Bader, "Tensor decompositions and applications", SIAM Review 51(3), 2009,
which is [48] of the tutorial. A mode is an axis; unfolding a tensor along one makes a matrix whose
rows are that axis.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tpsim.border import Count, Positive, Share, Steps, border, checked
from tpsim.checks import generator
from tpsim.errors import ArgumentError

STARTS = 4
"""Starts of CP: leading singular vectors, then random ones; the best result is kept."""


@dataclass(frozen=True, eq=False)
class Tucker:
    """A tensor as a small core, seen along orthonormal directions of every mode.

    X[i, j, ...] = sum over a, b, ... of core[a, b, ...] factors[0][i, a] factors[1][j, b] ...

    Parameters
    ----------
    core : (r_1, r_2, ...)
    factors : sequence of (I_n, r_n)
        Orthonormal columns, the most telling first.
    values : sequence of (min(I_n, rest),)
        Singular values of each unfolding of the whole tensor: how many columns would be enough.
    share : float
        Of the tensor's squared norm that is kept.
    """

    core: np.ndarray
    factors: tuple[np.ndarray, ...]
    values: tuple[np.ndarray, ...]
    share: float = 1.0

    def __post_init__(self) -> None:
        checked(self)
        _check_factors(f"the core has shape {self.core.shape}", self.core.shape, self.factors)

    @property
    def ranks(self) -> tuple[int, ...]:
        """Directions r_n that are kept of every mode."""
        return self.core.shape

    @property
    def numbers(self) -> int:
        """How many numbers it takes to store."""
        return self.core.size + sum(factor.size for factor in self.factors)

    @property
    def full(self) -> np.ndarray:
        """The tensor (I_1, I_2, ...) that it stands for."""
        return _along_all(self.core, self.factors)


@dataclass(frozen=True, eq=False)
class CP:
    """A tensor as a sum of outer products: canonical polyadic decomposition, or PARAFAC.

    X[i, j, ...] = sum over r of weights[r] factors[0][i, r] factors[1][j, r] ...

    Unlike Tucker's directions those of CP need not be orthogonal, and are mostly unique: each
    component is one cause with its own course along every mode.

    Parameters
    ----------
    weights : (R,)
        Largest first.
    factors : sequence of (I_n, R)
        Columns of unit length.
    share : float
        Of the tensor's squared norm that is kept.
    """

    weights: np.ndarray
    factors: tuple[np.ndarray, ...]
    share: float = 1.0

    def __post_init__(self) -> None:
        checked(self)
        shape = self.weights.shape
        ranks = shape * len(self.factors) if len(shape) == 1 else ()
        _check_factors(f"weights have shape {shape}", ranks, self.factors)

    @property
    def rank(self) -> int:
        """Number of components R."""
        return len(self.weights)

    @property
    def full(self) -> np.ndarray:
        """The tensor (I_1, I_2, ...) that it stands for."""
        shape = [len(factor) for factor in self.factors]
        return (_khatri_rao(self.factors) @ self.weights).reshape(shape)


@border
def tucker(
    tensor: np.ndarray,
    ranks: Sequence[Count] | None = None,
    *,
    share: Share = 0.99,
    tolerance: Positive = 1e-10,
    max_iterations: Steps = 50,
) -> Tucker:
    """Tucker decomposition: truncated HOSVD, then orthogonal iteration (Section 9).

    Parameters
    ----------
    tensor : (I_1, I_2, ...)
        With two modes or more.
    ranks : sequence of int, optional
        Directions kept of every mode; by default as few as keep ``share``.
    share : float
        Of the squared norm that is kept at least, where no ranks are given: every mode loses at
        most its part of the rest, and all losses add up at worst.
    tolerance, max_iterations
        The iteration ends when it gains less than this share, or after so many rounds. With ranks
        chosen by ``share`` it can only keep more than asked for.

    Raises
    ------
    ArgumentError
        A tensor of one mode or without entries, or ranks that do not fit its shape.
    """
    x, size = _scaled(tensor)
    left, values = zip(
        *(np.linalg.svd(unfold(x, mode), full_matrices=False)[:2] for mode in range(x.ndim)),
        strict=True,
    )
    if ranks is None:
        kept = [_enough(s, (1 - share) / x.ndim) for s in values]
    else:
        kept = _fitting(list(ranks), [u.shape[1] for u in left])
    factors = [u[:, :r] for u, r in zip(left, kept, strict=True)]
    total, reached = max(float((x**2).sum()), 1e-300), -np.inf
    for _ in range(max_iterations):
        for mode, rank in enumerate(kept):
            seen = unfold(_along_all(x, [f.T for f in factors], without=mode), mode)
            factors[mode] = np.linalg.svd(seen, full_matrices=False)[:2][0][:, :rank]
            if factors[mode].shape[1] < rank:  # the other ranks leave fewer directions than that
                factors[mode] = left[mode][:, :rank]
        norm = float((_along_all(x, [f.T for f in factors]) ** 2).sum())
        if norm - reached <= tolerance * total:
            break
        reached = norm
    factors = [_signed(factor) for factor in factors]
    core = _along_all(x, [f.T for f in factors])
    kept_share = min(float((core**2).sum()) / total, 1.0) if size > 0 else 1.0
    return Tucker(size * core, tuple(factors), tuple(size * s for s in values), kept_share)


@border
def cp(
    tensor: np.ndarray,
    rank: Count,
    *,
    tolerance: Positive = 1e-10,
    max_iterations: Steps = 500,
    rng: np.random.Generator | int | None = None,
) -> CP:
    """CP decomposition by alternating least squares, the best of several starts (Section 9).

    Parameters
    ----------
    tensor : (I_1, I_2, ...)
        With two modes or more.
    rank : int
        Number of components, at most the product of all lengths but the largest.
    tolerance, max_iterations
        A start ends when it gains less than this share of the squared norm, or after so many
        rounds.
    rng : numpy Generator or seed, optional
        Draws the starts; default a fixed seed.

    Raises
    ------
    ArgumentError
        A tensor of one mode or without entries, or more components than could be told apart.
    """
    x, size = _scaled(tensor)
    most = x.size // max(x.shape)
    if rank > most:
        raise ArgumentError(
            f"rank is {rank}; a tensor of shape {x.shape} has at most {most} components"
        )
    random = generator("rng", rng, 0)
    unfolded = [unfold(x, mode) for mode in range(x.ndim)]
    best: tuple[float, list[np.ndarray]] | None = None
    for start in range(STARTS):
        factors = [random.standard_normal((length, rank)) for length in x.shape]
        if start == 0:
            for factor, matrix in zip(factors, unfolded, strict=True):
                leading = np.linalg.svd(matrix, full_matrices=False)[:2][0][:, :rank]
                factor[:, : leading.shape[1]] = leading
        found = _alternate(unfolded, factors, tolerance, max_iterations)
        if best is None or found[0] < best[0]:
            best = found
    assert best is not None
    lost, factors = best
    lengths = [np.linalg.norm(factor, axis=0) for factor in factors]
    weights = size * np.prod(lengths, axis=0)
    order = np.argsort(-weights)
    units = [(f / np.where(s > 0, s, 1.0))[:, order] for f, s in zip(factors, lengths, strict=True)]
    total = max(float((x**2).sum()), 1e-300)
    return CP(weights[order], tuple(units), max(1 - lost / total, 0.0))


def unfold(tensor: np.ndarray, mode: int) -> np.ndarray:
    """The matrix (I_mode, all others) whose rows are one axis of a tensor."""
    return np.moveaxis(tensor, mode, 0).reshape(tensor.shape[mode], -1)


def _alternate(
    unfolded: list[np.ndarray], factors: list[np.ndarray], tolerance: float, rounds: int
) -> tuple[float, list[np.ndarray]]:
    """Squared norm of what is left, and factors: one mode after another by least squares."""
    total, lost = float((unfolded[0] ** 2).sum()), np.inf
    for _ in range(rounds):
        for mode, matrix in enumerate(unfolded):
            others = factors[:mode] + factors[mode + 1 :]
            known = _khatri_rao(others)
            gram = np.prod([f.T @ f for f in others], axis=0)
            factors[mode] = matrix @ known @ np.linalg.pinv(gram, rcond=1e-12, hermitian=True)
            if mode < len(unfolded) - 1:  # lengths stay in the last mode
                length = np.linalg.norm(factors[mode], axis=0)
                factors[mode] = factors[mode] / np.where(length > 0, length, 1.0)
        left = float(((unfolded[-1] - factors[-1] @ known.T) ** 2).sum())
        if lost - left <= tolerance * total:
            return min(left, lost), factors
        lost = left
    return lost, factors


def _khatri_rao(factors: Sequence[np.ndarray]) -> np.ndarray:
    """Column by column the outer product of all factors (I_n, R), unfolded: (product, R)."""
    product = np.ones((1, factors[0].shape[1]))
    for factor in factors:
        product = (product[:, None] * factor).reshape(-1, factor.shape[1])
    return product


def _along_all(
    tensor: np.ndarray, matrices: Sequence[np.ndarray], without: int | None = None
) -> np.ndarray:
    """Multiply every mode of a tensor with a matrix (J_n, I_n), perhaps all but one."""
    for mode, matrix in enumerate(matrices):
        if mode != without:
            tensor = np.moveaxis(np.tensordot(matrix, tensor, (1, mode)), 0, mode)
    return tensor


def _signed(factor: np.ndarray) -> np.ndarray:
    """The factor with the largest entry of every column positive: the same data, the same signs."""
    largest = factor[np.abs(factor).argmax(0), np.arange(factor.shape[1])]
    return factor * np.where(largest < 0, -1.0, 1.0)


def _enough(values: np.ndarray, loss: float) -> int:
    """How many singular values to keep so that at most this share of all squares is lost."""
    squares = np.cumsum(values[::-1] ** 2)[::-1]
    # What is rounding alone is not kept either.
    return max(int((squares > (loss + 1e-20) * squares[0]).sum()), 1)


def _fitting(ranks: list[int], most: list[int]) -> list[int]:
    if len(ranks) != len(most) or any(r > m for r, m in zip(ranks, most, strict=True)):
        raise ArgumentError(
            f"ranks are {ranks}; give one for each mode of the tensor, at most {most}"
        )
    return ranks


def _scaled(tensor: np.ndarray) -> tuple[np.ndarray, float]:
    """A tensor whose largest entry is one, and the factor; or zeros, and zero."""
    if tensor.ndim < 2 or tensor.size == 0:
        raise ArgumentError(
            f"tensor has shape {tensor.shape}; give two modes or more, none of them empty"
        )
    size = float(np.abs(tensor).max())
    return tensor / size if size > 0 else tensor, size


def _check_factors(given: str, ranks: tuple[int, ...], factors: tuple[np.ndarray, ...]) -> None:
    shapes = [factor.shape for factor in factors]
    if (
        not factors
        or [len(s) for s in shapes] != [2] * len(ranks)
        or any(s[1] != r for s, r in zip(shapes, ranks, strict=True))
    ):
        raise ArgumentError(
            f"{given} and factors have {shapes}; give factors (I_n, r_n), one for every mode"
        )
