"""What keeps the covariances of a mixture away from singular, Eqs (7) and (8).

The default is Eq. (7) with a floor that the data set, because the usual ridge of 1e-8 overfits:
a component may then shrink onto a few samples and claim to know them a thousand times better
than the data can say. With N samples of dimension D whose own covariance is M, no component may
be narrower than c M with

    c = max((D + 1) / N (3 %)^2, (0.1 %)^2):

as if D + 1 further samples, spread by 3 % of the data, had been seen by every component. The
floor has no unit; it follows the data through rotations and scalings; and since clipping
eigenvalues at a floor is the exact maximum of the likelihood above that floor, EM never lowers
the likelihood. A ridge (Eq. 8) has no such guarantee; it is there to reproduce the reference.
"""

from dataclasses import dataclass

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.gaussian import add_ridge, symmetric
from tpsim.learning.moments import Moments
from tpsim.learning.start import RESOLUTION

SPREAD = 0.03  # of the data: how widely the D + 1 imagined samples lie
LEAST = 0.001  # of the data: narrower than this is never believed
DEGENERATE = 1e-3  # least eigenvalue of the correlations, and variance of a constant column


@dataclass(frozen=True, eq=False)
class Ridge:
    """Adds rho I to every covariance of every M-step, Eq. (8)."""

    rho: float

    def scatter(self, S: np.ndarray) -> np.ndarray:
        """Covariance that the structure is fitted to."""
        return add_ridge(S, self.rho)

    def full(self, covariance: np.ndarray) -> np.ndarray:
        """Limit full covariances (G, K, d, d): a ridge has none."""
        return covariance

    def variances(self, variances: np.ndarray) -> np.ndarray:
        """Limit the variances (G, K, d) of single variables: a ridge has none."""
        return variances

    def isotropic(self, variances: np.ndarray) -> np.ndarray:
        """Limit variances (G, K, n) along any direction: a ridge has none."""
        return variances


@dataclass(frozen=True, eq=False)
class Floor:
    """Keeps every covariance above ``least``, Eq. (7) in the metric of the data.

    Parameters
    ----------
    least : (G, 1, d, d)
        The smallest covariance, per frame.
    """

    least: np.ndarray

    def scatter(self, S: np.ndarray) -> np.ndarray:
        """Covariance that the structure is fitted to: the data's own."""
        return S

    def full(self, covariance: np.ndarray) -> np.ndarray:
        """Raise covariances to at least ``least``."""
        try:
            np.linalg.cholesky(covariance - self.least)
        except np.linalg.LinAlgError:
            return self._clip(covariance)
        return covariance

    def variances(self, variances: np.ndarray) -> np.ndarray:
        """Raise the variances of single variables."""
        return np.maximum(variances, np.diagonal(self.least, axis1=-2, axis2=-1))

    def isotropic(self, variances: np.ndarray) -> np.ndarray:
        """Raise variances along any direction to the mean of ``least``."""
        trace = np.trace(self.least, axis1=-2, axis2=-1)[..., None]
        return np.maximum(variances, trace / self.least.shape[-1])

    def _clip(self, covariance: np.ndarray) -> np.ndarray:
        """Clip eigenvalues at one in the metric where ``least`` is the identity."""
        L = np.linalg.cholesky(self.least)
        W = np.linalg.inv(L)
        eigenvalues, V = np.linalg.eigh(symmetric(W @ covariance @ W.mT))
        root = L @ V
        clipped = (root * np.maximum(eigenvalues, 1.0)[..., None, :]) @ root.mT
        return np.where(
            (eigenvalues.min(-1) < 1.0)[..., None, None], symmetric(clipped), covariance
        )


Regularisation = Ridge | Floor


def data_floors(total: Moments) -> tuple[Floor, ...]:
    """Floors that the data set, one per group of frames; see the module's docstring.

    Parameters
    ----------
    total : Moments
        Of all samples, as one group.

    Raises
    ------
    ArgumentError
        All samples are the same point.
    """
    scales = [_mean_variance(scatter) for scatter in total.scatter]
    fallback = max(scale.max() for scale in scales)
    if not fallback > 0:
        raise ArgumentError("all samples are the same point; a Gaussian needs samples that differ")
    floors = []
    for mean, scatter, scale in zip(total.mean, total.scatter, scales, strict=True):
        share = max((mean.shape[-1] + 1) / total.weight[0] * SPREAD**2, LEAST**2)
        # A frame in which nothing moves has no scale of its own: it takes the largest one.
        scale = np.where(scale > 0, scale, fallback)
        floors.append(Floor(share * _loosened(mean, scatter, scale)))
    return tuple(floors)


def _mean_variance(scatter: np.ndarray) -> np.ndarray:
    return np.trace(scatter, axis1=-2, axis2=-1)[..., None] / scatter.shape[-1]


def _loosened(mean: np.ndarray, scatter: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Covariance of the data with constant columns and perfect correlations loosened."""
    variances = np.diagonal(scatter, axis1=-2, axis2=-1)
    constant = variances <= (RESOLUTION * mean) ** 2
    unknown = np.maximum(DEGENERATE * scale, (RESOLUTION / LEAST**2 * mean) ** 2)
    deviations = np.sqrt(np.where(constant, unknown, variances))
    outer = deviations[..., :, None] * deviations[..., None, :]
    known = ~(constant[..., :, None] | constant[..., None, :])
    correlation = np.where(known, scatter / outer, np.eye(mean.shape[-1]))
    eigenvalues, V = np.linalg.eigh(correlation)
    correlation = (V * np.maximum(eigenvalues, DEGENERATE)[..., None, :]) @ V.mT
    return symmetric(correlation) * outer
