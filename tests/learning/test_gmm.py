"""GMM: densities, samples, archives, and a fit that beats a well-known one at its own game."""

import numpy as np
import pytest
from sklearn.mixture import GaussianMixture

from tpsim import GMM, HDDC, MFA, Gaussian, fit_gmm
from tpsim.errors import ArgumentError, RecordingError
from tpsim.examples import letters


@pytest.fixture(scope="module")
def data():
    return np.vstack([d.with_time().data for d in letters("G")])


@pytest.fixture(scope="module")
def fitted(data):
    return fit_gmm(data, 5)


@pytest.mark.filterwarnings("ignore:Best performing initialization did not converge")
def test_ten_iterations_are_those_of_scikit_learn(data, fitted):
    ours = fit_gmm(data, 5, start=fitted, ridge=1e-6, tolerance=-1.0, max_iterations=10)
    theirs = GaussianMixture(
        5,
        weights_init=fitted.priors,
        means_init=fitted.gaussians.mean,
        precisions_init=fitted.gaussians.precision,
        reg_covar=1e-6,
        max_iter=10,
        tol=0.0,
    ).fit(data)
    np.testing.assert_allclose(ours.gaussians.mean, theirs.means_, atol=1e-6)
    np.testing.assert_allclose(ours.gaussians.covariance, theirs.covariances_, atol=1e-6)
    np.testing.assert_allclose(ours.log_likelihood(data), theirs.score_samples(data), atol=1e-4)
    np.testing.assert_allclose(ours.responsibilities(data), theirs.predict_proba(data), atol=1e-4)


def test_likelihood_is_the_log_of_the_mixture_density(data, fitted):
    densities = np.exp(fitted.gaussians.log_density(data[:50, None])) @ fitted.priors
    np.testing.assert_allclose(fitted.log_likelihood(data[:50]), np.log(densities), rtol=1e-10)
    np.testing.assert_allclose(fitted.responsibilities(data).sum(-1), 1.0)
    assert np.isclose(fitted.log_likelihood(data).mean(), fitted.history[-1], rtol=1e-9)


def test_default_start_is_at_least_as_likely_as_either(data, fitted):
    each = [fit_gmm(data, 5, start=start).history[-1] for start in ("time", "kmeans")]
    assert fitted.history[-1] == max(each)


def test_restarts_never_lose(data):
    rng = np.random.default_rng
    once = fit_gmm(data, 4, start="kmeans", rng=rng(3))
    often = fit_gmm(data, 4, start="kmeans", rng=rng(3), restarts=4)
    assert often.history[-1] >= once.history[-1]


def test_same_data_same_bits(data):
    one, other = (fit_gmm(data, 4) for _ in range(2))
    np.testing.assert_array_equal(one.gaussians.covariance, other.gaussians.covariance)


def test_floor_prevents_the_collapse_that_a_ridge_allows():
    """A pair of equal points draws a component to zero width under 1e-8, not under the floor."""
    rng = np.random.default_rng(0)
    data = np.vstack([rng.normal(size=(60, 2)), [[5.0, 5.0]] * 3])
    ridge = fit_gmm(data, 4, ridge=1e-8, start="kmeans")
    floor = fit_gmm(data, 4, start="kmeans")
    narrowest = [np.linalg.eigvalsh(g.gaussians.covariance).min() for g in (ridge, floor)]
    assert narrowest[0] < 1e-7
    assert narrowest[1] > 1e-5
    held_out = rng.normal(size=(2000, 2))
    assert floor.log_likelihood(held_out).mean() > ridge.log_likelihood(held_out).mean()


def test_sequences_of_unequal_length_are_split_each_in_its_own_time():
    rng = np.random.default_rng(0)
    ramps = [np.linspace(0, 1, T)[:, None] + 0.01 * rng.normal(size=(T, 1)) for T in (40, 200, 90)]
    model = fit_gmm(ramps, 3, start="time", max_iterations=0)
    np.testing.assert_allclose(model.priors, 1 / 3, atol=0.02)
    np.testing.assert_allclose(model.gaussians.mean[:, 0], [1 / 6, 1 / 2, 5 / 6], atol=0.02)


def test_samples_follow_the_mixture(fitted):
    samples = fitted.sample(np.random.default_rng(0), 20000)
    matched = fitted.to_gaussian()
    np.testing.assert_allclose(samples.mean(0), matched.mean, atol=0.03)
    np.testing.assert_allclose(np.cov(samples.T), matched.covariance, atol=0.03)


def test_leading_axes_carry_time():
    rng = np.random.default_rng(0)
    gmm = GMM([0.4, 0.6], Gaussian(rng.normal(size=(7, 2, 3)), np.eye(3)))
    x = rng.normal(size=(7, 3))
    assert gmm.responsibilities(x).shape == (7, 2)
    np.testing.assert_allclose(gmm[4].log_likelihood(x[4]), gmm.log_likelihood(x)[4])


@pytest.mark.parametrize("covariance", ["full", HDDC(2), MFA(1)])
def test_archive_returns_the_same_bits(data, tmp_path, covariance):
    model = fit_gmm(data, 3, covariance=covariance, max_iterations=5)
    again = GMM.load(model.save(tmp_path / "model.npz"))
    np.testing.assert_array_equal(again.gaussians.covariance, model.gaussians.covariance)
    np.testing.assert_array_equal(again.history, model.history)
    assert (again.structure, again.samples) == (model.structure, model.samples)
    with pytest.raises(RecordingError, match="TPGMM"):
        from tpsim import TPGMM

        TPGMM.load(tmp_path / "model.npz")


@pytest.mark.parametrize(
    ("data", "components", "options", "word"),
    [
        (np.zeros((10, 2)), 1, {}, "same point"),
        (np.ones((1, 2)), 1, {}, "at least 2"),
        ([[0.0], [1.0], [1.0]], 3, {}, "only 2 samples differ"),
        ([[0.0], [np.nan]], 1, {}, "NaN"),
        (np.zeros((0, 2)), 1, {}, "shapes"),
        (np.zeros(5), 1, {}, "shapes"),
        ([np.eye(2), np.eye(3)], 1, {}, "shapes"),
        (np.eye(3), 0, {}, "components"),
        (np.eye(3), 1.5, {}, "components"),
        (np.eye(3), 2, {"start": "magic"}, "start"),
        (np.eye(3), 2, {"covariance": "tied"}, "covariance"),
        (np.eye(3), 2, {"ridge": -1.0}, "ridge"),
        (np.eye(3), 2, {"tolerance": np.nan}, "tolerance"),
        (np.eye(3), 2, {"max_iterations": -1}, "max_iterations"),
        (np.eye(3), 2, {"time": [0.0]}, "time"),
        (np.eye(3), 2, {"start": GMM([1.0], Gaussian(np.zeros((1, 3)), np.eye(3)))}, "start"),
    ],
)
def test_bad_input_is_refused_by_name(data, components, options, word):
    with pytest.raises(ArgumentError, match=word):
        fit_gmm(data, components, **options)


@pytest.mark.parametrize("priors", [[0.5, 0.6], [-0.5, 1.5], [1.0], [], [[0.5, 0.5]]])
def test_bad_priors_are_refused(priors):
    with pytest.raises(ArgumentError):
        GMM(priors, Gaussian(np.zeros((2, 3)), np.eye(3)))
