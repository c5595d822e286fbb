"""Progress without a clock: brute force over all paces and paths, held, pushed on, two ways."""

from itertools import pairwise, product

import numpy as np
import pytest

from tpsim import Gaussian, SemiMarkovChain
from tpsim.errors import ArgumentError
from tpsim.retrieval.passage import Passage
from tpsim.retrieval.progress import Pace, ProgressFilter

CLOCK = Pace((0.0, 1.0))


def chain_of(transitions, means, variance=0.6, initial=None):
    K = len(means)
    durations = Gaussian(np.array(means, float)[:, None], np.full((K, 1, 1), variance))
    return SemiMarkovChain(np.eye(K)[0] if initial is None else initial, transitions, durations)


def paths(chain, ticks):
    """All states at ticks 0 ... with the ages that they have there, and their probabilities."""
    longest = chain.longest
    steps = np.arange(1, longest + 1)
    mean, variance = chain.durations.mean[:, 0], chain.durations.covariance[:, 0, 0]
    lasts = np.exp(-0.5 * (steps[:, None] - mean) ** 2 / variance)
    lasts /= lasts.sum(0)

    def grow(states, ages, probability, state):
        open_ended = not chain.transitions[state].any()
        left = ticks + 1 - len(states)
        at_least = 1.0 if open_ended else lasts[left - 1 :, state].sum()
        yield states + [state] * left, ages + list(range(left)), probability * at_least
        for stay in [] if open_ended else range(1, min(left, longest + 1)):
            for following in np.flatnonzero(chain.transitions[state]):
                chance = lasts[stay - 1, state] * chain.transitions[state, following]
                so_far = states + [state] * stay, ages + list(range(stay))
                yield from grow(*so_far, probability * chance, following)

    for state in np.flatnonzero(chain.initial):
        yield from grow([], [], chain.initial[state], state)


def brute_force(chain, pace, densities):
    """P(pace, state, age | all) and the log-likelihood, by enumeration of everything hidden."""
    T, V = len(densities), len(pace.likely)
    found = np.zeros((V, len(chain.initial), chain.longest))
    for paces in product(range(V), repeat=T):
        chance = pace.likely[paces[0]]
        for before, after in pairwise(paces):
            chance *= pace.transitions[before, after]
        at = np.cumsum((0, *paces[1:]))
        if chance == 0:
            continue
        for states, ages, probability in paths(chain, at[-1]):
            seen = sum(
                densities[t][paces[t], states[tick], min(ages[tick], chain.longest - 1)]
                for t, tick in enumerate(at)
            )
            last = paces[-1], states[at[-1]], min(ages[at[-1]], chain.longest - 1)
            found[last] += chance * probability * np.exp(seen)
    return found / found.sum(), np.log(found.sum())


CHAINS = {
    "one after the other": chain_of(np.eye(3, k=1), [1.5, 2.0, 1.0], 0.3),
    "a loop with two ways": chain_of([[0, 0.7, 0.3], [1, 0, 0], [0.5, 0.5, 0]], [2, 1, 1.5], 0.3),
    "anywhere": chain_of(1 - np.eye(2) + 0.0, [2.0, 1.2], 0.2, np.array([0.4, 0.6])),
}


@pytest.mark.parametrize("name", CHAINS)
@pytest.mark.parametrize("pace", [Pace((0.2, 0.5, 0.3), 0.6), CLOCK])
def test_the_recursion_is_the_sum_over_all_paces_and_paths(name, pace):
    chain, rng = CHAINS[name], np.random.default_rng(0)
    shape = len(pace.likely), len(chain.initial), chain.longest
    densities = rng.normal(size=(5, *shape))
    progress = ProgressFilter(chain, pace)
    belief = progress.start(densities[0])
    for t in range(1, 5):
        belief = progress.update(belief, densities[t])
    probability, log_likelihood = brute_force(chain, pace, densities)
    np.testing.assert_allclose(belief.probability, probability, atol=1e-12)
    assert belief.log_likelihood == pytest.approx(log_likelihood, abs=1e-10)


@pytest.mark.parametrize("name", CHAINS)
def test_one_tick_a_step_is_the_forward_variable(name):
    chain, densities = CHAINS[name], np.random.default_rng(1).normal(size=(12, 3))
    densities = densities[:, : len(chain.initial)]
    progress = ProgressFilter(chain, CLOCK)
    belief = progress.start(densities[0])
    found = [belief.states]
    for density in densities[1:]:
        belief = progress.update(belief, density)
        found.append(belief.states)
    np.testing.assert_allclose(found, chain.filtered(densities), atol=1e-12)


DT = 0.03
PLACES = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 90))  # from rest to rest, 0.6 m/s at most
LINE = SemiMarkovChain.along(np.repeat(np.arange(6), 15))


def follow(positions, pace, deviation):
    """Expected places, and paces, along positions [m] that are seen every DT."""
    way = Gaussian(PLACES[:, None], np.full((90, 1, 1), deviation**2))
    passage, progress = Passage(LINE, way, DT, 0.1), ProgressFilter(LINE, pace)
    belief, found = None, []
    for x, v in zip(positions, np.gradient(positions, DT), strict=True):
        density = passage.log_densities(np.array([x]), np.array([v]), len(pace.likely))
        belief = progress.update(belief, density) if belief else progress.start(density)
        found.append((passage.place(belief), belief.pace))
    return np.array(found).T


def at(ticks):
    return np.interp(ticks, np.arange(90), PLACES)


def test_who_is_held_makes_no_progress_while_the_durations_overtake_a_clock():
    """Vague observations, as where the hand may stray by 20 cm: the durations decide."""
    held = at(np.concatenate([np.arange(40), np.full(170, 40)]))
    place, pace = follow(held, Pace(), 0.2)
    assert np.abs(place[50:] - 40).max() < 4
    assert pace[60:].max() < 0.05
    ahead, _ = follow(held, CLOCK, 0.2)
    assert ahead[-1] > 65


def test_who_is_pushed_on_gets_ahead_and_who_is_let_go_goes_on_without_a_jump():
    ticks = np.concatenate([np.arange(20), np.full(60, 20), 20 + 2 * np.arange(1, 35)])
    place, pace = follow(at(ticks), Pace(), 0.03)
    np.testing.assert_allclose(place, ticks, atol=3)
    np.testing.assert_allclose(pace[90:105], 2, atol=0.1)
    assert np.abs(np.diff(place)).max() < 4


def test_places_are_passed_in_the_mean_time_of_a_clock():
    place, pace = follow(PLACES, CLOCK, 0.03)
    np.testing.assert_allclose(place, np.arange(90), atol=2)
    np.testing.assert_allclose(pace, 1, rtol=1e-12)


def test_of_two_ways_the_one_that_is_seen_is_followed():
    """Fig. 8: a fork after the first state, 1 or 2, which meet again in 3."""
    fork = chain_of(
        [[0, 0.5, 0.5, 0], [0, 0, 0, 1], [0, 0, 0, 1], [0, 0, 0, 0]], [4.0, 5.0, 5.0, 4.0]
    )
    progress = ProgressFilter(fork)
    belief = progress.start(np.log([0.9, 0.05, 0.05, 0.05]))
    assert (progress.states_ahead(belief, 12)[:10] == [0] * 4 + [1] * 5 + [3]).all()
    drawn = [progress.states_ahead(belief, 8, rng)[-1] for rng in range(200)]
    assert 0.35 < np.mean(np.array(drawn) == 2) < 0.65
    for _ in range(5):
        belief = progress.update(belief, np.log([0.2, 0.1, 0.9, 0.1]))
    assert belief.states.argmax() == 2
    ahead = progress.states_ahead(belief, 12)
    assert set(ahead) == {2, 3} and ahead[-1] == 3


def test_a_loop_goes_round_for_ever():
    loop = chain_of(np.roll(np.eye(3), 1, axis=1), [4.0, 3.0, 5.0], 0.1)
    progress = ProgressFilter(loop)
    ahead = progress.states_ahead(progress.start(np.zeros(3)), 36)
    np.testing.assert_array_equal(ahead, np.tile([0] * 4 + [1] * 3 + [2] * 5, 3))


def test_stays_of_a_sequence_are_a_chain():
    chain = SemiMarkovChain.along(np.array([4, 4, 4, 0, 0, 4]), spread=0.0)
    np.testing.assert_array_equal(chain.durations.mean[:, 0], [3, 2, 1])
    np.testing.assert_array_equal(chain.transitions, np.eye(3, k=1))
    progress = ProgressFilter(chain)
    belief = progress.foreseen(progress.start(np.zeros(3)))
    assert belief.states.sum() == pytest.approx(1)


def test_bad_input_is_said_in_one_line():
    with pytest.raises(ArgumentError, match="visit no state"):
        SemiMarkovChain.along(np.array([], int))
    with pytest.raises(ArgumentError, match="likely"):
        Pace((0.5, 0.6))
    progress = ProgressFilter(LINE)
    with pytest.raises(ArgumentError, match="places have means"):
        Passage(LINE, Gaussian(np.zeros((3, 1)), np.ones((3, 1, 1))), DT, 0.1)
    with pytest.raises(ArgumentError, match="log_densities have shape"):
        progress.start(np.zeros(4))
    with pytest.raises(ArgumentError, match="chain"):
        ProgressFilter(np.eye(3))
