"""Semi-Markov chain of hidden states: every stay in a state has an explicit duration."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Part
from tpsim.border import Count, Positive, Range, Steps, border, read
from tpsim.checks import affordable, entries, instance, number
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import checked_priors, posterior
from tpsim.learning.markov import (
    Expectation,
    Topology,
    checked_transitions,
    draw,
    first_states,
    log,
    log_sum,
    padded,
    successors,
    updated,
    visited,
)
from tpsim.learning.segments import (
    backward_segments,
    expected_stays,
    forward_segments,
    occupancy,
    viterbi_segments,
)

Spread = Annotated[float, Range(least=0, most=1e6)]
"""Deviation of a duration, as a share of the mean stay."""


@dataclass(frozen=True, eq=False)
class SemiMarkovChain(Part):
    """States that follow each other after stays of Gaussian duration.

    Parameters
    ----------
    initial : (K,)
        Probability of the first state.
    transitions : (K, K)
        Probability of state j (column) after a stay in state i (row). A row of zeros marks a
        last state: nothing follows, the movement rests there.
    durations : Gaussian (K, 1)
        Duration of a stay [steps], of which the whole numbers from 1 on count.
    least_variance : float
        Below this the M-step leaves no variance of a duration [steps^2].

    Raises
    ------
    ArgumentError
        Probabilities that are negative or do not sum to one, wrong shapes, or durations without
        a positive mean and variance.
    """

    initial: np.ndarray
    transitions: np.ndarray
    durations: Gaussian
    least_variance: float = 1.0

    def __post_init__(self) -> None:
        instance("durations", self.durations, Gaussian)
        least = number("least_variance", self.least_variance, least=0)
        object.__setattr__(self, "least_variance", least)
        object.__setattr__(self, "initial", checked_priors(self.initial, "initial"))
        rows = checked_transitions(self.transitions, len(self.initial))
        object.__setattr__(self, "transitions", rows)
        if self.durations.mean.shape != (len(self.initial), 1):
            raise ArgumentError(
                f"durations have means of shape {self.durations.mean.shape}; with "
                f"{len(self.initial)} initial probabilities it must be ({len(self.initial)}, 1)"
            )
        if not (self.durations.mean.min() > 0 and self.durations.covariance.min() > 0):
            raise ArgumentError("durations need positive means and variances [steps]")

    @classmethod
    @border
    def of(
        cls, components: Count, topology: Topology, stay: Positive, spread: Spread
    ) -> "SemiMarkovChain":
        """Chain in which a stay lasts ``stay`` steps, see :func:`.markov.successors`.

        No duration will vary less than by ``spread`` times ``stay``, or one step.
        """
        follow, least = successors(components, topology), max(1.0, (spread * stay) ** 2)
        mean = np.full((components, 1), stay)
        variance = np.full((components, 1, 1), max(least, (0.5 * stay) ** 2))
        return cls(
            first_states(components, topology),
            follow,
            Gaussian(mean, variance),
            least,
        )

    @classmethod
    @border
    def along(cls, states: object, spread: Spread = 0.1) -> "SemiMarkovChain":
        """Chain of the stays of one sequence of states (T,), one after the other.

        Its states are the runs of equal numbers, in their order; a duration deviates by ``spread``
        times the mean stay, or one step.

        Raises
        ------
        ArgumentError
            If the sequence visits no state.
        """
        states = visited("states", states)
        stays = np.diff(np.flatnonzero(np.diff(states, prepend=-1, append=-1))).astype(float)
        variance = max(1.0, (spread * stays.mean()) ** 2)
        durations = Gaussian(stays[:, None], np.full((len(stays), 1, 1), variance))
        return cls(np.eye(len(stays))[0], np.eye(len(stays), k=1), durations, variance)

    @classmethod
    def through(
        cls, sequences: Sequence[ArrayLike], components: int, spread: float = 0.1
    ) -> "SemiMarkovChain":
        """Chain of states as they follow each other in parts of a movement, in any order (Fig. 8).

        Parameters
        ----------
        sequences : sequence of (T_m,)
            States of each part, integers 0 ... K - 1: those that several parts pass join them.
            Where parts go on differently from a state, all ways are equally likely.
        components : int
            Number of states K; those that no part visits are never reached.
        spread : float
            Deviation of a duration, as a share of the mean stay; one step at least.

        Returns
        -------
        SemiMarkovChain
            It begins in the states that no part enters, or where all are entered, as in a loop,
            with the first part. A part may begin or end within a stay: where there are whole ones
            they alone tell the duration of a state, and otherwise the longest does.

        Raises
        ------
        ArgumentError
            Where a part visits no state, or one that is not there.
        """
        K = affordable("components", components)
        spread = read("spread", spread, Spread)
        given = entries("sequences", sequences)
        parts = [visited(f"sequences[{m}]", part, K) for m, part in enumerate(given)]
        if not parts:
            raise ArgumentError("sequences visit no state: there is none; give at least one")
        follows, longest, stays = np.zeros((K, K)), np.ones(K), [[0.0] for _ in range(K)]
        for states in parts:
            changes = np.flatnonzero(np.diff(states)) + 1
            follows[states[changes - 1], states[changes]] = 1.0
            first, *inner, last = np.split(states, changes) if len(changes) else [states, states]
            for stay in (first, last):
                longest[stay[0]] = max(longest[stay[0]], len(stay))
            for stay in inner:
                stays[stay[0]].append(float(len(stay)))
        mean = np.array([np.mean(s[1:]) if len(s) > 1 else longest[k] for k, s in enumerate(stays)])
        seen = np.isin(np.arange(K), np.concatenate(parts))
        begins = (seen & ~follows.any(0)).astype(float)
        if not begins.any():
            begins[parts[0][0]] = 1.0
        variance = max(1.0, (spread * mean[seen].mean()) ** 2)
        return cls(
            begins / begins.sum(),
            follows / np.maximum(follows.sum(1, keepdims=True), 1),
            Gaussian(mean[:, None], np.full((K, 1, 1), variance)),
            variance,
        )

    def expectation(self, sequences: Sequence[np.ndarray]) -> Expectation:
        """E-step for sequences of log densities (T_m, K), whose last stays are complete."""
        densities, lengths = padded(sequences)
        initial, transitions = log(self.initial), log(self.transitions)
        durations, _ = self.log_durations(len(densities))
        before = forward_segments(initial, transitions, durations, densities)
        after = backward_segments(transitions, durations, densities, lengths)
        total = log_sum(before.ends[lengths, np.arange(len(lengths))], axis=1)
        begun = np.exp(before.starts + after.starts - total[:, None])
        ended = np.exp(before.ends + after.ends - total[:, None])
        inside = np.maximum((begun - ended).cumsum(0), 0.0)
        responsibilities = [inside[:length, m] for m, length in enumerate(lengths)]
        joint = before.ends[..., None] + transitions + after.starts[:, :, None]
        return Expectation(
            total,
            [h / h.sum(1, keepdims=True) for h in responsibilities],
            np.exp(joint - total[:, None, None]).sum((0, 1)),
            expected_stays(before, after, durations, total),
        )

    def maximised(self, found: Expectation) -> "SemiMarkovChain":
        """M-step: a chain that explains what the E-step found better."""
        assert found.stays is not None  # a semi-Markov E-step counts them
        count, total, squared = found.stays
        safe = np.maximum(count, 1e-10)
        mean = total / safe
        variance = np.maximum(squared / safe - mean**2, self.least_variance)
        # Moments are the optimum but for what whole steps >= 1 cut off: old durations may win.
        old = self.durations.mean[:, 0], self.durations.covariance[:, 0, 0]
        better = _expected_log(found.stays, mean, variance) > _expected_log(found.stays, *old)
        mean, variance = np.where(better, mean, old[0]), np.where(better, variance, old[1])
        return SemiMarkovChain(
            *updated(self.initial, self.transitions, found),
            Gaussian(mean[:, None], variance[:, None, None]),
            self.least_variance,
        )

    def filtered(self, densities: np.ndarray) -> np.ndarray:
        """P(s_t | x_0 ... x_t), (T, K), for a stay that may go on after t."""
        return posterior(self._forward(densities))

    def viterbi(self, densities: np.ndarray) -> np.ndarray:
        """Most likely states (T,), the last stay complete."""
        durations, _ = self.log_durations(len(densities))
        states, lengths = viterbi_segments(
            log(self.initial), log(self.transitions), durations, densities
        )
        return np.repeat(states, lengths)

    @border
    def probabilities(self, steps: Steps) -> np.ndarray:
        """P(s_t) without observations, (steps, K)."""
        return np.exp(self._forward(np.zeros((steps, len(self.initial)))))

    @border
    def sample(self, steps: Steps, rng: np.random.Generator) -> np.ndarray:
        """Draw states (steps,); the last stay may be cut short."""
        durations = np.exp(self.log_durations(steps)[0])
        states: list[int] = []
        state = draw(self.initial, rng)
        while len(states) < steps:
            if not self.transitions[state].any():
                states += [state] * (steps - len(states))
                break
            # One bin more than can be shown: whatever lasts longer than the sequence.
            longer = np.append(durations[:, state], max(0.0, 1.0 - durations[:, state].sum()))
            states += [state] * (1 + draw(longer, rng))
            state = draw(self.transitions[state], rng)
        return np.array(states[:steps])

    @property
    def longest(self) -> int:
        """Steps after which a stay is over for certain, where something follows the state."""
        return _longest(self.durations.mean[:, 0], self.durations.covariance[:, 0, 0])

    @border
    def log_durations(self, longest: Steps) -> tuple[np.ndarray, np.ndarray]:
        """Log probabilities that a stay lasts 1 ... L steps, and at least as many, (L, K)."""
        mean, variance = self.durations.mean[:, 0], self.durations.covariance[:, 0, 0]
        durations = _log_stays(mean, variance, max(longest, self.longest))
        survival = np.logaddexp.accumulate(durations[::-1])[::-1]
        survival = np.where(self.transitions.any(1), survival, 0.0)
        return durations[:longest], survival[:longest]

    def _forward(self, densities: np.ndarray) -> np.ndarray:
        durations, survival = self.log_durations(len(densities))
        initial, transitions = log(self.initial), log(self.transitions)
        segments = forward_segments(initial, transitions, durations, densities[:, None])
        return occupancy(segments, survival)[:, 0]


def _longest(mean: np.ndarray, variance: np.ndarray) -> int:
    return int(np.ceil((mean + 8 * np.sqrt(variance)).max()))


def _log_stays(mean: np.ndarray, variance: np.ndarray, longest: int) -> np.ndarray:
    """Log probability of 1 ... L steps, (L, K)."""
    durations = -0.5 * (np.arange(1, longest + 1)[:, None] - mean) ** 2 / variance
    return durations - log_sum(durations)


def _expected_log(stays: np.ndarray, mean: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Expected log probability (K,) of stays with the given moments (3, K)."""
    count, total, squared = stays
    longest = _longest(mean, variance)
    normaliser = -0.5 * (1 - mean) ** 2 / variance - _log_stays(mean, variance, longest)[0]
    return -0.5 * (squared - 2 * mean * total + mean**2 * count) / variance - count * normaliser
