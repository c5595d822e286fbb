"""Markov chain of hidden states: recursions in log space, so that nothing underflows.

In the functions, `initial (K,)`, `transitions (K, K)` and the `densities (T, M, K)` of the
observations are logarithms; in the :class:`MarkovChain` they are probabilities. The axis M holds
several sequences, moved through time together; behind their ends they are padded with zeros.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from tpsim.archive import Part
from tpsim.border import Count, Positive, Steps, border
from tpsim.checks import affordable, array_of, frozen_array
from tpsim.errors import ArgumentError
from tpsim.learning.gmm import checked_priors, posterior

Topology = Literal["left-right", "any"]
"""States one after the other, or in any order."""


@dataclass(frozen=True, eq=False)
class MarkovChain(Part):
    """States that follow each other step by step: the stay in a state is geometric.

    Parameters
    ----------
    initial : (K,)
        Probability of the first state.
    transitions : (K, K)
        Probability of state j (column) one step after state i (row).

    Raises
    ------
    ArgumentError
        Probabilities that are negative, do not sum to one or have other shapes.
    """

    initial: np.ndarray
    transitions: np.ndarray

    def __post_init__(self) -> None:
        object.__setattr__(self, "initial", checked_priors(self.initial, "initial"))
        rows = checked_transitions(self.transitions, len(self.initial))
        if (rows.sum(1) == 0).any():
            raise ArgumentError("a row of transitions is zero; let the last state follow itself")
        object.__setattr__(self, "transitions", rows)

    @classmethod
    @border
    def of(cls, components: Count, topology: Topology, stay: Positive) -> "MarkovChain":
        """Chain in which a stay lasts ``stay`` steps on average, see :func:`successors`."""
        leave = successors(components, topology) / max(stay, 1.0)
        transitions = leave + np.diag(1.0 - leave.sum(1))
        return cls(first_states(components, topology), transitions)

    def expectation(self, sequences: Sequence[np.ndarray]) -> "Expectation":
        """E-step for sequences of log densities (T_m, K): the forward-backward recursion."""
        densities, lengths = padded(sequences)
        initial, transitions = log(self.initial), log(self.transitions)
        alpha = forward(initial, transitions, densities)
        beta = backward(transitions, densities, lengths)
        log_likelihood = log_sum(alpha[lengths - 1, np.arange(len(lengths))], axis=1)
        joint = alpha[:-1, ..., None] + transitions + (densities + beta)[1:, :, None]
        within = (np.arange(1, len(densities))[:, None] < lengths)[..., None, None]
        changes = np.exp(np.where(within, joint - log_likelihood[:, None, None], -np.inf))
        responsibilities = posterior(alpha + beta)
        return Expectation(
            log_likelihood,
            [responsibilities[:length, m] for m, length in enumerate(lengths)],
            changes.sum((0, 1)),
        )

    def maximised(self, found: "Expectation") -> "MarkovChain":
        """M-step: the chain that explains what the E-step found best."""
        return MarkovChain(*updated(self.initial, self.transitions, found))

    def filtered(self, densities: np.ndarray) -> np.ndarray:
        """P(s_t | x_0 ... x_t) for one sequence of log densities, (T, K)."""
        alpha = forward(log(self.initial), log(self.transitions), densities[:, None])
        return posterior(alpha[:, 0])

    def viterbi(self, densities: np.ndarray) -> np.ndarray:
        """Most likely states (T,)."""
        return viterbi(log(self.initial), log(self.transitions), densities)

    @border
    def probabilities(self, steps: Steps) -> np.ndarray:
        """P(s_t) without observations, (steps, K)."""
        probability = np.empty((steps, len(self.initial)))
        probability[0] = self.initial
        for t in range(1, steps):
            probability[t] = probability[t - 1] @ self.transitions
        return probability

    @border
    def sample(self, steps: Steps, rng: np.random.Generator) -> np.ndarray:
        """Draw states (steps,)."""
        states = [draw(self.initial, rng)]
        while len(states) < steps:
            states.append(draw(self.transitions[states[-1]], rng))
        return np.array(states)


@dataclass(frozen=True, eq=False)
class Expectation:
    """E-step for M sequences.

    Parameters
    ----------
    log_likelihood : (M,)
        Of every whole sequence.
    responsibilities : list of (T_m, K)
        P(s_t | all observations of the sequence).
    transitions : (K, K)
        Expected number of changes from state i (row) to state j.
    stays : (3, K), optional
        Expected number of stays, of their steps, and of their squared steps, per state.
    """

    log_likelihood: np.ndarray
    responsibilities: list[np.ndarray]
    transitions: np.ndarray
    stays: np.ndarray | None = None


def updated(
    initial: np.ndarray, transitions: np.ndarray, found: Expectation
) -> tuple[np.ndarray, np.ndarray]:
    """Re-estimate both distributions; a row without any change of state stays as it was."""
    first = sum(h[0] for h in found.responsibilities)
    total = found.transitions.sum(1, keepdims=True)
    seen = total > 1e-10
    rows = np.where(seen, found.transitions / np.where(seen, total, 1.0), transitions)
    return first / first.sum(), rows


def padded(sequences: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Sequences (T_m, K) side by side, (T, M, K) with zeros behind their ends, and lengths (M,)."""
    lengths = np.array([len(sequence) for sequence in sequences])
    side_by_side = np.zeros((lengths.max(), len(lengths), sequences[0].shape[1]))
    for m, sequence in enumerate(sequences):
        side_by_side[: len(sequence), m] = sequence
    return side_by_side, lengths


def successors(components: int, topology: str) -> np.ndarray:
    """Which state follows another, (K, K), rows summing to one, or zero where none does.

    ``"left-right"``: the next one only, and none after the last; ``"any"``: all others alike.
    """
    components = affordable("components", components, components)
    if topology == "left-right":
        return np.eye(components, k=1)
    return (1.0 - np.eye(components)) / max(components - 1, 1)


def first_states(components: int, topology: str) -> np.ndarray:
    """Initial probabilities (K,): the first state, or all alike."""
    if topology == "left-right":
        return np.eye(components)[0]
    return np.full(components, 1.0 / components)


def checked_transitions(transitions: np.ndarray, components: int) -> np.ndarray:
    """Transitions (K, K) whose rows sum to one or are zero, or an ArgumentError."""
    transitions = frozen_array("transitions", transitions)
    if transitions.shape != (components, components):
        raise ArgumentError(
            f"transitions have shape {transitions.shape}; with {components} initial "
            f"probabilities it must be ({components}, {components})"
        )
    sums = transitions.sum(1)
    if (transitions < 0).any() or (np.minimum(abs(sums), abs(sums - 1)) > 1e-6).any():
        raise ArgumentError(f"rows of transitions sum to {sums}; each must be a distribution")
    return transitions


def visited(name: str, states: object, components: int | None = None) -> np.ndarray:
    """A sequence of states (T,), of ``components`` ones if that is known, or an ArgumentError."""
    found = array_of(name, states)
    allowed = "0, 1, 2, ..." if components is None else f"0..{components - 1}"
    if found.ndim != 1 or found.dtype.kind not in "iu":
        raise ArgumentError(f"{name} must be (T,) integers, got {found.dtype} {found.shape}")
    if found.size == 0:
        raise ArgumentError(f"{name} visit no state: the sequence is empty; give one of {allowed}")
    beyond = found < 0 if components is None else (found < 0) | (found >= components)
    if beyond.any():
        raise ArgumentError(
            f"{name} has {found[beyond][0]} at step {beyond.argmax()}; states must be one or more "
            f"of {allowed}"
        )
    return found


def draw(probability: np.ndarray, rng: np.random.Generator) -> int:
    """One index at random."""
    return int(rng.choice(len(probability), p=probability / probability.sum()))


def log(probability: np.ndarray) -> np.ndarray:
    """Logarithm of probabilities, with log 0 = -inf and no warning."""
    with np.errstate(divide="ignore"):
        return np.log(probability)


def log_sum(values: np.ndarray, axis: int = 0) -> np.ndarray:
    """Log sum exp along an axis; -inf where all values are -inf."""
    top = values.max(axis, keepdims=True)
    top = np.where(np.isfinite(top), top, 0.0)
    return log(np.exp(values - top).sum(axis)) + top.squeeze(axis)


def forward(initial: np.ndarray, transitions: np.ndarray, densities: np.ndarray) -> np.ndarray:
    """Log P(x_0 ... x_t, s_t = i), shape (T, M, K)."""
    alpha = np.empty_like(densities)
    alpha[0] = initial + densities[0]
    for t in range(1, len(alpha)):
        alpha[t] = log_sum(alpha[t - 1, :, :, None] + transitions, axis=1) + densities[t]
    return alpha


def backward(transitions: np.ndarray, densities: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Log P(x_{t+1} ... | s_t = i), shape (T, M, K)."""
    beta = np.zeros_like(densities)
    for t in range(len(beta) - 2, -1, -1):
        follows = transitions + (densities[t + 1] + beta[t + 1])[:, None]
        beta[t] = np.where((t < lengths - 1)[:, None], log_sum(follows, axis=2), 0.0)
    return beta


def viterbi(initial: np.ndarray, transitions: np.ndarray, densities: np.ndarray) -> np.ndarray:
    """Most likely sequence of states, shape (T,)."""
    best = initial + densities[0]
    origins = np.empty(densities.shape, dtype=int)
    for t in range(1, len(densities)):
        arrivals = best[:, None] + transitions
        origins[t] = arrivals.argmax(0)
        best = arrivals.max(0) + densities[t]
    states = [int(best.argmax())]
    for t in range(len(densities) - 1, 0, -1):
        states.append(int(origins[t, states[-1]]))
    return np.array(states[::-1])
