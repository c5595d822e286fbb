"""The work of a manifold: its factors' maps on all of its columns at once, unchecked and fast."""

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from tpsim.manifold.spaces import Euclidean, Space
from tpsim.manifold.unit import identity


class Block(NamedTuple):
    """Neighbouring factors that are computed together, with their columns and tangent rows."""

    space: Space
    columns: slice
    rows: slice


class Charts:
    """Maps between points (..., width) and tangent spaces (..., dim) of a product of factors.

    Arrays must be points: the border is :class:`~tpsim.Manifold`. Leading axes broadcast.

    Attributes
    ----------
    single : tuple of Block
        Every factor with its places.
    width, dim : int
    flat : bool
    """

    def __init__(self, spaces: Sequence[Space]):
        found, column, row = [], 0, 0
        for space in spaces:
            ends = column + space.width, row + space.dim
            found.append(Block(space, slice(column, ends[0]), slice(row, ends[1])))
            column, row = ends
        self.single, self.width, self.dim = tuple(found), column, row
        self.flat = all(space.flat for space in spaces)

    def __str__(self) -> str:
        return " * ".join(str(block.space) for block in self.single)

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """Factors with their places, neighbours that are flat as one."""
        found: list[Block] = []
        for block in self.single:
            if found and block.space.flat and found[-1].space.flat:
                last = found.pop()
                size = last.space.width + block.space.width
                block = Block(
                    Euclidean(size),
                    slice(last.columns.start, block.columns.stop),
                    slice(last.rows.start, block.rows.stop),
                )
            found.append(block)
        return tuple(found)

    @cached_property
    def curved(self) -> tuple[Block, ...]:
        """Factors in which tangent spaces differ."""
        return tuple(b for b in self.blocks if b.space.curved)

    @cached_property
    def curved_rows(self) -> np.ndarray:
        """Their tangent rows."""
        return np.array([i for b in self.curved for i in range(b.rows.start, b.rows.stop)], int)

    def log(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Tangent vectors (..., dim) at x that lead to y, along the shortest way."""
        if self.flat:
            return y - x
        if len(self.blocks) == 1:
            return self.blocks[0].space.log(x, y)
        parts = [b.space.log(x[..., b.columns], y[..., b.columns]) for b in self.blocks]
        return _joined(parts, [b.rows for b in self.blocks], self.dim)

    def log_of_columns(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Tangent vectors (G, K, dim, N) at points x (G, K, width) to points y (G, width, N)."""
        v = np.empty((*x.shape[:-1], self.dim, y.shape[-1]))
        for space, columns, rows in self.blocks:
            space.log_of_columns(x[..., columns], y[..., columns, :], v[..., rows, :])
        return v

    def exp(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Points (..., width) to which tangent vectors at x lead."""
        if self.flat:
            return x + v
        if len(self.blocks) == 1:
            return self.blocks[0].space.exp(x, v)
        parts = [b.space.exp(x[..., b.columns], v[..., b.rows]) for b in self.blocks]
        return _joined(parts, [b.columns for b in self.blocks], self.width)

    def stepped(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Where :meth:`exp` leads to second order: enough for steps that become none."""
        y = np.empty(x.shape)
        for space, columns, rows in self.blocks:
            y[..., columns] = space.stepped(x[..., columns], v[..., rows])
        return y

    def transport(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Parallel transport (..., dim, dim) of tangent coordinates at x to those at y."""
        turn = self._identity(np.broadcast_shapes(x.shape[:-1], y.shape[:-1]))
        for space, columns, rows in self.curved:
            turn[..., rows, rows] = space.transport(x[..., columns], y[..., columns])
        return turn

    def slope(self, x: np.ndarray, y: np.ndarray, v: np.ndarray) -> np.ndarray:
        """How ``log_y`` of a point changes as it moves from x: (..., dim, dim), v = log_x(y)."""
        slope = self._identity(v.shape[:-1])
        for space, columns, rows in self.curved:
            slope[..., rows, rows] = space.slope(x[..., columns], y[..., columns], v[..., rows])
        return slope

    def seen(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Tangent vectors (..., dim) at x that lead to y, and :meth:`slope`."""
        v = self.log(x, y)
        return v, self.slope(x, y, v)

    def linearised(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """:meth:`slope` and, in the last column, what it makes of v: (..., dim, dim + 1)."""
        lead = np.broadcast(x[..., 0], y[..., 0]).shape
        found = np.empty((*lead, self.dim, self.dim + 1))
        found[...] = self._eye_and_zero
        for space, columns, rows in self.blocks:
            if space.curved:
                one = space.linearised(x[..., columns], y[..., columns])
                if rows.stop == self.dim:
                    found[..., rows, rows.start :] = one
                    continue
                found[..., rows, rows], found[..., rows, -1] = one[..., :-1], one[..., -1]
            else:
                found[..., rows, -1] = space.log(x[..., columns], y[..., columns])
        return found

    def carrying(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Tangent vectors (..., dim) at x that lead to y, and the inverse of :meth:`slope`.

        It carries tangent coordinates at y to those at x.
        """
        lead = np.broadcast(x[..., 0], y[..., 0]).shape
        v, carry = np.empty((*lead, self.dim)), self._identity(lead)
        for space, columns, rows in self.blocks:
            if space.curved:
                one = space.carrying(x[..., columns], y[..., columns])
                v[..., rows], carry[..., rows, rows] = one
            else:
                v[..., rows] = space.log(x[..., columns], y[..., columns])
        return v, carry

    def departing(self, x: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (..., width) to which tangent vectors lead, and what carries coordinates there.

        It is :meth:`carrying` seen from x.
        """
        lead = np.broadcast(x[..., 0], v[..., 0]).shape
        y, carry = np.empty((*lead, self.width)), self._identity(lead)
        for space, columns, rows in self.blocks:
            if space.curved:
                one = space.departing(x[..., columns], v[..., rows])
                y[..., columns], carry[..., rows, rows] = one
            else:
                y[..., columns] = space.exp(x[..., columns], v[..., rows])
        return y, carry

    def _identity(self, lead: tuple[int, ...]) -> np.ndarray:
        found = np.empty((*lead, self.dim, self.dim))
        found[...] = identity(self.dim)
        return found

    @cached_property
    def _eye_and_zero(self) -> np.ndarray:
        return np.eye(self.dim, self.dim + 1)

    def centre(self, y: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Point (..., width) near the mean of points (N, width), with weights (..., N)."""
        return np.concatenate(
            [space.centre(y[:, columns], weights) for space, columns, _ in self.blocks], axis=-1
        )

    def near_mean(self, weights: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Point (..., width) near the mean of few points (..., K, width), weights (..., K)."""
        if weights.ndim == 1 and y.ndim == 2:
            heaviest = y[weights.argmax()]
        else:
            heaviest = np.take_along_axis(y, weights.argmax(-1)[..., None, None], -2)[..., 0, :]
        found = np.empty(heaviest.shape)
        for space, columns, _ in self.blocks:
            found[..., columns] = space.near_mean(weights, y[..., columns], heaviest[..., columns])
        return found

    def moved(self, A: np.ndarray, b: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Images (..., width) of points under frames A (..., n, n), b (..., n), and tangent maps.

        The latter (..., dim, dim) lead from the points to their images.
        """
        lead = np.broadcast(b[..., 0], x[..., 0]).shape
        y, turn = np.empty((*lead, self.width)), self._identity(lead)
        for space, columns, rows in self.single:
            turn[..., rows, rows] = space.moved(A, b, x[..., columns], y[..., columns])
        return y, turn

    def turned(self, A: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Tangent map (..., dim, dim) of a frame, from points x to their images y."""
        if self.flat:
            return A
        lead = np.broadcast_shapes(A.shape[:-2], x.shape[:-1])
        turn = np.zeros((*lead, self.dim, self.dim))
        for space, columns, rows in self.blocks:
            turn[..., rows, rows] = space.turned(
                A[..., columns, columns], x[..., columns], y[..., columns]
            )
        return turn


def _joined(parts: list[np.ndarray], places: list[slice], size: int) -> np.ndarray:
    """Arrays side by side along the last axis: for arrays so small faster than joining them."""
    found = np.empty((*parts[0].shape[:-1], size))
    for part, place in zip(parts, places, strict=True):
        found[..., place] = part
    return found
