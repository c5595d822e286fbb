import numpy as np
import pytest

from tpsim import damping_of, spring_damper
from tpsim.errors import ArgumentError


def test_undamped_spring_is_a_cosine():
    dt, stiffness = 1e-4, 25.0
    plan = spring_damper(np.zeros((10000, 1)), stiffness, 0.0, dt, [1.0, 0.0])
    time = dt * np.arange(1, 10001)
    np.testing.assert_allclose(plan.states[:, 0], np.cos(5.0 * time), atol=2e-3)


@pytest.mark.parametrize(("ratio", "overshoots"), [(0.3, True), (1.0, False), (2.0, False)])
def test_damping_ratio_decides_on_overshoot(ratio, overshoots):
    plan = spring_damper(np.ones((2000, 1)), 50.0, damping_of(50.0, ratio), 1e-3, [0.0, 0.0])
    assert (plan.states[:, 0].max() > 1.0 + 1e-9) is np.bool_(overshoots)


def test_matrix_gains_turn_with_the_frame():
    rng = np.random.default_rng(0)
    R, _ = np.linalg.qr(rng.normal(size=(2, 2)))
    K, D, targets = np.diag([50.0, 5.0]), np.diag([10.0, 3.0]), rng.normal(size=(30, 2))
    plain = spring_damper(targets, K, D, 0.01)
    turned = spring_damper(targets @ R.T, R @ K @ R.T, R @ D @ R.T, 0.01)
    np.testing.assert_allclose(turned.states[:, :2], plain.states[:, :2] @ R.T, atol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((np.zeros(3), 1.0, 1.0, 0.1), "targets"),
        ((np.zeros((3, 1)), 1.0, 1.0, 0.0), "positive step"),
        ((np.zeros((3, 1)), np.eye(2), 1.0, 0.1), "stiffness has shape"),
        ((np.zeros((3, 1)), 1.0, 1.0, 0.1, [0.0]), "position and velocity"),
        ((np.ones((3000, 1)), 1e9, 0.0, 0.1, [0.0, 0.0]), "diverges"),
    ],
)
def test_bad_input_is_refused(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        spring_damper(*arguments)


def test_negative_stiffness_has_no_damping():
    with pytest.raises(ArgumentError, match="negative"):
        damping_of(-1.0)
