"""Tracking: batch = recursive = dense least squares, and the reference's figures."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import LinearSystem, integrator, lqt, lqt_batch, receding_horizon, trajectory
from tpsim.errors import ArgumentError

REFERENCE = Path(__file__).parents[1] / "reference"
FIGURES = np.load(REFERENCE / "lqt.npz")
EXACT = integrator(2, 0.01, exact=True)


def close(ours, theirs, tolerance=1e-8):
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=tolerance * np.abs(theirs).max())


def random_problem(seed, T, n=4, rank=None):
    rng = np.random.default_rng(seed)
    roots = rng.normal(size=(T, n, rank or n))
    return rng.normal(size=(T, n)), roots @ roots.mT, rng.normal(size=n)


def transfer(system, T):
    """The dense matrices S^xi (T n, n) and S^u (T n, (T - 1) m) of Eq. 35."""
    n, m = system.B.shape
    powers = [np.linalg.matrix_power(system.A, k) for k in range(T)]
    Su = np.zeros((T, n, T - 1, m))
    for t in range(1, T):
        for k in range(t):
            Su[t, :, k] = powers[t - 1 - k] @ system.B
    return np.concatenate(powers), Su.reshape(T * n, (T - 1) * m)


def dense(means, precisions, system, R, initial):
    """Eq. 37 as printed: states, controls and the blocks of S^u H^-1 S^u'."""
    T, n = means.shape
    m = system.B.shape[1]
    Sx, Su = transfer(system, T)
    Q = np.zeros((T, n, T, n))
    Q[np.arange(T), :, np.arange(T)] = precisions
    Q = Q.reshape(T * n, T * n)
    H = Su.T @ Q @ Su + np.kron(np.eye(T - 1), R)
    U = np.linalg.solve(H, Su.T @ Q @ (means.ravel() - Sx @ initial))
    spread = (Su @ np.linalg.solve(H, Su.T)).reshape(T, n, T, n)
    states = (Sx @ initial + Su @ U).reshape(T, n)
    return states, U.reshape(T - 1, m), spread[np.arange(T), :, np.arange(T)]


@pytest.mark.parametrize("i", range(3))
def test_reference_figures_of_a_stepwise_reference(i):
    """Efforts 1e-2, 1e-4 and 1e-8: batch, recursive gains and roll-out."""
    sequence = FIGURES["qs"][0].astype(int) - 1
    means = FIGURES["muK"].T[sequence]
    precisions = np.linalg.inv(np.moveaxis(FIGURES["SigK"], 2, 0))[sequence]
    problem = means, precisions, EXACT, FIGURES["r_list"][0, i]
    initial = FIGURES["x0"][:, 0]
    feedback = lqt(*problem)
    close(feedback.gain[:-1], np.moveaxis(FIGURES["KR"][..., i], 2, 0))
    for plan in (lqt_batch(*problem, initial), feedback.rollout(initial)):
        close(plan.states, FIGURES["xB"][..., i].T)
        close(plan.controls, FIGURES["uB"][..., i].T)
    if i == 0:
        close(feedback.covariance(), np.moveaxis(FIGURES["xCov"], 2, 0))


def test_reference_figures_of_via_points():
    means, precisions = np.zeros((100, 4)), np.zeros((100, 4, 4))
    for t, point in zip(FIGURES["tl"][0].astype(int) - 1, FIGURES["kp"].T, strict=True):
        means[t, :2], precisions[t, :2, :2] = point, np.eye(2)
    plan = lqt_batch(means, precisions, EXACT, 1e-8, np.zeros(4))
    close(plan.states, FIGURES["x_key"].T)
    close(plan.controls, FIGURES["u_key"].T)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_reference_integrators(order):
    system = integrator(2, 0.01, order, exact=True)
    np.testing.assert_allclose(system.A, FIGURES[f"Ad_{order}"], atol=1e-16)
    np.testing.assert_allclose(system.B, FIGURES[f"Bd_{order}"], atol=1e-16)


@pytest.mark.parametrize("situation", range(4))
def test_reference_task_parameterized_tracking(situation):
    """Eq. 38. The reference carries precision as A Λ A' instead of inv(A)' Λ inv(A).

    With A = sqrt(0.1) R this weighs a hundredth, as if the effort were a hundred times larger:
    with the fault put in its figures come out, and 0.04 to 0.16 m away is the optimum.
    """
    data = np.load(REFERENCE / "tp_lqt.npz")
    A, b = data["A"][situation][:, None], data["b"][situation][:, None]
    sequence = data["sequence"]
    means = (A @ data["means"][..., None])[..., 0] + b
    local = np.linalg.inv(data["covariances"])
    at_fault, right = A @ local @ A.mT, np.linalg.inv(A).mT @ local @ np.linalg.inv(A)
    theirs = data["states"][situation]
    arguments = EXACT, 1e-3, data["initial"]
    close(lqt_batch(means[:, sequence], at_fault[:, sequence], *arguments).states, theirs)
    ours = lqt_batch(means[:, sequence], right[:, sequence], *arguments).states
    assert 0.03 < np.abs(ours - theirs)[:, :2].max() < 0.2


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    T=st.integers(1, 12),
    order=st.integers(1, 3),
    rank=st.integers(1, 3),
    effort=st.sampled_from([1e-4, 1.0]),
)
def test_batch_and_recursion_are_dense_least_squares(seed, T, order, rank, effort):
    system = integrator(1, 0.5, order, exact=bool(seed % 2))
    means, precisions, initial = random_problem(seed, T, order, min(rank, order))
    states, controls, spread = dense(means, precisions, system, effort * np.eye(1), initial)
    batch = lqt_batch(means, precisions, system, effort, initial, covariance=True)
    for plan in (batch, lqt(means, precisions, system, effort).rollout(initial)):
        np.testing.assert_allclose(plan.states, states, atol=1e-8)
        np.testing.assert_allclose(plan.controls, controls, atol=1e-8)
    np.testing.assert_allclose(batch.covariance, spread, atol=1e-8)


def test_a_covariance_stays_symmetric_where_positions_count_a_million_times_more():
    roots = np.random.default_rng(0).normal(size=(200, 4, 4)) * np.array([1e3, 1e3, 1, 1])[:, None]
    covariance = lqt(np.zeros((200, 4)), roots @ roots.mT, EXACT, 1e-4).covariance()
    close(covariance.mT, covariance, 1e-14)


def test_any_system_and_matrix_effort():
    rng = np.random.default_rng(3)
    system = LinearSystem(rng.normal(size=(4, 4)) / 2, rng.normal(size=(4, 2)), 1.0)
    root = rng.normal(size=(2, 2))
    R = root @ root.T + 0.1 * np.eye(2)
    means, precisions, initial = random_problem(3, 10)
    states, controls, _ = dense(means, precisions, system, R, initial)
    varying = np.broadcast_to(R, (10, 2, 2))
    for effort in (R, varying):
        close(lqt_batch(means, precisions, system, effort, initial).controls, controls)
        close(lqt(means, precisions, system, effort).rollout(initial).states, states)


def test_long_horizon_batch_equals_recursion():
    system = integrator(3, 0.01)
    means, precisions, initial = random_problem(0, 2000, 6)
    feedback = lqt(means, precisions, system, 1e-2)
    batch = lqt_batch(means, precisions, system, 1e-2, initial)
    close(feedback.rollout(initial).states, batch.states)
    close(feedback.rollout(initial).controls, batch.controls)


def test_via_points_are_passed_and_nothing_else_is_asked():
    system, T = integrator(2, 0.01), 400
    means, precisions = np.full((T, 4), 7.0), np.zeros((T, 4, 4))
    points = {150: [1.0, 2.0], 399: [-1.0, 0.5]}
    for t, point in points.items():
        means[t, :2], precisions[t, :2, :2] = point, 1e6 * np.eye(2)
    plan = lqt_batch(means, precisions, system, 1e-6, np.zeros(4))
    for t, point in points.items():
        np.testing.assert_allclose(plan.states[t, :2], point, atol=1e-6)
    assert np.abs(plan.states[:, :2]).max() < 3.0
    close(lqt(means, precisions, system, 1e-6).rollout(np.zeros(4)).states, plan.states)


def test_several_coordinate_systems_are_the_product_of_their_gaussians():
    """Eq. 38: the information of all frames in one sum, and the two-step form of Section 6."""
    first, second = random_problem(1, 8), random_problem(2, 8)
    means, precisions = np.stack([first[0], second[0]]), np.stack([first[1], second[1]])
    total = precisions.sum(axis=0)
    product = np.linalg.solve(total, (precisions @ means[..., None]).sum(axis=0))[..., 0]
    several = lqt(means, precisions, EXACT, 0.1)
    one = lqt(product, total, EXACT, 0.1)
    close(several.gain, one.gain)
    close(several.feedforward, one.feedforward)


def test_singular_effort_where_precision_determines_the_control():
    system = integrator(1, 0.5, exact=True)
    means, precisions, initial = random_problem(5, 9, 2)
    states, _, _ = dense(means, precisions, system, np.zeros((1, 1)), initial)
    close(lqt(means, precisions, system, 0.0).rollout(initial).states, states)
    close(lqt_batch(means, precisions, system, 0.0, initial).states, states)


def test_free_start_minimises_over_the_first_state_too():
    system, T = integrator(1, 0.5), 7
    means, precisions, _ = random_problem(6, T, 2)
    plan = lqt_batch(means, precisions, system, 0.3)
    Sx, Su = transfer(system, T)
    Q = np.zeros((T, 2, T, 2))
    Q[np.arange(T), :, np.arange(T)] = precisions
    S, Q = np.hstack([Sx, Su]), Q.reshape(2 * T, 2 * T)
    cost = np.diag(np.r_[np.zeros(2), 0.3 * np.ones(T - 1)])
    solution = np.linalg.solve(S.T @ Q @ S + cost, S.T @ Q @ means.ravel())
    close(plan.states[0], solution[:2])
    close(plan.controls[:, 0], solution[2:])


def test_trajectory_retrieval_is_tracking_with_zero_effort():
    """Section 6 on Eq. 29: same least squares when acceleration is free and so is the start."""
    rng = np.random.default_rng(9)
    T, dt = 40, 0.1
    roots = rng.normal(size=(T, 4, 4))
    covariances = roots @ roots.mT + 0.1 * np.eye(4)
    means = np.cumsum(rng.normal(size=(T, 4)), axis=0)
    retrieved = trajectory(means, covariances, dt, derivatives=1)
    plan = lqt_batch(means, np.linalg.inv(covariances), integrator(2, dt), 0.0)
    close(plan.states[:, :2], retrieved.mean)
    velocity = np.diff(retrieved.mean, axis=0) / dt
    close(plan.states[:-1, 2:], velocity)


def test_shrinking_horizon_is_the_plan_and_a_moved_frame_is_followed():
    system, T = integrator(1, 0.1), 30
    means, precisions, initial = random_problem(7, T, 2)
    online = receding_horizon(
        lambda t, state: (means[t:], precisions[t:]), system, 0.1, initial, T - 1
    )
    close(online.states, lqt_batch(means, precisions, system, 0.1, initial).states)

    def goal(t, state):
        """An object at 1 that jumps to -1 at step 40, seen over half a second."""
        target = np.array([1.0 if t < 40 else -1.0, 0.0])
        return np.tile(target, (50, 1)), np.tile(np.diag([100.0, 1.0]), (50, 1, 1))

    path = receding_horizon(goal, system, 1e-2, np.zeros(2), 100).states
    assert path[39, 0] == pytest.approx(1.0, abs=0.02)
    assert path[-1, 0] == pytest.approx(-1.0, abs=0.02)


def test_feedback_answers_a_disturbed_state_as_a_new_plan_would():
    means, precisions, initial = random_problem(8, 12)
    feedback = lqt(means, precisions, EXACT, 0.1)
    disturbed = initial + 1.0
    again = lqt_batch(means[5:], precisions[5:], EXACT, 0.1, disturbed)
    close(feedback.control(5, disturbed), again.controls[0])


def test_horizon_of_one_step_has_no_control():
    feedback = lqt(np.ones((1, 4)), np.eye(4)[None], EXACT, 0.1)
    np.testing.assert_array_equal(feedback.gain, np.zeros((1, 2, 4)))
    for plan in (
        feedback.rollout(np.ones(4)),
        lqt_batch(np.ones((1, 4)), np.eye(4)[None], EXACT, 0.1, np.ones(4)),
    ):
        np.testing.assert_array_equal(plan.states, np.ones((1, 4)))
        assert plan.controls.shape == (0, 2)


MEANS, PRECISIONS = np.zeros((5, 4)), np.tile(np.eye(4), (5, 1, 1))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"means": np.zeros((5, 3))}, "means have shape"),
        ({"means": np.zeros((0, 4)), "precisions": np.zeros((0, 4, 4))}, "means have shape"),
        ({"precisions": PRECISIONS[:4]}, "precisions"),
        ({"precisions": -PRECISIONS}, "semi-definite"),
        ({"precisions": PRECISIONS + np.eye(4, k=1)}, "symmetric"),
        ({"means": MEANS * np.nan}, "NaN"),
        ({"effort": -1.0}, "effort is not"),
        ({"effort": np.eye(3)}, "effort has shape"),
        ({"effort": 0.0, "precisions": 0 * PRECISIONS}, "undetermined"),
        ({"system": integrator(2)}, "continuous"),
        ({"initial": np.zeros(3)}, "of 4 finite"),
        ({"initial": None, "precisions": 0 * PRECISIONS}, "free first state"),
    ],
)
def test_bad_input_is_refused(change, message):
    arguments = {
        "means": MEANS,
        "precisions": PRECISIONS,
        "system": EXACT,
        "effort": 0.1,
        "initial": np.zeros(4),
    } | change
    with pytest.raises(ArgumentError, match=message):
        lqt_batch(**arguments)
    if "initial" not in change:
        arguments.pop("initial")
        with pytest.raises(ArgumentError, match=message):
            lqt(**arguments)
