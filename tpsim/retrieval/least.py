"""The least variance that a model believes: a share of what varies there, without any unit."""

import numpy as np
from numpy.typing import NDArray

VANISHING = 1e-20  # of the largest variance: what rounding leaves of zero


def least_variances(local: NDArray, share: float) -> NDArray:
    """Least variances (n, D) where variables have variances (n, D) from place to place.

    A share of the variance at each place; at least the same share once more of the variable's
    mean over all places, since it may rest somewhere. A variable that never varies takes the
    largest of the others.

    Parameters
    ----------
    local : (n, D)
        Variances that were seen.
    share : float
        Squared, what is believed to be unknown.
    """
    typical = local.mean(0)
    largest = typical.max()
    typical = np.where(typical > VANISHING * largest, typical, largest)
    return share**2 * np.maximum(local, share**2 * typical)
