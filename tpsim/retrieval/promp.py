"""Probabilistic movement primitives: trajectories as weighted basis functions (Section 5.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.agreement import agreed_with_warning
from tpsim.archive import Stored
from tpsim.checks import (
    affordable,
    array_of,
    column_or_matrix,
    entries,
    frozen_array,
    instance,
    number,
    several,
    whole,
)
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian, add_ridge, cholesky
from tpsim.learning.product import product_of_frames
from tpsim.retrieval.basis import radial_basis as radial_basis
from tpsim.retrieval.basis import regress
from tpsim.retrieval.distribution import LEAST, TrajectoryDistribution
from tpsim.retrieval.least import least_variances
from tpsim.timeline import phase

STEP = 1e-3  # of the spread of a coordinate: noise of a single sample


@dataclass(frozen=True, eq=False)
class ProMP(Stored):
    """Probabilistic movement primitive x_t = sum_k psi_k(t) w_k + noise.

    Attributes
    ----------
    weights : Gaussian (K*D,), weight vectors of the basis functions one after the other.
    count : number of basis functions K.
    width : their width in phase; None as in :func:`radial_basis`.
    noise : variance around the sum: of every coordinate, one for each (D,), or (D, D).
    """

    weights: Gaussian
    count: int
    width: float | None = None
    noise: float | NDArray = 1e-6

    def __post_init__(self) -> None:
        object.__setattr__(self, "count", whole("count", self.count, least=1))
        shape = instance("weights", self.weights, Gaussian).mean.shape
        if len(shape) != 1 or shape[0] % self.count:
            raise ArgumentError(f"weights have means {shape}; with count K they must be (K*D,)")
        noise = frozen_array("noise", self.noise)
        D = shape[0] // self.count
        if noise.shape not in ((), (D,), (D, D)) or (noise.ndim < 2 and (noise < 0).any()):
            raise ArgumentError(
                f"noise has shape {noise.shape}; give variances, not negative: a number, ({D},) "
                f"or ({D}, {D})"
            )
        if self.width is not None:
            object.__setattr__(self, "width", number("width", self.width, above=0))
        object.__setattr__(self, "noise", noise if noise.ndim else float(noise))

    @property
    def noise_covariance(self) -> NDArray:
        """Covariance (D, D) of a single sample around the sum of basis functions."""
        noise = np.asarray(self.noise)
        return noise if noise.ndim == 2 else noise * np.eye(self.weights.dim // self.count)

    def distribution(self, steps: int | ArrayLike) -> TrajectoryDistribution:
        """Distribution of trajectories of a number of steps, or at phases (T,) from 0 to 1.

        Condition and sample it there.
        """
        K, D = self.count, self.weights.dim // self.count
        if array_of("steps", steps).ndim == 0:
            affordable("steps", steps, K * D * K * D)
        basis = radial_basis(steps, K, self.width)
        root = cholesky(self.weights.covariance, "covariance of the weights")
        modes = np.einsum("tk,kdn->ntd", basis, root.reshape(K, D, K * D))
        noise = np.tile(self.noise_covariance, (len(basis), 1, 1))
        return TrajectoryDistribution(basis @ self.weights.mean.reshape(K, D), modes, noise)


@dataclass(frozen=True, eq=False)
class TPProMP(Stored):
    """Probabilistic movement primitives seen from several frames (demo_TPproMP01).

    Attributes
    ----------
    frames : one :class:`ProMP` for every frame, with the same basis functions.
    """

    frames: tuple[ProMP, ...]

    def __post_init__(self) -> None:
        frames = tuple(several("frames", self.frames, ProMP))
        if len({(promp.count, promp.width) for promp in frames}) != 1:
            raise ArgumentError("give one or more frames with the same basis functions")
        object.__setattr__(self, "frames", frames)

    def adapt(self, frames: Sequence[Frame]) -> ProMP:
        """Product of the weights carried to the common coordinates, Eqs 5-6.

        The basis functions sum to one, so that a frame maps every weight vector like a point.

        Parameters
        ----------
        frames
            P constant frames. For moving ones adapt
            :class:`tpsim.retrieval.distribution.TPTrajectoryDistribution`.
        """
        frames = several("frames", frames, Frame)
        if len(frames) != len(self.frames) or any(frame.shape for frame in frames):
            raise ArgumentError(
                f"give {len(self.frames)} constant frames; got {len(frames)} with leading axes "
                f"{[frame.shape for frame in frames]}"
            )
        first = self.frames[0]
        dims = [promp.weights.dim // promp.count for promp in self.frames]
        if [f.local_dim for f in frames] != dims or len({f.dim for f in frames}) > 1:
            raise ArgumentError(
                f"frames have A of shapes {[f.A.shape for f in frames]}; the model asks for "
                f"(D, d) with d = {dims} and one D"
            )
        lifted = [
            Frame(np.kron(np.eye(first.count), frame.A), np.tile(frame.b, first.count))
            for frame in frames
        ]

        def stack(group: tuple[int, ...]) -> tuple[NDArray, NDArray]:
            weights = [self.frames[j].weights for j in group]
            means = [w.mean[None] for w in weights]
            precisions = [w.precision[None] for w in weights]
            return np.stack(means), np.stack(precisions)

        weights = product_of_frames(stack, lifted, prior=None)[0]
        return ProMP(weights, first.count, first.width, self._noise(frames))

    def _noise(self, frames: list[Frame]) -> float | NDArray:
        """Noise in common coordinates: the number that all share, or the mean over the frames."""
        numbers = {promp.noise for promp in self.frames if isinstance(promp.noise, float)}
        if len(numbers) == 1:
            return numbers.pop()
        seen = [
            frame.A @ promp.noise_covariance @ frame.A.T
            for promp, frame in zip(self.frames, frames, strict=True)
        ]
        return np.mean(seen, axis=0)


def fit_promp(
    trajectories: Demonstration | Sequence[Demonstration] | Sequence[ArrayLike],
    count: int,
    *,
    width: float | None = None,
    ridge: float | None = None,
    weight_ridge: float | None = None,
    noise: float | None = None,
) -> ProMP:
    """Weights of every demonstration by regularised regression, and their Gaussian.

    Parameters
    ----------
    trajectories
        M demonstrations, whose stamps give the phase of every sample, or evenly sampled arrays
        (T_m, D), of any lengths.
    count
        Number of basis functions K.
    width
        Their width in phase; see :func:`radial_basis`.
    ridge
        Penalty on squared weights: w = (Psi^T Psi + ridge I)^-1 Psi^T x, which pulls the movement
        towards the origin. By default neighbouring weights are drawn together instead, a little:
        gaps in a recording are bridged, and neither unit nor origin matters.
    weight_ridge
        Added to the covariance of the weights (Eq. 8), which M - 1 < K*D demonstrations leave
        singular, in squared units of the data. By default the variance of 5 % of the spread of
        each weight.
    noise
        Variance of a single coordinate around the sum of basis functions. By default that of
        0.1 % of the spread of each coordinate: points to pass are met.

    Raises
    ------
    ArgumentError
        Trajectories of another shape, or ridges that are not positive.
    """
    if isinstance(trajectories, Demonstration):
        trajectories = [trajectories]
    given = entries("trajectories", trajectories)
    if any(isinstance(one, Demonstration) for one in given):
        demonstrations = agreed_with_warning(several("demonstrations", given, Demonstration))
        paths, phases = [d.data for d in demonstrations], [phase(d.time) for d in demonstrations]
    else:
        paths = [column_or_matrix(f"trajectories[{m}]", path) for m, path in enumerate(given)]
        phases = [np.linspace(0.0, 1.0, len(path)) for path in paths]
    return _fit_promp(paths, phases, count, width, ridge, weight_ridge, noise)


def _fit_promp(
    paths: list[NDArray],
    phases: list[NDArray],
    count: int,
    width: float | None,
    ridge: float | None,
    weight_ridge: float | None,
    noise: float | None,
) -> ProMP:
    if not paths or any(p.shape[1] != paths[0].shape[1] for p in paths):
        raise ArgumentError(
            f"trajectories have shapes {[p.shape for p in paths]}; give M >= 1 of (T_m, D)"
        )
    ridge = None if ridge is None else number("ridge", ridge, above=0)
    weight_ridge = None if weight_ridge is None else number("weight_ridge", weight_ridge, above=0)
    noise = None if noise is None else number("noise", noise, least=0)
    count = whole("count", count, least=1)
    bases = [radial_basis(at, count, width) for at in phases]
    fits = [regress(path, basis, ridge) for path, basis in zip(paths, bases, strict=True)]
    mean = np.mean(fits, axis=0)
    apart = np.array(fits) - mean
    local = (apart**2).sum(0) / max(len(paths) - 1, 1)
    flat = apart.reshape(len(paths), -1)
    covariance = flat.T @ flat / max(len(paths) - 1, 1)
    if weight_ridge is None:
        covariance += np.diag(_least(local, paths).ravel())
    else:
        covariance = add_ridge(covariance, weight_ridge)
    if noise is None:
        typical = covariance.diagonal().reshape(count, -1).mean(0)
        return ProMP(Gaussian(mean.ravel(), covariance), count, width, STEP**2 * typical)
    return ProMP(Gaussian(mean.ravel(), covariance), count, width, noise)


def _least(local: NDArray, paths: list[NDArray]) -> NDArray:
    """Variance (K, D) that is added to that of the weights.

    A single demonstration shows no spread: the movement's own extent takes its place.
    """
    if local.max() > 0:
        return least_variances(local, LEAST)
    extent = np.mean([path.var(0) for path in paths], axis=0)
    if not extent.max() > 0:
        raise ArgumentError("nothing moves in the demonstrations; give weight_ridge=...")
    return np.broadcast_to(least_variances(extent[None], LEAST), local.shape)


def fit_tp_promp(
    demonstrations: Demonstration | Sequence[Demonstration],
    count: int,
    *,
    width: float | None = None,
    ridge: float | None = None,
    weight_ridge: float | None = None,
    noise: float | None = None,
) -> TPProMP:
    """Probabilistic movement primitive of demonstrations in each of their frames.

    Parameters
    ----------
    demonstrations
        M demonstrations with the same number of frames; their stamps give the phase.
    count
        Number of basis functions K.
    width, ridge, weight_ridge, noise
        As in :func:`fit_promp`.
    """
    given = agreed_with_warning(several("demonstrations", demonstrations, Demonstration))
    counts = {len(d.observations) for d in given}
    if counts in (set(), {0}) or len(counts) > 1:
        raise ArgumentError(
            "give demonstrations with the same frames or observations, at least one of each"
        )
    phases = [phase(d.time) for d in given]
    views = zip(*(d.observations for d in given), strict=True)
    options = width, ridge, weight_ridge, noise
    return TPProMP(tuple(_fit_promp(list(view), phases, count, *options) for view in views))
