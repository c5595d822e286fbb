"""Gaussian distributions of whole trajectories, by their principal modes (Sections 5.2 and 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian, add_ridge, cholesky, finite_array, inverse_spd


@dataclass(frozen=True, eq=False)
class TrajectoryDistribution:
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

    def __post_init__(self):
        T, D = self.mean.shape
        if self.modes.shape[1:] != (T, D) or self.noise.shape != (T, D, D):
            raise ArgumentError(
                f"mean {self.mean.shape}, modes {self.modes.shape} and noise {self.noise.shape} "
                "must be (T, D), (n, T, D) and (T, D, D)"
            )

    @classmethod
    def of(cls, gaussian: Gaussian) -> TrajectoryDistribution:
        """Independent time steps: a Gaussian (T, D) without any mode."""
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

    def sample(self, rng: np.random.Generator, size: int = 1, *, noisy: bool = False) -> NDArray:
        """Draw (size, T, D) trajectories, with or without the noise of single steps."""
        z = rng.standard_normal((size, len(self.modes)))
        paths = self.mean + np.tensordot(z, self.modes, 1)
        if noisy:
            paths += Gaussian.trusted(np.zeros_like(self.mean), self.noise).sample(rng, size)
        return paths

    def through(
        self, step: int, point: ArrayLike, covariance: ArrayLike = 0.0
    ) -> TrajectoryDistribution:
        """Condition on passing a point (D,) at a step, known up to a covariance (D, D)."""
        T, D = self.mean.shape
        if not -T <= step < T:
            raise ArgumentError(f"step is {step}; the trajectory has steps 0 to {T - 1}")
        seen = self.modes[:, step]
        total = self.noise[step] + np.broadcast_to(finite_array("covariance", covariance), (D, D))
        gain = np.linalg.solve(seen.T @ seen + total, seen.T).T
        shift = gain @ (finite_array("point", point) - self.mean[step])
        left = np.eye(len(seen)) - gain @ seen.T
        root = cholesky(0.5 * (left + left.T), "covariance of the modes")
        mean = self.mean + np.tensordot(shift, self.modes, 1)
        return TrajectoryDistribution(mean, np.tensordot(root.T, self.modes, 1), self.noise)


@dataclass(frozen=True)
class TPTrajectoryDistribution:
    """Trajectory distributions seen from several frames (demo_TPtrajDistrib01).

    Attributes
    ----------
    frames : one :class:`TrajectoryDistribution` (T, d_j) for every frame.
    """

    frames: tuple[TrajectoryDistribution, ...]

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
        if len(frames) != len(self.frames):
            raise ArgumentError(f"{len(frames)} frames were given, {len(self.frames)} were learned")
        evidence = [_evidence(*pair) for pair in zip(self.frames, frames, strict=True)]
        noise = inverse_spd(sum(e[0] for e in evidence), "information of the frames")
        explained = np.concatenate([e[1] for e in evidence])
        spread = np.einsum("nta,tab->ntb", explained, noise)
        gram = np.einsum("nta,mta->nm", spread, explained)
        root = cholesky(np.eye(len(gram)) - gram, "information of the modes")
        modes = _solve(root, spread)
        information = sum(e[2] for e in evidence)
        mean = np.einsum("tab,tb->ta", noise, information)
        mean += np.tensordot(np.tensordot(modes, information, 2), modes, 1)
        return TrajectoryDistribution(mean, modes, noise)


def fit_trajectory_distribution(
    trajectories: ArrayLike, modes: int = 3, *, noise: float = 1e-2
) -> TrajectoryDistribution:
    """Mean and largest eigencomponents of trajectories of equal length.

    Parameters
    ----------
    trajectories
        (M, T, D), M >= 2 demonstrations with the same time steps.
    modes
        Number of eigencomponents kept, at most M - 1.
    noise
        Variance added at every step and coordinate (Eq. 8).

    Raises
    ------
    ArgumentError
        Trajectories of another shape, too many modes, or no noise.
    """
    trajectories = finite_array("trajectories", trajectories)
    if trajectories.ndim != 3 or not 1 <= modes < len(trajectories) or not noise > 0:
        raise ArgumentError(
            f"trajectories {trajectories.shape}, modes {modes} and noise {noise} must be "
            "(M, T, D) with M > modes >= 1, and positive; resample demonstrations to one length"
        )
    count, T, D = trajectories.shape
    mean = trajectories.mean(0)
    _, size, directions = np.linalg.svd(
        (trajectories - mean).reshape(count, -1), full_matrices=False
    )
    kept = directions[:modes] * (size[:modes, None] / np.sqrt(count - 1))
    return TrajectoryDistribution(
        mean, kept.reshape(modes, T, D), np.tile(noise * np.eye(D), (T, 1, 1))
    )


def fit_tp_trajectory_distribution(
    demonstrations: Sequence[Demonstration], modes: int = 3, *, noise: float = 1e-2
) -> TPTrajectoryDistribution:
    """Trajectory distribution of demonstrations of equal length in each of their frames.

    Parameters as in :func:`fit_trajectory_distribution`.
    """
    views = zip(*(d.observations for d in demonstrations), strict=True)
    if len({len(d) for d in demonstrations}) > 1:
        raise ArgumentError("demonstrations differ in length; give demonstration.resampled(T)")
    return TPTrajectoryDistribution(
        tuple(fit_trajectory_distribution(np.stack(v), modes, noise=noise) for v in views)
    )


def fuse_frames(views: Sequence[Gaussian], frames: Sequence[Frame]) -> Gaussian:
    """Product over frames at every time step, Eqs 5-6: data-driven models (TP-GP, TP-LWR).

    Parameters
    ----------
    views
        P Gaussians (T, d_j), what a regression retrieved in each frame.
    frames
        P frames, constant or moving with leading axis T.

    Returns
    -------
    Gaussian with mean (T, D) and covariance (T, D, D).
    """
    model = TPTrajectoryDistribution(tuple(TrajectoryDistribution.of(view) for view in views))
    return model.adapt(frames).marginal()


def _evidence(local: TrajectoryDistribution, frame: Frame) -> tuple[NDArray, NDArray, NDArray]:
    """What a frame knows in common coordinates: its precision is N - U^T U, with information.

    Returns N (T, D, D), U (n, T, D) and information (T, D), by Woodbury's identity.
    """
    precision = inverse_spd(local.noise, "noise")
    white = np.einsum("nta,tab->ntb", local.modes, precision)
    gram = np.einsum("nta,mta->nm", white, local.modes)
    root = cholesky(add_ridge(gram, 1.0), "information of the modes")
    explained = _solve(root, white)
    inverse = np.broadcast_to(frame.inverse, (len(precision), *frame.inverse.shape[-2:]))
    center = local.mean + np.einsum(
        "tab,tb->ta", inverse, np.broadcast_to(frame.b, (len(precision), frame.dim))
    )
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
