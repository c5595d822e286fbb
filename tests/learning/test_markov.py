"""The recursions against sums over every possible path."""

import itertools

import numpy as np
import pytest

from tpsim.gaussian import Gaussian
from tpsim.learning import markov, segments
from tpsim.learning.markov import MarkovChain
from tpsim.learning.semi_markov import SemiMarkovChain

T, K, L = 6, 3, 4


@pytest.fixture
def chain():
    rng = np.random.default_rng(0)
    start = rng.dirichlet(np.ones(K))
    transitions = rng.dirichlet(np.ones(K), size=K)
    durations = rng.dirichlet(np.ones(L), size=K).T
    densities = rng.normal(scale=3.0, size=(T, K))
    return (*map(markov.log, (start, transitions, durations)), densities)


def every_path(start, transitions, densities):
    for path in itertools.product(range(K), repeat=T):
        steps = sum(transitions[i, j] for i, j in itertools.pairwise(path))
        yield path, start[path[0]] + steps + densities[np.arange(T), path].sum()


def every_segmentation(start, transitions, durations, densities, complete=True, steps=T):
    """All ways to fill the steps with segments; an incomplete last one may last beyond them."""

    def extend(states, lengths, score, t):
        if t == steps:
            yield states, lengths, score
            return
        for i in range(K):
            entry = start[i] if t == 0 else transitions[states[-1], i]
            for length in range(1, L + 1):
                if t + length > steps and complete:
                    continue
                shown = min(length, steps - t)
                gain = entry + durations[length - 1, i] + densities[t : t + shown, i].sum()
                yield from extend([*states, i], [*lengths, shown], score + gain, t + shown)

    yield from extend([], [], 0.0, 0)


def test_forward_and_backward_sum_over_every_path(chain):
    start, transitions, _, densities = chain
    posterior = np.zeros((T, K))
    for path, score in every_path(start, transitions, densities):
        posterior[np.arange(T), path] += np.exp(score)
    alpha = markov.forward(start, transitions, densities[:, None])
    beta = markov.backward(transitions, densities[:, None], np.array([T]))
    np.testing.assert_allclose(np.exp(alpha + beta)[:, 0], posterior, rtol=1e-12)


def test_viterbi_finds_the_best_of_every_path(chain):
    start, transitions, _, densities = chain
    best = max(every_path(start, transitions, densities), key=lambda item: item[1])[0]
    assert markov.viterbi(start, transitions, densities).tolist() == list(best)


def test_segments_sum_over_every_segmentation(chain):
    start, transitions, durations, densities = chain
    joint = np.zeros((T + 1, K))
    total = 0.0
    for states, lengths, score in every_segmentation(*chain):
        total += np.exp(score)
        joint[np.cumsum([0, *lengths[:-1]]), states] += np.exp(score)
    before = segments.forward_segments(start, transitions, durations, densities[:, None])
    after = segments.backward_segments(transitions, durations, densities[:, None], np.array([T]))
    np.testing.assert_allclose(np.exp(markov.log_sum(before.ends[-1, 0])), total, rtol=1e-12)
    np.testing.assert_allclose(np.exp(before.starts + after.starts)[:-1, 0], joint[:-1], rtol=1e-12)


def test_occupancy_is_the_probability_of_being_in_a_state(chain):
    start, transitions, durations, densities = chain
    before = segments.forward_segments(start, transitions, durations, densities[:, None])
    survival = markov.log(np.exp(durations)[::-1].cumsum(0)[::-1])
    inside = np.exp(segments.occupancy(before, survival))[:, 0]
    for t in range(T):
        expected = np.zeros(K)
        for states, _, score in every_segmentation(*chain, complete=False, steps=t + 1):
            expected[states[-1]] += np.exp(score)
        np.testing.assert_allclose(inside[t], expected, rtol=1e-12)


def test_viterbi_over_segments_finds_the_best_of_every_segmentation(chain):
    best = max(every_segmentation(*chain), key=lambda item: item[2])
    states, lengths = segments.viterbi_segments(*chain)
    assert states.tolist() == best[0]
    assert lengths.tolist() == best[1]


def test_long_sequences_do_not_underflow():
    rng = np.random.default_rng(1)
    densities = rng.normal(-500.0, 50.0, size=(3000, K))
    start, transitions = markov.log(np.full(K, 1 / K)), markov.log(np.full((K, K), 1 / K))
    alpha = markov.forward(start, transitions, densities[:, None])[:, 0]
    assert np.isfinite(alpha).all()
    # States drawn anew at every step: the sequence factorises.
    expected = markov.log_sum(densities - np.log(K), axis=1).sum()
    np.testing.assert_allclose(markov.log_sum(alpha[-1]), expected, rtol=1e-12)


def test_sequences_of_unequal_length_do_not_know_each_other(chain):
    start, transitions, durations, densities = chain
    short = [densities, densities[:4] + 1.0, densities[:1]]
    p = np.exp(durations)
    mean = (np.arange(1, L + 1) @ p)[:, None]
    semi = SemiMarkovChain(np.exp(start), np.exp(transitions), Gaussian(mean, np.ones((K, 1, 1))))
    for one in (MarkovChain(np.exp(start), np.exp(transitions)), semi):
        together, alone = one.expectation(short), [one.expectation([x]) for x in short]
        likelihoods = [x.log_likelihood[0] for x in alone]
        np.testing.assert_allclose(together.log_likelihood, likelihoods, rtol=1e-12)
        for h, x in zip(together.responsibilities, alone, strict=True):
            np.testing.assert_allclose(h, x.responsibilities[0], atol=1e-12)
        np.testing.assert_allclose(together.transitions, sum(x.transitions for x in alone))
        if together.stays is not None:
            np.testing.assert_allclose(together.stays, sum(x.stays for x in alone))
