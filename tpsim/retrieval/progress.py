"""Where in a movement one is, from what is seen alone: a semi-Markov chain without a clock.

The forward variable of an HSMM ages by one step with every time step: whoever holds the arm longer
than a stay can last is overtaken by its durations. Here the movement has ticks of its own, and how
many of them pass in a time step (:class:`Pace`) is hidden as well. A hand that is held is one whose
ticks stand still; one that is pushed on makes several at once.

After S.-Z. Yu, "Hidden semi-Markov models", Artificial Intelligence 174, 2010, whose recursion over
states and ages this is where one tick passes in every step.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import Share, Steps, border, checked
from tpsim.checks import Seed, finite_array, generator, instance
from tpsim.errors import ArgumentError
from tpsim.learning.gmm import checked_priors
from tpsim.learning.markov import draw, log
from tpsim.learning.semi_markov import SemiMarkovChain


@dataclass(frozen=True, eq=False)
class Pace:
    """How many ticks of a movement pass in one time step.

    Parameters
    ----------
    likely : (V,)
        Probability of 0, 1 ... V - 1 ticks; ``(0, 1)`` is a clock.
    lasting : float
        Share of the time steps in which the pace is that of the step before; in the others it is
        drawn anew. Whoever holds an arm will still hold it in the next step.

    Raises
    ------
    ArgumentError
        Probabilities that are negative or do not sum to one.
    """

    likely: np.ndarray = field(default_factory=lambda: np.array([0.1, 0.8, 0.1]))
    lasting: Share = 0.5

    def __post_init__(self) -> None:
        checked(self)
        object.__setattr__(self, "likely", checked_priors(self.likely, "likely"))

    @property
    def transitions(self) -> np.ndarray:
        """Probability (V, V) of a number of ticks (column) after another one (row)."""
        drawn = (1 - self.lasting) * self.likely
        return self.lasting * np.eye(len(self.likely)) + drawn


@dataclass(frozen=True, eq=False)
class Belief:
    """What is known of the progress of a movement.

    Parameters
    ----------
    probability : (V, K, L)
        Of the ticks that passed in the last time step, the state, and the ticks 1 ... L that the
        stay in it has lasted; given all that was seen.
    log_likelihood : float
        Of all that was seen [nats].
    """

    probability: np.ndarray
    log_likelihood: float = 0.0

    @property
    def states(self) -> np.ndarray:
        """Probability (K,) of every state: the normalised forward variable."""
        found: np.ndarray = self.probability.sum((0, 2))
        return found

    @property
    def pace(self) -> float:
        """Ticks that passed in the last time step, as expected."""
        return float(self.probability.sum((1, 2)) @ np.arange(len(self.probability)))

    def expected(self, values: np.ndarray) -> np.ndarray:
        """Expectation (...) of what has a value (K, L, ...) in every state and age."""
        found: np.ndarray = np.tensordot(self.probability.sum(0), values, axes=2)
        return found


class ProgressFilter:
    """Forward recursion of a semi-Markov chain whose ticks may stand still or hurry.

    Every time step costs O(V K L) operations, V paces, K states, L ticks at most in a state.

    Parameters
    ----------
    chain : SemiMarkovChain
        Durations in ticks: how long a stay lasts where nobody interferes, the prior of progress.
    pace : Pace

    Attributes
    ----------
    longest : int
        Ticks L up to which ages are told apart.
    """

    def __init__(self, chain: SemiMarkovChain, pace: Pace | None = None):
        self.chain = instance("chain", chain, SemiMarkovChain)
        self.pace = Pace() if pace is None else instance("pace", pace, Pace)
        self.longest = chain.longest
        durations, survival = chain.log_durations(self.longest)
        leave = np.exp(durations - survival).T
        leave[:, -1] = 1.0
        leave[chain.transitions.sum(1) == 0] = 0.0  # nothing follows: the movement rests there
        self._leave = leave
        self._transitions = self.pace.transitions
        # Who asks what is foreseen asks for the same again once more is seen.
        self._last: tuple[Belief, np.ndarray] | None = None

    def start(self, log_densities: ArrayLike) -> Belief:
        """What is known once the first observation is there.

        Parameters
        ----------
        log_densities : (K,) or (V, K, L)
            Of the observation in every state; where states see more, in every pace and age.
        """
        prior = np.zeros((len(self.pace.likely), *self._leave.shape))
        prior[:, :, 0] = self.pace.likely[:, None] * self.chain.initial
        return self._given(prior, log_densities, 0.0)

    def update(self, belief: Belief, log_densities: ArrayLike) -> Belief:
        """What is known one time step later, with one more observation, as for :meth:`start`.

        Raises
        ------
        ArgumentError
            Densities of another shape, or an observation that no state explains.
        """
        return self._given(self._passed(belief), log_densities, belief.log_likelihood)

    def foreseen(self, belief: Belief) -> Belief:
        """What is known one time step later, if nothing was seen."""
        return Belief(self._passed(belief), belief.log_likelihood)

    @border
    def states_ahead(self, belief: Belief, steps: Steps, rng: Seed = None) -> np.ndarray:
        """States (steps,) from now on, at one tick a step: the present one first.

        Every stay lasts as long as its mean, and the most likely state follows: of several ways
        that are equally likely the first. With ``rng``, what follows is drawn (Fig. 8).
        """
        random = None if rng is None else generator("rng", rng)
        now = belief.probability.sum(0)
        state = int(now.sum(1).argmax())
        left = self._left(state, int(now[state].argmax()))
        states: list[int] = []
        while True:
            follows = self.chain.transitions[state]
            states += [state] * (left if follows.any() else steps)
            if len(states) >= steps:
                return np.array(states[:steps])
            state = int(follows.argmax()) if random is None else draw(follows, random)
            left = self._left(state, 0)

    def _left(self, state: int, age: int) -> int:
        """Ticks that a stay of ``age + 1`` is expected to go on, this one among them."""
        stays = np.cumprod(1 - self._leave[state, age:])
        return max(1, round(1 + float(stays.sum())))

    def _passed(self, belief: Belief) -> np.ndarray:
        """Probabilities (V, K, L) after a time step, before anything is seen."""
        if self._last is None or self._last[0] is not belief:
            self._last = belief, self._pass(instance("belief", belief, Belief).probability)
        return self._last[1]

    def _pass(self, p: np.ndarray) -> np.ndarray:
        p = np.tensordot(self._transitions, p, axes=(0, 0))
        for ticks in range(1, len(p)):
            p[ticks:] = self._tick(p[ticks:])
        return p

    def _tick(self, p: np.ndarray) -> np.ndarray:
        """One tick passes: stays end or grow older; those of the last state stay as old as L."""
        ended = p * self._leave
        goes_on, older = p - ended, np.zeros_like(p)
        older[..., 1:] = goes_on[..., :-1]
        older[..., -1] += goes_on[..., -1]
        older[..., 0] += ended.sum(-1) @ self.chain.transitions
        return older

    def _given(self, prior: np.ndarray, log_densities: ArrayLike, before: float) -> Belief:
        densities = finite_array("log_densities", log_densities)
        if densities.ndim == 1:
            densities = densities[:, None]
        try:
            densities = np.broadcast_to(densities, prior.shape)
        except ValueError:
            raise ArgumentError(
                f"log_densities have shape {np.shape(log_densities)}; give "
                f"({prior.shape[1]},) or what broadcasts to {prior.shape}"
            ) from None
        joint = log(prior) + densities
        top = joint.max()
        p = np.exp(joint - top)
        total = p.sum()
        return Belief(p / total, before + float(top + np.log(total)))
