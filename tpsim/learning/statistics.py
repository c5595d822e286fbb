"""Sufficient statistics of samples seen from several frames: EM as two matrix products.

A Gaussian log density is linear in the features [1, x, vech(x x')] of a sample, and so is a
log density over independent frames in the features of all frames together. One product with the
features gives the densities of all samples and components (E-step, Eq. 49); one product of
responsibilities with the same features gives all weighted moments (M-step, Eqs 50-52). Each
frame is centred and scaled first, which keeps the cancellation in S = E[x x'] - mu mu' harmless.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tpsim.checks import LARGEST
from tpsim.errors import ArgumentError
from tpsim.gaussian import LOG_2PI, cholesky
from tpsim.learning.moments import CAPACITY, Memory, Moments
from tpsim.learning.start import RESOLUTION

CACHE_BYTES = 2**28  # features are kept up to this size, else made anew in every pass
BLOCK_BYTES = 2**20  # one block of samples at a time: what stays in the processor's cache
SEGMENT = 2  # successive samples that a model remembers as one
FAINTEST = -200.0  # log of the least responsibility: smaller ones make slow subnormal numbers


@dataclass(frozen=True, eq=False)
class Components:
    """K Gaussians in each of G frames of equal dimension: the parameters that EM moves.

    Parameters
    ----------
    mean : (G, K, d)
        Centres.
    covariance : (G, K, d, d)
        Covariances.
    factors : tuple of arrays, optional
        State of a factor analyser, see :mod:`tpsim.learning.subspace`.
    """

    mean: np.ndarray
    covariance: np.ndarray
    factors: tuple[np.ndarray, ...] | None = None


class Samples:
    """N samples seen from P frames, (N, d_j) each, ready for the passes of EM.

    Parameters
    ----------
    views : sequence of P arrays (N, d_j)
        What each frame saw.
    memory : Memory, optional
        Earlier samples of which only moments are left; their expected log density is just as
        linear in the features.

    Attributes
    ----------
    groups : tuple of tuples of int
        Frames of equal dimension are handled together.
    count : int
        Number of samples N.
    """

    _own = 0
    """Further features, which a subclass appends."""

    def __init__(self, views: Sequence[np.ndarray], memory: Memory | None = None):
        dims = [view.shape[1] for view in views]
        self.dims = tuple(sorted(set(dims)))
        self.groups = tuple(tuple(j for j, d in enumerate(dims) if d == dim) for dim in self.dims)
        self.count = len(views[0])
        self._memory = memory
        self._triangles = tuple(np.triu_indices(d) for d in self.dims)
        stacks = [np.stack([views[j].T for j in group]) for group in self.groups]
        extent = max(float(np.ptp(stack, axis=-1).max()) for stack in stacks)
        if 0 < extent < 1 / LARGEST:
            raise ArgumentError(
                f"samples differ by {extent:.1e} at most; change units to stay above "
                f"{1 / LARGEST:.0e}"
            )
        self._stacks, self._centres, self._scales = zip(*map(_measured, stacks), strict=True)
        self._size = 1 + sum(
            len(group) * (d + d * (d + 1) // 2)
            for group, d in zip(self.groups, self.dims, strict=True)
        )
        self._size += self._own
        rows = max(64, BLOCK_BYTES // (8 * self._size))
        self._slices = [slice(n, n + rows) for n in range(0, self.count, rows)]
        small = 8 * self._size * self.count <= CACHE_BYTES
        self._cache = [self._features(rows) for rows in self._slices] if small else None

    def log_densities(self, components: Sequence[Components]) -> np.ndarray:
        """Log density of every sample under every component, all frames together, (N, K)."""
        weights = self._weights(components)
        return np.concatenate([(weights @ features).T for _, features in self._blocks()])

    def moments(self, responsibilities: np.ndarray) -> Moments:
        """Moments of the samples, without memory, for responsibilities (N, K), Eqs (50-52)."""
        total = np.zeros((responsibilities.shape[1], self._size))
        for rows, features in self._blocks():
            total += responsibilities[rows].T @ features.T
        return self._moments(total)

    def total(self) -> Moments:
        """Moments of all samples, and of the memory, as one group."""
        total = np.zeros(self._size)
        for _, features in self._blocks():
            total += features.sum(1)
        for weight, features in self._recalled():
            total = total + features @ weight
        return self._moments(total[None])

    def expectation(
        self, priors: np.ndarray, components: Sequence[Components]
    ) -> tuple[float, Moments]:
        """Mean log-likelihood, Eq. (49), and the moments it asks for, in one pass."""
        weights = self._weights(components)
        weights[:, 0] += np.log(priors)
        log_likelihood, count = 0.0, float(self.count)
        total = np.zeros((len(weights), self._size))
        for _, features in self._blocks():
            evidence, joint = _responsibilities(weights @ features)
            log_likelihood += evidence.sum()
            total += joint @ features.T
        for weight, features in self._recalled():
            evidence, joint = _responsibilities(weights @ features)
            log_likelihood += evidence @ weight
            total = total + (joint * weight) @ features.T
            count += weight.sum()
        return float(log_likelihood) / count, self._moments(total)

    def remembered(self, time: np.ndarray, lengths: Sequence[int]) -> Memory:
        """What to remember of the samples, at times (N,), and of the memory."""
        run = max(SEGMENT, -(-2 * self.count // CAPACITY))
        ends = np.cumsum(lengths)
        begun = [np.arange(end - n, end, run) for end, n in zip(ends, lengths, strict=True)]
        cuts = np.unique(np.concatenate([*begun, [rows.start for rows in self._slices]]))
        totals = [
            np.add.reduceat(
                features, cuts[(cuts >= rows.start) & (cuts < rows.stop)] - rows.start, axis=1
            )
            for rows, features in self._blocks()
        ]
        times = [np.add.reduceat(time, cuts) / np.diff(cuts, append=self.count)]
        for weight, features in self._recalled():
            totals.append(features * weight)
        if self._memory is not None:
            times.append(self._memory.time)
        moments = self._moments(np.concatenate(totals, axis=1).T)
        return Memory(moments, np.concatenate(times)).within(CAPACITY)

    def _blocks(self) -> Iterator[tuple[slice, np.ndarray]]:
        if self._cache is not None:
            return zip(self._slices, self._cache, strict=True)
        return ((rows, self._features(rows)) for rows in self._slices)

    def _features(self, rows: slice) -> np.ndarray:
        """Features [1, x, vech(x x')] of all frames, one column per sample."""
        parts = []
        for stack, centre, scale, (i, j) in zip(
            self._stacks, self._centres, self._scales, self._triangles, strict=True
        ):
            x = (stack[:, :, rows] - centre[..., None]) / scale[..., None]
            parts += [x, x[:, i] * x[:, j]]
        return self._assembled(parts)

    def _recalled(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Weights (L,) and mean features (F, L) of the samples in memory."""
        if self._memory is None:
            return
        parts = []
        for mean, scatter, centre, scale, (i, j) in zip(
            self._memory.moments.mean,
            self._memory.moments.scatter,
            self._centres,
            self._scales,
            self._triangles,
            strict=True,
        ):
            x = ((mean - centre[:, None]) / scale[:, None]).mT
            within = (scatter / (scale[:, None, :, None] * scale[:, None, None, :]))[..., i, j].mT
            parts += [x, x[:, i] * x[:, j] + within]
        yield self._memory.moments.weight, self._assembled(parts)

    def _assembled(self, parts: list[np.ndarray]) -> np.ndarray:
        n = parts[0].shape[-1]
        features = np.empty((self._size - self._own, n))
        features[0] = 1.0
        start = 1
        for part in parts:
            part = part.reshape(-1, n)
            features[start : start + len(part)] = part
            start += len(part)
        return features

    def _weights(self, components: Sequence[Components]) -> np.ndarray:
        """Coefficients of the log densities in the features, (K, F)."""
        K = components[0].mean.shape[1]
        parts = [np.zeros((K, 1))]
        for group, centre, scale, (i, j) in zip(
            components, self._centres, self._scales, self._triangles, strict=True
        ):
            mean = (group.mean - centre[:, None]) / scale[:, None]
            W = np.linalg.inv(cholesky(group.covariance, "covariance of a component"))
            log_det = np.log(np.diagonal(W, axis1=-2, axis2=-1)).sum((0, -1))
            W *= scale[:, None, None]
            precision = W.mT @ W
            information = (precision @ mean[..., None])[..., 0]
            parts[0][:, 0] += log_det - 0.5 * (information * mean).sum((0, -1))
            parts[0][:, 0] -= 0.5 * centre.size * LOG_2PI
            quadratic = -precision[..., i, j]
            quadratic[..., i == j] *= 0.5
            parts += [part.swapaxes(0, 1).reshape(K, -1) for part in (information, quadratic)]
        return np.hstack(parts)

    def _moments(self, total: np.ndarray) -> Moments:
        """Weighted sums of the features (K, F) as moments in the units of the data."""
        K, weight = len(total), total[:, 0]
        average = total / np.maximum(weight, np.finfo(float).tiny)[:, None]
        means, scatters, start = [], [], 1
        for group, d, centre, scale, (i, j) in zip(
            self.groups, self.dims, self._centres, self._scales, self._triangles, strict=True
        ):
            G = len(group)
            first = average[:, start : start + G * d].reshape(K, G, d).swapaxes(0, 1)
            start += G * d
            second = average[:, start : start + G * len(i)].reshape(K, G, -1).swapaxes(0, 1)
            start += G * len(i)
            scatter = np.empty((G, K, d, d))
            scatter[..., i, j] = scatter[..., j, i] = second
            scatter -= first[..., :, None] * first[..., None, :]
            means.append(centre[:, None] + scale[:, None] * first)
            scatters.append(scatter * (scale[:, None, :, None] * scale[:, None, None, :]))
        return Moments(weight, tuple(means), tuple(scatters))


def _responsibilities(joint: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Log evidence (n,) and responsibilities (K, n) from log densities, which are overwritten."""
    top = joint.max(0)
    np.maximum(np.subtract(joint, top, out=joint), FAINTEST, out=joint)
    np.exp(joint, out=joint)
    evidence = joint.sum(0)
    joint /= evidence
    return top + np.log(evidence), joint


def _measured(stack: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples (G, d, N), their centre (G, d) and standard deviation (G, d).

    A column whose spread is lost in the rounding of its size is made constant, with scale one.
    """
    lowest, highest = stack.min(-1), stack.max(-1)
    size = np.maximum(highest, -lowest)
    if size.max() > LARGEST:
        raise ArgumentError(
            f"samples reach {size.max():.1e}; change units to stay below {LARGEST:.0e}"
        )
    centre = stack.mean(-1)
    largest = np.maximum(highest - centre, centre - lowest)
    constant = largest <= np.maximum(RESOLUTION * size, 1 / LARGEST)
    if constant.any():
        stack = np.where(constant[..., None], centre[..., None], stack)
        largest = np.where(constant, 1.0, largest)
    deviation = (stack - centre[..., None]) / largest[..., None]
    scale = largest * np.sqrt(np.einsum("gdn,gdn->gd", deviation, deviation) / stack.shape[-1])
    return stack, centre, np.where(constant, 1.0, scale)
