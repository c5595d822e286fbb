"""Gaussian mixture model: the mixture itself, and its fit by EM."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import load_arrays, save_arrays
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian, finite_array, match_moments
from tpsim.learning.fit import Options, Start, fit
from tpsim.learning.subspace import FULL, Structure, structure_named


@dataclass(frozen=True, eq=False)
class GMM:
    """Gaussian mixture model, one mixture for every leading axis of its Gaussians.

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

    def __post_init__(self):
        priors = checked_priors(self.priors)
        if self.gaussians.mean.ndim < 2 or self.gaussians.mean.shape[-2] != len(priors):
            raise ArgumentError(
                f"gaussians have means of shape {self.gaussians.mean.shape}; with "
                f"{len(priors)} priors it must be (..., {len(priors)}, D)"
            )
        object.__setattr__(self, "priors", priors)
        object.__setattr__(self, "history", np.asarray(self.history, float))

    @classmethod
    def trusted(cls, priors: np.ndarray, gaussians: Gaussian) -> "GMM":
        """Build without checks, for results of our own that are valid by construction."""
        gmm = object.__new__(cls)
        gmm.__dict__.update(
            priors=priors, gaussians=gaussians, history=np.empty(0), samples=0, structure=FULL
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

    def __getitem__(self, index) -> "GMM":
        """Select along the leading axes, as ``gmm[t]`` for the mixture at step t."""
        return GMM(self.priors, self.gaussians[index])

    def log_joint(self, x: ArrayLike) -> np.ndarray:
        """Log of prior times density of ``x`` (..., D) for every component, (..., K)."""
        x = finite_array("x", x)
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

    def sample(self, rng: np.random.Generator, size: int) -> np.ndarray:
        """Draw (size, D) samples of a mixture without leading axes."""
        chosen = rng.choice(self.components, size=size, p=self.priors)
        return self.gaussians[chosen].sample(rng)

    def save(self, path: str | Path) -> Path:
        """Write to an .npz archive, whole or not at all, without pickles."""
        model = model_arrays(self)
        model |= {"mean": self.gaussians.mean, "covariance": self.gaussians.covariance}
        return save_arrays(path, "GMM", model)

    @classmethod
    def load(cls, path: str | Path) -> "GMM":
        """Read what :meth:`save` wrote; RecordingError where the file is something else."""
        arrays = load_arrays(path, "GMM")
        gaussians = Gaussian(arrays["mean"], arrays["covariance"])
        return cls(arrays["priors"], gaussians, **model_fields(arrays))


def fit_gmm(
    data: ArrayLike | Sequence[ArrayLike],
    components: int,
    *,
    covariance: str | Structure = "full",
    start: Start | GMM = None,
    ridge: float | None = None,
    tolerance: float = 1e-5,
    max_iterations: int = 100,
    restarts: int = 0,
    time: ArrayLike | None = None,
    rng: np.random.Generator | None = None,
) -> GMM:
    """Fit a Gaussian mixture by expectation-maximisation, Eqs (49-52).

    Parameters
    ----------
    data : (N, D) array, or sequence of (T_m, D) arrays
        Samples, or several sequences of them, of unequal length if need be.
    components, covariance, start, ridge, tolerance, max_iterations, restarts, time, rng
        As in :func:`tpsim.learning.tp_gmm.fit_tp_gmm`, with one frame.

    Returns
    -------
    GMM

    Raises
    ------
    ArgumentError
        Data or options without a finite answer; the message says which.
    """
    sequences = _sequences(data)
    if isinstance(start, GMM):
        start = start.priors, (start.gaussians,)
    options = Options(covariance, start, ridge, tolerance, max_iterations, restarts, time, rng)
    lengths = [len(sequence) for sequence in sequences]
    fitted = fit([np.concatenate(sequences)], lengths, components, options)
    return GMM(
        fitted.priors, fitted.frames[0], fitted.history, fitted.samples.count, fitted.structure
    )


def _sequences(data) -> list[np.ndarray]:
    if isinstance(data, np.ndarray) and data.ndim == 2:
        data = [data]
    sequences = [finite_array("data", sequence) for sequence in data]
    if sequences and all(sequence.ndim == 1 for sequence in sequences):
        sequences = [finite_array("data", data)]
    shapes = [sequence.shape for sequence in sequences]
    if not sequences or any(len(s) != 2 or 0 in s or s[1] != shapes[0][1] for s in shapes):
        raise ArgumentError(
            f"data has shapes {shapes}; give (N, D), or sequences (T_m, D) of one D, none empty"
        )
    return sequences


def checked_priors(priors: ArrayLike) -> np.ndarray:
    """Priors (K,) that are a distribution, or an ArgumentError."""
    priors = finite_array("priors", priors)
    if priors.ndim != 1 or not len(priors) or (priors < 0).any() or abs(priors.sum() - 1) > 1e-6:
        raise ArgumentError(f"priors are {priors}; they must be (K,), not negative, and sum to 1")
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


def model_arrays(model) -> dict[str, np.ndarray]:
    """Arrays that a mixture's archive holds beside its Gaussians."""
    return {
        "priors": model.priors,
        "history": model.history,
        "samples": np.array(model.samples),
        "structure": np.array(model.structure.name),
        "subspace": np.array(getattr(model.structure, "dimension", 0)),
    }


def model_fields(arrays: dict[str, np.ndarray]) -> dict:
    """Fields of a mixture from :func:`model_arrays`, priors and Gaussians apart."""
    return {
        "history": arrays["history"],
        "samples": int(arrays["samples"]),
        "structure": structure_named(str(arrays["structure"]), int(arrays["subspace"])),
    }
