"""EM: the reference's figures, a likelihood that never falls, hostile data."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import HDDC, MFA, MPPCA, Gaussian, fit_tp_gmm
from tpsim.errors import TpsimError
from tpsim.learning.em import Mixture, em, maximise, project
from tpsim.learning.regularisation import Ridge
from tpsim.learning.start import kmeans, split_in_time
from tpsim.learning.statistics import Components, Samples
from tpsim.learning.subspace import FULL

FOLDER = Path(__file__).parents[1] / "reference"
FIGURES = {
    name: np.load(FOLDER / f"{name}.npz")
    for name in ("tensor_init", "tensor_em", "tensor_subspace", "plain_subspace")
}
STRUCTURES = ["full", "diagonal", "spherical", HDDC(1), HDDC(2), MFA(1), MFA(2), MPPCA(1), MPPCA(2)]


class ReferenceRidge(Ridge):
    """The reference adds its constant twice: to the scatter and to the rebuilt covariance."""

    def variances(self, variances):
        return variances + self.rho

    def isotropic(self, variances):
        return variances + self.rho


def loadings(L0):
    """Reference loadings (D, [d,] ...) as (P, K, D, d); imaginary columns stand for real ones."""
    plain = L0.shape[0] in (4,) and L0.ndim in (2, 3) and L0.shape[-1] == 4
    if L0.ndim == (2 if plain else 3):
        L0 = L0[:, None]
    L0 = L0.transpose(2, 0, 1)[None] if plain else L0.transpose(2, 3, 0, 1)
    return np.where(np.abs(L0.imag) > np.abs(L0.real), L0.imag, L0.real)


def start_of(figures, name, samples):
    frames = [
        Gaussian(mean, covariance)
        for mean, covariance in zip(
            figures[f"{name}_mean"], figures[f"{name}_covariance"], strict=True
        )
    ]
    return Mixture.of(figures[f"{name}_priors"], frames, samples)


def run(figures, data, start, name, structure, limit, factors=None):
    """Repeat the reference's EM: same start, same constant, same number of iterations."""
    samples = Samples(list(data))
    mixture = project(start_of(figures, start, samples), structure, [limit])
    if factors is not None:
        part = mixture.components[0]
        mixture = Mixture(mixture.priors, (Components(part.mean, part.covariance, factors),))
    history = figures[f"{name}_history"]
    found, ours = em(samples, mixture, structure, [limit], -np.inf, len(history))
    part = found.components[0]
    np.testing.assert_allclose(ours[:-1], history, rtol=1e-10)
    np.testing.assert_allclose(found.priors, figures[f"{name}_priors"], rtol=1e-8)
    np.testing.assert_allclose(part.mean, figures[f"{name}_mean"], rtol=1e-8, atol=1e-10)
    covariance = figures[f"{name}_covariance"].real
    np.testing.assert_allclose(part.covariance, covariance, rtol=1e-8, atol=1e-8 * covariance.max())


@pytest.mark.parametrize(
    ("start", "name", "ridge", "data"),
    [
        ("init", "one", 1e-8, "data"),
        ("init", "three", 1e-8, "data"),
        ("init", "converged", 1e-8, "data"),
        ("init", "r4", 1e-4, "data"),
        ("init5", "k5", 1e-8, "data"),
        ("init_k", "deriv", 1e-8, "data_k"),
    ],
)
def test_tp_gmm_reference(start, name, ridge, data):
    figures = FIGURES["tensor_em"]
    run(figures, figures[data], start, name, FULL, Ridge(ridge))


def test_public_fit_reaches_the_reference_with_its_rule():
    """Same start, ridge, tolerance: the same number of iterations and the same model."""
    figures = FIGURES["tensor_em"]
    samples = Samples(list(figures["data"]))
    start = start_of(figures, "init", samples)
    model = fit_tp_gmm(
        list(figures["data"]),
        3,
        start=(start.priors, start.frames(samples)),
        ridge=1e-8,
        tolerance=1e-5,
    )
    assert len(model.history) - 1 == len(figures["converged_history"])
    for frame, mean, covariance in zip(
        model.frames, figures["converged_mean"], figures["converged_covariance"], strict=True
    ):
        np.testing.assert_allclose(frame.mean, mean, rtol=1e-8, atol=1e-10)
        np.testing.assert_allclose(frame.covariance, covariance, rtol=1e-8, atol=1e-10)


def test_responsibilities_reference():
    """The reference's weights are responsibilities divided by each component's mass."""
    figures = FIGURES["tensor_em"]
    samples = Samples(list(figures["data"]))
    limits = [Ridge(1e-8)]
    start = start_of(figures, "init", samples)
    mixture, _ = em(samples, start, FULL, limits, -np.inf, len(figures["converged_history"]) - 1)
    joint = samples.log_densities(mixture.components) + np.log(mixture.priors)
    h = np.exp(joint - joint.max(1, keepdims=True))
    h /= h.sum(1, keepdims=True)
    np.testing.assert_allclose(h / h.sum(0), figures["responsibilities"], atol=1e-12)


@pytest.mark.parametrize(
    ("start", "name", "data", "d"),
    [("init", "hd", "data", 1), ("init6", "hd6_1", "data6", 1), ("init6", "hd6_2", "data6", 2)],
)
def test_tp_hddc_reference(start, name, data, d):
    figures = FIGURES["tensor_subspace"]
    run(figures, figures[data], start, name, HDDC(d), ReferenceRidge(1e-10))


@pytest.mark.parametrize(
    ("start", "name", "data", "d"),
    [("init", "mfa", "data", 1), ("init6", "mfa6_1", "data6", 1), ("init6", "mfa6_2", "data6", 2)],
)
def test_tp_mfa_reference(start, name, data, d):
    figures = FIGURES["tensor_subspace"]
    noise = np.diagonal(figures[f"{name}_P0"].real.transpose(2, 3, 0, 1), axis1=-2, axis2=-1)
    factors = loadings(figures[f"{name}_L0"]), noise
    run(figures, figures[data], start, name, MFA(d), ReferenceRidge(1e-10), factors)


@pytest.mark.parametrize(
    ("start", "name", "data", "d"),
    [("init", "mpp", "data", 1), ("init6", "mpp6_1", "data6", 1), ("init6", "mpp6_2", "data6", 2)],
)
def test_tp_mppca_reference(start, name, data, d):
    figures = FIGURES["tensor_subspace"]
    factors = loadings(figures[f"{name}_L0"]), figures[f"{name}_o0"].real[..., None]
    run(figures, figures[data], start, name, MPPCA(d), Ridge(1e-10), factors)


@pytest.mark.parametrize(
    ("start", "name", "structure", "limit"),
    [
        ("init_g", "gmm", FULL, Ridge(1e-4)),
        ("init_t", "gmm_t", FULL, Ridge(1e-4)),
        ("init", "hd1", HDDC(1), ReferenceRidge(1e-8)),
        ("init", "hd2", HDDC(2), ReferenceRidge(1e-8)),
        ("init", "mfa1", MFA(1), ReferenceRidge(1e-6)),
        ("init", "mfa2", MFA(2), ReferenceRidge(1e-6)),
        ("init", "mpp1", MPPCA(1), Ridge(1e-6)),
        ("init", "mpp2", MPPCA(2), Ridge(1e-6)),
    ],
)
def test_plain_mixtures_reference(start, name, structure, limit):
    figures = FIGURES["plain_subspace"]
    data = figures["data_t" if start == "init_t" else "data"][None]
    factors = None
    if name.startswith("mfa"):
        noise = np.diagonal(figures[f"{name}_P0"].real.transpose(2, 0, 1), axis1=-2, axis2=-1)
        factors = loadings(figures[f"{name}_L0"]), noise[None]
    elif name.startswith("mpp"):
        factors = loadings(figures[f"{name}_L0"]), figures[f"{name}_o0"].real[None, :, None]
    run(figures, data, start, name, structure, limit, factors)


def test_kmeans_reference():
    figures = FIGURES["tensor_init"]
    labels, centres = kmeans(np.hstack(list(figures["data"])), figures["centres0"])
    np.testing.assert_array_equal(labels, figures["labels"])
    np.testing.assert_allclose(centres, figures["centres"], rtol=1e-12)


def test_start_in_time_reference():
    """The reference drops the last sample of every demonstration and divides by n - 1."""
    figures = FIGURES["tensor_init"]
    time = figures["data"][0][:, 0]
    kept = time < time.max()
    one_hot = (split_in_time(time, 3)[kept, None] == np.arange(3)).astype(float)
    views = [view[kept] for view in figures["data"]]
    assert_starts(views, one_hot, one_hot.sum(0), "time")


def test_start_by_kmeans_reference():
    """The reference counts every sample twice and divides by one less, then adds 1e-4 I."""
    figures = FIGURES["tensor_init"]
    one_hot = (figures["labels"][:, None] == np.arange(3)).astype(float)
    assert_starts(list(figures["data"]), one_hot, 2 * one_hot.sum(0), "kmeans")


def assert_starts(views, one_hot, counted, start):
    """The first M-step is the reference's, which divides by one less than it counted."""
    figures = FIGURES["tensor_init"]
    mixture = maximise(Samples(views).moments(one_hot), None, FULL, [Ridge(0.0)])
    n, part = counted[:, None, None], mixture.components[0]
    np.testing.assert_allclose(mixture.priors, figures[f"{start}_priors"], rtol=1e-12)
    np.testing.assert_allclose(part.mean, figures[f"{start}_mean"], rtol=1e-10)
    expected = figures[f"{start}_covariance"] - 1e-4 * np.eye(3)
    np.testing.assert_allclose(part.covariance * n / (n - 1), expected, atol=1e-10)


def test_start_in_bins_reference():
    """The reference's bins share the sample at their border, and have no constant."""
    figures = FIGURES["tensor_em"]
    edges = np.array([1, 67, 134, 200]) - 1
    step = np.arange(1000) % 200
    shared = (step[:, None] >= edges[:-1]) & (step[:, None] <= edges[1:])
    moments = Samples(list(figures["data_k"])).moments(shared.astype(float))
    n = moments.weight[:, None, None]
    np.testing.assert_allclose(n.ravel() / n.sum(), figures["init_k_priors"], rtol=1e-12)
    np.testing.assert_allclose(moments.mean[0], figures["init_k_mean"], rtol=1e-9, atol=1e-9)
    covariance = moments.scatter[0] * n / (n - 1)
    np.testing.assert_allclose(covariance, figures["init_k_covariance"], rtol=1e-9, atol=1e-9)


@st.composite
def mixtures(draw):
    """Samples of a random mixture seen from random frames, a structure and a start."""
    seed, P, K = draw(st.integers(0, 2**31)), draw(st.integers(1, 3)), draw(st.integers(1, 5))
    N = draw(st.integers(2 * K + 2, 150))
    rng = np.random.default_rng(seed)
    labels = rng.integers(K, size=N)
    views = []
    for _ in range(P):
        d = draw(st.integers(1, 5))
        centres, roots = 3 * rng.normal(size=(K, d)), rng.normal(size=(K, d, d))
        points = np.einsum("nij,nj->ni", roots[labels], rng.normal(size=(N, d)))
        views.append((centres[labels] + points) * 10.0 ** rng.uniform(-3, 3, d))
    return views, K, draw(st.sampled_from(STRUCTURES)), draw(st.sampled_from(["time", "kmeans"]))


@settings(max_examples=150, deadline=None)
@given(mixtures())
def test_likelihood_never_falls_and_covariances_are_positive_definite(case):
    views, K, structure, start = case
    model = fit_tp_gmm(views, K, covariance=structure, start=start)
    assert np.diff(model.history).min(initial=0.0) > -1e-9 * (1 + np.abs(model.history).max())
    assert np.isclose(model.history[-1], model.log_likelihood(views).mean(), rtol=1e-7, atol=1e-7)
    assert np.isclose(model.priors.sum(), 1.0)
    for frame in model.frames:
        np.testing.assert_array_equal(frame.covariance, frame.covariance.mT)
        np.linalg.cholesky(frame.covariance)


def spoil(rng, x, kind):
    """Make data hostile in one of nine ways."""
    N, d = x.shape
    column, row = rng.integers(d), rng.integers(N)
    if kind == 0:
        x[:, column] = rng.normal()
    elif kind == 1:
        x *= 10.0 ** rng.uniform(-120, 120)
    elif kind == 2:
        x[:] = x[rng.integers(N, size=N)]
    elif kind == 3:
        x[:, column] = x[:, rng.integers(d)]
    elif kind == 4:
        x[row, column] *= 10.0 ** rng.uniform(0, 12)
    elif kind == 5:
        x += 10.0 ** rng.uniform(0, 15)
    elif kind == 6:
        np.round(x, out=x)
    elif kind == 7:
        x[:] = x[0]
    elif kind == 8:
        x[row, column] = rng.choice([np.nan, np.inf])


@settings(max_examples=500, deadline=None)
@given(
    seed=st.integers(0, 2**31),
    N=st.integers(1, 30),
    K=st.integers(1, 7),
    dims=st.lists(st.integers(1, 5), min_size=1, max_size=3),
    kinds=st.lists(st.integers(0, 8), max_size=3),
    structure=st.sampled_from(STRUCTURES),
    start=st.sampled_from([None, "time", "kmeans"]),
    ridge=st.sampled_from([None, None, 0.0, 1e-8, 1e-4]),
)
def test_hostile_data_end_in_an_error_or_a_finite_model(
    seed, N, K, dims, kinds, structure, start, ridge
):
    rng = np.random.default_rng(seed)
    views = [rng.normal(size=(N, d)) for d in dims]
    for kind in kinds:
        spoil(rng, views[rng.integers(len(views))], kind)
    try:
        model = fit_tp_gmm(views, K, covariance=structure, start=start, ridge=ridge)
    except TpsimError:
        return
    assert np.isfinite(model.history).all()
    assert np.isfinite(model.log_likelihood(views)).all()
    for frame in model.frames:
        assert np.isfinite(frame.mean).all()
        np.linalg.cholesky(frame.covariance)
        assert np.isfinite(frame.precision).all()
