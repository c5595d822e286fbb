"""Parametric GMM: a known map recovered, the reference's figures and its two additions."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import Demonstration, Frame, Gaussian
from tpsim.errors import ArgumentError
from tpsim.learning import pgmm
from tpsim.learning.gmm import GMM, log_sum, posterior
from tpsim.learning.pgmm import PGMM, fit_pgmm, task_vector
from tpsim.learning.regularisation import Ridge

FIGURES = np.load(Path(__file__).parents[1] / "reference" / "pgmm.npz")


class AddedToNumerator(Ridge):
    """The reference's place for its 1e-4 I: before the division by the component's mass."""

    def __init__(self, mass):
        super().__init__(0.0)
        object.__setattr__(self, "mass", mass)

    def scatter(self, S):
        return S + 1e-4 / self.mass[:, None, None] * np.eye(S.shape[-1])


def test_reference_parameters_appear_with_its_two_additions():
    data = np.concatenate(FIGURES["data"])
    Q = np.repeat(FIGURES["parameters"], 200, axis=0)
    gaussians = Gaussian(FIGURES["start_mean"], FIGURES["start_covariance"])
    model = pgmm._at_rest(GMM(FIGURES["start_priors"], gaussians), Q.shape[1])
    history = []
    for _ in FIGURES["log_likelihood"]:
        joint = model._log_joint(data, Q)
        history.append(log_sum(joint).mean())
        h = posterior(joint)
        model = pgmm._maximised(model, data, Q, h, AddedToNumerator(h.sum(0)), task_ridge=1e-4)
    np.testing.assert_allclose(history, FIGURES["log_likelihood"], rtol=1e-8)
    np.testing.assert_allclose(model.priors, FIGURES["priors"], rtol=1e-8)
    np.testing.assert_allclose(model.covariance, FIGURES["covariance"], rtol=1e-8, atol=1e-10)
    # Five situations for nine unknowns: the inverted matrix is singular but for its 1e-4 I.
    np.testing.assert_allclose(model.maps, FIGURES["maps"], atol=1e-7)
    new = model.adapt(FIGURES["new_parameters"]).gaussians.mean
    np.testing.assert_allclose(new, FIGURES["new_means"], rtol=1e-7, atol=1e-8)


def test_ours_is_likelier_than_the_reference():
    start = GMM(
        FIGURES["start_priors"], Gaussian(FIGURES["start_mean"], FIGURES["start_covariance"])
    )
    options = {"start": start, "ridge": 0.0, "tolerance": 1e-8, "max_iterations": 300}
    model = fit_pgmm(FIGURES["data"], FIGURES["parameters"], 3, **options)
    assert model.history[-1] >= FIGURES["log_likelihood"][-1]
    Q = np.repeat(FIGURES["parameters"], 200, axis=0)
    likelihood = model.log_likelihood(np.concatenate(FIGURES["data"]), Q).mean()
    assert np.isclose(likelihood, model.history[-1])


def sequences_of(truth, rng, count=12, length=40):
    """Movements through the three components of a model, one task each."""
    Q = rng.uniform(-1, 1, size=(count, truth.maps.shape[-1] - 1))
    states = np.arange(length) * truth.components // length
    return [truth.adapt(q).gaussians[states].sample(rng) for q in Q], Q


@pytest.fixture
def truth():
    maps = np.array([[[1.0, 0, 0], [0, 0, 5]], [[0, 2, 5], [1, 0, 0]], [[0, 0, 9], [-1, 1, 9]]])
    return PGMM(np.full(3, 1 / 3), maps, np.stack([0.01 * np.eye(2)] * 3))


def test_known_maps_are_recovered(truth):
    sequences, Q = sequences_of(truth, np.random.default_rng(0))
    model = fit_pgmm(sequences, Q, 3, start="time")
    np.testing.assert_allclose(model.maps, truth.maps, atol=0.1)
    new = np.array([0.3, -0.4])
    mean = model.adapt(new).gaussians.mean
    np.testing.assert_allclose(mean, truth.adapt(new).gaussians.mean, atol=0.1)


def test_one_component_is_least_squares(truth):
    sequences, Q = sequences_of(truth, np.random.default_rng(1))
    model = fit_pgmm(sequences, Q, 1)
    Q1 = np.repeat(np.column_stack([Q, np.ones(len(Q))]), 40, axis=0)
    expected = np.linalg.lstsq(Q1, np.concatenate(sequences))[0].T
    np.testing.assert_allclose(model.maps[0], expected, atol=1e-10)


@settings(max_examples=30, deadline=None)
@given(
    st.integers(1, 3),
    st.integers(1, 4),
    st.integers(1, 4),
    st.integers(1, 4),
    st.integers(0, 10**6),
)
def test_likelihood_never_falls(D, K, q, situations, seed):
    rng = np.random.default_rng(seed)
    sequences = [rng.normal(size=(int(rng.integers(5, 30)), D)) for _ in range(situations)]
    Q = rng.normal(scale=10.0 ** rng.integers(-3, 3), size=(situations, q))
    model = fit_pgmm(sequences, Q, K, tolerance=-np.inf, max_iterations=15)
    assert np.diff(model.history).min() > -1e-9
    assert np.isfinite(model.maps).all()
    assert np.linalg.eigvalsh(model.covariance).min() > 0


def test_fewer_situations_than_parameters_leave_unseen_directions_alone(truth):
    sequences, Q = sequences_of(truth, np.random.default_rng(2))
    unseen = np.column_stack([Q, np.full(len(Q), 3.0)])  # a parameter that never changed
    model = fit_pgmm(sequences, unseen, 3)
    np.testing.assert_allclose(model.maps[..., 2], 0.0, atol=1e-12)
    far = model.adapt([0.1, 0.2, 50.0]).gaussians.mean
    near = model.adapt([0.1, 0.2, 3.0]).gaussians.mean
    np.testing.assert_allclose(far, near, atol=1e-9)


def test_task_parameters_may_come_from_frames_and_move(truth):
    rng = np.random.default_rng(3)
    sequences, Q = sequences_of(truth, rng)
    time = np.arange(40.0)
    demonstrations = [
        Demonstration(time, x, [Frame(np.eye(2), np.broadcast_to(q, (40, 2)))])
        for x, q in zip(sequences, Q, strict=True)
    ]
    vectors = task_vector(demonstrations[0].frames)
    np.testing.assert_array_equal(vectors[7], [*Q[0], 1, 0, 0, 1])
    ours = fit_pgmm(demonstrations, None, 3, start="time")
    theirs = fit_pgmm(sequences, Q, 3, start="time")
    np.testing.assert_allclose(ours.maps[..., :2], theirs.maps[..., :2], atol=1e-8)
    assert ours.adapt(vectors).gaussians.mean.shape == (40, 3, 2)


@pytest.mark.parametrize(
    "call",
    [
        lambda x, Q: fit_pgmm([], [], 2),
        lambda x, Q: fit_pgmm(x, Q[:-1], 2),
        lambda x, Q: fit_pgmm(x, [q[: 1 + i] for i, q in enumerate(Q[:2])] * 6, 2),
        lambda x, Q: fit_pgmm(x, Q * np.nan, 2),
        lambda x, Q: fit_pgmm(x, None, 2),
        lambda x, Q: fit_pgmm(x, Q, 2, task_ridge=-1.0),
        lambda x, Q: fit_pgmm(x, Q, 2, start=GMM([1.0], Gaussian(np.zeros((1, 2)), np.eye(2)))),
        lambda x, Q: fit_pgmm([x[0][0]], Q[:1], 1),
        lambda x, Q: fit_pgmm(x, Q, 2).adapt([1.0]),
        lambda x, Q: PGMM([1.0], np.zeros((2, 2, 3)), np.eye(2)[None]),
    ],
)
def test_bad_arguments_are_refused(call, truth):
    with pytest.raises(ArgumentError):
        call(*sequences_of(truth, np.random.default_rng(4)))
