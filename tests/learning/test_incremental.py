"""Learning on without the old data: within 1 % of the likelihood of a batch fit."""

import numpy as np
import pytest

from tpsim import MFA, TPGMM, Gaussian, fit_tp_gmm, update_tp_gmm
from tpsim.errors import ArgumentError
from tpsim.examples import u_demonstrations
from tpsim.learning.moments import Memory, Moments


@pytest.fixture(scope="module")
def demonstrations():
    return [d.with_time() for d in u_demonstrations(8)]


@pytest.mark.parametrize("covariance", ["full", "diagonal", MFA(1)])
@pytest.mark.parametrize("first", [1, 4])
def test_updates_come_within_one_percent_of_a_batch_fit(demonstrations, covariance, first):
    model = fit_tp_gmm(demonstrations[:first], 4, covariance=covariance)
    for n in range(first, 8, first):
        model = update_tp_gmm(model, demonstrations[n : n + first])
    batch = fit_tp_gmm(demonstrations, 4, covariance=covariance)
    target = batch.log_likelihood(demonstrations).mean()
    assert model.log_likelihood(demonstrations).mean() > target - 0.01 * max(1, abs(target))
    assert model.samples == batch.samples


def test_likelihood_never_falls_while_learning_on(demonstrations):
    model = update_tp_gmm(fit_tp_gmm(demonstrations[:2], 4), demonstrations[2:3])
    assert np.diff(model.history).min() > -1e-9


def test_one_component_is_updated_exactly(demonstrations):
    """For K = 1 the remembered moments lose nothing."""
    model = update_tp_gmm(fit_tp_gmm(demonstrations[:3], 1), demonstrations[3:])
    batch = fit_tp_gmm(demonstrations, 1)
    for one, other in zip(model.frames, batch.frames, strict=True):
        np.testing.assert_allclose(one.mean, other.mean, atol=1e-9)
        np.testing.assert_allclose(one.covariance, other.covariance, atol=1e-9)


def test_memory_stays_small_and_keeps_the_moments(demonstrations):
    long = [d.resampled(2000) for d in demonstrations[:6]]
    memory = update_tp_gmm(fit_tp_gmm(long[:3], 2), long[3:]).memory
    assert len(memory.time) <= 1024
    everything = memory.moments.pooled(np.zeros(len(memory.time), int), 1)
    seen = np.concatenate([d.observations[0] for d in long])
    assert np.isclose(everything.weight[0], len(seen))
    np.testing.assert_allclose(everything.mean[0][0, 0], seen.mean(0), atol=1e-9)
    np.testing.assert_allclose(everything.scatter[0][0, 0], np.cov(seen.T, ddof=0), atol=1e-9)


def test_pooling_is_associative():
    rng = np.random.default_rng(0)
    x = rng.normal(size=(1, 12, 3))
    single = Moments(np.ones(12), (x,), (np.zeros((1, 12, 3, 3)),))
    pairs = single.pooled(np.arange(12) // 2, 6)
    at_once, in_two = single.pooled(np.arange(12) // 6, 2), pairs.pooled(np.arange(6) // 3, 2)
    np.testing.assert_allclose(at_once.scatter[0], in_two.scatter[0])
    np.testing.assert_allclose(at_once.scatter[0][0, 0], np.cov(x[0, :6].T, ddof=0))
    assert len(Memory(single, np.arange(12.0)).within(5).time) <= 5


def test_less_retention_follows_the_new_data(demonstrations):
    model = fit_tp_gmm(demonstrations[:2], 1)
    new = demonstrations[2:3]
    seen = new[0].observations[1].mean(0)
    distances = [
        np.linalg.norm(update_tp_gmm(model, new, retention=r).frames[1].mean[0] - seen)
        for r in (1.0, 0.1, 0.001)
    ]
    assert distances[0] > distances[1] > distances[2]


def test_archived_models_learn_on(demonstrations, tmp_path):
    model = fit_tp_gmm(demonstrations[:2], 3)
    again = TPGMM.load(model.save(tmp_path / "model.npz"))
    one, other = (update_tp_gmm(m, demonstrations[2:]) for m in (model, again))
    np.testing.assert_array_equal(one.frames[0].covariance, other.frames[0].covariance)


def test_misuse_is_refused(demonstrations):
    model = fit_tp_gmm(demonstrations[:1], 2)
    bare = TPGMM([1.0], [Gaussian(np.zeros((1, 2)), np.eye(2))])
    with pytest.raises(ArgumentError, match="memory"):
        update_tp_gmm(bare, demonstrations)
    with pytest.raises(ArgumentError, match="dimensions"):
        update_tp_gmm(model, u_demonstrations(1))
    for retention in (0.0, -1.0, np.nan):
        with pytest.raises(ArgumentError, match="retention"):
            update_tp_gmm(model, demonstrations, retention=retention)
