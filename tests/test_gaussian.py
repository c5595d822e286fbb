"""Gaussian algebra against dense linear algebra, Eqs (1-8) and (14-19)."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

import tpsim
from tpsim import Gaussian, gaussian_product
from tpsim.errors import ArgumentError


@pytest.fixture
def rng():
    return np.random.default_rng(0)


def spd(rng, *shape):
    root = rng.normal(size=(*shape, shape[-1]))
    return root @ root.mT + 0.1 * np.eye(shape[-1])


def test_log_density_is_that_of_scipy_over_leading_axes(rng):
    gaussian = Gaussian(rng.normal(size=(5, 3)), spd(rng, 5, 3))
    x = rng.normal(size=(7, 3))
    expected = [
        multivariate_normal(m, S).logpdf(x)
        for m, S in zip(gaussian.mean, gaussian.covariance, strict=True)
    ]
    np.testing.assert_allclose(gaussian.log_density(x[:, None]), np.transpose(expected), rtol=1e-10)


def test_log_density_does_not_underflow():
    gaussian = Gaussian(np.zeros(2), 1e-12 * np.eye(2))
    assert np.isclose(gaussian.log_density([1e3, 0.0]), -0.5e18)


def test_product_minimises_the_weighted_sum_of_squares(rng):
    """Eq. (3): the product's mean solves the stacked least squares, its covariance is A'A."""
    gaussians = [Gaussian(rng.normal(size=3), spd(rng, 3)) for _ in range(4)]
    roots = [np.linalg.cholesky(g.precision).T for g in gaussians]
    stacked = np.vstack(roots)
    targets = np.concatenate([R @ g.mean for R, g in zip(roots, gaussians, strict=True)])
    mean = np.linalg.lstsq(stacked, targets)[0]
    product = gaussian_product(gaussians)
    np.testing.assert_allclose(product.mean, mean, rtol=1e-10)
    np.testing.assert_allclose(product.covariance, np.linalg.inv(stacked.T @ stacked), rtol=1e-10)


def test_product_broadcasts_over_leading_axes(rng):
    many = Gaussian(rng.normal(size=(6, 4, 2)), spd(rng, 4, 2))
    one = Gaussian(rng.normal(size=2), spd(rng, 2))
    product = gaussian_product([many, one])
    expected = gaussian_product([many[3, 1], one])
    np.testing.assert_allclose(product[3, 1].mean, expected.mean)
    np.testing.assert_allclose(product[3, 1].covariance, expected.covariance)


def test_units_do_not_matter_to_the_inverse():
    units, correlation = np.array([1e-9, 1.0, 1e9]), 0.5 * np.eye(3) + 0.5
    precision = Gaussian(np.zeros(3), np.outer(units, units) * correlation).precision
    scaled = precision * np.outer(units, units)
    np.testing.assert_allclose(scaled, np.linalg.inv(correlation), rtol=1e-12)


def test_affine_map_moves_moments(rng):
    gaussian, A, b = Gaussian(rng.normal(size=3), spd(rng, 3)), rng.normal(size=(2, 3)), [1.0, 2.0]
    mapped = gaussian.affine(A, b)
    np.testing.assert_allclose(mapped.mean, A @ gaussian.mean + b)
    np.testing.assert_allclose(mapped.covariance, A @ gaussian.covariance @ A.T)


def test_conditioning_is_the_ratio_of_densities(rng):
    """log P(o | i) = log P(o, i) - log P(i), for any choice of dimensions."""
    joint = Gaussian(rng.normal(size=5), spd(rng, 5))
    given, of = [3, 0], [1, 4, 2]
    point = rng.normal(size=5)
    conditional = joint.condition(point[given], given, of)
    expected = joint.log_density(point) - joint.marginal(given).log_density(point[given])
    np.testing.assert_allclose(conditional.log_density(point[of]), expected)
    np.testing.assert_allclose(
        joint.condition(point[given], given).mean, conditional.mean[[0, 2, 1]]
    )


def test_conditioning_broadcasts_inputs_over_components(rng):
    joint = Gaussian(rng.normal(size=(4, 3)), spd(rng, 4, 3))
    inputs = rng.normal(size=(9, 1, 1))
    conditional = joint.condition(inputs, [0])
    assert conditional.mean.shape == (9, 4, 2)
    alone = joint[2].condition(inputs[5, 0], [0])
    np.testing.assert_allclose(conditional.mean[5, 2], alone.mean)
    np.testing.assert_allclose(conditional.covariance[5, 2], alone.covariance)


def test_matched_moments_are_those_of_samples(rng):
    weights = np.array([0.2, 0.5, 0.3])
    parts = Gaussian(rng.normal(size=(3, 2)), spd(rng, 3, 2))
    matched = tpsim.match_moments(weights, parts)
    mean = weights @ parts.mean
    second = np.einsum(
        "k,kij->ij", weights, parts.covariance + parts.mean[:, :, None] * parts.mean[:, None]
    )
    np.testing.assert_allclose(matched.mean, mean)
    np.testing.assert_allclose(matched.covariance, second - np.outer(mean, mean))


def test_samples_have_the_moments_even_where_singular(rng):
    covariance = np.outer([1.0, 2.0], [1.0, 2.0])
    samples = Gaussian([1.0, -1.0], covariance).sample(rng, 20000)
    np.testing.assert_allclose(samples.mean(0), [1, -1], atol=0.05)
    np.testing.assert_allclose(np.cov(samples.T), covariance, atol=0.1)
    np.testing.assert_allclose(samples @ [2, -1], 3.0, atol=1e-9)


def test_regularisation_floors_eigenvalues_or_adds_a_ridge(rng):
    """Eqs (7) and (8)."""
    covariance = spd(rng, 4, 3) - 0.1 * np.eye(3)
    floored = np.linalg.eigvalsh(tpsim.floor_eigenvalues(covariance, 0.5))
    np.testing.assert_allclose(floored, np.maximum(np.linalg.eigvalsh(covariance), 0.5))
    ridged = np.linalg.eigvalsh(tpsim.add_ridge(covariance, 0.5))
    np.testing.assert_allclose(ridged, np.linalg.eigvalsh(covariance) + 0.5)


@pytest.mark.parametrize(
    ("mean", "covariance", "word"),
    [
        ([0.0, np.nan], np.eye(2), "NaN"),
        ([0.0, 0.0], np.eye(3), "shape"),
        (0.0, 1.0, "shape"),
        ([0.0, 0.0], [[1.0, 0.5], [0.0, 1.0]], "symmetric"),
        ([0.0, 0.0], -np.eye(2), "negative"),
        (np.zeros((3, 2)), np.zeros((4, 2, 2)), "leading"),
        (["a", "b"], np.eye(2), "numbers"),
    ],
)
def test_bad_gaussians_are_refused_by_name(mean, covariance, word):
    with pytest.raises(ArgumentError, match=word):
        Gaussian(mean, covariance)


def test_singular_covariance_is_refused_where_it_is_inverted():
    flat = Gaussian(np.zeros(2), np.ones((2, 2)))
    for use in (
        lambda: flat.precision,
        lambda: flat.log_density([0, 0]),
        lambda: gaussian_product([flat]),
    ):
        with pytest.raises(ArgumentError, match="singular"):
            use()


@pytest.mark.parametrize(
    "use",
    [
        lambda g: g.log_density([1.0]),
        lambda g: g.affine(np.eye(2)),
        lambda g: g.marginal([3]),
        lambda g: g.marginal([0.5]),
        lambda g: g.condition([1.0], [0, 1]),
        lambda g: g.condition([1.0], [0], [0, 1]),
        lambda g: gaussian_product([]),
        lambda g: gaussian_product([g, g.marginal([0])]),
    ],
)
def test_misuse_is_refused(use):
    with pytest.raises(ArgumentError):
        use(Gaussian(np.zeros(3), np.eye(3)))
