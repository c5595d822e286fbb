"""Regression on manifolds: against R^n, the conditional of one component, and far frames."""

import numpy as np
import pytest

from tpsim import (
    ArgumentError,
    Frame,
    Regression,
    fit_gmm,
    fit_tp_gmm,
    gmr,
    gmr_mixture,
    rotation,
    tp_gmr,
)
from tpsim.bench.poses import POSES, movements, situation
from tpsim.learning.gmm import GMM
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import S1, S2, S3, R

POSE = R(3) * S3
TIMES = np.linspace(0, 1, 61)


@pytest.fixture(scope="module")
def model():
    views = [view[::5] for view in movements(np.random.default_rng(0))]
    return fit_tp_gmm(views, 4, manifold=POSES, start="time")


def test_on_r_n_it_is_the_regression_of_r_n():
    rng = np.random.default_rng(0)
    x = np.column_stack([np.linspace(0, 1, 80), rng.normal(size=(80, 3)).cumsum(0) / 9])
    plain = fit_gmm(x, 3, start="time")
    same = GMM(
        plain.priors, RiemannianGaussian(R(4), plain.gaussians.mean, plain.gaussians.covariance)
    )
    for options in ({}, {"given": (0, 2)}, {"of": (3, 1)}, {"ridge": 0.1}):
        inputs = rng.normal(size=(7, len(options.get("given", (0,)))))
        ours, expected = gmr(same, inputs, **options), gmr(plain, inputs, **options)
        np.testing.assert_allclose(ours.mean, expected.mean, atol=1e-12)
        np.testing.assert_allclose(ours.covariance, expected.covariance, atol=1e-12)


def test_one_component_is_its_conditional():
    rng = np.random.default_rng(0)
    manifold = S1 * S2 * R(1) * S3
    root = 0.3 * rng.normal(size=(7, 7))
    g = RiemannianGaussian(manifold, rng.normal(size=9), root @ root.mT + 0.05 * np.eye(7))
    given = [5, 6, 7, 8]
    q = S3.exp(g.mean[5:], 0.4 * rng.normal(size=(6, 3)))
    found = gmr(GMM([1.0], g[None]), q, given=given)
    expected = g.condition(q, given)
    assert found.manifold == S1 * S2 * R(1)
    np.testing.assert_allclose(found.mean, expected.mean, atol=1e-12)
    np.testing.assert_allclose(found.covariance, expected.covariance, atol=1e-12)


def test_one_point_and_all_modes_are_those_of_the_batch(model):
    gmm = model.adapt(situation(np.random.default_rng(1)))
    path, regression = gmr(gmm, TIMES), Regression.of(gmm)
    for t in (0, 7, 60):
        one = regression.at([TIMES[t]])
        np.testing.assert_allclose(one.mean, path.mean[t], atol=1e-12)
        np.testing.assert_allclose(one.covariance, path.covariance[t], atol=1e-12)
    weights, modes = gmr_mixture(gmm, TIMES)
    np.testing.assert_allclose(weights.sum(1), 1)
    assert modes.mean.shape == (61, 4, 7)


@pytest.mark.parametrize("order", ["regression", "product"])
def test_turning_the_world_turns_the_movement(model, order):
    frames = situation(np.random.default_rng(1))
    turn, move = rotation.exp([2.0, 1.0, -2.0]), np.array([1.0, -2.0, 0.5])
    moved = [Frame(turn @ f.A, turn @ f.b + move) for f in frames]
    one, other = (tp_gmr(model, given, TIMES, order=order) for given in (frames, moved))
    expected = one.affine(*_map(turn, move))
    assert POSE.distance(expected.mean, other.mean).max() < 1e-3
    np.testing.assert_allclose(expected.covariance, other.covariance, atol=1e-4)


def _map(turn, move):
    frame = POSE.frame(Frame(turn, move))
    return frame.A, frame.b


def test_the_movement_ends_where_its_last_frame_says_up_to_179_degrees_away(model):
    """Docks turned against each other as never shown: the end is seen from the last frame."""
    home = situation(np.random.default_rng(1))
    local = tp_gmr(model, [None, None, home[2]], TIMES)
    for degrees in (60, 120, 179):
        spun = rotation.exp(np.radians(degrees) * np.array([0.6, 0.0, 0.8]))
        frames = [*home[:2], Frame(spun @ home[2].A, home[2].b)]
        path = tp_gmr(model, frames, TIMES)
        assert np.isfinite(path.covariance).all()
        R_end, p_end = frames[2].A @ home[2].A.T, frames[2].b
        expected_p = p_end + R_end @ (local.mean[-1, :3] - home[2].b)
        expected_q = POSE.frame(Frame(R_end, np.zeros(3))).to_common(local.mean[-1])
        precise = tp_gmr(model, [None, None, frames[2]], TIMES)
        np.testing.assert_allclose(precise.mean[-1, :3], expected_p, atol=1e-9)
        assert S3.distance(precise.mean[-1, 3:], expected_q[3:]) < 1e-6
        # Between two docks no step of the way jumps.
        path = tp_gmr(model, [home[0], None, frames[2]], TIMES)
        assert POSE.distance(path.mean[1:], path.mean[:-1]).max() < 0.6


def test_far_from_the_data_it_stays_finite(model):
    gmm = model.adapt(situation(np.random.default_rng(1)))
    found = gmr(gmm, [-50.0, 50.0])
    assert np.isfinite(found.covariance).all()
    np.testing.assert_allclose(np.linalg.norm(found.mean[:, 3:], axis=1), 1)


def test_what_does_not_fit_is_one_clear_line(model):
    gmm = model.adapt(situation(np.random.default_rng(1)))
    for call, words in (
        (lambda: gmr(gmm, TIMES, given=(4,)), "together or not at all"),
        (lambda: gmr(gmm, np.zeros((3, 2))), "8 columns|1 columns|has 1"),
        (lambda: gmr(gmm, TIMES, given=(0,), of=(0, 1)), "overlap"),
        (
            lambda: tp_gmr(model, situation(np.random.default_rng(1)), TIMES, order="held"),
            "order is",
        ),
        (lambda: tp_gmr(model, [None] * 3, TIMES), "at least one"),
    ):
        with pytest.raises(ArgumentError, match=words):
            call()
