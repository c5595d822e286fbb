"""What joints do in the place of others that have come to their limits."""

import numpy as np
from scipy.optimize import lsq_linear


def nearest_within(
    step: np.ndarray, root: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> np.ndarray:
    """Step (n,) that joints can make, as near to another as a precision W = root^T root asks.

    The step most likely under a Gaussian of mean ``step`` and precision W, of those between
    ``lower`` and ``upper``: that of the Gaussian conditioned on the joints that are at a limit
    there, Eqs (14) and (15). Where a frame is precise, the other joints keep to it as far as they
    can.

    Parameters
    ----------
    step : (n,)
        What is wanted [rad].
    root : (n, n)
        [1/rad]
    lower, upper : (n,)
        [rad]

    Returns
    -------
    (n,) ndarray
        ``step`` itself where it is within.
    """
    if ((lower <= step) & (step <= upper)).all():
        return step
    # A joint that is beyond its limit already has no room.
    found = lsq_linear(root, root @ step, (lower, np.maximum(upper, lower + 1e-9)), method="bvls")
    nearest: np.ndarray = found.x
    return nearest
