"""Model selection on data whose answer is known, and DP-means by its own objective."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import MFA, PGMM, Demonstration, Frame, fit_gmm, fit_tp_gmm
from tpsim.errors import ArgumentError
from tpsim.learning.selection import aic, bic, dp_means, dp_means_start, select_model


@pytest.fixture(scope="module")
def clusters():
    rng = np.random.default_rng(0)
    centres = np.array([[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]], float)
    return (centres[:, None] + rng.normal(size=(4, 150, 3))).reshape(-1, 3)


@pytest.mark.parametrize("criterion", ["bic", "aic"])
def test_the_true_number_of_components_wins(clusters, criterion):
    options = {"fit": fit_gmm, "start": "kmeans", "restarts": 2}
    found = select_model(clusters, range(1, 7), ["spherical"], criterion=criterion, **options)
    # The milder penalty of AIC lets it keep a component too many.
    assert found.model.components in {"bic": (4,), "aic": (4, 5)}[criterion]
    assert len(found.candidates) == 6
    scores = [candidate.score for candidate in found.candidates]
    assert scores == sorted(scores)
    function = {"bic": bic, "aic": aic}[criterion]
    assert np.isclose(scores[0], function(found.model, clusters))
    assert str(found).count("\n") == 6


def test_the_true_subspace_wins():
    rng = np.random.default_rng(1)
    loadings = rng.normal(size=(8, 2))
    x = rng.normal(size=(600, 2)) @ loadings.T + 0.1 * rng.normal(size=(600, 8))
    structures = ["diagonal", MFA(1), MFA(2), MFA(4), "full"]
    found = select_model(x, [1], structures, fit=fit_gmm)
    assert found.candidates[0].covariance == MFA(2)


def test_criteria_by_hand(clusters):
    model = fit_gmm(clusters, 2)
    log_likelihood, p = model.log_likelihood(clusters).sum(), 2 * (3 + 6) + 1
    assert np.isclose(bic(model, clusters), p * np.log(600) - 2 * log_likelihood)
    assert np.isclose(aic(model, clusters), 2 * p - 2 * log_likelihood)
    # A parametric model without parameters is the mixture, one constant column per component.
    maps = model.gaussians.mean[..., None]
    parametric = PGMM(model.priors, maps, model.gaussians.covariance)
    assert np.isclose(bic(parametric, clusters, np.empty((600, 0))), bic(model, clusters))


@pytest.mark.parametrize("radius", [0.4, 0.7, 1.5])
def test_dp_means_covers_every_sample_and_pays_for_every_cluster(clusters, radius):
    points = (clusters - clusters.mean(0)) / clusters.std(0)
    labels = dp_means(clusters, radius)
    centres = np.array([points[labels == k].mean(0) for k in range(labels.max() + 1)])
    squared = ((points[:, None] - centres) ** 2).mean(-1)
    assert np.sqrt(squared[np.arange(600), labels].max()) <= radius * (1 + 1e-6)
    cost = squared[np.arange(600), labels].sum() + radius**2 * len(centres)
    assert cost <= (points**2).mean(-1).sum() + radius**2  # than one cluster


def test_dp_means_finds_well_separated_clusters(clusters):
    labels = dp_means(clusters, 0.9)
    truth = np.repeat(np.arange(4), 150)
    assert labels.max() == 3
    pairs = {*zip(labels.tolist(), truth.tolist(), strict=True)}
    assert len(pairs) <= 6  # a handful of stray samples at most
    shuffled = np.random.default_rng(2).permutation(600)
    again = dp_means(clusters[shuffled], 0.9)
    same = labels[shuffled][:, None] == labels[shuffled]
    assert (same == (again[:, None] == again)).mean() > 0.999


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 20), st.integers(1, 4), st.floats(1e-3, 1e3), st.integers(0, 10**6))
def test_dp_means_ends_on_any_points(N, D, radius, seed):
    rng = np.random.default_rng(seed)
    points = rng.integers(-3, 3, size=(N, D)).astype(float)  # with duplicates and constants
    labels = dp_means(points, radius)
    assert labels.shape == (N,)
    assert set(labels) == set(range(labels.max() + 1))


def test_dp_means_starts_em(clusters):
    start = dp_means_start(clusters, 0.9)
    model = fit_gmm(clusters, start.components, start=start)
    assert model.components == 4
    assert model.history[-1] >= model.history[0]
    time = np.arange(600.0)
    frames = [Frame(np.eye(3), np.zeros(3)), Frame(2 * np.eye(3), np.ones(3))]
    demonstration = Demonstration(time, clusters, frames)
    start = dp_means_start([demonstration], 0.9)
    assert start.components == 4
    fitted = fit_tp_gmm([demonstration], 4, start=start)
    assert fitted.history[-1] >= fitted.history[0]


@pytest.mark.parametrize(
    "call",
    [
        lambda x: dp_means(x, 0.0),
        lambda x: dp_means(x, np.nan),
        lambda x: dp_means(x[0]),
        lambda x: dp_means(x * np.nan),
        lambda x: select_model(x, []),
        lambda x: select_model(x, [1], []),
        lambda x: select_model(x, [1], criterion="mdl", fit=fit_gmm),
        lambda x: select_model(x, [0], fit=fit_gmm),
        lambda x: dp_means_start([]),
    ],
)
def test_bad_arguments_are_refused(call, clusters):
    with pytest.raises(ArgumentError):
        call(clusters)
