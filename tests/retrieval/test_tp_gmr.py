"""Orders of regression and product over frames, and how a product pulls components in time."""

from typing import get_args

import numpy as np
import pytest

from tpsim import (
    GMM,
    TPGMM,
    Frame,
    Gaussian,
    fit_tp_gmm,
    fuse_frames,
    gaussian_product,
    gmr,
    gmr_mixture,
    tp_gmr,
)
from tpsim.errors import ArgumentError
from tpsim.examples import u_demonstrations, u_frames
from tpsim.retrieval.tp_gmr import Order

ORDERS = get_args(Order)
TIMES = np.linspace(0.0, 2.0, 30)


def a_model(K=3, D=2, P=2, seed=0):
    """TP-GMM over [t, x] whose frames share the time of every component, as EM makes them."""
    rng = np.random.default_rng(seed)
    time = np.linspace(0.2, 1.8, K)
    frames = []
    for _ in range(P):
        slope, spread = rng.normal(size=(K, D)), 0.05
        root = rng.normal(size=(K, D, D))
        covariance = np.zeros((K, 1 + D, 1 + D))
        covariance[:, 0, 0] = spread
        covariance[:, 0, 1:] = covariance[:, 1:, 0] = spread * slope
        covariance[:, 1:, 1:] = spread * slope[:, :, None] * slope[:, None]
        covariance[:, 1:, 1:] += 0.1 * root @ root.mT + 0.05 * np.eye(D)
        frames.append(Gaussian(np.column_stack([time, rng.normal(size=(K, D))]), covariance))
    return TPGMM(np.full(K, 1 / K), tuple(frames))


def two_frames(seed=1, far=1.0):
    rng = np.random.default_rng(seed)
    c, s = np.cos(0.7), np.sin(0.7)
    return [Frame(np.eye(2), np.zeros(2)), Frame([[c, -s], [s, c]], far * rng.normal(size=2))]


def test_two_frames_pull_a_component_in_time():
    """The closed form: a component moves to the time at which its frames agree."""
    sigma, slopes, residuals, places = 0.04, (1.5, -0.5), (0.02, 0.05), (0.3, -0.2)
    views = [
        Gaussian([[1.0, x]], [[[sigma, k * sigma], [k * sigma, k**2 * sigma + S]]])
        for k, S, x in zip(slopes, residuals, places, strict=True)
    ]
    model = TPGMM([1.0], views)
    for far in (0.0, 0.5, 2.0, 5.0):
        frames = [Frame(np.eye(1), [0.0]), Frame(np.eye(1), [far])]
        adapted = model.adapt([frame.with_input() for frame in frames]).gaussians[0]
        apart, turn = places[0] - places[1] - far, slopes[0] - slopes[1]
        precision = 2 / sigma + turn**2 / sum(residuals)
        pull = -turn * apart / sum(residuals) / precision
        np.testing.assert_allclose(adapted.mean[0], 1.0 + pull, rtol=1e-12)
        np.testing.assert_allclose(adapted.covariance[0, 0], 1 / precision, rtol=1e-12)
    assert pull > 5 * np.sqrt(sigma)  # by far more than the component lasts


def test_the_pull_is_the_density_of_the_disagreement():
    """Marginal in time of the product: N(t)^P times the density of what the frames disagree by."""
    model, frames = a_model(K=1), two_frames(far=3.0)
    adapted = model.adapt([f.with_input() for f in frames]).gaussians[0]
    marginal = adapted.marginal([0]).log_density(TIMES[:, None])
    local = [gmr(GMM(model.priors, view), TIMES) for view in model.frames]
    seen = [g.affine(f.A, f.b) for g, f in zip(local, frames, strict=True)]
    disagreement = Gaussian(seen[0].mean - seen[1].mean, seen[0].covariance + seen[1].covariance)
    each = [view[0].marginal([0]).log_density(TIMES[:, None]) for view in model.frames]
    expected = sum(each) + disagreement.log_density(np.zeros(2))
    np.testing.assert_allclose(np.diff(marginal), np.diff(expected), rtol=1e-8)


def test_one_component_has_one_answer():
    model, frames = a_model(K=1), two_frames(far=4.0)
    paths = [tp_gmr(model, frames, TIMES, order=order) for order in ORDERS]
    for path in paths[1:]:
        np.testing.assert_allclose(path.mean, paths[0].mean, atol=1e-9)
        np.testing.assert_allclose(path.covariance, paths[0].covariance, atol=1e-9)


def test_weights_stay_where_they_were_learned_unless_the_product_comes_first():
    model = a_model()
    learned = gmr_mixture(GMM(model.priors, model.frames[0]), TIMES)[0]
    near, far = (
        gmr_mixture(model.adapt([f.with_input() for f in two_frames(far=far)]), TIMES)[0]
        for far in (0.0, 6.0)
    )
    assert np.abs(near - far).max() > 0.5
    held = tp_gmr(model, two_frames(far=6.0), TIMES, order="held")
    products = [
        gaussian_product(
            [
                view[k].condition(TIMES[:, None], [0]).affine(f.A, f.b)
                for view, f in zip(model.frames, two_frames(far=6.0), strict=True)
            ]
        ).mean
        for k in range(3)
    ]
    mixed = np.einsum("tk,ktd->td", learned, products)
    np.testing.assert_allclose(held.mean, mixed, atol=1e-9)


def test_regression_is_the_product_of_the_regressions():
    model, frames = a_model(), two_frames()
    local = [gmr(GMM(model.priors, view), TIMES) for view in model.frames]
    ours = tp_gmr(model, frames, TIMES)
    np.testing.assert_allclose(ours.mean, fuse_frames(local, frames).mean)


def test_pooled_components_minimise_the_expected_cost():
    """The gradient of sum_i h_i (x - x_i)' Lambda_i (x - x_i), over all frames, is zero there."""
    model, frames = a_model(), two_frames(far=3.0)
    path = tp_gmr(model, frames, TIMES, order="pooled")
    gradient, curvature = np.zeros((len(TIMES), 2)), np.zeros((len(TIMES), 2, 2))
    for view, frame in zip(model.frames, frames, strict=True):
        weights, local = gmr_mixture(GMM(model.priors, view), TIMES)
        seen = local.affine(frame.A, frame.b)
        cost = weights[..., None, None] * seen.precision
        gradient += np.einsum("tkij,tkj->ti", cost, path.mean[:, None] - seen.mean)
        curvature += cost.sum(1)
    np.testing.assert_allclose(gradient, 0, atol=1e-9)
    np.testing.assert_allclose(path.precision, curvature, rtol=1e-9, atol=1e-9)


def test_a_vague_component_does_not_drown_a_precise_one_that_is_pooled():
    """Half way between two components: moments give half the vague variance, pooling twice the
    precise one."""
    times, variances = np.array([0.5, 1.5]), np.array([1e-4, 1.0])
    covariance = np.zeros((2, 2, 2))
    covariance[:, 0, 0], covariance[:, 1, 1] = 0.05, variances
    model = TPGMM([0.5, 0.5], [Gaussian(np.column_stack([times, [0.0, 0.0]]), covariance)])
    moments, pooled = (
        tp_gmr(model, [Frame(np.eye(1), [0.0])], [1.0], order=order).covariance[0, 0, 0]
        for order in ("regression", "pooled")
    )
    assert moments == pytest.approx(variances.mean(), rel=1e-9)
    assert pooled == pytest.approx(1 / np.mean(1 / variances), rel=1e-9)


def test_far_away_the_product_first_loses_the_goal():
    """On the tutorial's own task the last component is pulled away: the end is missed by metres."""
    demonstrations = [d.with_time() for d in u_demonstrations(4, 60, np.random.default_rng(3))]
    model = fit_tp_gmm(demonstrations, 6, start="time")
    learned = model.frames[0].marginal([0])
    rng, errors, pulls = np.random.default_rng(3), {order: [] for order in ORDERS}, []
    for _ in range(12):
        frames = u_frames(rng, 4.0)
        times = np.linspace(0.0, 2.0, 60)
        for order in ORDERS:
            end = tp_gmr(model, frames, times, order=order).mean[-1]
            errors[order].append(np.linalg.norm(end - frames[1].b))
        adapted = model.adapt([f.with_input() for f in frames]).gaussians.mean[:, 0]
        pulls.append(np.abs(adapted - learned.mean[:, 0]) / np.sqrt(learned.covariance[:, 0, 0]))
    assert np.max(pulls) > 3  # standard deviations in time
    assert max(errors["regression"]) < 0.03
    assert max(errors["held"]) < 0.03
    assert max(errors["pooled"]) < 0.03
    assert max(errors["product"]) > 1.0


@pytest.mark.parametrize("order", ORDERS)
def test_frames_may_be_lifted_missing_or_moving(order):
    model, frames = a_model(), two_frames()
    plain = tp_gmr(model, frames, TIMES, order=order)
    lifted = tp_gmr(model, [f.with_input() for f in frames], TIMES[:, None], order=order)
    np.testing.assert_array_equal(plain.mean, lifted.mean)
    moving = [
        Frame(np.tile(f.A, (len(TIMES), 1, 1)), np.tile(f.b, (len(TIMES), 1))) for f in frames
    ]
    still = tp_gmr(model, moving, TIMES, order=order)
    np.testing.assert_allclose(still.mean, plain.mean, atol=1e-10)
    alone = tp_gmr(model, [frames[0], None], TIMES, order=order)
    only = tp_gmr(TPGMM(model.priors, model.frames[:1]), frames[:1], TIMES, order=order)
    np.testing.assert_allclose(alone.mean, only.mean, atol=1e-9)
    if order != "pooled":
        known = gmr(GMM(model.priors, model.frames[0]), TIMES)
        np.testing.assert_allclose(alone.mean, known.mean, atol=1e-9)


def test_inputs_may_be_any_dimension():
    model, frames = a_model(), two_frames()
    turned = TPGMM(model.priors, [g.marginal([1, 2, 0]) for g in model.frames])
    for order in ORDERS:
        ours = tp_gmr(turned, frames, TIMES, given=(2,), order=order)
        np.testing.assert_allclose(
            ours.mean, tp_gmr(model, frames, TIMES, order=order).mean, atol=1e-9
        )


def test_ridge_is_added_once():
    model, frames = a_model(), two_frames()
    for order in ORDERS:
        plain = tp_gmr(model, frames, TIMES, order=order)
        more = tp_gmr(model, frames, TIMES, order=order, ridge=0.5)
        np.testing.assert_allclose(
            more.covariance, plain.covariance + 0.5 * np.eye(2), rtol=1e-9, atol=1e-9
        )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"order": "later"}, "order is 'later'"),
        ({"frames": [None, None]}, "all frames are None"),
        ({"frames": [Frame(np.eye(2), [0, 0])]}, "the model has 2"),
        ({"frames": [Frame(np.eye(4), np.zeros(4))] * 2}, "A of shape"),
        ({"frames": [Frame(2 * np.eye(3), np.zeros(3))] * 2}, "changes the inputs"),
        ({"frames": [Frame(np.ones((1, 3)), [0])] * 2, "order": "product"}, "leaves no output"),
        ({"inputs": [np.nan]}, "not finite"),
    ],
)
def test_bad_arguments(change, words):
    options = {"frames": two_frames(), "inputs": TIMES} | change
    with pytest.raises(ArgumentError, match=words):
        tp_gmr(a_model(), **options)


def test_frames_that_are_not_observed_say_nothing():
    rng = np.random.default_rng(1)
    views = [Gaussian(rng.normal(size=(4, 2)), np.eye(2) * s) for s in (0.5, 1.0, 2.0)]
    frames = [Frame(rng.normal(size=(2, 2)), rng.normal(size=2)) for _ in views]
    some = fuse_frames(views, [frames[0], None, frames[2]])
    expected = fuse_frames([views[0], views[2]], [frames[0], frames[2]])
    np.testing.assert_array_equal(some.mean, expected.mean)
    with pytest.raises(ArgumentError, match="at least one that is not None"):
        fuse_frames(views, [None] * 3)
