"""Recursions over the segments of a semi-Markov chain, in log space.

A segment is one stay in one state. Borders between time steps are counted: border t lies before
step t, so T steps have T + 1 borders. `initial (K,)`, `transitions (K, K)`, the probabilities
`durations (L, K)` of a stay of 1 ... L steps and the `densities (T, M, K)` of the observations of M
sequences are logarithms.
"""

from dataclasses import dataclass

import numpy as np

from tpsim.learning.markov import log_sum


@dataclass(frozen=True, eq=False)
class Segments:
    """What one pass knows of every border: log likelihoods of the observations on its side.

    Parameters
    ----------
    starts : (T + 1, M, K)
        Jointly with (or, in a backward pass, given) a segment of the state that starts there.
    ends : (T + 1, M, K)
        The same for a segment that ends there.
    evidence : (T + 1, M, K)
        Summed log densities of the observations before the border.
    """

    starts: np.ndarray
    ends: np.ndarray
    evidence: np.ndarray

    @classmethod
    def empty(cls, densities: np.ndarray) -> "Segments":
        """Nothing known yet."""
        evidence = np.concatenate([np.zeros_like(densities[:1]), densities.cumsum(0)])
        return cls(np.full_like(evidence, -np.inf), np.full_like(evidence, -np.inf), evidence)


def forward_segments(
    initial: np.ndarray, transitions: np.ndarray, durations: np.ndarray, densities: np.ndarray
) -> Segments:
    """Log P(x_0 ... x_{t-1}, a segment of state i starts, or ends, at border t)."""
    found = Segments.empty(densities)
    starts, ends, evidence = found.starts, found.ends, found.evidence
    starts[0] = initial
    for t in range(1, len(starts)):
        stay = min(t, len(durations))
        since = starts[t - stay : t] - evidence[t - stay : t]
        ends[t] = log_sum(since + durations[stay - 1 :: -1, None]) + evidence[t]
        starts[t] = log_sum(ends[t, :, :, None] + transitions, axis=1)
    return found


def backward_segments(
    transitions: np.ndarray, durations: np.ndarray, densities: np.ndarray, lengths: np.ndarray
) -> Segments:
    """Log P(x_t ... | a segment of state i starts, or ends, at border t), the last one complete."""
    found = Segments.empty(densities)
    starts, ends, evidence = found.starts, found.ends, found.evidence
    ends[lengths, np.arange(len(lengths))] = 0.0
    for t in range(len(densities) - 1, -1, -1):
        stay = min(len(densities) - t, len(durations))
        until = ends[t + 1 : t + 1 + stay] + evidence[t + 1 : t + 1 + stay]
        starts[t] = log_sum(until + durations[:stay, None]) - evidence[t]
        follows = log_sum(transitions + starts[t][:, None], axis=2)
        ends[t] = np.where((t < lengths)[:, None], follows, ends[t])
    return found


def occupancy(segments: Segments, survival: np.ndarray) -> np.ndarray:
    """Log P(x_0 ... x_t, s_t = i), shape (T, M, K): of being in state i, not of leaving it.

    Sums over the segments that started at or before t and last beyond it; `survival (L, K)`
    is the probability of a stay of at least 1 ... L steps.
    """
    starts, evidence = segments.starts, segments.evidence
    inside = np.empty_like(starts[1:])
    for t in range(len(inside)):
        stay = min(t + 1, len(survival))
        since = slice(t + 1 - stay, t + 1)
        still_open = starts[since] - evidence[since] + survival[stay - 1 :: -1, None]
        inside[t] = log_sum(still_open) + evidence[t + 1]
    return inside


def viterbi_segments(
    initial: np.ndarray, transitions: np.ndarray, durations: np.ndarray, densities: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Most likely segments of one sequence, densities (T, K): their states and durations."""
    found = Segments.empty(densities)
    starts, ends, evidence = found.starts, found.ends, found.evidence
    stays, origins = np.zeros(starts.shape, int), np.zeros(starts.shape, int)
    starts[0] = initial
    for t in range(1, len(starts)):
        stay = min(t, len(durations))
        since = starts[t - stay : t] - evidence[t - stay : t]
        paths = since + durations[stay - 1 :: -1]
        stays[t] = stay - paths.argmax(0)
        ends[t] = paths.max(0) + evidence[t]
        arrivals = ends[t][:, None] + transitions
        origins[t], starts[t] = arrivals.argmax(0), arrivals.max(0)
    states, lengths, t = [int(ends[-1].argmax())], [], len(densities)
    while t > 0:
        lengths.append(int(stays[t, states[-1]]))
        t -= lengths[-1]
        states.append(int(origins[t, states[-1]]))
    return np.array(states[-2::-1]), np.array(lengths[::-1])


def expected_stays(
    before: Segments, after: Segments, durations: np.ndarray, log_likelihood: np.ndarray
) -> np.ndarray:
    """Expected number of stays, of their steps and of their squared steps, (3, K)."""
    since = before.starts - before.evidence
    until = after.ends + before.evidence - log_likelihood[:, None]
    steps = np.arange(1, len(durations) + 1)
    powers = np.stack([steps**0, steps, steps**2]).astype(float)
    counts = np.zeros(durations.shape)
    for t in range(1, len(until)):
        stay = min(t, len(durations))
        weights = since[t - stay : t][::-1] + durations[:stay, None] + until[t]
        counts[:stay] += np.exp(weights).sum(1)
    return powers @ counts
