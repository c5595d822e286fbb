"""Expectation-maximisation on manifolds: tangent spaces that follow the means of the components.

Every component sees the samples in the tangent space at its own mean. There the M-step is that of
R^n (:func:`tpsim.learning.em.maximise`, with all covariance structures and floors); then the mean
moves along the tangent vector found, and covariances and floors are carried to where it ends.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from tpsim.gaussian import Gaussian
from tpsim.learning.em import Limits, Mixture, maximise
from tpsim.learning.moments import Moments
from tpsim.learning.regularisation import Floor, Ridge, data_floors
from tpsim.learning.statistics import FAINTEST, Components
from tpsim.learning.subspace import FULL, Structure
from tpsim.learning.tangent_sums import Sums, log_densities, whitening_of
from tpsim.manifold.gaussian import RiemannianGaussian, carried, shifted
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


class TangentSamples:
    """N samples seen from P frames on manifolds, ready for the passes of EM.

    Parameters
    ----------
    manifolds : sequence of P Manifold
    views : sequence of P arrays (N, width_j), points of the manifolds

    Attributes
    ----------
    groups : tuple of tuples of int
        Frames of equal manifold are handled together.
    of_frames : tuple of P Manifold
    count : int
    """

    def __init__(self, manifolds: Sequence[Manifold], views: Sequence[np.ndarray]):
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

    def log_densities(self, model: Charted) -> np.ndarray:
        """Log density of every sample under every component, all frames together, (N, K)."""
        whitening = [whitening_of(part.covariance) for part in model.mixture.components]
        K = len(model.mixture.priors)
        return np.concatenate(
            [
                log_densities(self._tangents(rows, model.bases), whitening).T
                for rows in self._blocks(K)
            ]
        )

    def expectation(self, model: Charted) -> tuple[float, Moments]:
        """Mean log-likelihood, Eq. (49), and moments in the tangent spaces, in one pass."""
        whitening = [whitening_of(part.covariance) for part in model.mixture.components]
        bias = np.log(model.mixture.priors)[:, None]
        total, log_likelihood = Sums(model.bases, self.manifolds), 0.0
        for rows in self._blocks(len(bias)):
            tangents = self._tangents(rows, model.bases)
            joint = log_densities(tangents, whitening)
            joint += bias
            top = joint.max(0)
            joint -= top
            np.exp(np.maximum(joint, FAINTEST, out=joint), out=joint)
            evidence = joint.sum(0)
            joint /= evidence
            log_likelihood += float((top + np.log(evidence)).sum())
            total.add(joint, tangents)
        return log_likelihood / self.count, total.moments()

    def moments(self, h: np.ndarray, bases: Sequence[np.ndarray]) -> Moments:
        """Moments in the tangent spaces at the bases for responsibilities (N, K), Eqs (50-52)."""
        total = Sums(bases, self.manifolds)
        for rows in self._blocks(h.shape[1]):
            total.add(np.ascontiguousarray(h[rows].T), self._tangents(rows, bases))
        return total.moments()

    def means(self, h: np.ndarray) -> tuple[np.ndarray, ...]:
        """Weighted means (G, K, width) for responsibilities (N, K)."""
        bases = tuple(
            np.stack([manifold.work.centre(self._views[j], h.T) for j in group])
            for group, manifold in zip(self.groups, self.manifolds, strict=True)
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

    def begin(
        self, h: np.ndarray, structure: Structure, ridge: float | None
    ) -> tuple[Charted, Limits]:
        """Mixture that responsibilities (N, K) begin with, and what limits its covariances."""
        bases = self.means(h)
        parts = self.moments(h, bases)
        limits = self.floors(parts, bases) if ridge is None else self.ridges(ridge)
        return self.moved(maximise(parts, None, structure, limits), bases, limits, structure)

    def ridges(self, ridge: float) -> Limits:
        """The ridge of Eq. (8) for every group of frames."""
        return tuple(Ridge(ridge) for _ in self.groups)

    def floors(self, parts: Moments, bases: Sequence[np.ndarray]) -> Limits:
        """Floors that the data set, for components that begin with ``parts`` at the bases."""
        total = self._total
        spread = tuple(
            carried(manifold, one, base, scatter)
            for manifold, one, base, scatter in zip(
                self.manifolds, self.centres, bases, total.scatter, strict=True
            )
        )
        zeros = tuple(np.zeros_like(mean) for mean in parts.mean)
        return data_floors(Moments(total.weight, zeros, spread), parts)

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

    def placed(self, priors: np.ndarray, frames: Sequence[Gaussian]) -> Charted:
        """A mixture (K,) in the tangent spaces at the means of all samples, on the manifolds."""
        centre = {
            j: one
            for group, part in zip(self.groups, self.centres, strict=True)
            for j, one in zip(group, part, strict=True)
        }
        return self.charted(
            priors,
            [
                shifted(manifold, centre[j], frame)
                for j, (manifold, frame) in enumerate(zip(self.of_frames, frames, strict=True))
            ],
        )

    def moved(
        self,
        mixture: Mixture,
        bases: Sequence[np.ndarray],
        limits: Limits,
        structure: Structure,
    ) -> tuple[Charted, Limits]:
        """The mixture with its means as bases, covariances and floors carried there.

        Structured covariances stay as they are: carried, they would lose their structure.
        """
        parts, found, floors = [], [], []
        for manifold, base, part, limit in zip(
            self.manifolds, bases, mixture.components, limits, strict=True
        ):
            there = manifold.work.exp(base, part.mean)
            covariance = part.covariance
            if structure == FULL:
                covariance = carried(manifold, base, there, covariance)
            if isinstance(limit, Floor) and manifold.work.curved:
                limit = Floor(carried(manifold, base, there, limit.least))
            part = replace(part, mean=np.zeros_like(part.mean), covariance=covariance)
            parts.append(part)
            found.append(there)
            floors.append(limit)
        return Charted(Mixture(mixture.priors, tuple(parts)), tuple(found)), tuple(floors)

    def em(
        self,
        start: Charted,
        structure: Structure,
        limits: Limits,
        tolerance: float,
        max_iterations: int,
    ) -> tuple[Charted, np.ndarray]:
        """Alternate Eqs (49) and (50-52) as :func:`tpsim.learning.em.em` does.

        On a curved manifold the mean in the tangent space is the likeliest to third order of the
        spread only; where a step would lower the likelihood EM has converged, and ends before it.
        """
        model, best = start, start
        history: list[float] = []
        for iteration in range(max_iterations + 1):
            log_likelihood, moments = self.expectation(model)
            if history and log_likelihood < history[-1] and not self._flat:
                break
            best = model
            history.append(log_likelihood)
            converged = len(history) > 2 and history[-1] - history[-2] < tolerance
            if converged or iteration == max_iterations:
                break
            found = maximise(moments, model.mixture, structure, limits)
            model, limits = self.moved(found, model.bases, limits, structure)
        return best, np.array(history)

    @property
    def _flat(self) -> bool:
        return all(manifold.flat for manifold in self.manifolds)

    def gaussians(self, model: Charted) -> tuple[RiemannianGaussian, ...]:
        """One Gaussian (K,) per frame, in the order of the frames."""
        found = {
            j: RiemannianGaussian.trusted_on(manifold, mean, covariance)
            for group, manifold, bases, part in zip(
                self.groups, self.manifolds, model.bases, model.mixture.components, strict=True
            )
            for j, mean, covariance in zip(group, bases, part.covariance, strict=True)
        }
        return tuple(found[j] for j in range(len(found)))

    def charted(self, priors: np.ndarray, frames: Sequence[RiemannianGaussian]) -> Charted:
        """What :meth:`gaussians` returned, for another pass."""
        parts, bases = [], []
        for group in self.groups:
            covariance = np.stack([frames[j].covariance for j in group])
            bases.append(np.stack([frames[j].mean for j in group]))
            parts.append(Components(np.zeros(covariance.shape[:-1]), covariance))
        priors = np.maximum(priors, np.finfo(float).tiny)
        return Charted(Mixture(priors, tuple(parts)), tuple(bases))
