"""Mixtures, task-parameterized ones and hidden states on manifolds."""

import numpy as np
import pytest

from tpsim import (
    ArgumentError,
    Demonstration,
    Frame,
    dtw,
    fit_gmm,
    fit_hmm,
    fit_hsmm,
    fit_tp_gmm,
    gaussian_product,
    load,
    rotation,
)
from tpsim.bench.poses import POSES, movements, situation
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import S1, S2, S3, R

POSE = R(3) * S3


@pytest.fixture(scope="module")
def views():
    """Three frames see poses over time, (400, 8) each."""
    return [view[::5] for view in movements(np.random.default_rng(0))]


@pytest.fixture(scope="module")
def model(views):
    return fit_tp_gmm(views, 4, manifold=POSES, start="time")


def clusters(manifold, means, spread=0.15, count=150, seed=0):
    rng = np.random.default_rng(seed)
    means = manifold.points("means", means)
    parts = [manifold.exp(m, spread * rng.normal(size=(count, manifold.dim))) for m in means]
    return np.concatenate(parts)


def test_on_r_n_it_is_the_fit_of_r_n(views):
    flat = [view[:, :4] for view in views]
    for options in (
        {"start": "time"},
        {"start": "kmeans"},
        {"covariance": "diagonal"},
        {"ridge": 1e-3},
    ):
        plain = fit_tp_gmm(flat, 3, tolerance=1e-9, max_iterations=300, **options)
        found = fit_tp_gmm(
            flat, 3, tolerance=1e-9, max_iterations=300, manifold=R(1, "inputs") * R(3), **options
        )
        assert found.history[-1] == pytest.approx(plain.history[-1], abs=1e-6)
        for ours, expected in zip(found.frames, plain.frames, strict=True):
            np.testing.assert_allclose(ours.mean, expected.mean, atol=1e-3)
            np.testing.assert_allclose(ours.covariance, expected.covariance, atol=1e-4)


@pytest.mark.parametrize("start", ["time", "kmeans", None])
def test_the_likelihood_never_falls_and_is_that_of_the_model(views, start):
    found = fit_tp_gmm(views, 4, manifold=POSES, start=start)
    assert (np.diff(found.history) >= 0).all()
    assert found.log_likelihood(views).mean() == pytest.approx(found.history[-1], abs=1e-9)


def test_no_mean_nearby_is_likelier(model, views):
    """Where EM ends, moving a mean by a hundredth of its spread gains nothing that matters."""
    best = model.log_likelihood(views).mean()
    for k in range(4):
        root = np.linalg.cholesky(model.frames[1].covariance[k])
        for step in 0.02 * root.T[[0, 4, 6]]:
            mean = model.frames[1].mean.copy()
            mean[k] = POSES.exp(mean[k], step)
            frames = list(model.frames)
            frames[1] = RiemannianGaussian(POSES, mean, frames[1].covariance)
            moved = type(model)(model.priors, frames).log_likelihood(views).mean()
            assert moved < best + 1e-4


@pytest.mark.parametrize(
    ("manifold", "means"),
    [
        (S1, [[0.0], [2.0], [-2.2]]),
        (S2, [[1.0, 0, 0], [-1.0, 0.1, 0], [0, 0, 1.0]]),
        (S3, [[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, 0.7, 0.7]]),
        (S1 * S3, [[3.1, 1.0, 0, 0, 0], [0.0, 0, 1.0, 0, 0], [1.5, 0, 0, 0.7, 0.7]]),
    ],
    ids=str,
)
def test_clusters_all_the_way_round_are_found(manifold, means):
    x = clusters(manifold, means)
    signs = np.random.default_rng(1).choice([-1.0, 1.0], (len(x), 1))
    if manifold is S3:
        x = signs * x
    found = fit_gmm(x, 3, manifold=manifold, rng=0)
    means = manifold.points("means", means)
    apart = manifold.distance(found.gaussians.mean[:, None], means)
    assert (apart.min(0) < 0.06).all() and sorted(apart.argmin(0)) == [0, 1, 2]
    np.testing.assert_allclose(found.priors, 1 / 3, atol=0.03)
    spreads = np.diagonal(found.gaussians.covariance, axis1=-2, axis2=-1)
    np.testing.assert_allclose(np.sqrt(spreads), 0.15, atol=0.03)
    assert (found.responsibilities(x).argmax(1).reshape(3, -1).std(1) == 0).all()


def test_a_turned_base_and_other_signs_give_the_same_model_turned():
    x = clusters(POSE, [[0, 0, 0, 1.0, 0, 0, 0], [1, 0, 0, 0.7, 0.7, 0, 0]], 0.3)
    turn = POSE.frame(Frame(rotation.exp([1.0, 2.0, -1.5]), [0.5, -1.0, 2.0]))
    signs = np.random.default_rng(1).choice([-1.0, 1.0], (len(x), 1))
    other = turn.to_common(x) * np.hstack([np.ones((len(x), 3)), np.repeat(signs, 4, 1)])
    options = {"manifold": POSE, "start": "time", "tolerance": 1e-10, "max_iterations": 500}
    one, two = fit_gmm(x, 2, **options), fit_gmm(other, 2, **options)
    moved = one.gaussians.affine(turn.A, turn.b)
    np.testing.assert_allclose(POSE.distance(moved.mean, two.gaussians.mean), 0, atol=1e-4)
    np.testing.assert_allclose(moved.covariance, two.gaussians.covariance, atol=1e-4)


def test_structures_are_fitted_in_the_tangent_spaces(views):
    found = fit_tp_gmm(views, 3, manifold=POSES, covariance="spherical", start="time")
    covariance = found.frames[0].covariance
    np.testing.assert_allclose(covariance, covariance[:, :1, :1] * np.eye(7), atol=1e-9)
    assert found.free_parameters == 3 * (3 * (7 + 1) + 1) - 1


def test_adaptation_is_the_product_of_the_moved_gaussians(model):
    frames = situation(np.random.default_rng(9))
    found = model.adapt(frames)
    lifted = [POSES.frame(frame) for frame in frames]
    for given in (frames, lifted):
        again = model.adapt(given)
        np.testing.assert_allclose(again.gaussians.mean, found.gaussians.mean, atol=1e-12)
    moved = [g.affine(f.A, f.b) for g, f in zip(model.frames, lifted, strict=True)]
    expected = gaussian_product(moved)
    assert POSES.distance(found.gaussians.mean, expected.mean).max() < 2e-4
    some = model.adapt([frames[0], None, None])
    np.testing.assert_allclose(POSES.distance(some.gaussians.mean, moved[0].mean), 0, atol=1e-7)
    np.testing.assert_allclose(
        some.gaussians.covariance, moved[0].covariance, rtol=1e-6, atol=1e-12
    )


def test_frames_that_move_are_adapted_to_at_every_step(model):
    one, other = (situation(np.random.default_rng(s)) for s in (3, 4))
    moving = [
        Frame(np.stack([a.A, b.A]), np.stack([a.b, b.b])) for a, b in zip(one, other, strict=True)
    ]
    found = model.adapt(moving)
    assert found.gaussians.mean.shape == (2, 4, 8)
    for t, frames in enumerate((one, other)):
        alone = model.adapt(frames).gaussians
        assert POSES.distance(found[t].gaussians.mean, alone.mean).max() < 2e-4


def test_adaptation_on_r_n_is_that_of_r_n(views):
    flat = [view[:, 1:4] for view in views]
    plain, found = (
        fit_tp_gmm(flat, 3, start="time"),
        fit_tp_gmm(flat, 3, start="time", manifold=R(3)),
    )
    frames = situation(np.random.default_rng(1))
    same = type(found)(
        plain.priors, [RiemannianGaussian(R(3), g.mean, g.covariance) for g in plain.frames]
    )
    for options in ({}, {"ridge": 1e-2}):
        ours, expected = same.adapt(frames, **options), plain.adapt(frames, **options)
        np.testing.assert_allclose(ours.gaussians.mean, expected.gaussians.mean, atol=1e-11)
        np.testing.assert_allclose(
            ours.gaussians.covariance, expected.gaussians.covariance, atol=1e-11
        )


def test_models_come_back_from_files(model, tmp_path):
    back = load(model.save(tmp_path / "model.npz"))
    frames = situation(np.random.default_rng(2))
    np.testing.assert_array_equal(
        back.adapt(frames).gaussians.mean, model.adapt(frames).gaussians.mean
    )


def test_demonstrations_hold_what_frames_of_columns_see():
    rng = np.random.default_rng(0)
    taught = []
    for _ in range(3):
        frames = [POSE.frame(frame) for frame in situation(rng)]
        data = clusters(POSE, [[0, 0, 0, 1.0, 0, 0, 0], [1, 0, 0, 0.9, 0.3, 0, 0]], 0.05, 20)
        taught.append(Demonstration(np.linspace(0, 1, 40), data, frames))
    found = fit_tp_gmm(taught, 2, manifold=POSE)
    back = found.adapt(taught[-1].frames).responsibilities(taught[-1].data)
    assert (back.argmax(1).reshape(2, -1).std(1) == 0).all()


@pytest.mark.parametrize("fit", [fit_hmm, fit_hsmm])
def test_hidden_states_follow_each_other_round_the_circle(fit):
    rng = np.random.default_rng(0)
    sequences = []
    for _ in range(4):
        stays = np.repeat([0.0, 1.5, 3.0, 4.5], rng.integers(12, 18, 4))
        turn = np.column_stack([np.cos(stays / 2), 0 * stays, 0 * stays, np.sin(stays / 2)])
        noise = 0.05 * rng.normal(size=(len(stays), 3))
        sequences.append(S3.exp(turn, noise) * rng.choice([-1.0, 1.0], (len(stays), 1)))
    found = fit(sequences, 4, manifold=S3)
    assert (np.diff(found.history) > -1e-9).all()
    angle = 2 * np.arctan2(found.gaussians.mean[:, 3], found.gaussians.mean[:, 0])
    np.testing.assert_allclose(
        S1.log(np.array([0.0, 1.5, 3, 4.5])[:, None], angle[:, None]), 0, atol=0.05
    )
    states = found.viterbi(sequences[0])
    assert (np.diff(states) >= 0).all() and set(states) == {0, 1, 2, 3}


def test_hidden_states_on_r_n_are_those_of_r_n(views):
    sequences = np.split(views[0][:, 1:4], 10)
    plain, found = (
        fit_hsmm(sequences, 3, start="time"),
        fit_hsmm(sequences, 3, start="time", manifold=R(3)),
    )
    np.testing.assert_allclose(found.gaussians.mean, plain.gaussians.mean, atol=2e-3)
    assert found.history[-1] == pytest.approx(plain.history[-1], abs=1e-3)


def test_dtw_measures_shortest_ways():
    rng = np.random.default_rng(0)
    x, y = (clusters(POSE, [[0, 0, 0, 1.0, 0, 0, 0]], 0.4, n, n) for n in (9, 12))
    warp = dtw(x, y, manifold=POSE)
    i, j = warp.path.T
    assert warp.cost == pytest.approx(POSE.distance(x[i], y[j]).sum())
    flipped = y * np.hstack([np.ones((12, 3)), np.repeat(rng.choice([-1.0, 1], (12, 1)), 4, 1)])
    np.testing.assert_array_equal(dtw(x, flipped, manifold=POSE).path, warp.path)
    np.testing.assert_array_equal(
        dtw(x[:, :3], y[:, :3], manifold=R(3)).path, dtw(x[:, :3], y[:, :3]).path
    )


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda v: fit_tp_gmm(v, 2, manifold=S3), "S3 has 4 columns"),
        (
            lambda v: fit_tp_gmm(v, 2, manifold=[POSES, POSES]),
            "2 manifolds were given for 3 frames",
        ),
        (lambda v: fit_tp_gmm(v, 2, manifold="S3"), "manifold"),
        (
            lambda v: fit_tp_gmm([np.tile(v[0][:1], (9, 1))], 2, manifold=POSES),
            "only 1 samples differ",
        ),
        (lambda v: fit_tp_gmm([v[0] * ([1.0] * 4 + [0.0] * 4)], 2, manifold=POSES), "zero length"),
        (lambda v: dtw(v[0], v[1], manifold=POSE), "7 columns"),
    ],
)
def test_what_does_not_fit_is_one_clear_line(views, call, words):
    with pytest.raises(ArgumentError) as error:
        call(views)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_adaptation_says_what_frames_it_asks_for(model):
    frames = situation(np.random.default_rng(0))
    for given, words in (
        (frames[:2], "2 frames were given; the model has 3"),
        ([None] * 3, "at least one frame"),
        ([Frame(2 * np.eye(3), np.zeros(3))] * 3, "no rotation"),
        ([frames[0], frames[1], Frame(np.eye(2), np.zeros(2))], "different shapes"),
    ):
        with pytest.raises(ArgumentError, match=words):
            model.adapt(given)


def test_a_model_may_be_the_start_of_another(model, views):
    again = fit_tp_gmm(views, 4, manifold=POSES, start=model)
    assert again.history[0] == pytest.approx(model.history[-1], abs=1e-9)
    assert S2.dim == 2 and len(again.history) <= 4
