"""HMM and HSMM: likelihood, the reference's figures and its faults, frames, hostile input."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tpsim import Demonstration, Frame, Gaussian
from tpsim.errors import ArgumentError
from tpsim.learning.gmm import GMM
from tpsim.learning.hmm import HMM, fit_hmm
from tpsim.learning.hsmm import HSMM, fit_hsmm
from tpsim.learning.markov import MarkovChain, log
from tpsim.learning.segments import forward_segments
from tpsim.learning.semi_markov import SemiMarkovChain

FIGURES = np.load(Path(__file__).parents[1] / "reference" / "traj_hsmm.npz")
FITS = [fit_hmm, fit_hsmm]


@pytest.fixture(scope="module")
def reference_hmm():
    """The reference's fit: its start, its ridge, its number of iterations."""
    start = GMM(np.full(4, 0.25), Gaussian(FIGURES["start_mean"], FIGURES["start_covariance"]))
    count = len(FIGURES["log_likelihood"])
    options = {"ridge": FIGURES["ridge"], "tolerance": -np.inf, "max_iterations": count}
    return fit_hmm(FIGURES["sequences"], 4, start=start, **options)


@pytest.fixture
def reference_hsmm(reference_hmm):
    """Its states with the durations that the reference counted."""
    mean, variance = FIGURES["duration_mean"], FIGURES["duration_variance"]
    durations = Gaussian(mean[:, None], variance[:, None, None])
    chain = SemiMarkovChain(np.eye(4)[0], np.eye(4, k=1), durations)
    return HSMM(chain, reference_hmm.emissions)


def test_baum_welch_finds_the_references_parameters(reference_hmm):
    gaussians = reference_hmm.gaussians
    np.testing.assert_allclose(gaussians.mean, FIGURES["mean"], rtol=1e-8)
    np.testing.assert_allclose(gaussians.covariance, FIGURES["covariance"], rtol=1e-8, atol=1e-8)
    expected = FIGURES["log_likelihood"] / 100  # per sample
    np.testing.assert_allclose(reference_hmm.history[:-1], expected, rtol=1e-10)


def stays(states):
    """Lengths of the runs of equal states."""
    return np.diff(np.flatnonzero(np.diff(states, prepend=-1, append=-1)))


def test_reference_counts_the_first_stay_one_step_too_long(reference_hmm):
    ours = np.array([stays(reference_hmm.viterbi(x)) for x in FIGURES["sequences"]])
    faulty = ours.copy()
    faulty[0, 0] += 1
    np.testing.assert_array_equal(faulty.T, FIGURES["stays"])
    np.testing.assert_array_equal(ours.sum(1), 100)


def test_reference_takes_the_end_of_a_stay_for_being_in_it(reference_hsmm):
    chain = reference_hsmm.chain
    durations = chain.log_durations(int(FIGURES["longest"]))[0]
    transitions = log(chain.transitions + np.diag([0, 0, 0, 1]))  # the last follows itself
    found = forward_segments(log(chain.initial), transitions, durations, np.zeros((100, 1, 4)))
    ending = np.exp(found.ends[1:, 0])
    ending /= ending.sum(1, keepdims=True)
    np.testing.assert_allclose(ending, FIGURES["forward"], atol=1e-7)
    np.testing.assert_array_equal(ending.argmax(1), FIGURES["states"])
    # Which changes state half a stay late; ours changes where the mean stays end.
    ours = reference_hsmm.state_sequence(100)
    expected = np.cumsum(FIGURES["duration_mean"])[:-1]
    assert np.abs(np.flatnonzero(np.diff(ours)) + 1 - expected).max() <= 1
    late = np.flatnonzero(np.diff(FIGURES["states"])) + 1 - expected
    assert (late > 8).all()


def test_state_probabilities_agree_with_sampled_movements(reference_hsmm):
    rng = np.random.default_rng(0)
    drawn = np.array([reference_hsmm.sample_states(100, rng) for _ in range(2000)])
    frequency = (drawn[..., None] == np.arange(4)).mean(0)
    probability = reference_hsmm.state_probabilities(100)
    np.testing.assert_allclose(probability.sum(1), 1.0, rtol=1e-12)
    assert np.abs(frequency - probability).max() < 4 * 0.5 / np.sqrt(2000)
    assert (np.diff(drawn, axis=1) >= 0).all()


def test_last_state_is_never_left(reference_hsmm):
    np.testing.assert_array_equal(reference_hsmm.state_sequence(300)[120:], 3)
    np.testing.assert_allclose(reference_hsmm.state_probabilities(300)[-1], [0, 0, 0, 1], atol=1e-9)


def test_geometric_durations_are_a_markov_chain():
    """A semi-Markov chain whose stays all last one step is the Markov chain itself."""
    rng = np.random.default_rng(1)
    transitions = rng.dirichlet(np.ones(3), size=3)
    initial, densities = rng.dirichlet(np.ones(3)), rng.normal(size=(20, 3))
    one_step = Gaussian(np.full((3, 1), 1.0), np.full((3, 1, 1), 1e-4))
    semi = SemiMarkovChain(initial, transitions, one_step)
    chain = MarkovChain(initial, transitions)
    ours, theirs = semi.expectation([densities]), chain.expectation([densities])
    np.testing.assert_allclose(ours.log_likelihood, theirs.log_likelihood)
    np.testing.assert_allclose(*(x.responsibilities[0] for x in (ours, theirs)), atol=1e-12)
    np.testing.assert_allclose(ours.transitions, theirs.transitions, atol=1e-12)
    np.testing.assert_allclose(semi.filtered(densities), chain.filtered(densities), atol=1e-12)
    np.testing.assert_allclose(semi.probabilities(20), chain.probabilities(20), atol=1e-12)
    np.testing.assert_array_equal(semi.viterbi(densities), chain.viterbi(densities))


@pytest.fixture(scope="module")
def known():
    """Sequences of a known semi-Markov model that may jump between its three states."""
    rng = np.random.default_rng(2)
    means = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])
    transitions = np.array([[0, 0.7, 0.3], [0.5, 0, 0.5], [0.1, 0.9, 0]])
    durations = Gaussian(np.array([[8.0], [15.0], [25.0]]), np.full((3, 1, 1), 4.0))
    emissions = GMM(np.full(3, 1 / 3), Gaussian(means, np.stack([np.eye(2)] * 3)))
    model = HSMM(SemiMarkovChain(np.eye(3)[0], transitions, durations), emissions)
    states = [model.sample_states(200, rng) for _ in range(6)]
    states = [s[: np.flatnonzero(np.diff(s))[-1] + 1] for s in states]  # whole stays
    return model, states, [emissions.gaussians[s].sample(rng) for s in states]


def test_hsmm_recovers_the_durations_and_transitions_of_a_known_model(known):
    truth, states, sequences = known
    start = replace(truth.emissions, gaussians=truth.gaussians)
    model = fit_hsmm(sequences, 3, topology="any", start=start)
    np.testing.assert_allclose(model.gaussians.mean, truth.gaussians.mean, atol=0.2)
    mean = model.chain.durations.mean[:, 0]
    np.testing.assert_allclose(mean, [8, 15, 25], atol=1.5)
    np.testing.assert_allclose(model.chain.transitions, truth.chain.transitions, atol=0.25)
    found = np.concatenate([model.viterbi(x) for x in sequences])
    assert (found == np.concatenate(states)).mean() > 0.98


@pytest.mark.parametrize("fit", FITS)
@pytest.mark.parametrize("topology", ["left-right", "any"])
@pytest.mark.parametrize("components", [1, 2, 5])
def test_likelihood_never_falls(fit, topology, components, known):
    sequences = [x[: 60 + 20 * i] for i, x in enumerate(known[2][:4])]
    model = fit(sequences, components, topology=topology, tolerance=-np.inf, max_iterations=12)
    assert np.diff(model.history).min() > -1e-9
    total = sum(model.log_likelihood(x) for x in sequences)
    assert np.isclose(model.history[-1], total / sum(map(len, sequences)))
    np.testing.assert_allclose(model.chain.initial.sum(), 1.0)


@pytest.mark.parametrize("fit", FITS)
def test_forward_needs_no_future(fit, known):
    x = known[2][0][:80]
    model = fit([x, known[2][1]], 3, topology="any")
    np.testing.assert_allclose(model.forward(x)[:40], model.forward(x[:40]), atol=1e-9)
    np.testing.assert_allclose(model.responsibilities(x).sum(1), 1.0)


@pytest.mark.parametrize("fit", FITS)
def test_states_learned_in_frames_adapt_to_new_frames(fit):
    rng = np.random.default_rng(3)
    demonstrations = []
    for _ in range(8):
        start, goal = rng.normal(size=2), np.array([5.0, 0.0]) + rng.normal(size=2)
        s = np.linspace(0, 1, int(rng.integers(40, 60)))[:, None]
        data = start + (goal - start) * (3 * s**2 - 2 * s**3) + 0.1 * rng.normal(size=(len(s), 2))
        frames = [Frame(np.eye(2), start), Frame(np.eye(2), goal)]
        demonstrations.append(Demonstration(np.linspace(0, 1, len(s)), data, frames))
    model = fit(demonstrations, 4)
    with pytest.raises(ArgumentError, match="adapt"):
        _ = model.gaussians
    start, goal = np.array([-1.0, 2.0]), np.array([6.0, -3.0])
    adapted = model.adapt([Frame(np.eye(2), start), Frame(np.eye(2), goal)])
    q = adapted.state_sequence(50)
    assert q[0] == 0
    assert q[-1] == 3
    np.testing.assert_allclose(adapted.gaussians.mean[q[0]], start, atol=1.0)
    np.testing.assert_allclose(adapted.gaussians.mean[q[-1]], goal, atol=1.0)
    views = demonstrations[0].observations
    np.testing.assert_array_equal(model.viterbi(views), model.viterbi(demonstrations[0]))


def test_demonstrations_without_frames_are_plain_data(known):
    demonstrations = [Demonstration(np.arange(float(len(x))), x) for x in known[2][:2]]
    from_demonstrations = fit_hsmm(demonstrations, 3)
    from_arrays = fit_hsmm(known[2][:2], 3)
    np.testing.assert_array_equal(from_demonstrations.history, from_arrays.history)


def test_sampled_states_repeat_with_the_seed(known):
    draws = [known[0].sample_states(50, np.random.default_rng(7)) for _ in range(2)]
    np.testing.assert_array_equal(*draws)


@pytest.mark.parametrize(
    "call",
    [
        lambda x: fit_hmm([], 2),
        lambda x: fit_hmm([x], 2, topology="round"),
        lambda x: fit_hsmm([x], 2, duration_spread=-1.0),
        lambda x: fit_hmm([x * np.nan], 2),
        lambda x: fit_hsmm([x, x[:0]], 2),
        lambda x: fit_hmm([x], 3, start=GMM([1.0], Gaussian(np.zeros((1, 2)), np.eye(2)))),
        lambda x: fit_hmm([x[0]], 2, start=GMM([1.0], Gaussian(np.zeros((1, 2)), np.eye(2)))),
        lambda x: fit_hmm([x], 1).state_sequence(0),
        lambda x: fit_hmm([x], 2).adapt([]),
        lambda x: MarkovChain([0.5, 0.6], np.eye(2)),
        lambda x: MarkovChain([1.0, 0.0], np.eye(2, k=1)),
        lambda x: MarkovChain([1.0, 0.0], np.eye(3)),
        lambda x: SemiMarkovChain([1.0], [[0.0]], Gaussian(np.zeros((1, 1)), np.ones((1, 1, 1)))),
        lambda x: SemiMarkovChain([1.0], [[0.5]], Gaussian(np.ones((1, 1)), np.ones((1, 1, 1)))),
        lambda x: SemiMarkovChain([1.0], [[0.0]], Gaussian(np.ones((2, 1)), np.ones((2, 1, 1)))),
        lambda x: HMM(MarkovChain([1.0], [[1.0]]), fit_hmm([x], 2).emissions),
    ],
)
def test_bad_arguments_are_refused(call):
    with pytest.raises(ArgumentError):
        call(np.random.default_rng(0).normal(size=(30, 2)))
