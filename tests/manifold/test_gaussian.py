"""Gaussians on manifolds against the density itself, Monte Carlo, and the answers of R^n."""

import warnings

import numpy as np
import pytest
from scipy.optimize import minimize

from tpsim import (
    ArgumentError,
    DataWarning,
    Frame,
    Gaussian,
    gaussian_product,
    match_moments,
    rotation,
)
from tpsim.archive import load
from tpsim.manifold.gaussian import RiemannianGaussian, carried
from tpsim.manifold.manifold import S1, S2, S3, R

POSE = R(3) * S3


def some(manifold, seed=0, spread=0.3, lead=()):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(*lead, manifold.dim, manifold.dim))
    covariance = spread**2 * (root @ root.mT / manifold.dim + 0.3 * np.eye(manifold.dim))
    return RiemannianGaussian(manifold, rng.normal(size=(*lead, manifold.width)), covariance)


def test_in_r_n_everything_is_the_gaussian():
    flat = [some(R(2) * R(2), seed) for seed in (0, 1)]
    plain = [Gaussian(g.mean, g.covariance) for g in flat]
    x = np.random.default_rng(5).normal(size=(6, 4))
    np.testing.assert_array_equal(flat[0].log_density(x), plain[0].log_density(x))
    np.testing.assert_array_equal(flat[0].sample(3, 5), plain[0].sample(3, 5))
    for ours, expected in (
        (gaussian_product(flat), gaussian_product(plain)),
        (flat[0].condition([0.3, 0.1], [0, 2]), plain[0].condition([0.3, 0.1], [0, 2])),
        (flat[0].marginal([3, 1]), plain[0].marginal([3, 1])),
        (
            flat[0].affine(np.diag([1.0, 2, 3, 4]), 1.0),
            plain[0].affine(np.diag([1.0, 2, 3, 4]), 1.0),
        ),
    ):
        np.testing.assert_allclose(ours.mean, expected.mean, atol=1e-14)
        np.testing.assert_allclose(ours.covariance, expected.covariance, atol=1e-14)


@pytest.mark.parametrize("manifold", [S1, S2, S3], ids=str)
def test_samples_have_the_density(manifold):
    """Their tangent vectors have the covariance, and quaternions' signs do not matter."""
    g = some(manifold, 1)
    x = g.sample(0, 40_000)
    v = g.log(x)
    np.testing.assert_allclose(v.mean(0), 0, atol=0.01)
    np.testing.assert_allclose(np.cov(v.T), g.covariance.squeeze(), atol=0.005)
    if manifold is S3:
        np.testing.assert_allclose(g.log_density(-x), g.log_density(x), atol=1e-12)


def furthest(manifold, factors, found):
    """How far the product is from the point of greatest density, found numerically."""

    def cost(v):
        return -sum(float(g.log_density(manifold.exp(found.mean, v))) for g in factors)

    return np.abs(minimize(cost, np.zeros(manifold.dim), options={"gtol": 1e-9}).x).max()


@pytest.mark.parametrize("seed", range(6))
def test_the_product_is_the_point_of_greatest_density(seed):
    manifold = R(2) * S3 * S2
    factors = [some(manifold, 10 * seed + j) for j in range(3)]
    assert furthest(manifold, factors, gaussian_product(factors)) < 1e-5


@pytest.mark.parametrize("degrees", [1, 60, 120, 170, 179])
def test_orientations_up_to_179_degrees_apart_meet_where_their_precisions_say(degrees):
    angle = np.radians(degrees)
    q = rotation.to_quaternion(rotation.exp(np.array([[0.0, 0, 0], [0.0, 0, angle]])))
    one, other = (RiemannianGaussian(S3, q[i], np.eye(3) * s) for i, s in enumerate((0.01, 0.03)))
    found = gaussian_product([one, other])
    np.testing.assert_allclose(S3.log(q[0], found.mean), [0, 0, angle / 4], atol=1e-8)
    assert furthest(S3, [one, other], found) < 1e-5
    assert np.linalg.eigvalsh(found.covariance).min() > 0
    # Along the way precisions add; across it they are stretched, by what the half angles say.
    assert found.covariance[2, 2] == pytest.approx(1 / (1 / 0.01 + 1 / 0.03))


def test_the_product_agrees_with_monte_carlo():
    """Samples of one factor, weighted by the density of the other."""
    one, other = some(S3, 0, 0.2), some(S3, 1, 0.2)
    other = RiemannianGaussian(S3, S3.exp(one.mean, np.array([0.2, -0.1, 0.15])), other.covariance)
    x = one.sample(0, 200_000)
    weights = np.exp(other.log_density(x) - other.log_density(x).max())
    found = gaussian_product([one, other])
    v = S3.log(found.mean, x)
    mean = weights @ v / weights.sum()
    np.testing.assert_allclose(mean, 0, atol=0.005)
    spread = (v * weights[:, None]).T @ v / weights.sum()
    np.testing.assert_allclose(spread, found.covariance, rtol=0.06, atol=3e-4)


def test_the_conditional_agrees_with_monte_carlo():
    manifold = R(1) * S3 * S2
    g = some(manifold, 3, 0.5)
    value = g.mean[:1] + 1.0
    found = g.condition(value, 0)
    x = g.sample(1, 400_000)
    near = x[np.abs(x[:, 0] - value) < 0.05][:, 1:]
    assert len(near) > 2000
    v = found.log(near)
    # Second order in the spread, which is up to 0.5 rad here.
    np.testing.assert_allclose(v.mean(0), 0, atol=0.03)
    np.testing.assert_allclose(np.cov(v.T), found.covariance, atol=0.03)


def test_conditioning_on_an_orientation_does_not_see_its_sign():
    g = some(POSE, 2)
    q = S3.exp(g.mean[3:], np.array([0.1, 0.2, -0.1]))
    one, other = g.condition(q, [3, 4, 5, 6]), g.condition(-q, [3, 4, 5, 6])
    np.testing.assert_allclose(one.mean, other.mean, atol=1e-14)
    local = g.spread.condition([0.1, 0.2, -0.1], [3, 4, 5])
    np.testing.assert_allclose(one.mean, g.mean[:3] + local.mean, atol=1e-12)


@pytest.mark.parametrize("manifold", [S2, S3], ids=str)
def test_small_spread_is_r_n_to_second_order(manifold):
    """Product in a tangent space nearby: where the spread halves, the error falls fourfold."""
    base = some(manifold, 7).mean
    rng = np.random.default_rng(0)
    places = rng.normal(size=(2, manifold.dim))

    def error(spread):
        x = manifold.exp(base, spread * places)
        covariance = [
            np.diag(spread**2 * c) for c in (np.arange(1, manifold.dim + 1), np.ones(manifold.dim))
        ]
        near = [
            Gaussian(spread * p, carried(manifold, y, base, c))
            for p, y, c in zip(places, x, covariance, strict=True)
        ]
        curved = [RiemannianGaussian(manifold, y, c) for y, c in zip(x, covariance, strict=True)]
        expected = gaussian_product(near)
        found = gaussian_product(curved)
        return np.abs(manifold.log(base, found.mean) - expected.mean).max() / spread

    assert error(0.2) > 1e-5
    assert error(0.2) / error(0.1) == pytest.approx(4, rel=0.3)


def test_a_turned_base_turns_every_answer():
    rng = np.random.default_rng(0)
    turn = POSE.frame(Frame(rotation.exp([2.0, -1.0, 1.5]), [0.3, 0.1, -2.0]))
    factors = [some(POSE, seed) for seed in (0, 1)]
    moved = [g.affine(turn.A, turn.b) for g in factors]
    x = POSE.points("x", rng.normal(size=(5, 7)))
    np.testing.assert_allclose(
        moved[0].log_density(turn.to_common(x)), factors[0].log_density(x), atol=1e-10
    )
    expected = gaussian_product(factors).affine(turn.A, turn.b)
    found = gaussian_product(moved)
    np.testing.assert_allclose(POSE.distance(found.mean, expected.mean), 0, atol=1e-8)
    np.testing.assert_allclose(found.covariance, expected.covariance, atol=1e-8)


def test_the_mean_of_a_mixture_is_where_its_ways_cancel():
    parts = some(POSE, 4, lead=(5,))
    near = POSE.exp(parts.mean[0], 0.3 * np.random.default_rng(1).normal(size=(5, 6)))
    parts = RiemannianGaussian(POSE, near, parts.covariance)
    h = np.array([0.1, 0.3, 0.2, 0.15, 0.25])
    found = match_moments(h, parts)
    np.testing.assert_allclose(h @ POSE.log(found.mean, parts.mean), 0, atol=1e-4)
    chosen = np.random.default_rng(2).choice(5, 100_000, p=h)
    v = found.log(parts[chosen].sample(3))
    np.testing.assert_allclose(np.cov(v.T), found.covariance, atol=0.02)


def test_opposite_means_are_said_and_their_product_is_finite():
    for manifold, a, b in (
        (S3, [1.0, 0, 0, 0], [0.0, 1, 0, 0]),
        (S2, [0.0, 0, 1], [0.0, 0, -1]),
        (S1, [0.0], [np.pi]),
    ):
        pair = [RiemannianGaussian(manifold, p, np.eye(manifold.dim)) for p in (a, b)]
        with pytest.warns(DataWarning, match="half a turn apart"):
            found = gaussian_product(pair)
        assert manifold.distance(found.mean, pair[0].mean) == pytest.approx(np.pi / 2, abs=1e-6)
        assert np.linalg.eigvalsh(found.covariance).min() > 0


def test_batches_are_their_parts_and_files_bring_them_back(tmp_path):
    many = some(POSE, 3, lead=(4,))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = gaussian_product([many, some(POSE, 3)])
    alone = gaussian_product([many[2], some(POSE, 3)])
    np.testing.assert_allclose(POSE.distance(found[2].mean, alone.mean), 0, atol=1e-8)
    back = load(many.save(tmp_path / "poses.npz"))
    assert back.manifold == POSE and np.array_equal(back.mean, many.mean)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: RiemannianGaussian(S3, np.zeros(4), np.eye(3)), "quaternions of zero length"),
        (lambda: RiemannianGaussian(S3, [1.0, 0, 0, 0], np.eye(4)), "3 tangent coordinates"),
        (lambda: RiemannianGaussian(POSE, [1.0, 0, 0, 0], np.eye(6)), "R(3) * S3 has 7 columns"),
        (lambda: RiemannianGaussian("S3", np.ones(4), np.eye(3)), "where a Manifold belongs"),
        (lambda: gaussian_product([some(S3), some(S2)]), "give one manifold"),
        (lambda: gaussian_product([Gaussian(np.ones(3), np.eye(3)), some(S3)]), "R(3), S3"),
        (lambda: some(POSE).condition([1.0], [4]), "together or not at all"),
        (lambda: some(POSE).condition([1.0], [0], [0, 1]), "overlap"),
        (lambda: some(POSE).log_density(np.ones(6)), "7 columns"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_one_clear_line(call, words):
    with pytest.raises(ArgumentError) as error:
        call()
    assert words in str(error.value) and "\n" not in str(error.value)
