"""Effective samples: known processes, invariances, limits, and what precision they support."""

import numpy as np
import pytest
from scipy.signal import lfilter

from tpsim import Demonstration, demonstrations_wanted, deviation_interval, effective_samples
from tpsim.errors import ArgumentError


def processes(a, count, steps, columns=1, seed=0):
    """Stationary autoregressive processes of first order."""
    noise = np.random.default_rng(seed).standard_normal((count, steps + 500, columns))
    return list(lfilter([1.0], [1.0, -a], noise, axis=1)[:, 500:])


@pytest.mark.parametrize("a", [0.0, 0.5, 0.9, 0.98])
@pytest.mark.parametrize("columns", [1, 3])
def test_an_autoregressive_process_has_the_known_number(a, columns):
    given, n = processes(a, 20, 5000, columns), 20 * 5000
    assert effective_samples(given) == pytest.approx(n * (1 - a) / (1 + a), rel=0.15)
    squared = n * (1 - a**2) / (1 + a**2)
    assert effective_samples(given, "covariance") == pytest.approx(squared, rel=0.15)


def test_the_mean_and_the_variance_have_the_errors_of_that_many_samples():
    """Over 400 sets of short sequences of known mean and variance, such as six demonstrations."""
    a, found, means, variances = 0.95, [], [], []
    for seed in range(400):
        given = processes(a, 6, 120, seed=seed)
        found.append([effective_samples(given), effective_samples(given, "covariance")])
        means.append(np.mean(given))
        variances.append(np.mean(np.square(given)) * (1 - a**2))
    of_mean, of_covariance = np.median(found, axis=0)
    assert of_mean == pytest.approx(1 / (1 - a**2) / np.var(means), rel=0.3)
    assert of_covariance == pytest.approx(2 / np.var(variances), rel=0.3)


def test_sequences_that_do_not_move_are_one_sample_each():
    still = [np.full((50 + 10 * i, 1), float(i**2)) for i in range(6)]
    expected = sum(map(len, still)) ** 2 / sum(len(x) ** 2 for x in still)
    assert effective_samples(still) == pytest.approx(expected, rel=1e-3)
    assert effective_samples([np.full(50, x) for x in (0.0, 1.0, 3.0)]) == pytest.approx(3)
    assert effective_samples(np.zeros((9, 2))) == 1


def test_units_rotations_and_dull_columns_change_nothing():
    given = processes(0.8, 5, 300, 3)
    mixed = np.random.default_rng(1).normal(size=(3, 3)) * [1, 1e3, 1e-3]
    number = effective_samples(given)
    assert effective_samples([4.0 + x @ mixed for x in given]) == pytest.approx(number)
    assert effective_samples([np.hstack([x, 0 * x[:, :1]]) for x in given]) == pytest.approx(number)


def test_alternating_noise_counts_no_more_than_its_samples_and_one_sample_as_one():
    assert effective_samples(processes(-0.9, 2, 1000)) == 2000
    assert effective_samples(np.ones((1, 4))) == 1
    given = processes(0.5, 1, 200)
    assert effective_samples(given[0][:, 0]) == effective_samples(given)
    demonstration = Demonstration(np.arange(200.0), given[0])
    assert effective_samples(demonstration) == effective_samples([demonstration])


def test_the_interval_of_a_deviation_covers_as_often_as_it_says():
    rng, low, high = np.random.default_rng(0), *deviation_interval(12.0, 0.9)
    deviations = rng.normal(size=(4000, 12)).std(1, ddof=1)
    assert np.mean((low * deviations < 1) & (high * deviations > 1)) == pytest.approx(0.9, abs=0.02)
    assert deviation_interval(1e6) == pytest.approx((1, 1), abs=0.01)


def test_more_demonstrations_are_wanted_where_each_says_little():
    many, few = (demonstrations_wanted(processes(a, 6, 200)) for a in (0.5, 0.999))
    assert many == 1
    assert few > 3
    still = [np.full(50, x) for x in (0.0, 1.0, 3.0)]
    wanted = demonstrations_wanted(still, within=1.5)
    assert deviation_interval(wanted)[1] <= 1.5 < deviation_interval(wanted - 1)[1]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([], "no demonstrations"),
        ([np.zeros((4, 2)), np.zeros((4, 3))], "the same number"),
        ([[0.0, np.nan]], r"demonstrations\[0\]"),
    ],
)
def test_what_cannot_be_counted_is_refused(given, words):
    with pytest.raises(ArgumentError, match=words):
        effective_samples(given)
    with pytest.raises(ArgumentError, match="'mean' or 'covariance'"):
        effective_samples(np.zeros((3, 1)), "variance")
    with pytest.raises(ArgumentError, match="above 1"):
        deviation_interval(1.0)
