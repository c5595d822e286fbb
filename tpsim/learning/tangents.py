"""Samples on manifolds, as components see them in the tangent spaces at their means."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tpsim.learning.em import LITTLE, Mixture
from tpsim.learning.hidden import too_little_seen, widened
from tpsim.learning.moments import Moments
from tpsim.learning.statistics import FAINTEST
from tpsim.learning.tangent_sums import Sums, log_densities, whitening_of
from tpsim.manifold.manifold import Manifold

BLOCK_BYTES = 2**18
"""Tangent vectors of one block of samples: what stays in the processor's cache."""

SETTLING = 3
"""Steps of a weighted mean towards the point at which its tangent vectors sum to zero."""


@dataclass(frozen=True, eq=False)
class Charted:
    """A mixture in tangent spaces: its components are about zero, at base points.

    Parameters
    ----------
    mixture : Mixture
    bases : tuple of (G, K, width)
        Means, per group of frames.
    """

    mixture: Mixture
    bases: tuple[np.ndarray, ...]


class Tangents:
    """N samples seen from P frames on manifolds, ready for the passes of EM.

    Parameters
    ----------
    manifolds : sequence of P Manifold
    views : sequence of P arrays (N, width_j), points of the manifolds
    observed : (N, P), optional
        Which samples every frame saw, see :mod:`tpsim.learning.hidden`; by default all.

    Attributes
    ----------
    groups : tuple of tuples of int
        Frames of equal manifold are handled together.
    of_frames : tuple of P Manifold
    count : int
    """

    def __init__(
        self,
        manifolds: Sequence[Manifold],
        views: Sequence[np.ndarray],
        observed: np.ndarray | None = None,
    ):
        self.of_frames = tuple(manifolds)
        self.manifolds = tuple(dict.fromkeys(manifolds))
        self.groups = tuple(
            tuple(j for j, one in enumerate(manifolds) if one == kind) for kind in self.manifolds
        )
        self.count = len(views[0])
        # Coordinates first: what belongs to one of them lies together in memory.
        self._columns = [
            np.stack([np.ascontiguousarray(views[j].T) for j in group]) for group in self.groups
        ]
        self._views = views
        self._observed = (
            ()
            if observed is None
            else tuple(observed.T[list(group)].astype(float) for group in self.groups)
        )
        self._answered: tuple[Charted, tuple[float, Moments]] | None = None

    def _blocks(self, components: int) -> Iterator[slice]:
        size = sum(
            len(g) * m.dim * components for g, m in zip(self.groups, self.manifolds, strict=True)
        )
        rows = max(64, BLOCK_BYTES // (8 * size))
        return (slice(n, min(n + rows, self.count)) for n in range(0, self.count, rows))

    def _tangents(self, rows: slice, bases: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Tangent vectors (G, K, dim, n) of a block of samples at the bases."""
        return [
            manifold.work.log_of_columns(base, columns[..., rows])
            for manifold, base, columns in zip(self.manifolds, bases, self._columns, strict=True)
        ]

    def _seen(self, rows: slice) -> list[np.ndarray]:
        """Which of a block of samples every frame saw, (G, n); empty where all saw all."""
        return [part[:, rows] for part in self._observed]

    def log_densities(self, model: Charted) -> np.ndarray:
        """Log density of every sample under every component, all frames together, (N, K)."""
        whitening = [whitening_of(part.covariance) for part in model.mixture.components]
        K = len(model.mixture.priors)
        return np.concatenate(
            [
                log_densities(self._tangents(rows, model.bases), whitening, self._seen(rows)).T
                for rows in self._blocks(K)
            ]
        )

    def expectation(self, model: Charted) -> tuple[float, Moments]:
        """Mean log-likelihood, Eq. (49), and moments in the tangent spaces, in one pass.

        The last answer is remembered: floors and the first iteration ask for the same model.
        """
        if self._answered is None or self._answered[0] is not model:
            self._answered = model, self._pass(model)
        return self._answered[1]

    def _pass(self, model: Charted) -> tuple[float, Moments]:
        whitening = [whitening_of(part.covariance) for part in model.mixture.components]
        bias = np.log(model.mixture.priors)[:, None]
        total, log_likelihood = self._sums(model.bases), 0.0
        for rows in self._blocks(len(bias)):
            tangents = self._tangents(rows, model.bases)
            observed = self._seen(rows)
            joint = log_densities(tangents, whitening, observed)
            joint += bias
            top = joint.max(0)
            joint -= top
            np.exp(np.maximum(joint, FAINTEST, out=joint), out=joint)
            evidence = joint.sum(0)
            joint /= evidence
            log_likelihood += float((top + np.log(evidence)).sum())
            total.add(joint, tangents, observed)
        moments = widened(total.moments(), lambda: self._of_all(model.bases))
        return log_likelihood / self.count, moments

    def moments(self, h: np.ndarray, bases: Sequence[np.ndarray]) -> Moments:
        """Moments in the tangent spaces at the bases for responsibilities (N, K), Eqs (50-52)."""
        return widened(self._collected(h, bases), lambda: self._of_all(bases))

    def _of_all(self, bases: Sequence[np.ndarray]) -> Moments:
        """Moments of all samples, as every component sees them."""
        return self._collected(np.ones((self.count, bases[0].shape[1])), bases)

    def _collected(self, h: np.ndarray, bases: Sequence[np.ndarray]) -> Moments:
        total = self._sums(bases)
        for rows in self._blocks(h.shape[1]):
            total.add(
                np.ascontiguousarray(h[rows].T), self._tangents(rows, bases), self._seen(rows)
            )
        return total.moments()

    def hidden(self, model: Charted) -> list[tuple[int, int]]:
        """Components and frames that saw too little of them."""
        return too_little_seen(self.expectation(model)[1], self.groups) if self._observed else []

    def _sums(self, bases: Sequence[np.ndarray]) -> Sums:
        return Sums(bases, self.manifolds, bool(self._observed))

    def means(self, h: np.ndarray) -> tuple[np.ndarray, ...]:
        """Weighted means (G, K, width) for responsibilities (N, K)."""
        bases = tuple(
            np.stack([manifold.work.centre(self._views[j], self._share(h, i, j)) for j in group])
            for i, (group, manifold) in enumerate(zip(self.groups, self.manifolds, strict=True))
        )
        if all(manifold.flat for manifold in self.manifolds):
            return bases
        for _ in range(SETTLING):
            found = self.moments(h, bases).mean
            bases = tuple(
                manifold.work.exp(base, step)
                for manifold, base, step in zip(self.manifolds, bases, found, strict=True)
            )
        return bases

    def _share(self, h: np.ndarray, i: int, j: int) -> np.ndarray:
        """Weights (K, N) of what frame j, of group i, saw for responsibilities (N, K)."""
        if not self._observed:
            return h.T
        seen = self._observed[i][self.groups[i].index(j)]
        weights = h.T * seen
        return np.where(weights.sum(1, keepdims=True) > LITTLE, weights, seen)

    @cached_property
    def centres(self) -> tuple[np.ndarray, ...]:
        """Means (G, 1, width) of all samples."""
        return self.means(np.ones((self.count, 1)))

    @cached_property
    def _total(self) -> Moments:
        return self.moments(np.ones((self.count, 1)), self.centres)

    def in_tangent_spaces(self) -> list[np.ndarray]:
        """Tangent vectors (N, dim_j) of all samples at their means, per frame."""
        found = {
            j: x[0].T
            for group, part in zip(
                self.groups, self._tangents(slice(None), self.centres), strict=True
            )
            for j, x in zip(group, part, strict=True)
        }
        return [found[j] for j in range(len(found))]

    def farthest(self, views: Sequence[np.ndarray]) -> float:
        """Largest angle [rad] among tangent vectors (N, dim_j), of what is not flat."""
        return max(
            (
                float(np.sqrt(np.vecdot(v, v).max()))
                for manifold, view in zip(self.of_frames, views, strict=True)
                for block in manifold.work.blocks
                if not block.space.flat
                for v in [view[:, block.rows]]
            ),
            default=0.0,
        )
