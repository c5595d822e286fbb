import numpy as np
import pytest

from tpsim.section8.statistics import bootstrap, ranks, ratio_to_best


def test_interval_is_that_of_the_mean():
    values = np.random.default_rng(0).normal(3.0, 1.0, size=(1, 400))
    estimate = bootstrap(values)
    assert estimate.mean[0] == pytest.approx(values.mean())
    half = 1.96 * values.std() / 20
    assert estimate.low[0] == pytest.approx(values.mean() - half, abs=0.02)
    assert estimate.high[0] == pytest.approx(values.mean() + half, abs=0.02)


def test_pairing_removes_what_situations_share():
    """One method always 10 % worse than another is so for certain, however much both vary."""
    easy = np.random.default_rng(1).lognormal(0, 1, 60)
    best, ratios = ratio_to_best(np.array([1.1 * easy, easy]))
    assert best == 1
    np.testing.assert_allclose([ratios.low[0], ratios.mean[0], ratios.high[0]], 1.1)


def test_failures_have_no_mean_and_the_last_rank():
    values = np.array([[1.0, 4.0], [2.0, 3.0], [np.nan, np.nan]])
    estimate = bootstrap(values)
    assert np.isnan([estimate.mean[2], estimate.low[2], estimate.high[2]]).all()
    rank, wins = ranks(values)
    np.testing.assert_allclose(rank, [1.5, 1.5, 3.0])
    np.testing.assert_allclose(wins, [0.5, 0.5, 0.0])
    best, ratios = ratio_to_best(values)
    assert best in (0, 1)
    assert np.isnan(ratios.mean[2])


def test_ties_share_ranks_and_wins():
    rank, wins = ranks(np.array([[1.0], [1.0], [2.0]]))
    np.testing.assert_allclose(rank, [1.5, 1.5, 3])
    np.testing.assert_allclose(wins, [0.5, 0.5, 0])


def test_median_ignores_one_outlier():
    values = np.array([[1.0, 2.0, 3.0, 4.0, 1e9]])
    assert bootstrap(values, median=True).mean[0] == 3


def test_when_all_fail_there_is_no_best():
    best, ratios = ratio_to_best(np.full((2, 3), np.nan))
    assert best is None
    assert np.isnan(ratios.mean).all()
