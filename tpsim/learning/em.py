"""Expectation-maximisation for mixtures seen from one frame or from many (App. A and B).

A GMM is a TP-GMM with one frame. All covariance structures share this loop.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tpsim.checks import number
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.moments import Moments
from tpsim.learning.regularisation import Regularisation, Ridge, data_floors
from tpsim.learning.statistics import Components, Samples
from tpsim.learning.subspace import Structure

EMPTY = 1e-10  # share of a sample below which a component is left where it is
LITTLE = 1.0  # samples seen by a frame that does not see all, below which its part is left


@dataclass(frozen=True, eq=False)
class Mixture:
    """Parameters of a mixture, frames grouped by dimension as in :class:`Samples`.

    Parameters
    ----------
    priors : (K,)
        Mixing coefficients, Eq. (50).
    components : tuple of Components
        One per group of frames.
    """

    priors: np.ndarray
    components: tuple[Components, ...]

    @classmethod
    def of(cls, priors: np.ndarray, frames: Sequence[Gaussian], samples: Samples) -> "Mixture":
        """Group the Gaussians (K, d_j) of every frame."""
        components = tuple(
            Components(
                np.stack([frames[j].mean for j in group]),
                np.stack([frames[j].covariance for j in group]),
            )
            for group in samples.groups
        )
        return cls(np.asarray(priors, float), components)

    def frames(self, samples: Samples) -> tuple[Gaussian, ...]:
        """Ungroup: one Gaussian (K, d_j) per frame, in the order of the frames."""
        found = {
            j: Gaussian.trusted(mean, covariance)
            for group, part in zip(samples.groups, self.components, strict=True)
            for j, mean, covariance in zip(group, part.mean, part.covariance, strict=True)
        }
        return tuple(found[j] for j in range(len(found)))


Limits = Sequence[Regularisation]
"""One regularisation per group of frames."""


def regularisation(samples: Samples, ridge: float | None, parts: Moments) -> Limits:
    """Regularisation per group of frames: the data's own floor, or a ridge (Eq. 8).

    ``parts`` are the moments of the samples on which the components start.
    """
    if ridge is None:
        return data_floors(samples.total(), parts)
    rho = number("ridge", ridge, least=0)
    return tuple(Ridge(rho) for _ in samples.groups)


def maximise(
    moments: Moments,
    previous: Mixture | None,
    structure: Structure,
    limits: Limits,
) -> Mixture:
    """M-step, Eqs (50-52): the mixture that explains the moments best."""
    weight = moments.weight
    known = moments.of_frames
    least = EMPTY if moments.seen is None else LITTLE
    priors = np.maximum(weight, EMPTY)
    old: Sequence[Components | None] = previous.components if previous else (None,) * len(limits)
    components = tuple(
        _fit(mean, scatter, part, one > least, structure, limit)
        for mean, scatter, part, one, limit in zip(
            moments.mean, moments.scatter, old, known, limits, strict=True
        )
    )
    return Mixture(priors / priors.sum(), components)


def _fit(
    mean: np.ndarray,
    scatter: np.ndarray,
    old: Components | None,
    alive: np.ndarray,
    structure: Structure,
    limit: Regularisation,
) -> Components:
    """Fit one group of frames; components without samples stay where they were."""
    if old is not None and not alive.all():
        mean = np.where(alive[..., None], mean, old.mean)
        scatter = np.where(alive[..., None, None], scatter, old.covariance)
    factors = old.factors if old is not None else None
    covariance, factors = structure.fit(scatter, factors, limit)
    return Components(mean, covariance, factors)


def project(mixture: Mixture, structure: Structure, limits: Limits) -> Mixture:
    """Start EM from covariances of another structure.

    Under a floor the covariances are first brought into the structure, so that the likelihood
    can only rise from there. Under a ridge they are used as they are, as the reference does.
    """
    components = []
    for part, limit in zip(mixture.components, limits, strict=True):
        part = replace(part, factors=structure.start(part.covariance, limit))
        if not isinstance(limit, Ridge):
            covariance, factors = structure.fit(part.covariance, part.factors, limit)
            part = Components(part.mean, covariance, factors)
        components.append(part)
    return Mixture(mixture.priors, tuple(components))


def em(
    samples: Samples,
    start: Mixture,
    structure: Structure,
    limits: Limits,
    tolerance: float,
    max_iterations: int,
) -> tuple[Mixture, np.ndarray]:
    """Alternate Eqs (49) and (50-52) until the mean log-likelihood gains less than ``tolerance``.

    Returns
    -------
    Mixture and history (n + 1,)
        ``history[i]`` is the mean log-likelihood after i iterations: the first entry belongs to
        the start, the last to the mixture returned.
    """
    mixture = start
    history: list[float] = []
    for _ in range(max_iterations):
        log_likelihood, moments = samples.expectation(mixture.priors, mixture.components)
        history.append(log_likelihood)
        mixture = maximise(moments, mixture, structure, limits)
        if len(history) > 1 and history[-1] - history[-2] < tolerance:
            break
    log_likelihood, _ = samples.expectation(mixture.priors, mixture.components)
    return mixture, np.array([*history, log_likelihood])


def likeliest(
    samples: Samples,
    starts: Iterable[tuple[Mixture, Limits]],
    structure: Structure,
    tolerance: float,
    max_iterations: int,
) -> tuple[Mixture, np.ndarray]:
    """Run EM from every start, under its own limits, and keep the likeliest, with its history.

    Raises
    ------
    ArgumentError
        A covariance became singular, which a floor prevents and a small ridge does not.
    """
    try:
        with np.errstate(divide="raise", invalid="raise", over="raise"):
            found = [
                em(samples, start, structure, limits, tolerance, max_iterations)
                for start, limits in starts
            ]
    except (np.linalg.LinAlgError, FloatingPointError) as error:
        raise ArgumentError(
            f"EM met a singular covariance ({error}); give a larger ridge, or None for the floor "
            "that the data set"
        ) from error
    return max(found, key=lambda result: result[1][-1])
