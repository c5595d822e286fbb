"""Gaussian mixture model: the mixture itself, and its fit by EM."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Stored
from tpsim.checks import (
    Seed,
    affordable,
    finite_array,
    frozen,
    frozen_array,
    generator,
    instance,
    shown,
    whole,
)
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian, match_moments
from tpsim.learning.fit import Options, Start, fit, seen_as_data
from tpsim.learning.fit_on import fit_on
from tpsim.learning.subspace import FULL, Structure
from tpsim.manifold.manifold import Manifold

NONE = frozen(np.empty(0))


@dataclass(frozen=True, eq=False)
class GMM(Stored):
    """Gaussian mixture model, one mixture for every leading axis of its Gaussians.

    On R^n, or on a manifold where its Gaussians are.

    Parameters
    ----------
    priors : (K,)
        Mixing coefficients, summing to one.
    gaussians : Gaussian (..., K, D)
        The components.
    history : (n,)
        Mean log-likelihood of the data after every iteration of the fit.
    samples : int
        Number of samples behind the fit.
    structure : covariance structure
        Decides the number of free parameters.

    Raises
    ------
    ArgumentError
        Priors that are negative, do not sum to one or do not match the components.
    """

    priors: np.ndarray
    gaussians: Gaussian
    history: np.ndarray = field(default_factory=lambda: np.empty(0))
    samples: int = 0
    structure: Structure = FULL

    def __post_init__(self) -> None:
        priors = checked_priors(self.priors)
        instance("gaussians", self.gaussians, Gaussian, "Gaussian(mean, covariance)")
        if self.gaussians.mean.ndim < 2 or self.gaussians.mean.shape[-2] != len(priors):
            raise ArgumentError(
                f"gaussians have means of shape {self.gaussians.mean.shape}; with "
                f"{len(priors)} priors it must be (..., {len(priors)}, D)"
            )
        object.__setattr__(self, "priors", priors)
        object.__setattr__(self, "samples", whole("samples", self.samples))
        object.__setattr__(self, "history", frozen_array("history", self.history))

    @classmethod
    def trusted(cls, priors: np.ndarray, gaussians: Gaussian) -> "GMM":
        """Build without checks, for results of our own that are valid by construction."""
        gmm = object.__new__(cls)
        gmm.__dict__.update(
            priors=frozen(priors), gaussians=gaussians, history=NONE, samples=0, structure=FULL
        )
        return gmm

    @property
    def components(self) -> int:
        """Number of components K."""
        return len(self.priors)

    @property
    def dim(self) -> int:
        """Dimension D."""
        return self.gaussians.dim

    @property
    def free_parameters(self) -> int:
        """Number of free parameters: means, covariances of this structure, and priors."""
        per_component = self.dim + self.structure.free_parameters(self.dim)
        return self.components * (per_component + 1) - 1

    def __getitem__(self, index: object) -> "GMM":
        """Select along the leading axes, as ``gmm[t]`` for the mixture at step t."""
        chosen = self.gaussians[index]
        if chosen.mean.shape[-2:] != self.gaussians.mean.shape[-2:]:
            raise ArgumentError("only leading axes can be selected, before those of K and D")
        return GMM.trusted(self.priors, chosen)

    def log_joint(self, x: ArrayLike) -> np.ndarray:
        """Log of prior times density of ``x`` (..., D) for every component, (..., K)."""
        x = finite_array("x", x)
        width = self.gaussians.mean.shape[-1]
        if x.shape[-1:] != (width,):
            raise ArgumentError(f"x has shape {x.shape}; its last axis must be D = {width}")
        return log_priors(self.priors) + self.gaussians.log_density(x[..., None, :])

    def log_likelihood(self, x: ArrayLike) -> np.ndarray:
        """Log-likelihood of every sample of ``x`` (..., D); its mean compares with history."""
        return log_sum(self.log_joint(x))

    def responsibilities(self, x: ArrayLike) -> np.ndarray:
        """Posterior of every component for every sample, Eq. (49), (..., K)."""
        return posterior(self.log_joint(x))

    def to_gaussian(self) -> Gaussian:
        """Single Gaussian with the mixture's mean and covariance, App. C."""
        return match_moments(self.priors, self.gaussians)

    def sample(self, rng: Seed, size: int) -> np.ndarray:
        """Draw (size, D) samples of a mixture without leading axes; ``rng`` may be a seed."""
        if self.gaussians.mean.ndim != 2:
            raise ArgumentError("the mixture has leading axes; select one step, gmm[t], first")
        random = generator("rng", rng)
        chosen = random.choice(
            self.components, size=affordable("size", size, self.dim**2, least=0), p=self.priors
        )
        return self.gaussians[chosen].sample(random)


def fit_gmm(
    data: ArrayLike | Sequence[ArrayLike] | Demonstration | Sequence[Demonstration],
    components: int,
    *,
    covariance: str | Structure = "full",
    start: Start | GMM = None,
    ridge: float | None = None,
    tolerance: float = 1e-5,
    max_iterations: int = 100,
    restarts: int = 0,
    time: ArrayLike | None = None,
    manifold: Manifold | None = None,
    rng: Seed = None,
) -> GMM:
    """Fit a Gaussian mixture by expectation-maximisation, Eqs (49-52).

    Parameters
    ----------
    data : (N, D) array, sequence of (T_m, D) arrays, or Demonstrations
        Samples, or several sequences of them, of unequal length if need be; of demonstrations
        their ``data``.
    components, covariance, start, ridge, tolerance, max_iterations, restarts, time, manifold, rng
        As in :func:`tpsim.learning.tp_gmm.fit_tp_gmm`, with one frame.

    Returns
    -------
    GMM

    Raises
    ------
    ArgumentError
        Data or options without a finite answer; the message says which.
    """
    if isinstance(start, GMM):
        start = start.priors, (start.gaussians,)
    options = Options(covariance, start, ridge, tolerance, max_iterations, restarts, time, rng)
    seen = seen_as_data(data)
    fitted = (
        fit(seen, components, options)
        if manifold is None
        else fit_on(manifold, seen, components, options)
    )
    return GMM(
        fitted.priors, fitted.frames[0], fitted.history, fitted.samples.count, fitted.structure
    )


def checked_priors(priors: ArrayLike, name: str = "priors") -> np.ndarray:
    """Priors (K,) that are a distribution, or an ArgumentError."""
    priors = frozen_array(name, priors)
    if priors.ndim != 1 or not len(priors) or (priors < 0).any() or abs(priors.sum() - 1) > 1e-6:
        raise ArgumentError(
            f"{name} are {shown(priors)}; they must be (K,), not negative, and sum to 1"
        )
    return priors


def log_priors(priors: np.ndarray) -> np.ndarray:
    """Logarithms of priors, very small instead of minus infinity where a prior is zero."""
    return np.log(np.maximum(priors, np.finfo(float).tiny))


def log_sum(log_joint: np.ndarray) -> np.ndarray:
    """Log sum exp over the last axis."""
    top = log_joint.max(-1)
    return top + np.log(np.exp(log_joint - top[..., None]).sum(-1))


def posterior(log_joint: np.ndarray) -> np.ndarray:
    """Normalised exponentials over the last axis."""
    h = np.exp(log_joint - log_joint.max(-1, keepdims=True))
    return h / h.sum(-1, keepdims=True)
