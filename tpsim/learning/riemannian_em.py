"""Expectation-maximisation on manifolds: tangent spaces that follow the means of the components.

Every component sees the samples in the tangent space at its own mean. There the M-step is that of
R^n (:func:`tpsim.learning.em.maximise`, with all covariance structures and floors); then the mean
moves along the tangent vector found, and covariances and floors are carried to where it ends.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tpsim.gaussian import Gaussian
from tpsim.learning.em import Limits, Mixture, maximise
from tpsim.learning.moments import Moments
from tpsim.learning.regularisation import Floor, Ridge, data_floors
from tpsim.learning.statistics import Components
from tpsim.learning.subspace import FULL, Structure
from tpsim.learning.tangents import Charted, Tangents
from tpsim.manifold.gaussian import RiemannianGaussian, carried, shifted


class TangentSamples(Tangents):
    """Samples with the steps of EM between their passes."""

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
