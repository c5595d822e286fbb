"""The recommended way from a few demonstrations to a movement that generalises."""

from collections.abc import Sequence

from tpsim.border import border
from tpsim.demonstration import Demonstration
from tpsim.retrieval.clock import on_one_clock
from tpsim.retrieval.fit_tp_gmr import TPGMR, fit_tp_gmr
from tpsim.retrieval.fit_tp_trajectory import TPTrajectory, fit_tp_trajectory


@border
def fit_movement(demonstrations: Sequence[Demonstration]) -> TPGMR | TPTrajectory:
    """Learn a movement that adapts to frames; everything is chosen by the demonstrations.

    Of the members of the TP-GMM family that generalise, over [t, x] (:func:`fit_tp_gmr`) and over
    [t, x, dx] (:func:`fit_tp_trajectory`), each with covariances shrunk towards equal spread and
    its own number of components, the one that best predicts demonstrations that are left out of
    the fit. Fewer than three demonstrations leave no choice: the trajectory model is taken.

    Parameters
    ----------
    demonstrations
        M demonstrations with the same frames, of any lengths.

    Returns
    -------
    TPGMR or TPTrajectory
        Call it with the frames of a situation: Gaussian (T, D) at ``times`` (T,) [s].

    Raises
    ------
    ArgumentError
        No demonstration, too few samples, or different frames.
    """
    demonstrations = on_one_clock(demonstrations)
    trajectory, regression = fit_tp_trajectory(demonstrations), fit_tp_gmr(demonstrations)
    trajectory_error = min(trajectory.errors.values(), default=0.0)
    regression_error = min(regression.errors.values(), default=0.0)
    return trajectory if trajectory_error <= regression_error else regression
