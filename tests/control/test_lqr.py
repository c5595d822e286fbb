from pathlib import Path

import numpy as np
import pytest

from tpsim import integrator, lqr, lqt
from tpsim.errors import ArgumentError

FIGURES = np.load(Path(__file__).parents[1] / "reference" / "lqr.npz")


@pytest.mark.parametrize("case", range(24))
def test_reference_figures(case):
    """Discrete and continuous regulators of chains of order 1-3, positions or all penalised."""
    order, dim = (int(FIGURES[f"{k}_{case}"].item()) for k in ("nd", "np"))
    effort, dt = (FIGURES[f"{k}_{case}"].item() for k in ("r", "dt"))
    Q = FIGURES[f"Q_{case}"]
    discrete = lqr(integrator(dim, dt, order, exact=True), Q, effort)
    continuous = lqr(integrator(dim, None, order), Q, effort, discrete=False)
    for ours, name in (
        (discrete.riccati, "Pd"),
        (discrete.gain, "Ld"),
        (continuous.riccati, "Pc"),
        (continuous.gain, "Lc"),
    ):
        theirs = FIGURES[f"{name}_{case}"]
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-8 * np.abs(theirs).max())


@pytest.mark.parametrize(("order", "effort"), [(1, 1e-2), (2, 1e-2), (2, np.diag([1e-3, 1e-1]))])
def test_long_horizon_tracking_tends_to_the_regulator(order, effort):
    system = integrator(2, 0.05, order)
    n = 2 * order
    rng = np.random.default_rng(0)
    root = rng.normal(size=(n, n))
    precision, target = root @ root.T + np.eye(n), np.r_[1.0, -2.0, np.zeros(n - 2)]
    T = 600
    feedback = lqt(np.tile(target, (T, 1)), np.tile(precision, (T, 1, 1)), system, effort)
    regulator = lqr(system, precision, effort)
    scale = np.abs(regulator.gain).max()
    np.testing.assert_allclose(feedback.gain[0], regulator.gain, atol=1e-8 * scale)
    np.testing.assert_allclose(feedback.feedforward[0], regulator.gain @ target, atol=1e-8 * scale)


def test_riccati_is_the_cost_to_go():
    system, Q, R = integrator(1, 0.1), np.diag([3.0, 0.5]), 0.2
    regulator = lqr(system, Q, R)
    start = np.array([1.0, -1.0])
    state, cost = start, 0.0
    for _ in range(400):
        control = -regulator.gain @ state
        cost += state @ Q @ state + R * control @ control
        state = system.step(state, control)
    assert cost == pytest.approx(start @ regulator.riccati @ start, rel=1e-10)


def test_leading_axes_broadcast_and_pairs_are_systems():
    system = integrator(1, 0.1)
    Q = np.stack([np.diag([k, 1.0]) for k in (1.0, 2.0, 3.0)])
    stacked = lqr((system.A, system.B), Q, 0.1)
    assert stacked.gain.shape == (3, 1, 2)
    np.testing.assert_array_equal(stacked.gain[1], lqr(system, Q[1], 0.1).gain)


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        ((integrator(1, 0.1), np.eye(3), 1.0), {}, "Q has shape"),
        ((integrator(1, 0.1), np.diag([1.0, -1.0]), 1.0), {}, "indefinite"),
        ((integrator(1, 0.1), np.eye(2), 0.0), {}, "not positive definite"),
        ((integrator(1, 0.1), np.eye(2), np.nan), {}, "NaN"),
        ((integrator(1, 0.1), np.zeros((2, 2)), 1.0), {}, "no stabilising"),
        ((integrator(1, 0.1), np.eye(2), 1.0), {"discrete": False}, "is discrete"),
        ((integrator(1), np.eye(2), 1.0), {}, "is continuous"),
    ],
)
def test_bad_input_is_refused(arguments, options, message):
    with pytest.raises(ArgumentError, match=message):
        lqr(*arguments, **options)
