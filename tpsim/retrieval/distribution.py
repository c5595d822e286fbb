"""Gaussian distributions of whole trajectories, by their principal modes (Sections 5.2 and 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.agreement import agreed_with_warning
from tpsim.archive import Stored
from tpsim.checks import (
    Seed,
    affordable,
    finite_array,
    flag,
    frozen_array,
    generator,
    instance,
    number,
    several,
    whole,
)
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian, cholesky, inverse_spd
from tpsim.retrieval.least import least_variances
from tpsim.timeline import evenly_spaced

LEAST = 0.05  # of the spread of the demonstrations: a smaller error is never believed


@dataclass(frozen=True, eq=False)
class TrajectoryDistribution(Stored):
    """Trajectories x_t = mean_t + sum_i z_i modes_i,t + noise_t, with z standard normal.

    The covariance of all T*D coordinates is low rank plus block diagonal, and stays so in
    products: every operation is linear in T.

    Attributes
    ----------
    mean : (T, D)
    modes : (n, T, D), one standard deviation along each principal mode.
    noise : (T, D, D), covariance at a single time step.
    """

    mean: NDArray
    modes: NDArray
    noise: NDArray

    def __post_init__(self) -> None:
        for name in ("mean", "modes", "noise"):
            object.__setattr__(self, name, frozen_array(name, getattr(self, name)))
        T, D = self.mean.shape if self.mean.ndim == 2 else (0, 0)
        if self.mean.ndim != 2 or self.modes.shape[1:] != (T, D) or self.noise.shape != (T, D, D):
            raise ArgumentError(
                f"mean {self.mean.shape}, modes {self.modes.shape} and noise {self.noise.shape} "
                "must be (T, D), (n, T, D) and (T, D, D)"
            )

    @classmethod
    def of(cls, gaussian: Gaussian, name: str = "gaussian") -> TrajectoryDistribution:
        """Independent time steps: a Gaussian (T, D) without any mode."""
        if instance(name, gaussian, Gaussian).mean.ndim != 2:
            raise ArgumentError(f"{name} has means of shape {gaussian.mean.shape}; give (T, D)")
        return cls(gaussian.mean, np.zeros((0, *gaussian.mean.shape)), gaussian.covariance)

    def marginal(self) -> Gaussian:
        """Distribution at every time step: mean (T, D), covariance (T, D, D)."""
        covariance = self.noise + np.einsum("nta,ntb->tab", self.modes, self.modes)
        return Gaussian.trusted(self.mean, covariance)

    def covariance(self) -> NDArray:
        """Covariance between all coordinates, dense (T*D, T*D); for small T."""
        from scipy.linalg import block_diag

        modes = self.modes.reshape(len(self.modes), -1)
        return block_diag(*self.noise) + modes.T @ modes

    def sample(self, rng: Seed, size: int = 1, *, noisy: bool = False) -> NDArray:
        """Draw (size, T, D) trajectories, with or without the noise of single steps."""
        rng, size = generator("rng", rng), affordable("size", size, self.mean.size, least=0)
        z = rng.standard_normal((size, len(self.modes)))
        paths = self.mean + np.tensordot(z, self.modes, 1)
        if flag("noisy", noisy):
            paths += Gaussian.trusted(np.zeros_like(self.mean), self.noise).sample(rng, size)
        return paths

    def through(
        self, step: int, point: ArrayLike, covariance: ArrayLike = 0.0
    ) -> TrajectoryDistribution:
        """Condition on passing a point (D,) at a step, known up to a covariance (D, D)."""
        T, D = self.mean.shape
        if not -T <= whole("step", step, least=-T) < T:
            raise ArgumentError(f"step is {step}; the trajectory has steps 0 to {T - 1}")
        seen_as = finite_array("covariance", covariance)
        if seen_as.shape not in ((), (D, D)):
            raise ArgumentError(f"covariance has shape {seen_as.shape}; it must be ({D}, {D})")
        seen_as = seen_as if seen_as.ndim else seen_as * np.ones((D, D))
        at = finite_array("point", point)
        if at.shape != (D,):
            raise ArgumentError(f"point has shape {at.shape}; it must be ({D},)")
        to = Gaussian(at, seen_as)
        seen = self.modes[:, step]
        total = self.noise[step] + to.covariance
        gain = seen @ inverse_spd(seen.T @ seen + total, "covariance at the step")
        shift = gain @ (to.mean - self.mean[step])
        left = np.eye(len(seen)) - gain @ seen.T
        root = cholesky(0.5 * (left + left.T), "covariance of the modes")
        mean = self.mean + np.tensordot(shift, self.modes, 1)
        return TrajectoryDistribution(mean, np.tensordot(root.T, self.modes, 1), self.noise)


@dataclass(frozen=True, eq=False)
class TPTrajectoryDistribution(Stored):
    """Trajectory distributions seen from several frames (demo_TPtrajDistrib01).

    Attributes
    ----------
    frames : one :class:`TrajectoryDistribution` (T, d_j) for every frame.
    """

    frames: tuple[TrajectoryDistribution, ...]

    def __post_init__(self) -> None:
        frames = tuple(several("frames", self.frames, TrajectoryDistribution))
        if not frames or len({len(frame.mean) for frame in frames}) > 1:
            raise ArgumentError(f"{len(frames)} frames; give one or more of one length T")
        object.__setattr__(self, "frames", frames)

    def adapt(self, frames: Sequence[Frame]) -> TrajectoryDistribution:
        """Product of the distributions carried to the common coordinates, Eqs 5-6.

        Parameters
        ----------
        frames
            P frames, constant or moving with leading axis T. Where A is not invertible its
            pseudo-inverse carries the information.

        Raises
        ------
        ArgumentError
            Another number of frames, or frames that leave a direction undetermined.
        """
        frames = several("frames", frames, Frame)
        if len(frames) != len(self.frames):
            raise ArgumentError(f"{len(frames)} frames were given, {len(self.frames)} were learned")
        self._check_shapes(frames)
        origin = frames[0].to_common(self.frames[0].mean)  # near the result, to keep its digits
        pairs = zip(self.frames, frames, strict=True)
        evidence = [_evidence(local, frame, origin) for local, frame in pairs]
        precision = np.sum([e[0] for e in evidence], axis=0)
        noise = inverse_spd(precision, "information of the frames")
        explained = np.concatenate([e[1] for e in evidence])
        spread = np.einsum("nta,tab->ntb", explained, noise)
        gram = np.einsum("nta,mta->nm", spread, explained)
        root = cholesky(np.eye(len(gram)) - gram, "information of the modes")
        modes = _solve(root, spread)
        information = sum(e[2] for e in evidence)
        mean = origin + np.einsum("tab,tb->ta", noise, information)
        mean += np.tensordot(np.tensordot(modes, information, 2), modes, 1)
        return TrajectoryDistribution(mean, modes, noise)

    def _check_shapes(self, frames: list[Frame]) -> None:
        T = len(self.frames[0].mean)
        for j, (local, frame) in enumerate(zip(self.frames, frames, strict=True)):
            if frame.local_dim != local.mean.shape[1] or frame.shape not in ((), (T,)):
                raise ArgumentError(
                    f"frame {j} has A of shape {frame.A.shape}; the model asks for "
                    f"(D, {local.mean.shape[1]}) or ({T}, D, {local.mean.shape[1]})"
                )
        if len({frame.dim for frame in frames}) > 1:
            raise ArgumentError("the frames lead to different dimensions D; all must agree")


def fit_trajectory_distribution(
    trajectories: ArrayLike | Sequence[Demonstration],
    modes: int = 3,
    *,
    noise: float | None = None,
) -> TrajectoryDistribution:
    """Mean and largest eigencomponents of trajectories of equal length.

    Parameters
    ----------
    trajectories
        (M, T, D), M >= 2 demonstrations with the same time steps, or Demonstrations of one
        length T: the data of those that are sampled unevenly at evenly spaced times instead.
    modes
        Number of eigencomponents kept, at most M - 1.
    noise
        Variance at every step and coordinate beside the modes (Eq. 8), in squared units of the
        data. By default what the modes leave of the demonstrations' variance there, and at least
        that of 5 % of their spread, whatever the unit.

    Raises
    ------
    ArgumentError
        Trajectories of another shape, too many modes, or no noise.
    """
    demonstrations = _demonstrations(trajectories)
    paths = [d.data for d in demonstrations] if demonstrations else trajectories
    trajectories = finite_array("trajectories", paths)
    finite_array("variance of trajectories", np.abs(trajectories).max(initial=0.0) ** 2)
    modes = whole("modes", modes, least=1)
    noise = None if noise is None else number("noise", noise, above=0)
    if trajectories.ndim != 3 or not 1 <= modes < len(trajectories):
        raise ArgumentError(
            f"trajectories {trajectories.shape} and modes {modes} must be (M, T, D) with "
            "M > modes >= 1; resample demonstrations to one length, demonstration.resampled(T)"
        )
    count, T, D = trajectories.shape
    mean = trajectories.mean(0)
    _, size, directions = np.linalg.svd(
        (trajectories - mean).reshape(count, -1), full_matrices=False
    )
    kept = directions[:modes] * (size[:modes, None] / np.sqrt(count - 1))
    kept = kept.reshape(modes, T, D)
    variance = np.full((T, D), noise) if noise else _left_over(trajectories - mean, kept)
    return TrajectoryDistribution(mean, kept, variance[..., None] * np.eye(D))


def _left_over(apart: NDArray, kept: NDArray) -> NDArray:
    """Variance (T, D) of deviations (M, T, D) that the kept modes leave, above the least."""
    local = (apart**2).sum(0) / (len(apart) - 1)
    if not local.max() > 0:
        raise ArgumentError("all demonstrations are the same; give the variance noise=...")
    return np.maximum(local - (kept**2).sum(0), least_variances(local, LEAST))


def _demonstrations(given: object) -> list[Demonstration]:
    """Demonstrations of one length at evenly spaced times, or none where these are arrays."""
    if isinstance(given, Demonstration):
        given = [given]
    if not isinstance(given, list | tuple) or not any(isinstance(g, Demonstration) for g in given):
        return []
    demonstrations = agreed_with_warning(several("demonstrations", given, Demonstration))
    lengths = [len(d) for d in demonstrations]
    if len(set(lengths)) > 1:
        raise ArgumentError(
            f"demonstrations differ in length, {lengths}; give demonstration.resampled(T)"
        )
    return [d if evenly_spaced(d.time) else d.resampled(len(d)) for d in demonstrations]


def fit_tp_trajectory_distribution(
    demonstrations: Sequence[Demonstration], modes: int = 3, *, noise: float | None = None
) -> TPTrajectoryDistribution:
    """Trajectory distribution of demonstrations of equal length in each of their frames.

    Parameters as in :func:`fit_trajectory_distribution`.
    """
    given = _demonstrations(demonstrations)
    counts = {len(d.observations) for d in given}
    if counts in (set(), {0}) or len(counts) > 1:
        raise ArgumentError(
            "give demonstrations with the same frames or observations, at least one of each"
        )
    views = zip(*(d.observations for d in given), strict=True)
    return TPTrajectoryDistribution(
        tuple(fit_trajectory_distribution(np.stack(v), modes, noise=noise) for v in views)
    )


def _evidence(
    local: TrajectoryDistribution, frame: Frame, origin: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """What a frame knows in coordinates from ``origin``: its precision N - U^T U, information.

    Returns N (T, D, D), U (n, T, D) and information (T, D), by Woodbury's identity.
    """
    precision = inverse_spd(local.noise, "noise")
    white = np.einsum("nta,tab->ntb", local.modes, precision)
    gram = np.einsum("nta,mta->nm", white, local.modes)
    root = cholesky(gram + np.eye(len(gram)), "information of the modes")
    explained = _solve(root, white)
    inverse = np.broadcast_to(frame.inverse, (len(precision), *frame.inverse.shape[-2:]))
    center = local.mean + np.einsum("tab,tb->ta", inverse, frame.b - origin)
    projected = np.tensordot(explained, center, 2)
    information = np.einsum("tab,tb->ta", precision, center)
    information -= np.tensordot(projected, explained, 1)
    return (
        inverse.mT @ precision @ inverse,
        np.einsum("nta,tab->ntb", explained, inverse),
        np.einsum("tba,tb->ta", inverse, information),
    )


def _solve(root: NDArray, modes: NDArray) -> NDArray:
    n, T, D = modes.shape
    return np.linalg.solve(root, modes.reshape(n, T * D)).reshape(n, T, D)
