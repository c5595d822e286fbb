"""Radial basis functions over the phase of a movement, and regression on them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.checks import affordable, array_of, finite_array, number
from tpsim.errors import ArgumentError
from tpsim.gaussian import add_ridge

STIFF = 1e-6  # of the samples that a basis function has: how much neighbouring weights agree


def radial_basis(steps: int | ArrayLike, count: int, width: float | None = None) -> NDArray:
    """Radial basis functions (T, K) over the phase 0..1, summing to one at every step.

    Parameters
    ----------
    steps
        Number of evenly spaced time steps T, or the phases (T,) themselves.
    count
        Number of functions K, centred from phase 0 to 1.
    width
        Standard deviation of each, in phase; by default the distance between centres.
    """
    if array_of("steps", steps).ndim == 0:
        at = np.linspace(0, 1, affordable("steps", steps))
    else:
        at = finite_array("steps", steps)
        if at.ndim != 1 or len(at) == 0:
            raise ArgumentError(f"steps have shape {at.shape}; give a number, or phases (T,)")
    count = affordable("count", count, len(at))
    width = 1 / max(count - 1, 1) if width is None else number("width", width, above=0)
    log = -0.5 * ((at[:, None] - np.linspace(0, 1, count)) / width) ** 2
    basis = np.exp(log - log.max(1, keepdims=True))
    return basis / basis.sum(1, keepdims=True)


def regress(path: NDArray, basis: NDArray, ridge: float | None) -> NDArray:
    """Weights (K, D) of one trajectory (T, D) in basis functions (T, K)."""
    normal = basis.T @ basis
    if ridge is not None:
        return np.linalg.solve(add_ridge(normal, ridge), basis.T @ path)
    centre = path.mean(0)
    apart = np.diff(np.eye(normal.shape[0]), axis=0)
    normal = normal + STIFF * np.trace(normal) / len(normal) * (apart.T @ apart)
    return np.linalg.solve(normal, basis.T @ (path - centre)) + centre
