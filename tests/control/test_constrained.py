"""Tracking within constraints: Riccati where none binds, KKT where they do, what is infeasible."""

import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import (
    Constraint,
    Frame,
    Gaussian,
    LinearSystem,
    constrained_lqt,
    gaussian_product,
    integrator,
    joint_range,
    joint_speed,
    joint_torque,
    lqt,
    lqt_batch,
    receding_horizon,
    state_references,
)
from tpsim.errors import ArgumentError, TpsimError

SYSTEM = integrator(2, 0.1, exact=True)
T = 20


def problem(seed, steps=T, system=SYSTEM, effort=0.05):
    rng = np.random.default_rng(seed)
    n = system.size[0]
    roots = rng.normal(size=(steps, n, n))
    return rng.normal(size=(steps, n)), roots @ roots.mT, system, effort, rng.normal(size=n)


def cost(plan, means, precisions, system, effort, initial):
    away = plan.states - means
    m = system.size[1]
    R = effort * np.eye(m) if np.ndim(effort) == 0 else effort
    return np.einsum("ti,tij,tj", away, precisions, away) + np.einsum(
        "ti,ij,tj", plan.controls, R, plan.controls
    )


def gradient(plan, given, h=1e-6):
    """Slope of the cost in all controls, by central differences through the dynamics."""
    system, initial = given[2], given[4]

    def total(controls):
        states = [np.array(initial)]
        for t, control in enumerate(controls):
            states.append(system.step(states[-1], control, t))
        return cost(type(plan)(np.array(states), controls), *given), np.array(states)

    slope, response = np.zeros(plan.controls.shape), []
    for index in np.ndindex(plan.controls.shape):
        step = np.zeros(plan.controls.shape)
        step[index] = h
        up, down = total(plan.controls + step), total(plan.controls - step)
        slope[index] = (up[0] - down[0]) / (2 * h)
        response.append((up[1] - down[1]) / (2 * h))
    return slope, np.array(response).reshape(*plan.controls.shape, *plan.states.shape)


def limits(scale):
    return [
        joint_range(-1.5 * scale * np.ones(2), np.ones(2) * scale),
        joint_speed([1.5 * scale] * 2),
        joint_torque([4.0 * scale, 3.0 * scale], [[2.0, 0.3], [0.3, 1.0]], [0.1, -0.2]),
    ]


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6), steps=st.integers(1, 30))
def test_where_no_constraint_binds_it_is_riccatis(seed, steps):
    given_ = problem(seed, steps)
    plan = constrained_lqt(*given_, limits(1e4))
    np.testing.assert_allclose(plan.states, lqt_batch(*given_).states, rtol=0, atol=1e-8)
    np.testing.assert_allclose(plan.controls, lqt_batch(*given_).controls, rtol=0, atol=1e-8)
    assert not plan.missed and not any(m.any() for m in plan.multipliers.values())


@pytest.mark.parametrize("seed", range(4))
def test_where_constraints_bind_the_conditions_of_karush_kuhn_and_tucker_hold(seed):
    given_ = problem(seed)
    given_[-1][:] *= 0.2
    few = limits(1.0)
    plan = constrained_lqt(*given_, few)
    slope, response = gradient(plan, given_)
    bound = 0
    for constraint in few:
        C, D, lower, upper = constraint.over(T, 4, 2)
        controls = np.vstack([plan.controls, np.zeros((1, 2))])
        value = np.einsum("tcn,tn->tc", C, plan.states) + np.einsum("tcm,tm->tc", D, controls)
        counts = slice(0, T - 1) if constraint.control is not None else slice(1, T)
        multiplier = plan.multipliers[constraint.name]
        # Primal and dual feasibility, and complementary slackness.
        assert (value[counts] < upper[counts] + 1e-7).all()
        assert (value[counts] > lower[counts] - 1e-7).all()
        size = np.abs(multiplier).max(initial=1.0)
        free = (value < upper - 1e-6) & (value > lower + 1e-6)
        assert np.abs(multiplier[free]).max(initial=0.0) < 1e-8 * size
        assert (multiplier[value > 0.5 * (lower + upper)] >= -1e-8 * size).all()
        assert (multiplier[value < 0.5 * (lower + upper)] <= 1e-8 * size).all()
        bound += np.count_nonzero(np.abs(multiplier) > 1e-6 * size)
        # Stationarity: the slope of the cost is that of the constraints, weighted.
        slope += np.einsum("tc,tcn,sktn->sk", multiplier, C, response)
        slope += np.einsum("tc,tcm->tm", multiplier, D)[:-1]
    assert bound > 5
    assert np.abs(slope).max() < 1e-4


def test_a_system_that_changes_over_time_is_dense_least_squares():
    rng = np.random.default_rng(1)
    A, B = np.eye(3) + 0.2 * rng.normal(size=(7, 3, 3)), rng.normal(size=(7, 3, 2))
    given_ = problem(2, 8, LinearSystem(A, B, 0.1))
    means, precisions, system, effort, initial = given_
    Sx, Su = [np.eye(3)], np.zeros((8, 3, 7, 2))
    for t in range(7):
        Sx.append(A[t] @ Sx[t])
        Su[t + 1] = np.tensordot(A[t], Su[t], 1)
        Su[t + 1, :, t] = B[t]
    flat, Q = Su.reshape(24, 14), np.zeros((8, 3, 8, 3))
    Q[np.arange(8), :, np.arange(8)] = precisions
    Q = Q.reshape(24, 24)
    right = flat.T @ Q @ (means.ravel() - np.concatenate(Sx) @ initial)
    controls = np.linalg.solve(flat.T @ Q @ flat + effort * np.eye(14), right).reshape(7, 2)
    for plan in (
        lqt_batch(*given_, covariance=True),
        lqt(*given_[:-1]).rollout(initial),
        constrained_lqt(*given_, [Constraint("all", [-1e3] * 2, [1e3] * 2, control=np.eye(2))]),
    ):
        np.testing.assert_allclose(plan.controls, controls, atol=1e-9)
    singular = lqt_batch(means, precisions, system, np.diag([0.0, 0.0]), initial)
    np.testing.assert_allclose(
        singular.controls,
        lqt(means, precisions, system, 1e-12).rollout(initial).controls,
        atol=1e-5,
    )
    limited = Constraint("push", [-0.3] * 2, [0.3] * 2, control=np.eye(2))
    plan = constrained_lqt(*given_, [limited])
    assert np.abs(plan.controls).max() < 0.3 + 1e-9
    slope, _ = gradient(plan, given_)
    np.testing.assert_allclose(slope, -plan.multipliers["push"][:-1], atol=1e-4)


def test_what_no_movement_keeps_is_said_and_missed_by_as_little_as_can_be():
    means, precisions = np.tile([1.0, 0.0], (10, 1)), np.tile(np.eye(2), (10, 1, 1))
    system = integrator(1, 0.1, exact=True)
    weak = Constraint("push", [-1.0], [1.0], control=np.eye(1))
    there = Constraint("there", [0.8], [np.inf], state=[[1.0, 0.0]])
    given_ = means, precisions, system, 0.1, np.zeros(2)
    with pytest.raises(ArgumentError, match=r"misses 'there' \(by 0.795 from step 1\)"):
        constrained_lqt(*given_, [weak, there])
    plan = constrained_lqt(*given_, [weak, there], infeasible="relax")
    # The push is kept, and does all it can: 0.8 is out of its reach at every step.
    np.testing.assert_allclose(plan.controls[:-1], 1.0, atol=1e-3)
    assert set(plan.missed) == {"there"}
    assert plan.missed["there"] == pytest.approx(0.8 - 0.005, abs=1e-3)
    against = Constraint("back", [-2.0], [-1.5], control=np.eye(1))
    with pytest.raises(ArgumentError, match=r"'push'.*'back'"):
        constrained_lqt(*given_, [weak, against])


def test_bad_constraints_are_refused():
    given_ = problem(0)
    for constraint, message in (
        (lambda: Constraint("none", [0.0], [1.0]), "limits nothing"),
        (lambda: Constraint("crossed", [1.0], [0.0], control=np.eye(1)), "above its upper"),
        (lambda: Constraint("odd", [0.0], [1.0], control=np.eye(2)), "has shapes"),
        (lambda: Constraint("nan", [np.nan], [1.0], control=np.eye(1)), "NaN"),
        (lambda: joint_speed([1.0, 1.0, 1.0]), "for 20 steps, 4 states"),
    ):
        with pytest.raises(ArgumentError, match=message):
            constrained_lqt(*given_, [constraint()])
    with pytest.raises(ArgumentError, match="name of its own"):
        constrained_lqt(*given_, [joint_speed([1.0, 1.0])] * 2)
    with pytest.raises(ArgumentError, match="for 7 steps"):
        lqt(*problem(0, 9, LinearSystem(np.ones((7, 2, 2)), np.ones((2, 1)), 0.1))[:-1])


def test_a_moving_goal_is_followed_within_limits_and_what_is_missed_is_said():
    """Receding horizon: the limit binds, is kept, and a wall that the goal is behind is missed."""
    system = integrator(1, 0.1, exact=True)
    precision = np.tile(np.diag([100.0, 0.0]), (12, 1, 1))
    push = Constraint("push", [-1.0], [1.0], control=np.eye(1))

    def moving(t, state):
        return np.tile([1.0 if t < 20 else -1.0, 0.0], (12, 1)), precision

    given_ = moving, system, 1e-2, np.zeros(2), 90
    online = receding_horizon(*given_, constraints=[push, joint_speed([0.4])])
    assert np.abs(online.controls).max() == pytest.approx(1.0, abs=1e-6)
    assert np.abs(online.states[:, 1]).max() == pytest.approx(0.4, abs=1e-6)
    assert online.states[-1, 0] == pytest.approx(-1.0, abs=0.01) and not online.missed
    free = receding_horizon(*given_)
    wide = receding_horizon(*given_, constraints=[joint_speed([100.0])])
    np.testing.assert_allclose(wide.states, free.states, atol=1e-8)
    shaken = receding_horizon(
        moving, lambda t, state: system, 1e-2, [0.0, 3.0], 20,
        constraints=lambda t, state: [push, joint_range([-0.2], [0.2])],
    )  # fmt: skip
    assert set(shaken.missed) == {"joint range"} and np.abs(shaken.controls).max() < 1 + 1e-6


@pytest.mark.parametrize(
    ("reference", "options", "message"),
    [
        (len, {}, "reference cannot be called as reference"),
        (lambda t, state: 3, {}, "reference returned a int"),
        (None, {"constraints": len}, "constraints cannot be called as constraints"),
    ],
)
def test_functions_that_answer_wrongly_are_named(reference, options, message):
    told = reference or (lambda t, state: (np.zeros((5, 4)), np.tile(np.eye(4), (5, 1, 1))))
    with pytest.raises(ArgumentError, match=message):
        receding_horizon(told, SYSTEM, 0.1, np.zeros(4), 3, **options)


def test_coordinate_systems_have_state_sequences_of_their_own():
    """Eq. (38): the sum of what each asks for along its own states."""
    rng = np.random.default_rng(0)
    roots = rng.normal(size=(2, 3, 4, 4))
    models = [Gaussian(rng.normal(size=(3, 4)), r @ r.mT + np.eye(4)) for r in roots]
    sequences = [np.array([0, 0, 1, 2]), np.array([2, 2, 2, 0])]
    turned = Frame(np.array([[0.0, -1.0], [1.0, 0.0]]), [0.5, 0.2]).with_derivatives(1)
    frames = [turned, Frame(np.eye(4), np.zeros(4))]
    means, precisions = state_references(models, sequences, frames)
    total, wanted = precisions.sum(0), (precisions @ means[..., None]).sum(0)
    for t in range(4):
        product = gaussian_product(
            [
                model[s[t]].affine(f.A, f.b)
                for model, s, f in zip(models, sequences, frames, strict=True)
            ]
        )
        np.testing.assert_allclose(total[t], product.precision, rtol=1e-9)
        np.testing.assert_allclose(np.linalg.solve(total[t], wanted[t])[:, 0], product.mean)
    with pytest.raises(ArgumentError, match=r"sequences\[1\] visit no state"):
        state_references(models, [sequences[0], np.array([], int)])
    with pytest.raises(ArgumentError, match="has 3 at step 1"):
        state_references(models[0], [np.array([0, 3])])


def test_a_missing_solver_is_one_line_that_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "qpsolvers", None)
    given_ = problem(0)
    constrained_lqt(*given_, limits(1e4))  # where nothing binds none is needed
    with pytest.raises(TpsimError, match=r"pip install 'tpsim\[constraints\]'"):
        constrained_lqt(*given_, limits(1.0))


def test_a_frame_of_other_coordinates_than_its_states_is_named():
    state = Gaussian(np.zeros((2, 2)), np.tile(np.eye(2), (2, 1, 1)))
    with pytest.raises(ArgumentError, match=r"frames\[0\] is of 1 local coordinates"):
        state_references([state], [[0, 1, 1]], [Frame(np.eye(1), np.zeros(1))])
    wide = Frame(np.eye(3, 2), np.zeros(3))
    assert state_references([state], [[0, 1, 1]], [wide])[0].shape == (1, 3, 3)
