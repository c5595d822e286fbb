"""What keeps the covariances of a mixture away from singular, Eqs (7) and (8).

The default is Eq. (7) with a floor that the data set, because the usual ridge of 1e-8 overfits:
a component may then shrink onto a few samples and claim to know them a thousand times better
than the data can say. A component that EM starts on N samples of dimension D with covariance S,
out of data with covariance M, may not become narrower than c (S + w M) with

    c = max((D + 1) / N (3 %)^2, (0.1 %)^2),    w = ((D + 1) / N)^2 (20 %)^2:

as if D + 1 further samples, spread by 3 % of what it started on, had been seen; M stands for what
few samples cannot know of their own extent. The floor is local: how precise a movement is at its
end does not depend on how long its approach was. It has no unit; it follows the data through
rotations and scalings; and since clipping eigenvalues at a floor is the exact maximum of the
likelihood above that floor, EM never lowers the likelihood. A ridge (Eq. 8) has no such guarantee;
it is there to reproduce the reference.
"""

from dataclasses import dataclass

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.gaussian import symmetric
from tpsim.learning.moments import Moments
from tpsim.learning.start import RESOLUTION

SPREAD = 0.03  # of the data: how widely the D + 1 imagined samples lie
LEAST = 0.001  # of the data: narrower than this is never believed
WIDE = 0.2  # of the data: what as many samples as a Gaussian needs leave open of their extent
EXACT = 1e-9  # eigenvalue of the correlations below which two columns say the same
DEGENERATE = 1e-3  # least eigenvalue of the correlations, and variance of a constant column


@dataclass(frozen=True, eq=False)
class Ridge:
    """Adds rho I to every covariance of every M-step, Eq. (8)."""

    rho: float

    def scatter(self, S: np.ndarray) -> np.ndarray:
        """Covariance that the structure is fitted to."""
        return S + self.rho * np.eye(S.shape[-1])

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
    least : (G, K, d, d)
        The smallest covariance, per frame and component.
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


def data_floors(total: Moments, parts: Moments) -> tuple[Floor, ...]:
    """Floors that the data set, one per group of frames; see the module's docstring.

    Parameters
    ----------
    total : Moments
        Of all samples, as one group.
    parts : Moments
        Of the K groups of samples on which the components start.

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
    for mean, scatter, part, scale, weight in zip(
        total.mean, total.scatter, parts.scatter, scales, parts.of_frames, strict=True
    ):
        count = np.maximum(weight, 1.0)
        further = ((mean.shape[-1] + 1) / count)[..., None, None]
        share = np.maximum(further * SPREAD**2, LEAST**2)
        few = np.clip(further**2 * WIDE**2, LEAST**2, 1.0)
        # A frame in which nothing moves has no scale of its own: it takes the largest one.
        scale = np.where(scale > 0, scale, fallback)
        whole, unknown = _loosened(mean, scatter, scale)
        floors.append(Floor(share * (part + unknown + few * whole)))
    return tuple(floors)


def _mean_variance(scatter: np.ndarray) -> np.ndarray:
    return np.trace(scatter, axis1=-2, axis2=-1)[..., None] / scatter.shape[-1]


def _loosened(
    mean: np.ndarray, scatter: np.ndarray, scale: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Covariance of the data with constant columns and perfect correlations loosened.

    And the part of it that the data do not know at all: directions that are exactly constant.
    """
    variances = np.diagonal(scatter, axis1=-2, axis2=-1)
    constant = variances <= (RESOLUTION * mean) ** 2
    unknown = np.maximum(DEGENERATE * scale, (RESOLUTION / LEAST**2 * mean) ** 2)
    deviations = np.sqrt(np.where(constant, unknown, variances))
    outer = deviations[..., :, None] * deviations[..., None, :]
    known = ~(constant[..., :, None] | constant[..., None, :])
    correlation = np.where(known, scatter / outer, np.eye(mean.shape[-1]))
    eigenvalues, V = np.linalg.eigh(correlation)

    def with_eigenvalues(values: np.ndarray) -> np.ndarray:
        return symmetric((V * values[..., None, :]) @ V.mT) * outer

    missing = with_eigenvalues(np.where(eigenvalues < EXACT, DEGENERATE, 0.0))
    missing += np.where(constant, unknown, 0.0)[..., None] * np.eye(mean.shape[-1])
    return with_eigenvalues(np.maximum(eigenvalues, DEGENERATE)), missing
