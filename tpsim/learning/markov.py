"""Recursions in log space over Markov and semi-Markov chains of hidden states.

Arrays: `start (K,)`, `transitions (K, K)`, `densities (T, K)` of the observations and
`durations (L, K)` of a stay of 1 ... L steps are logarithms, so that nothing underflows.
"""

from dataclasses import dataclass

import numpy as np


def log(probability: np.ndarray) -> np.ndarray:
    """Logarithm of probabilities, with log 0 = -inf and no warning."""
    with np.errstate(divide="ignore"):
        return np.log(probability)


def log_sum(values: np.ndarray, axis: int = 0) -> np.ndarray:
    """Log sum exp along an axis; -inf where all values are -inf."""
    top = values.max(axis, keepdims=True)
    top = np.where(np.isfinite(top), top, 0.0)
    return log(np.exp(values - top).sum(axis)) + top.squeeze(axis)


def normalised(values: np.ndarray) -> np.ndarray:
    """Probabilities over the last axis from their unnormalised logarithms."""
    weights = np.exp(values - values.max(-1, keepdims=True))
    return weights / weights.sum(-1, keepdims=True)


# --- Markov chains (HMM) ------------------------------------------------------------------


def forward(start: np.ndarray, transitions: np.ndarray, densities: np.ndarray) -> np.ndarray:
    """Log P(x_0 ... x_t, s_t = i), shape (T, K)."""
    alpha = np.empty_like(densities)
    alpha[0] = start + densities[0]
    for t in range(1, len(alpha)):
        alpha[t] = log_sum(alpha[t - 1, :, None] + transitions) + densities[t]
    return alpha


def backward(transitions: np.ndarray, densities: np.ndarray) -> np.ndarray:
    """Log P(x_{t+1} ... x_{T-1} | s_t = i), shape (T, K)."""
    beta = np.zeros_like(densities)
    for t in range(len(beta) - 2, -1, -1):
        beta[t] = log_sum(transitions + densities[t + 1] + beta[t + 1], axis=1)
    return beta


def viterbi(start: np.ndarray, transitions: np.ndarray, densities: np.ndarray) -> np.ndarray:
    """Most likely sequence of states, shape (T,)."""
    best = start + densities[0]
    origins = np.empty(densities.shape, dtype=int)
    for t in range(1, len(densities)):
        arrivals = best[:, None] + transitions
        origins[t] = arrivals.argmax(0)
        best = arrivals.max(0) + densities[t]
    states = [int(best.argmax())]
    for t in range(len(densities) - 1, 0, -1):
        states.append(int(origins[t, states[-1]]))
    return np.array(states[::-1])


# --- Semi-Markov chains (HSMM) ------------------------------------------------------------
# A segment is a stay in one state. `starts[t, i]`: a segment of state i starts at t;
# `ends[t, i]`: one ended at t - 1. Row t is a border between steps, so there are T + 1 rows.


@dataclass(frozen=True)
class Segments:
    """Forward pass over segments: joint logarithms with the observations before the border.

    Attributes
    ----------
    starts, ends : (T + 1, K) arrays
    evidence : (T + 1, K) array
        Summed log densities of the observations before each border.
    """

    starts: np.ndarray
    ends: np.ndarray
    evidence: np.ndarray


def forward_segments(
    start: np.ndarray, transitions: np.ndarray, durations: np.ndarray, densities: np.ndarray
) -> Segments:
    """Probability that a segment starts, or has ended, at every border of the time steps."""
    steps, count = densities.shape
    evidence = _evidence(densities)
    starts = np.full((steps + 1, count), -np.inf)
    ends = np.full((steps + 1, count), -np.inf)
    starts[0] = start
    for t in range(1, steps + 1):
        stay = min(t, len(durations))
        since = starts[t - stay : t] - evidence[t - stay : t]
        ends[t] = log_sum(since + durations[stay - 1 :: -1]) + evidence[t]
        starts[t] = log_sum(ends[t, :, None] + transitions)
    return Segments(starts, ends, evidence)


def backward_segments(
    transitions: np.ndarray, durations: np.ndarray, densities: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Likelihood of all that follows a border, given that a segment starts (ends) there.

    The last segment ends with the sequence. Two (T + 1, K) arrays.
    """
    steps, count = densities.shape
    evidence = _evidence(densities)
    starts = np.full((steps + 1, count), -np.inf)
    ends = np.zeros((steps + 1, count))
    for t in range(steps - 1, -1, -1):
        stay = min(steps - t, len(durations))
        until = ends[t + 1 : t + 1 + stay] + evidence[t + 1 : t + 1 + stay]
        starts[t] = log_sum(until + durations[:stay]) - evidence[t]
        ends[t] = log_sum(transitions + starts[t], axis=1)
    return starts, ends


def occupancy(segments: Segments, survival: np.ndarray) -> np.ndarray:
    """Log P(x_0 ... x_t, s_t = i), shape (T, K): being in state i, not leaving it.

    Sums over the segments that started at or before t and last beyond it; `survival (L, K)`
    is the probability of a stay of at least 1 ... L steps.
    """
    starts, evidence = segments.starts, segments.evidence
    inside = np.empty_like(starts[1:])
    for t in range(len(inside)):
        stay = min(t + 1, len(survival))
        since = slice(t + 1 - stay, t + 1)
        open_segments = starts[since] - evidence[since] + survival[stay - 1 :: -1]
        inside[t] = log_sum(open_segments) + evidence[t + 1]
    return inside


def viterbi_segments(
    start: np.ndarray, transitions: np.ndarray, durations: np.ndarray, densities: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Most likely segments: their states and their durations, the last one complete."""
    steps, count = densities.shape
    evidence = _evidence(densities)
    starts = np.full((steps + 1, count), -np.inf)
    ends = np.full((steps + 1, count), -np.inf)
    stays = np.zeros((steps + 1, count), dtype=int)
    origins = np.zeros((steps + 1, count), dtype=int)
    starts[0] = start
    for t in range(1, steps + 1):
        stay = min(t, len(durations))
        since = starts[t - stay : t] - evidence[t - stay : t]
        paths = since + durations[stay - 1 :: -1]
        best = paths.argmax(0)
        stays[t] = stay - best
        ends[t] = paths[best, np.arange(count)] + evidence[t]
        arrivals = ends[t][:, None] + transitions
        origins[t] = arrivals.argmax(0)
        starts[t] = arrivals.max(0)
    states, lengths, t = [int(ends[-1].argmax())], [], steps
    while t > 0:
        lengths.append(int(stays[t, states[-1]]))
        t -= lengths[-1]
        states.append(int(origins[t, states[-1]]))
    return np.array(states[-2::-1]), np.array(lengths[::-1])


def _evidence(densities: np.ndarray) -> np.ndarray:
    return np.vstack([np.zeros_like(densities[:1]), densities.cumsum(0)])
