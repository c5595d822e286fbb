"""The work of a manifold: its factors' maps on all of its columns at once, unchecked and fast."""

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from tpsim.manifold.orientations import Rotations
from tpsim.manifold.spaces import Euclidean, Space
from tpsim.manifold.sphere import Sphere


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
        return tuple(b for b in self.blocks if isinstance(b.space, Sphere | Rotations))

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
        found = [
            (b, b.space.seen(x[..., b.columns], y[..., b.columns]))
            for b in self.blocks
            if not b.space.flat
        ]
        lead = (
            found[0][1][0].shape[:-1] if found else np.broadcast_shapes(x.shape[:-1], y.shape[:-1])
        )
        v, slope = np.empty((*lead, self.dim)), self._identity(lead)
        for (_, _, rows), (way, stretch) in found:
            v[..., rows], slope[..., rows, rows] = way, stretch
        for space, columns, rows in self.blocks:
            if space.flat:
                np.subtract(y[..., columns], x[..., columns], out=v[..., rows])
        return v, slope

    def _identity(self, lead: tuple[int, ...]) -> np.ndarray:
        found = np.empty((*lead, self.dim, self.dim))
        found[...] = self._eye
        return found

    @cached_property
    def _eye(self) -> np.ndarray:
        return np.eye(self.dim)

    def centre(self, y: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Point (..., width) near the mean of points (N, width), with weights (..., N)."""
        return np.concatenate(
            [space.centre(y[:, columns], weights) for space, columns, _ in self.blocks], axis=-1
        )

    def rigid(self, A: np.ndarray) -> bool:
        """Whether a frame's A (..., width, width) keeps lengths."""
        return bool(np.abs(A @ A.mT - np.eye(self.width)).max() < 1e-9)

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
