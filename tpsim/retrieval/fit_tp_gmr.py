"""TP-GMR for who does not want to choose: structure and number of components by the data."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tpsim.border import Count, border, checked
from tpsim.checks import entries, whole
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import GMM
from tpsim.learning.shrinkage import shrink_directions
from tpsim.learning.subspace import Structure
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.retrieval.clock import on_one_clock
from tpsim.retrieval.fusion import fuse_frames
from tpsim.retrieval.gmr import gmr
from tpsim.retrieval.left_out import choose_components
from tpsim.retrieval.tp_gmr import Order, tp_gmr

COMPONENTS = (4, 6, 8, 11, 15)
"""Numbers of components that are tried."""

SHRUNK = "shrunk"


@dataclass(frozen=True, eq=False)
class TPGMR:
    """A movement over time that adapts to frames; call it with those of a situation.

    Attributes
    ----------
    model : TPGMM over [t, x].
    times : (T,), when it answers [s].
    order : as in :func:`tp_gmr`.
    errors : of demonstrations that were left out [m], for every number of components tried.
    """

    model: TPGMM
    times: NDArray
    order: Order = "regression"
    errors: Mapping[int, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        checked(self)

    @border
    def __call__(self, frames: Sequence[Frame | None]) -> Gaussian:
        """Movement in new frames of the positions: mean (T, D), covariance (T, D, D).

        None stands for a frame that is not observed.
        """
        if self.order != "regression" or not self._plain(frames):
            return tp_gmr(self.model, frames, self.times, order=self.order)
        return fuse_frames(self._views, frames)

    def _plain(self, frames: Sequence[Frame | None]) -> bool:
        """Whether the regressions that are remembered answer for these frames."""
        dims = [None if frame is None else frame.local_dim + 1 for frame in frames]
        return (
            len(dims) == len(self.model.dims)
            and set(dims) != {None}
            and all(d in (None, dim) for d, dim in zip(dims, self.model.dims, strict=True))
        )

    @cached_property
    def _views(self) -> list[Gaussian]:
        """Regression in every frame, which no situation changes."""
        return [gmr(GMM(self.model.priors, frame), self.times) for frame in self.model.frames]


@border
def fit_tp_gmr(
    demonstrations: Sequence[Demonstration],
    components: Count | Iterable[Count] = COMPONENTS,
    *,
    covariance: str | Structure = SHRUNK,
    order: Order = "regression",
) -> TPGMR:
    """Learn a movement over time that generalises to new frames, without further choices.

    A TP-GMM over [t, x] with full covariances, whose spread given time is shrunk towards equal
    spread in all directions as far as the number of demonstrations demands
    (:func:`tpsim.learning.shrinkage.shrink_directions`); regression in every frame, then the
    product (:func:`tp_gmr`); and the number of components that best predicts demonstrations that
    are left out of the fit.

    Parameters
    ----------
    demonstrations
        M demonstrations with the same frames, of any lengths; they are brought on one clock
        (:func:`tpsim.retrieval.clock.on_one_clock`), at which the movement is retrieved.
    components
        Number of components K, or the numbers to choose from. Fewer than three demonstrations
        leave no choice: the number nearest to 8 is taken.
    covariance
        ``"shrunk"``, or any structure of :func:`fit_tp_gmm` as it is.
    order
        As in :func:`tp_gmr`.

    Raises
    ------
    ArgumentError
        No demonstration, no number of components, or what :func:`fit_tp_gmm` refuses.
    """
    demonstrations = on_one_clock(demonstrations)
    numbers = numbers_of(components)

    def fit(K: int, taught: list[Demonstration]) -> TPGMR:
        return TPGMR(_model(taught, K, covariance), taught[0].time, order)

    best, errors = choose_components(fit, numbers, demonstrations)
    return replace(fit(best, demonstrations), errors=errors)


def numbers_of(components: int | Iterable[int]) -> list[int]:
    """Numbers of components to choose from; ArgumentError where there is none."""
    one = isinstance(components, int | np.integer)
    given = [components] if one else entries("components", components, tables=False)
    numbers = [whole("components", K, least=1) for K in given]
    if not numbers:
        raise ArgumentError("components is empty; give at least one number of components")
    return sorted(numbers)


def _model(
    demonstrations: Sequence[Demonstration], components: int, covariance: str | Structure
) -> TPGMM:
    timed = [demonstration.with_time() for demonstration in demonstrations]
    if covariance != SHRUNK:
        return fit_tp_gmm(timed, components, covariance=covariance, start="time")
    model = fit_tp_gmm(timed, components, start="time")
    return shrink_directions(model, len(demonstrations))
