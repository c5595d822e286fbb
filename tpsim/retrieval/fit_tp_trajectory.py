"""Task-parameterized trajectory-GMM, from demonstrations to a movement in new frames."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.shrinkage import shrink_directions
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.retrieval.clock import on_one_clock
from tpsim.retrieval.fit_tp_gmr import numbers_of
from tpsim.retrieval.left_out import choose
from tpsim.retrieval.trajectory import trajectory_of_states

COMPONENTS = (6, 10, 15)
"""Numbers of components that are tried."""

WITHOUT_CHOICE = 10  # where too few demonstrations leave no choice
DERIVATIVES = 2


@dataclass(frozen=True, eq=False)
class TPTrajectory:
    """A movement of position, velocity and acceleration; call it with the frames of a situation.

    Attributes
    ----------
    model : TPGMM over [x, dx, ddx].
    states : (T,), the component of every step.
    times : (T,), when it answers [s].
    errors : of demonstrations that were left out [m], for every number of components tried.
    """

    model: TPGMM
    states: NDArray
    times: NDArray
    errors: dict[int, float] = field(default_factory=dict)

    def __call__(self, frames: Sequence[Frame | None]) -> Gaussian:
        """Movement in new frames of the positions: mean (T, D), covariance (T, D, D), Eq. 30.

        None stands for a frame that is not observed.
        """
        lifted = [frame if frame is None else frame.with_derivatives(DERIVATIVES) for frame in frames]
        dt = float(self.times[1] - self.times[0])
        return trajectory_of_states(self.model.adapt(lifted), self.states, dt)


def fit_tp_trajectory(
    demonstrations: Sequence[Demonstration],
    components: int | Iterable[int] = COMPONENTS,
    *,
    shrunk: bool = True,
) -> TPTrajectory:
    """Learn a TP-GMM over [x, dx, ddx] whose trajectory generalises to new frames, Section 5.2.

    What a frame says of velocity ties the steps of the movement together, so that frames agree
    on a whole path and not on every step by itself.

    Parameters
    ----------
    demonstrations
        M demonstrations with the same frames, of any lengths; they are brought on one clock
        (:func:`tpsim.retrieval.clock.on_one_clock`), at which the movement is retrieved.
    components
        Number of components K, or the numbers to choose from by demonstrations that are left
        out. Fewer than three demonstrations leave no choice: the number nearest to 10 is taken.
    shrunk
        Shrink covariances towards equal spread in all directions of space
        (:func:`tpsim.learning.shrinkage.shrink_directions`).

    Raises
    ------
    ArgumentError
        No demonstration, too few samples, or what :func:`fit_tp_gmm` refuses.
    """
    demonstrations = on_one_clock(demonstrations)
    numbers = numbers_of(components)
    if len(demonstrations[0]) <= DERIVATIVES:
        raise ArgumentError(
            f"the demonstrations have {len(demonstrations[0])} samples; accelerations need "
            f"{DERIVATIVES + 1}"
        )

    def fit(K: int, taught: list[Demonstration]) -> TPTrajectory:
        return _fit(taught, K, shrunk)

    middle = min(numbers, key=lambda K: abs(K - WITHOUT_CHOICE))
    best, errors = choose({K: partial(fit, K) for K in numbers}, demonstrations, middle)
    chosen = fit(best, demonstrations)
    return TPTrajectory(chosen.model, chosen.states, chosen.times, errors)


def _fit(demonstrations: list[Demonstration], components: int, shrunk: bool) -> TPTrajectory:
    moving = [d.with_derivatives(DERIVATIVES) for d in demonstrations]
    model = fit_tp_gmm(moving, components, start="time")
    count, times = len(moving), demonstrations[0].time
    states = model.responsibilities(moving).reshape(count, len(times), -1).mean(0).argmax(1)
    if shrunk:
        model = shrink_directions(model, count, given=(), blocks=DERIVATIVES + 1)
    return TPTrajectory(model, states, np.asarray(times))
