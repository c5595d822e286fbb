"""Weighted moments of samples: what EM needs of them, and all that a model remembers."""

from dataclasses import dataclass

import numpy as np

from tpsim.archive import Part
from tpsim.learning.start import clusters

CAPACITY = 1024  # runs of samples that a model remembers


@dataclass(frozen=True, eq=False)
class Moments(Part):
    """Weight, mean and scatter of K groups of samples, in frames grouped by dimension.

    Parameters
    ----------
    weight : (K,)
        Sum of responsibilities, or number of samples.
    mean : tuple of (G, K, d)
        Per group of frames, dimensions increasing.
    scatter : tuple of (G, K, d, d)
        Covariance around ``mean``, per group of frames.
    seen : tuple of (G, K), optional
        Sum of responsibilities of the samples that each frame saw, where not all saw all.
    """

    weight: np.ndarray
    mean: tuple[np.ndarray, ...]
    scatter: tuple[np.ndarray, ...]
    seen: tuple[np.ndarray, ...] | None = None

    @property
    def of_frames(self) -> tuple[np.ndarray, ...]:
        """Weights (K,) or (G, K) behind the moments of every group of frames."""
        return (self.weight,) * len(self.mean) if self.seen is None else self.seen

    def pooled(self, labels: np.ndarray, count: int) -> "Moments":
        """Moments of ``count`` unions of groups, none of them empty."""
        share = np.where(labels == np.arange(count)[:, None], self.weight, 0.0)
        weight = share.sum(1)
        share /= weight[:, None]
        means, scatters = [], []
        for mean, scatter in zip(self.mean, self.scatter, strict=True):
            pooled = share @ mean
            deviation = mean - pooled[:, labels]
            spread = scatter + deviation[..., :, None] * deviation[..., None, :]
            flat = spread.reshape(*spread.shape[:2], -1)
            means.append(pooled)
            scatters.append((share @ flat).reshape(*pooled.shape, -1))
        return Moments(weight, tuple(means), tuple(scatters))


@dataclass(frozen=True, eq=False)
class Memory(Part):
    """Short runs of successive samples, of which only moments are kept.

    Parameters
    ----------
    moments : Moments
        Of L runs.
    time : (L,)
        Mean time of each run, 0 at the start of a movement and 1 at its end.
    """

    moments: Moments
    time: np.ndarray

    def times(self, factor: float) -> "Memory":
        """Let every sample count ``factor`` times."""
        moments = self.moments
        return Memory(Moments(factor * moments.weight, moments.mean, moments.scatter), self.time)

    def within(self, capacity: int = CAPACITY) -> "Memory":
        """Pool neighbours until at most ``capacity`` runs are left."""
        if len(self.time) <= capacity:
            return self
        views = [mean for part in self.moments.mean for mean in part]
        labels = clusters(views, capacity, np.random.default_rng(0), max_iterations=10)
        _, labels = np.unique(labels, return_inverse=True)
        weight = self.moments.weight
        time = np.bincount(labels, weight * self.time) / np.bincount(labels, weight)
        return Memory(self.moments.pooled(labels, len(time)), time)
