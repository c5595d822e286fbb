"""Covariance structures: what they keep, what they fit exactly, what they cost."""

import numpy as np
import pytest

from tpsim import GMM, HDDC, MFA, MPPCA, Gaussian, fit_gmm, fit_tp_gmm
from tpsim.errors import ArgumentError
from tpsim.learning.regularisation import Floor, Ridge
from tpsim.learning.subspace import FULL, structure_of

NO_LIMIT = Ridge(0.0)


def scatter(rng, D, samples=50):
    x = rng.normal(size=(1, 3, samples, D)) @ rng.normal(size=(D, D))
    return x.mT @ x / samples


@pytest.mark.parametrize(
    ("structure", "per_covariance"),
    [
        ("full", 4465),
        ("diagonal", 94),
        ("spherical", 1),
        (MFA(2), 281),
        (MPPCA(2), 188),
        (HDDC(2), 188),
    ],
)
def test_free_parameters_of_one_covariance(structure, per_covariance):
    assert structure_of(structure).free_parameters(94) == per_covariance


def test_the_tutorials_example_counts_4511_and_54719():
    """D = 94, K = 12, d = 2 (Fig. 6)."""
    gaussians = Gaussian(np.zeros((12, 94)), np.eye(94))
    priors = np.full(12, 1 / 12)
    assert GMM(priors, gaussians, structure=MFA(2)).free_parameters == 4511
    assert GMM(priors, gaussians).free_parameters == 54719


def test_parameters_count_every_frame():
    views = [np.random.default_rng(0).normal(size=(40, d)) for d in (2, 4)]
    assert fit_tp_gmm(views, 3).free_parameters == 3 * (2 + 3 + 4 + 10) + 2
    assert fit_tp_gmm(views, 3, covariance=MFA(1)).free_parameters == 3 * (2 + 4 + 4 + 8) + 2


def test_hddc_keeps_eigenvalues_and_trace():
    """Eqs (9-10): the leading d eigenvalues and the trace are those of the scatter."""
    S = scatter(np.random.default_rng(0), 5)
    covariance, _ = HDDC(2).fit(S, None, NO_LIMIT)
    expected, found = np.linalg.eigvalsh(S), np.linalg.eigvalsh(covariance)
    np.testing.assert_allclose(found[..., -2:], expected[..., -2:])
    np.testing.assert_allclose(found[..., 0], found[..., 2])
    np.testing.assert_allclose(found.sum(-1), expected.sum(-1))


def test_mfa_recovers_a_factor_model():
    rng = np.random.default_rng(1)
    loadings, noise = rng.normal(size=(8, 2)), rng.uniform(0.5, 2.0, 8)
    truth = (loadings @ loadings.T + np.diag(noise))[None, None]
    factors = MFA(2).start(truth, NO_LIMIT)
    for _ in range(500):
        covariance, factors = MFA(2).fit(truth, factors, NO_LIMIT)
    np.testing.assert_allclose(covariance, truth, atol=1e-4)


def test_mppca_settles_where_its_closed_form_does():
    """Tipping and Bishop: the maximum keeps d eigenvalues and averages the rest, like HDDC."""
    S = scatter(np.random.default_rng(2), 6)
    factors = None
    for _ in range(3000):
        covariance, factors = MPPCA(2).fit(S, factors, NO_LIMIT)
    np.testing.assert_allclose(covariance, HDDC(2).fit(S, None, NO_LIMIT)[0], rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("structure", ["full", "diagonal", "spherical", HDDC(1), MFA(1), MPPCA(1)])
def test_floor_bounds_every_structure_from_below(structure):
    rng = np.random.default_rng(3)
    direction = rng.normal(size=(1, 2, 3, 1))
    S = direction @ direction.mT
    least = 0.01 * np.eye(3)[None, None]
    covariance, _ = structure_of(structure).fit(S, None, Floor(least))
    assert np.linalg.eigvalsh(covariance).min() > 0.01 * (1 - 1e-9)


def test_full_floor_is_the_most_likely_covariance_above_it():
    """No covariance above the floor explains the scatter better (random directions)."""
    rng = np.random.default_rng(4)
    S = np.diag([4.0, 0.5, 0.001])[None, None]
    root = rng.normal(size=(3, 3))
    least = 0.05 * (root @ root.T + np.eye(3))[None, None]
    best, _ = FULL.fit(S, None, Floor(least))

    def log_likelihood(covariance):
        return -np.linalg.slogdet(covariance)[1] - np.trace(np.linalg.solve(covariance, S[0, 0]))

    for _ in range(200):
        step = rng.normal(size=(3, 2)) * 10.0 ** rng.uniform(-4, 0)
        other = best[0, 0] + rng.uniform(-1e-2, 1e-2) * (best - least)[0, 0] + step @ step.T
        assert log_likelihood(other) <= log_likelihood(best[0, 0]) + 1e-9


@pytest.mark.parametrize("structure", [HDDC(3), MFA(3), MPPCA(3)])
def test_a_subspace_is_smaller_than_a_small_frame(structure):
    rng = np.random.default_rng(5)
    views = [rng.normal(size=(60, d)) for d in (1, 2, 6)]
    model = fit_tp_gmm(views, 2, covariance=structure)
    assert model.dims == (1, 2, 6)
    assert np.isfinite(model.history).all()


def test_scaling_one_variable_scales_a_factor_analyser_with_it():
    rng = np.random.default_rng(6)
    data = rng.normal(size=(200, 2)) @ rng.normal(size=(2, 4)) + 0.3 * rng.normal(size=(200, 4))
    units = np.array([1.0, 1e3, 1e-3, 10.0])
    one = fit_gmm(data, 2, covariance=MFA(1), start="time")
    other = fit_gmm(data * units, 2, covariance=MFA(1), start="time")
    np.testing.assert_allclose(
        other.gaussians.covariance, one.gaussians.covariance * np.outer(units, units), rtol=1e-6
    )


@pytest.mark.parametrize("make", [HDDC, MFA, MPPCA])
@pytest.mark.parametrize("dimension", [0, -1, 1.5])
def test_bad_subspaces_are_refused(make, dimension):
    with pytest.raises(ArgumentError, match="subspace"):
        make(dimension)
