"""Locally weighted regression: a small linear model around every query (Section 8)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import finite_array, number, whole
from tpsim.errors import ArgumentError
from tpsim.gaussian import WORST_CONDITION, Gaussian
from tpsim.retrieval.least import least_variances

LEAST = 1e-3  # of the spread of the outputs around a query: a smaller error is never believed


FAR = 40.0
"""Widths away from a query at which the weight of an input has vanished."""


def lwr(
    inputs: ArrayLike,
    outputs: ArrayLike,
    queries: ArrayLike,
    width: float,
    *,
    degree: int = 1,
    ridge: float | None = None,
) -> Gaussian:
    """Locally weighted regression with the spread of the data around it (TP-LWR, Fig. 13).

    At each query a polynomial is fitted by least squares under Gaussian weights; its residuals,
    under the same weights, give the covariance.

    Parameters
    ----------
    inputs
        (N,), usually the time of every sample of all demonstrations [s].
    outputs
        (N, O).
    queries
        (T,).
    width
        Standard deviation of the Gaussian weights, in the units of the inputs.
    degree
        Degree of the local polynomial: 0 averages, 1 is the usual line.
    ridge
        Added to the diagonal of the covariance (Eq. 8), in squared units of the outputs. By
        default no variance is smaller than a millionth of that of its own output around the
        query, whatever the unit.

    Returns
    -------
    Gaussian with mean (T, O) and covariance (T, O, O).

    Raises
    ------
    ArgumentError
        Shapes that do not fit, or a query whose neighbourhood does not determine the polynomial.
    """
    inputs, y = finite_array("inputs", inputs), finite_array("outputs", outputs)
    queries = np.atleast_1d(finite_array("queries", queries))
    if inputs.ndim != 1 or y.ndim != 2 or len(inputs) != len(y) or queries.ndim != 1:
        raise ArgumentError(
            f"inputs {inputs.shape}, outputs {y.shape} and queries {queries.shape} must be "
            "(N,), (N, O) and (T,)"
        )
    width, degree = number("width", width, above=0), whole("degree", degree, most=20)
    ridge = None if ridge is None else number("ridge", ridge, least=0)
    with np.errstate(over="ignore"):  # Clipped: what is far away has no weight.
        z = np.clip((inputs - queries[:, None]) / width, -FAR, FAR)
    h = np.exp(-0.5 * z**2)
    reached = h.sum(1) > 1e-12
    if not reached.all():
        raise ArgumentError(
            f"The query {queries[~reached][0]:g} is more than 7 widths from every input "
            f"({inputs.min():g} to {inputs.max():g}). Stay in that range or give a larger width"
        )
    h /= h.sum(1, keepdims=True)
    powers = z[..., None] ** np.arange(degree + 1)
    weighted = powers.mT * h[:, None]
    normal = weighted @ powers
    if not (np.linalg.cond(normal) < WORST_CONDITION).all():
        raise ArgumentError(f"Too few inputs around a query for degree {degree}; widen the width")
    centre = y.mean(0)
    y = y - centre
    polynomial = np.linalg.solve(normal, weighted @ y)
    residual = y - powers @ polynomial
    covariance = (residual * h[..., None]).mT @ residual
    if ridge is None:
        local = np.maximum(h @ y**2 - (h @ y) ** 2, 0.0)
        added = least_variances(local, LEAST) - np.diagonal(covariance, axis1=1, axis2=2)
        covariance += np.maximum(added, 0.0)[..., None] * np.eye(y.shape[1])
    else:
        covariance += ridge * np.eye(y.shape[1])
    return Gaussian.trusted(polynomial[:, 0] + centre, covariance)
