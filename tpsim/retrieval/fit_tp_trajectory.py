"""Task-parameterized trajectories: regression in every frame, their product, then one path."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, partial

import numpy as np
from numpy.typing import NDArray

from tpsim.border import Count, Positive, border, checked
from tpsim.demonstration import Demonstration
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import GMM
from tpsim.learning.shrinkage import shrink_directions
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.retrieval.clock import on_one_clock
from tpsim.retrieval.fit_tp_gmr import numbers_of
from tpsim.retrieval.fusion import fuse_frames
from tpsim.retrieval.gmr import gmr
from tpsim.retrieval.left_out import choose_components, left_out_scale
from tpsim.retrieval.trajectory import trajectory

COMPONENTS = (5, 8, 12)
"""Numbers of components that are tried."""

VELOCITY_SHARE = 0.5
"""How much velocity counts beside position, of what Eq. 30 says.

Between a quarter and a half the errors hardly differ; at full weight what the frames disagree
about on the way reaches the end (docs/comparison.md).
"""


@dataclass(frozen=True, eq=False)
class TPTrajectory:
    """A movement of position and velocity over time; call it with the frames of a situation.

    Attributes
    ----------
    model : TPGMM over [t, x, dx].
    times : (T,), when it answers [s].
    scale : factor of the covariance, sigma of Eq. 31.
    errors : of demonstrations that were left out [m], for every number of components tried.
    """

    model: TPGMM
    times: NDArray
    scale: Positive = 1.0
    errors: Mapping[int, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        checked(self)

    @border
    def __call__(self, frames: Sequence[Frame | None]) -> Gaussian:
        """Movement in new frames of the positions: mean (T, D), covariance (T, D, D).

        Position and velocity are retrieved in every frame, multiplied over the frames at equal
        time (Eqs 5-6), and the path that agrees best with both is returned (Eqs 30-31). None
        stands for a frame that is not observed.
        """
        lifted = [None if frame is None else frame.with_derivatives(1) for frame in frames]
        fused = fuse_frames(self._views, lifted)
        doubt = np.repeat([1.0, VELOCITY_SHARE**-0.5], fused.dim // 2)
        return trajectory(
            fused.mean,
            fused.covariance * doubt[:, None] * doubt,
            float(self.times[1] - self.times[0]),
            derivatives=1,
            scale=self.scale,
        )

    @cached_property
    def _views(self) -> list[Gaussian]:
        """Regression in every frame, which no situation changes, its velocities doubted."""
        duration = float(self.times[-1] - self.times[0])
        local = (gmr(GMM(self.model.priors, frame), self.times) for frame in self.model.frames)
        return [_doubted(view, duration) for view in local]


@border
def fit_tp_trajectory(
    demonstrations: Sequence[Demonstration],
    components: Count | Iterable[Count] = COMPONENTS,
    *,
    shrunk: bool = True,
) -> TPTrajectory:
    """Learn a TP-GMM over time, position and velocity whose path generalises to new frames.

    What a frame says of velocity ties the steps of the movement together, so that the frames
    agree on a path and not on every step by itself (Section 5.2, with time as the input).

    Parameters
    ----------
    demonstrations, components
        As in :func:`tpsim.retrieval.fit_tp_gmr.fit_tp_gmr`.
    shrunk
        Shrink covariances towards equal spread in all directions of space
        (:func:`tpsim.learning.shrinkage.shrink_directions`).

    Raises
    ------
    ArgumentError
        No demonstration, too few samples, or what :func:`fit_tp_gmm` refuses.

    Notes
    -----
    Eq. 31 takes the steps as independent, which the steps of a demonstration are not: its
    covariance is too small. ``scale`` is the mean squared distance of demonstrations that were
    left out, in units of that covariance; T / K with fewer than three demonstrations, the number
    of steps that share a component.
    """
    demonstrations = on_one_clock(demonstrations)
    numbers = numbers_of(components)

    # Fits that choose K without some demonstrations give the scale as well.
    @cache
    def learned(K: int, taught: tuple[Demonstration, ...]) -> TPTrajectory:
        return TPTrajectory(_model(list(taught), K, shrunk), taught[0].time)

    def fit(K: int, taught: list[Demonstration]) -> TPTrajectory:
        return learned(K, tuple(taught))

    best, errors = choose_components(fit, numbers, demonstrations)
    scale = left_out_scale(partial(fit, best), demonstrations)
    steps = len(demonstrations[0]) / best
    return replace(fit(best, demonstrations), scale=scale or steps, errors=errors)


def _model(demonstrations: list[Demonstration], components: int, shrunk: bool) -> TPGMM:
    moving = [demonstration.with_derivatives(1).with_time() for demonstration in demonstrations]
    model = fit_tp_gmm(moving, components, start="time")
    return shrink_directions(model, len(moving), blocks=2) if shrunk else model


def _doubted(view: Gaussian, duration: float) -> Gaussian:
    """Believe the velocities (T, 2 d) of one frame no more than its positions.

    Every frame has seen the movement come to rest, so that at the end even a frame that knows
    nothing of the goal claims to know the velocity. Taken at its word, it drags the path: the
    error at the goal grows with the distance from the demonstrations (docs/comparison.md). A
    frame that leaves the position open by s therefore leaves the velocity open by at least
    s / duration.
    """
    covariance, d = view.covariance.copy(), view.dim // 2
    covariance[:, d:, d:] += covariance[:, :d, :d] / duration**2
    return Gaussian.trusted(view.mean, covariance)
