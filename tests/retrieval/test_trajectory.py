from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import block_diag

from tpsim import (
    GMM,
    TPGMM,
    Frame,
    Gaussian,
    derivative_operator,
    integrator,
    lqt_batch,
    trajectory,
    trajectory_of_states,
)
from tpsim.errors import ArgumentError
from tpsim.learning.hsmm import HSMM
from tpsim.learning.semi_markov import SemiMarkovChain

REFERENCE = Path(__file__).parents[1] / "reference"
FIGURES = np.load(REFERENCE / "traj_gmm.npz")


def some_statistics(T, size, seed=0):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(T, size, size))
    return rng.normal(size=(T, size)), root @ root.mT + np.eye(size)


@pytest.mark.parametrize("derivatives", [0, 1, 2])
def test_operator_of_the_reference(derivatives):
    ours = derivative_operator(8, 0.01, derivatives, 2, differences="backward")
    np.testing.assert_allclose(ours.toarray(), FIGURES[f"operator_{derivatives}"], rtol=1e-12)


def test_operator_differentiates_polynomials():
    """Third differences of a cubic are exact, whatever their side; rows at the border are zero."""
    t = 0.1 * np.arange(9)
    for differences, inside in (("forward", slice(0, 6)), ("backward", slice(3, 9))):
        zeta = derivative_operator(9, 0.1, 3, differences=differences) @ t**3
        np.testing.assert_allclose(zeta.reshape(9, 4)[inside, 3], 6.0, rtol=1e-9)
    velocity = (derivative_operator(9, 0.1, 1) @ t**2).reshape(9, 2)[:, 1]
    np.testing.assert_allclose(velocity, np.r_[np.diff(t**2) / 0.1, 0.0], atol=1e-12)


@pytest.mark.parametrize("situation", range(4))
def test_reference_figures(situation):
    """TP-trajectory-GMM of the reference: backward differences, zero at the border."""
    views = [
        Gaussian(*pair)
        for pair in zip(FIGURES["model_mean"], FIGURES["model_covariance"], strict=True)
    ]
    frames = [
        Frame(A, b) for A, b in zip(FIGURES["A"][situation], FIGURES["b"][situation], strict=True)
    ]
    gmm = TPGMM(FIGURES["priors"], views).adapt(frames)
    product = FIGURES["product_mean"][situation]
    np.testing.assert_allclose(
        gmm.gaussians.mean, product, rtol=1e-7, atol=1e-8 * abs(product).max()
    )
    path = trajectory_of_states(gmm, FIGURES["states"], 0.01, differences="backward", border="zero")
    for ours, theirs in (
        (path.mean, FIGURES["path"][situation]),
        (path.covariance, FIGURES["covariance"][situation]),
    ):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=2e-8 * np.abs(theirs).max())


def test_reference_hidden_states():
    """demo_trajHSMM01: its own state sequence, and T times the mean squared residual as sigma."""
    figures = np.load(REFERENCE / "traj_hsmm.npz")
    states, mean, covariance = figures["states"], figures["mean"], figures["covariance"]
    operator = derivative_operator(100, 1.0, 2, 2, differences="backward")
    residual = mean[states] - (operator @ figures["path"].ravel()).reshape(100, 6)
    white = np.linalg.solve(np.linalg.cholesky(covariance)[states], residual[..., None])
    scale = 100 * (white**2).sum() / (600 - 200)
    path = trajectory_of_states(
        GMM(np.full(4, 0.25), Gaussian(mean, covariance)),
        states,
        1.0,
        differences="backward",
        border="zero",
        scale=scale,
    )
    np.testing.assert_allclose(path.mean, figures["path"], rtol=1e-8)
    expected = figures["path_covariance"]
    np.testing.assert_allclose(path.covariance, expected, atol=1e-8 * expected.max())


def test_optional_paths_of_a_semi_markov_model():
    """Fig. 8: by way of (1, 1) or (1, -1) with equal chance, never straight through the middle."""
    corners = np.array([[0, 0], [1, 1], [1, -1], [2, 0]])
    means, covariance = np.c_[corners, np.zeros((4, 4))], np.diag([0.01, 0.01, 0.1, 0.1, 1, 1])
    transitions = np.zeros((4, 4))
    transitions[0, 1:3], transitions[1:3, 3] = 0.5, 1.0
    stays = Gaussian(np.full((4, 1), 20.0), np.full((4, 1, 1), 9.0))
    emissions = GMM(np.full(4, 0.25), Gaussian(means, np.tile(covariance, (4, 1, 1))))
    model = HSMM(SemiMarkovChain(np.eye(4)[0], transitions, stays), emissions)
    rng = np.random.default_rng(0)
    paths = [trajectory_of_states(model, model.sample_states(60, rng), 0.1) for _ in range(100)]
    heights = np.array([max(path.mean[:, 1], key=abs) for path in paths])
    assert 30 < (heights > 0).sum() < 70
    assert np.abs(heights).min() > 0.7
    jumps = [np.abs(np.diff(path.mean, axis=0)).max() for path in paths]
    assert max(jumps) < 0.2


@pytest.mark.parametrize("differences", ["forward", "backward"])
@pytest.mark.parametrize("border", ["free", "zero"])
@pytest.mark.parametrize(
    ("derivatives", "dim", "T"),
    [(2, 2, 40), (1, 3, 7), (0, 2, 5), (2, 2, 1), (2, 1, 2), (3, 2, 30)],
)
def test_against_dense_least_squares(differences, border, derivatives, dim, T):
    means, covariances = some_statistics(T, (derivatives + 1) * dim)
    dt = 0.3
    phi = derivative_operator(T, dt, derivatives, dim, differences=differences).toarray()
    known = phi.any(1) if border == "free" else np.ones(len(phi), bool)
    precision = np.linalg.inv(block_diag(*covariances)[np.ix_(known, known)])
    dense = np.linalg.inv(phi[known].T @ precision @ phi[known])
    mean = dense @ phi[known].T @ precision @ means.ravel()[known]
    blocks = dense.reshape(T, dim, T, dim)[range(T), :, range(T)]
    ours = trajectory(
        means,
        covariances,
        dt,
        derivatives=derivatives,
        differences=differences,
        border=border,
        scale=2.0,
    )
    np.testing.assert_allclose(ours.mean.ravel(), mean, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(ours.covariance, 2 * blocks, rtol=1e-7, atol=1e-9)


def test_is_tracking_without_effort():
    """Section 6: Eq. 29 is Eq. 34 with R = 0, the first state free."""
    T, dim, dt = 60, 2, 0.1
    means, covariances = some_statistics(T, 2 * dim)
    plan = lqt_batch(means, np.linalg.inv(covariances), integrator(dim, dt), np.zeros((dim, dim)))
    path = trajectory(means, covariances, dt, derivatives=1)
    np.testing.assert_allclose(plan.states[:, :dim], path.mean, rtol=1e-8, atol=1e-8)


def test_without_derivatives_each_step_is_alone():
    means, covariances = some_statistics(5, 2)
    path = trajectory(means, covariances, 0.1, derivatives=0)
    np.testing.assert_allclose(path.mean, means)
    np.testing.assert_allclose(path.covariance, covariances)


def test_moving_mixture_follows_its_state_at_every_step():
    means, covariances = some_statistics(20, 4, seed=1)
    still, _ = some_statistics(20, 4, seed=2)
    both = Gaussian(np.stack([means, still], 1), np.stack([covariances] * 2, 1))
    states = np.zeros(20, int)
    ours = trajectory_of_states(GMM([0.5, 0.5], both), states, 0.1, derivatives=1)
    np.testing.assert_allclose(ours.mean, trajectory(means, covariances, 0.1, derivatives=1).mean)


def test_stationary_reference_is_kept():
    """Where nothing moves, the reference itself is the most likely trajectory."""
    means = np.tile([1.0, -2.0, 0, 0, 0, 0], (30, 1))
    covariances = np.tile(np.diag([1e-2, 1e-2, 1, 1, 10, 10]), (30, 1, 1))
    path = trajectory(means, covariances, 0.01)
    np.testing.assert_allclose(path.mean, means[:, :2], rtol=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (dict(dt=0.0), "positive time step"),
        (dict(derivatives=2), "cannot share equally"),
        (dict(derivatives=-1), "0 or more"),
        (dict(differences="central"), "allowed"),
        (dict(border="open"), "allowed"),
        (dict(covariances=np.zeros((5, 3, 3))), "do not fit"),
        (dict(covariances=np.tile(np.diag([1.0, 1, 1, -1]), (5, 1, 1))), "not positive definite"),
        (dict(means=np.full((5, 4), np.nan)), "NaN"),
        (dict(means=np.zeros((0, 4)), covariances=np.zeros((0, 4, 4))), "1 or more"),
    ],
)
def test_bad_arguments(change, message):
    means, covariances = some_statistics(5, 4)
    arguments = dict(means=means, covariances=covariances, dt=0.1, derivatives=1) | change
    with pytest.raises(ArgumentError, match=message):
        trajectory(**arguments)


@pytest.mark.parametrize("states", [[], [0, 3], [-1], [0.5], [[0]]])
def test_bad_states(states):
    gmm = GMM([0.5, 0.5], Gaussian(*some_statistics(2, 4)))
    with pytest.raises(ArgumentError, match="states must be"):
        trajectory_of_states(gmm, states, 0.1, derivatives=1)
