from pathlib import Path

import numpy as np
import pytest

from tpsim import impedance, impedance_of, integrator, lqr, lqt, spring_damper
from tpsim.errors import ArgumentError

FIGURES = np.load(Path(__file__).parents[1] / "reference" / "ds_lqr.npz")
CHAIN = integrator(2)
DT, EFFORT = 0.01, 1e-2


def spd(rng, n, *leading):
    root = rng.normal(size=(*leading, n, n))
    return root @ root.mT + 0.1 * np.eye(n)


def riccati_gains(precision, effort):
    n = len(precision)
    Q = np.zeros((2 * n, 2 * n))
    Q[:n, :n] = precision
    return impedance_of(lqr(integrator(n), Q, effort, discrete=False))


@pytest.mark.parametrize("n", [1, 2, 3, 7])
def test_closed_form_is_the_riccati_solution(n):
    rng = np.random.default_rng(n)
    precision = spd(rng, n)
    for effort in (0.03, spd(rng, n)):
        for ours, riccati in zip(
            impedance(precision, effort), riccati_gains(precision, effort), strict=True
        ):
            np.testing.assert_allclose(ours, riccati, atol=1e-8 * np.abs(riccati).max())


def test_the_roots_are_roots():
    rng = np.random.default_rng(0)
    precision = spd(rng, 3, 5)
    stiffness, damping = impedance(precision, 0.1)
    np.testing.assert_allclose(stiffness @ stiffness, precision / 0.1, atol=1e-10)
    np.testing.assert_allclose(damping @ damping, 2 * stiffness, atol=1e-10)


def test_inertia_as_effort_gives_a_symmetric_physical_stiffness():
    rng = np.random.default_rng(1)
    precision, M = spd(rng, 4), spd(rng, 4)
    stiffness, _ = impedance(precision, 0.5 * M)
    np.testing.assert_allclose(M @ stiffness, (M @ stiffness).T, atol=1e-10)
    assert np.abs(stiffness - stiffness.T).max() > 1e-3


def test_a_direction_without_precision_is_free():
    axis = np.array([0.6, 0.8])
    stiffness, damping = impedance(np.eye(2) - np.outer(axis, axis), 1e-2)
    np.testing.assert_allclose(stiffness @ axis, 0.0, atol=1e-7)
    np.testing.assert_allclose(damping @ axis, 0.0, atol=1e-3)
    zero, _ = impedance(np.zeros((2, 2)), 1.0)
    np.testing.assert_array_equal(zero, 0.0)


def test_feedback_far_from_the_end_is_the_closed_form():
    precision = np.array([[4.0, 1.0], [1.0, 2.0]])
    gaps = []
    for dt in (0.02, 0.01):
        T = int(10 / dt)
        precisions = np.zeros((T, 4, 4))
        precisions[:, :2, :2] = precision
        stiffness, damping = impedance_of(
            lqt(np.zeros((T, 4)), precisions, integrator(2, dt), EFFORT)
        )
        K, D = impedance(precision, EFFORT)
        gaps.append(np.abs(stiffness[0] - K).max() + np.abs(damping[0] - D).max())
    assert gaps[1] < 0.6 * gaps[0]
    assert gaps[1] < 0.15 * np.abs(K).max()


@pytest.mark.parametrize("situation", [0, 1])
def test_reference_paths_with_constant_and_optimal_gains(situation):
    targets = FIGURES["yG"][..., situation].T
    precision = np.linalg.inv(np.moveaxis(FIGURES["SG"][..., situation], 2, 0))
    start = np.r_[FIGURES["bt"][1:, 0, situation], 0.0, 0.0]
    constant = spring_damper(targets, 100.0, np.sqrt(200.0), DT, start)
    np.testing.assert_allclose(constant.states[:, :2], FIGURES["ds"][..., situation].T, rtol=1e-9)
    K, D = impedance(precision, EFFORT)
    optimal = spring_damper(targets, K, D, DT, start)
    np.testing.assert_allclose(optimal.states[:, :2], FIGURES["li"][..., situation].T, rtol=1e-9)
    np.testing.assert_allclose(np.linalg.det(K), FIGURES["li_kp"][:, situation], rtol=1e-8)
    np.testing.assert_allclose(np.linalg.det(D), FIGURES["li_kv"][:, situation], rtol=1e-8)


@pytest.mark.parametrize("situation", [0, 1])
def test_reference_finite_horizon_is_an_euler_riccati_equation(situation):
    """The reference integrates the continuous Riccati equation backwards by explicit Euler.

    Its gains and feedforward follow from that; ours are the exact optimum of the discrete cost,
    from which they differ by the step.
    """
    targets = FIGURES["yG"][..., situation].T
    T = len(targets)
    reference = np.c_[targets, np.zeros((T, 2))]
    rate = np.c_[np.gradient(targets, axis=0) / DT, np.zeros((T, 2))]
    Q = np.zeros((T, 4, 4))
    Q[:, :2, :2] = np.linalg.inv(np.moveaxis(FIGURES["SG"][..., situation], 2, 0))
    A, B = CHAIN.A, CHAIN.B
    P, d = np.zeros((T, 4, 4)), np.zeros((T, 4))
    for t in range(T - 1, 0, -1):
        G = P[t] @ B @ B.T / EFFORT
        P[t - 1] = P[t] + DT * (Q[t] - G @ P[t] + P[t] @ A + A.T @ P[t])
        d[t - 1] = d[t] + DT * ((A.T - G) @ d[t] - P[t] @ (A @ reference[t] - rate[t]))
    gain, feedforward = B.T @ P / EFFORT, d @ B / EFFORT
    # Semi-implicit Euler: the velocity moves first, so the position sees its new value.
    state, path = np.r_[FIGURES["bt"][1:, 0, situation], 0.0, 0.0], []
    for t in range(T):
        state[2:] += DT * (gain[t] @ (reference[t] - state) + feedforward[t])
        state[:2] += DT * state[2:]
        path.append(state[:2].copy())
    np.testing.assert_allclose(path, FIGURES["lf"][..., situation].T, rtol=1e-9)
    np.testing.assert_allclose(
        np.linalg.det(gain[:, :, :2]), FIGURES["lf_kp"][:, situation], rtol=1e-8, atol=1e-8
    )
    ours, _ = impedance_of(lqt(reference, Q, integrator(2, DT), EFFORT))
    early = np.linalg.norm(ours[:100] - gain[:100, :, :2], axis=(1, 2))
    assert (early < 0.3 * np.linalg.norm(gain[:100, :, :2], axis=(1, 2))).all()


@pytest.mark.parametrize(
    ("precision", "effort", "message"),
    [
        (np.ones(3), 1.0, "square"),
        (np.diag([1.0, -1.0]), 1.0, "indefinite"),
        (np.full((2, 2), np.inf), 1.0, "infinite"),
        (np.eye(2) + np.eye(2, k=1), 1.0, "not symmetric"),
        (np.eye(2), np.ones(3), "over time"),
        (np.eye(2), 0.0, "positive number"),
        (np.eye(2), np.diag([1.0, 0.0]), "positive definite"),
        (np.eye(2), np.eye(3), "not usable"),
    ],
)
def test_bad_input_is_refused(precision, effort, message):
    with pytest.raises(ArgumentError, match=message):
        impedance(precision, effort)


def test_gains_of_another_chain_have_no_stiffness():
    with pytest.raises(ArgumentError, match="order=2"):
        impedance_of(lqr(integrator(2, 0.1, order=1), np.eye(2), 1.0))
