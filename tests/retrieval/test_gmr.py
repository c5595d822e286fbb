from pathlib import Path

import numpy as np
import pytest

from tpsim import (
    GMM,
    TPGMM,
    Frame,
    Gaussian,
    Regression,
    gaussian_product,
    gmr,
    gmr_mixture,
    match_moments,
)
from tpsim.errors import ArgumentError

REFERENCE = Path(__file__).parents[1] / "reference"
FIGURES, PRODUCT = np.load(REFERENCE / "gmr.npz"), np.load(REFERENCE / "product.npz")


def a_mixture(K=3, D=4, leading=(), seed=0):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(*leading, K, D, D))
    covariance = root @ root.mT + 0.1 * np.eye(D)
    return GMM(
        np.arange(1, K + 1) / np.arange(1, K + 1).sum(),
        Gaussian(rng.normal(size=(*leading, K, D)), covariance),
    )


@pytest.mark.parametrize("situation", range(4))
def test_reference_figures(situation):
    """TP-GMM adapted to four situations, then retrieved over time (fx_product_GMR)."""
    views = [Gaussian(*pair) for pair in zip(PRODUCT["mean"], PRODUCT["covariance"], strict=True)]
    frames = [
        Frame(A, b) for A, b in zip(PRODUCT["A"][situation], PRODUCT["b"][situation], strict=True)
    ]
    gmm = TPGMM(PRODUCT["priors"], views).adapt(frames)
    path = gmr(gmm, FIGURES["inputs"], ridge=1e-8)
    weights, _ = gmr_mixture(gmm, FIGURES["inputs"])
    np.testing.assert_allclose(path.mean, FIGURES["mean"][situation], rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(
        path.covariance, FIGURES["covariance"][situation], rtol=1e-8, atol=1e-10
    )
    np.testing.assert_allclose(weights, FIGURES["weights"][situation], rtol=1e-8, atol=1e-9)


def test_regression_in_each_frame_first_is_another_answer():
    """The reference's demo_TPGMR01 takes the product after the regression; Section 5.1 before."""
    frames = [Frame(A, b) for A, b in zip(PRODUCT["A"][3], PRODUCT["b"][3], strict=True)]
    views = [Gaussian(*pair) for pair in zip(PRODUCT["mean"], PRODUCT["covariance"], strict=True)]
    inputs = FIGURES["inputs"]
    first = [gmr(GMM(PRODUCT["priors"], view), inputs) for view in views]
    later = gaussian_product(
        [g.affine(f.A[1:, 1:], f.b[1:]) for g, f in zip(first, frames, strict=True)]
    )
    before = gmr(TPGMM(PRODUCT["priors"], views).adapt(frames), inputs)
    assert 0.005 < np.abs(later.mean - before.mean).max() < 0.5


def test_one_component_is_conditioning():
    gmm = a_mixture(K=1)
    x = np.array([[0.3, -1.0], [2.0, 0.5]])
    ours = gmr(gmm, x, given=(2, 0))
    exact = gmm.gaussians[0].condition(x, given=(2, 0))
    np.testing.assert_allclose(ours.mean, exact.mean)
    np.testing.assert_allclose(ours.covariance, np.broadcast_to(exact.covariance, (2, 2, 2)))


def test_against_monte_carlo():
    """Keep the samples of the joint density whose input falls close to the query."""
    gmm, rng = a_mixture(D=3), np.random.default_rng(1)
    samples = gmm.sample(rng, 400_000)
    near = samples[np.abs(samples[:, 0] - 0.4) < 0.03]
    ours = gmr(gmm, [[0.4]])
    assert len(near) > 3000
    error = 5 / np.sqrt(len(near))
    scale = np.sqrt(np.diagonal(ours.covariance[0]))
    np.testing.assert_allclose(near[:, 1:].mean(0), ours.mean[0], atol=error * scale.max())
    np.testing.assert_allclose(
        np.cov(near[:, 1:].T), ours.covariance[0], atol=2 * error * scale.max() ** 2
    )


def test_spread_between_components_is_counted():
    """Two branches, each thin: the single Gaussian must be as wide as they are apart."""
    covariance = np.tile(np.diag([1.0, 1e-4]), (2, 1, 1))
    gmm = GMM([0.5, 0.5], Gaussian([[0.0, -1.0], [0.0, 1.0]], covariance))
    np.testing.assert_allclose(gmr(gmm, [0.0]).covariance, [[[1.0 + 1e-4]]])
    weights, branches = gmr_mixture(gmm, [0.0])
    np.testing.assert_allclose(weights, [[0.5, 0.5]])
    np.testing.assert_allclose(branches.mean[0, :, 0], [-1, 1])
    np.testing.assert_allclose(branches.covariance, 1e-4)


def test_many_modes_and_their_moments_agree():
    gmm = a_mixture()
    x = np.linspace(-2, 2, 7)
    matched = match_moments(*gmr_mixture(gmm, x, given=(1,)))
    single = gmr(gmm, x, given=(1,))
    np.testing.assert_allclose(single.mean, matched.mean)
    np.testing.assert_allclose(single.covariance, matched.covariance)


def test_part_of_the_outputs_is_the_marginal_of_all():
    gmm, x = a_mixture(D=5), np.array([[0.1, -0.2]])
    every, some = gmr(gmm, x, (3, 1)), gmr(gmm, x, (3, 1), of=(4, 0))
    np.testing.assert_allclose(some.mean, every.mean[:, [2, 0]])
    np.testing.assert_allclose(some.covariance, every.covariance[:, [[2], [0]], [2, 0]])


@pytest.mark.parametrize("given", [(0,), (2,), (1, 3)])
def test_one_point_is_one_step_of_the_batch(given):
    gmm = a_mixture()
    regression = Regression.of(gmm, given, ridge=1e-3)
    x = np.random.default_rng(2).normal(size=(5, len(given)))
    batch = regression(x)
    for t in range(5):
        point = regression.at(x[t])
        np.testing.assert_allclose(point.mean, batch.mean[t], atol=1e-13)
        np.testing.assert_allclose(point.covariance, batch.covariance[t], atol=1e-13)


def test_moving_frames_are_static_ones_at_every_step():
    rng = np.random.default_rng(3)
    T, views = 6, [a_mixture(D=3, seed=s).gaussians for s in range(2)]
    model = TPGMM(np.full(3, 1 / 3), views)
    moving = [
        Frame(rng.normal(size=(T, 2, 2)), rng.normal(size=(T, 2))).with_input() for _ in views
    ]
    time = np.linspace(0, 1, T)
    path = gmr(model.adapt(moving), time)
    for t in range(T):
        now = gmr(model.adapt([frame[t] for frame in moving]), time[t : t + 1])
        np.testing.assert_allclose(path.mean[t], now.mean[0], rtol=1e-9)
        np.testing.assert_allclose(path.covariance[t], now.covariance[0], rtol=1e-9)


def test_far_from_the_data_the_widest_component_extrapolates():
    covariance = [[[1.0, 0.5], [0.5, 1.0]], [[4.0, -2.0], [-2.0, 3.0]]]
    gmm = GMM([0.9, 0.1], Gaussian([[0.0, 0.0], [0.0, 1.0]], covariance))
    far = gmr(gmm, [1e6, -1e6])
    np.testing.assert_allclose(far.mean[:, 0], 1 - 0.5 * np.array([1e6, -1e6]))
    np.testing.assert_allclose(far.covariance[:, 0, 0], 2.0)


def test_a_prior_of_zero_has_no_say():
    gmm = a_mixture(K=2)
    alone = GMM([1.0], gmm.gaussians[:1])
    np.testing.assert_allclose(
        gmr(GMM([1.0, 0.0], gmm.gaussians), [0.3]).mean, gmr(alone, [0.3]).mean
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (dict(inputs=[np.nan]), "not finite"),
        (dict(inputs=[1e200]), "support"),
        (dict(inputs=np.zeros((3, 2))), "must have 1 values"),
        (dict(inputs=[0.0], given=(0, 1), of=(1, 2)), "different dimensions"),
        (dict(inputs=[0.0], given=(7,)), "different dimensions"),
        (dict(inputs=[0.0], given=()), "at least one"),
        (dict(inputs=[0.0], given=range(4)), "at least one"),
    ],
)
def test_bad_arguments(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        gmr(a_mixture(), **arguments)


def test_inputs_without_variance():
    covariance = np.diag([0.0, 1.0])[None]
    with pytest.raises(ArgumentError, match="positive definite"):
        gmr(GMM([1.0], Gaussian([[0.0, 0.0]], covariance)), [0.0])


def test_bad_points():
    regression = Regression.of(a_mixture())
    for point in ([np.nan], [np.inf], [1.0, 2.0]):
        with pytest.raises(ArgumentError, match="finite values"):
            regression.at(point)
    with pytest.raises(ArgumentError, match="leading axes"):
        Regression.of(a_mixture(leading=(5,))).at([0.0])
    with pytest.raises(ArgumentError, match="leading axes"):
        gmr(a_mixture(leading=(5,)), np.zeros((4, 1)))
