"""What is seen all along a movement: emissions of a chain whose stays pass through places."""

import numpy as np

from tpsim.border import Duration, border
from tpsim.checks import finite_array, shown
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.retrieval.progress import Belief


class Passage:
    """A movement through places, as a hidden semi-Markov chain sees it (trajectory-HSMM).

    A state alone says little about progress within its stay. Here the states are passed along a
    trajectory, such as those of Eqs (26)-(31): at age a of its stay a state has the a-th of its
    places, and its last one for as long as the stay lasts. At a pace of v ticks a step the hand has
    v times the speed at which the trajectory passes.

    Parameters
    ----------
    chain : SemiMarkovChain
        States one after the other, as :meth:`SemiMarkovChain.along` makes it, whose mean durations
        add up to S.
    places : Gaussian (S, d)
        Where the hand is at every tick of the movement, and how far from there it may be.
    dt : float
        Time [s] of a tick.
    speed_deviation : float or (d,)
        Standard deviation of the velocity.
    """

    @border
    def __init__(
        self,
        chain: SemiMarkovChain,
        places: Gaussian,
        dt: Duration,
        speed_deviation: np.ndarray | float,
    ):
        stays = np.round(chain.durations.mean[:, 0]).astype(int)
        if places.mean.ndim != 2 or stays.sum() != len(places.mean):
            raise ArgumentError(
                f"places have means of shape {places.mean.shape}; with stays of {stays.tolist()} "
                f"ticks give ({stays.sum()}, d)"
            )
        deviation, d = finite_array("speed_deviation", speed_deviation), places.mean.shape[1]
        if deviation.shape not in ((), (d,)) or not (deviation > 1e-150).all():
            raise ArgumentError(
                f"speed_deviation is {shown(speed_deviation)}; give a positive number, or ({d},)"
            )
        first = np.cumsum(stays) - stays
        ages = np.minimum(np.arange(chain.longest), stays[:, None] - 1)
        self.chain, self.places = chain, places
        self._index = first[:, None] + ages
        still = len(places.mean) == 1
        self._speed = 0 * places.mean if still else np.gradient(places.mean, dt, axis=0)
        self._weight = np.broadcast_to(deviation, (d,)) ** -2.0
        self._precision = places.precision
        self._volume = 0.5 * np.linalg.slogdet(self._precision)[1]

    def log_densities(self, position: np.ndarray, velocity: np.ndarray, paces: int) -> np.ndarray:
        """Log density (V, K, L) of a position and velocity (d,) at every pace, state and age."""
        away = position - self.places.mean
        there = self._volume - 0.5 * np.einsum("si,sij,sj->s", away, self._precision, away)
        slip = velocity - np.arange(paces)[:, None, None] * self._speed
        found: np.ndarray = (there - 0.5 * slip**2 @ self._weight)[:, self._index]
        return found

    def place(self, belief: Belief) -> float:
        """Place in the movement, 0 ... S - 1, as expected."""
        return float(belief.expected(self._index))
