"""Task-parameterized Gaussian mixture model (Section 3): learn in frames, adapt to new frames."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Stored
from tpsim.checks import Seed, frozen_array, several, whole
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.fit import Options, Start, Views, fit, seen_by_frames
from tpsim.learning.fit_on import fit_on
from tpsim.learning.free_movement import Relevance
from tpsim.learning.gmm import GMM, checked_priors, log_priors, log_sum, posterior
from tpsim.learning.hidden import Observed, say_if_hidden
from tpsim.learning.moments import Memory
from tpsim.learning.product import (
    checked_frames,
    checked_uncertainty,
    product_of_frames,
    product_with_ridge,
)
from tpsim.learning.product_on import product_on
from tpsim.learning.subspace import FULL, Structure
from tpsim.manifold.manifold import Manifold


@dataclass(frozen=True, eq=False)
class TPGMM(Stored):
    """Task-parameterized Gaussian mixture model.

    Parameters
    ----------
    priors : (K,)
        Mixing coefficients, summing to one.
    frames : sequence of P Gaussian (K, d_j)
        The components as every frame sees them.
    history : (n,)
        Mean log-likelihood of the data after every iteration of the fit.
    samples : int
        Number of samples behind the fit.
    structure : covariance structure
        Decides the number of free parameters.
    memory : Memory, optional
        Moments of short runs of the samples, for :func:`tpsim.learning.incremental.update_tp_gmm`.
    relevance : tuple of P Relevance
        Which directions matter (:mod:`~tpsim.learning.free_movement`); empty: all of them.

    Raises
    ------
    ArgumentError
        Priors that are no distribution, or frames of another number of components.
    """

    priors: np.ndarray
    frames: tuple[Gaussian, ...]
    history: np.ndarray = field(default_factory=lambda: np.empty(0))
    samples: int = 0
    structure: Structure = FULL
    memory: Memory | None = None
    relevance: tuple[Relevance, ...] = ()

    def __post_init__(self) -> None:
        priors = checked_priors(self.priors)
        frames = tuple(several("frames", self.frames, Gaussian))
        shapes = [frame.mean.shape for frame in frames]
        if not frames or any(len(s) != 2 or s[0] != len(priors) for s in shapes):
            raise ArgumentError(
                f"frames have means of shapes {shapes}; with {len(priors)} priors each must be "
                f"({len(priors)}, d)"
            )
        object.__setattr__(self, "priors", priors)
        relevance = tuple(several("relevance", self.relevance, Relevance))
        found = [one.precision.shape for one in relevance]
        if found and found != [frame.covariance.shape for frame in frames]:
            raise ArgumentError(
                f"relevance has precisions of shapes {found}; give one for each frame, "
                f"of {[frame.covariance.shape for frame in frames]}"
            )
        object.__setattr__(self, "relevance", relevance)
        object.__setattr__(self, "samples", whole("samples", self.samples))
        object.__setattr__(self, "frames", frames)
        object.__setattr__(self, "history", frozen_array("history", self.history))

    @property
    def components(self) -> int:
        """Number of components K."""
        return len(self.priors)

    @cached_property
    def dims(self) -> tuple[int, ...]:
        """Local dimension d_j of every frame."""
        return tuple(frame.dim for frame in self.frames)

    @cached_property
    def _on_manifolds(self) -> bool:
        return any(type(frame) is not Gaussian for frame in self.frames)

    @property
    def precisions(self) -> tuple[np.ndarray, ...]:
        """Precision (K, d_j, d_j) that every frame brings to control: of what matters in it.

        It is zero in the directions in which the teacher moved freely, where free movement was
        looked at; else it is that of the Gaussians.
        """
        if self.relevance:
            return tuple(one.precision for one in self.relevance)
        return tuple(frame.precision for frame in self.frames)

    @property
    def free_parameters(self) -> int:
        """Number of means, entries of covariances of this structure, and priors."""
        per_component = sum(d + self.structure.free_parameters(d) for d in self.dims)
        return self.components * (per_component + 1) - 1

    def adapt(
        self,
        frames: Sequence[Frame | None],
        ridge: float | None = None,
        prior: Gaussian | None = None,
        uncertainty: Sequence[ArrayLike | None] | None = None,
    ) -> GMM:
        """Mixture in common coordinates for new frames, Eqs (5-6).

        In information form: frame j adds the precision (A^+)' Sigma^-1 A^+, which is
        (A Sigma A')^-1 where A is invertible, and knows nothing outside the range of A.

        Parameters
        ----------
        frames : sequence of P Frame or None
            None where a frame is not observed. Moving frames have leading axes (T,). On manifolds
            rigid motions, see :meth:`Manifold.frame`.
        ridge : float, optional
            Add rho I to every A Sigma A' instead, as the tutorial's own code does (1e-4); every
            frame then claims to know every direction.
        prior : Gaussian (D,), optional
            On every component, weak: for directions that no frame determines.
        uncertainty : sequence of P arrays (D, D), (K, D, D) or None, optional
            Covariance of where each frame is (:meth:`tpsim.Frame.uncertainty`), added to A Sigma A'
            before Eq. (6); None: exactly known.

        Returns
        -------
        GMM
            Gaussians (..., K, D), with the leading axes of the frames.

        Raises
        ------
        ArgumentError
            Frames of wrong number or shape, all of them None, or a direction that no frame
            determines; the message names it.
        """
        if self._on_manifolds:
            if uncertainty is not None:
                raise ArgumentError("uncertainty is of frames in R^n; the model is on manifolds")
            return GMM.trusted(
                self.priors, product_on(self.frames, frames, ridge, prior, self._stack)
            )
        frames = checked_frames(frames, self.dims, prior)
        unsure = checked_uncertainty(uncertainty, frames, self.components)
        if ridge is not None:
            gaussians = product_with_ridge(self.frames, frames, ridge, prior, unsure)
        else:
            gaussians = product_of_frames(self._stack, frames, prior, unsure)
        return GMM.trusted(self.priors, gaussians)

    def log_joint(self, observations: object, observed: object = None) -> np.ndarray:
        """Log of prior times densities in all frames that saw it for every component, (N, K)."""
        given = seen_by_frames(observations, observed)
        views = given.views
        widths = [frame.mean.shape[-1] for frame in self.frames]
        if [view.shape[1] for view in views] != widths:
            raise ArgumentError(
                f"observations have shapes {[view.shape for view in views]}; the model's frames "
                f"have dimensions {widths}"
            )
        seen = zip(self.frames, views, strict=True)
        parts = [one.log_density(view[:, None]) for one, view in seen]
        if given.observed is not None:
            parts = [
                np.where(o[:, None], p, 0.0) for o, p in zip(given.observed.T, parts, strict=True)
            ]
        return log_priors(self.priors) + sum(parts)

    def log_likelihood(self, observations: Views, observed: Observed = None) -> np.ndarray:
        """Log-likelihood of every sample, (N,); its mean compares with history."""
        return log_sum(self.log_joint(observations, observed))

    def responsibilities(self, observations: Views, observed: Observed = None) -> np.ndarray:
        """Posterior of every component for every sample, Eq. (49), (N, K)."""
        return posterior(self.log_joint(observations, observed))

    def _stack(self, group: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Means (G, K, d) and precisions (G, K, d, d) of frames of equal dimension."""
        if group not in self._stacks:
            members = [self.frames[j] for j in group]
            precisions = np.stack([gaussian.precision for gaussian in members])
            self._stacks[group] = np.stack([gaussian.mean for gaussian in members]), precisions
        return self._stacks[group]

    @cached_property
    def _stacks(self) -> dict[tuple[int, ...], tuple[np.ndarray, np.ndarray]]:
        """Remembered, since adaptation runs in control loops."""
        return {}


def fit_tp_gmm(
    demonstrations: Views,
    components: int,
    *,
    covariance: str | Structure = "full",
    start: Start | TPGMM = None,
    ridge: float | None = None,
    tolerance: float = 1e-5,
    max_iterations: int = 100,
    restarts: int = 0,
    time: ArrayLike | None = None,
    manifold: Manifold | Sequence[Manifold] | None = None,
    observed: Observed = None,
    rng: Seed = None,
) -> TPGMM:
    """Fit a task-parameterized Gaussian mixture by EM, Eqs (49-52), or (57-68) in subspaces.

    Parameters
    ----------
    demonstrations : Demonstration, sequence of Demonstration, or of P arrays (N, d_j)
        Demonstrations of any lengths with the same frames or observations, or what each frame
        saw. Quaternions and wrapped angles are brought into agreement first, with a warning, see
        :func:`tpsim.agree`.
    components : int
        Number of components K.
    covariance : str or structure
        ``"full"``, ``"diagonal"``, ``"spherical"``, ``HDDC(d)``, ``MFA(d)`` or ``MPPCA(d)``.
    start : str or TPGMM, optional
        ``"time"`` (equal spans in time), ``"kmeans"`` (on the stacked standardised frames), or a
        model; by default both are tried and the likelier result is kept.
    ridge : float, optional
        Tikhonov regularisation of every M-step, Eq. (8), in squared units of the data. By default
        the data set a floor instead, Eq. (7), without any unit: no covariance is smaller than c
        times that of the N samples on which its component starts, with
        c = max((D + 1) / N (3 %)^2, (0.1 %)^2); see :mod:`tpsim.learning.regularisation`.
    tolerance : float
        EM ends when the mean log-likelihood of a sample gains less than this [nats]; -inf lets it
        take all iterations.
    max_iterations : int
        EM ends after this many iterations in any case.
    restarts : int
        Further k-means starts; the likeliest result is kept.
    time : (N,), optional
        Time of every sample for the start in time. Default: by the stamps of each demonstration;
        for arrays a first column that all frames share, else the order of the rows.
    manifold : Manifold or sequence of P Manifold, optional
        On which the observations live, such as ``R(3) * S3``, of all frames or of each; by
        default R^n. Components then are :class:`~tpsim.RiemannianGaussian`.
    observed : (N, P), or one array (T_m, P) for every demonstration, optional
        False where a frame was hidden; by default all saw all. EM is then that of the marginal
        likelihood: only frames count that saw a sample; what others hold there, also NaN in
        arrays, does not matter. Such a model has no memory for ``update_tp_gmm``.
    rng : numpy Generator or seed, optional
        Draws the k-means seeds; default a fixed seed, so that the same data give the same model.

    Returns
    -------
    TPGMM

    Raises
    ------
    ArgumentError
        NaN, a frame that saw nothing, fewer than two samples, more components than samples that
        differ, all samples the same, shapes that do not fit, or options outside their range.

    Notes
    -----
    Departures from the tutorial's code: densities are logarithms, so nothing underflows; the
    start in time keeps the last sample of each demonstration and divides by n, not n - 1; k-means
    runs on standardised variables; the floor replaces the ridge; the first E-step of HDDC, MFA and
    MPPCA has that structure (under a floor); ``history`` ends with the model that is returned.
    """
    seen = seen_by_frames(demonstrations, observed)
    if isinstance(start, TPGMM):
        start = start.priors, start.frames
    options = Options(covariance, start, ridge, tolerance, max_iterations, restarts, time, rng)
    if manifold is not None:
        found = fit_on(manifold, seen, components, options)
        say_if_hidden(found.hidden)
        return TPGMM(found.priors, found.frames, found.history, sum(seen.lengths), found.structure)
    fitted = fit(seen, components, options)
    say_if_hidden(fitted.hidden)
    return TPGMM(
        fitted.priors,
        fitted.frames,
        fitted.history,
        fitted.samples.count,
        fitted.structure,
        fitted.samples.remembered(fitted.time, seen.lengths),
    )
