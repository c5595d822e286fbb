from math import factorial

import numpy as np
import pytest
from scipy.linalg import expm

from tpsim import LinearSystem, integrator
from tpsim.errors import ArgumentError


def test_double_integrator_is_eq_33():
    system = integrator(2, 0.1)
    I, O = np.eye(2), np.zeros((2, 2))
    np.testing.assert_array_equal(system.A, np.block([[I, 0.1 * I], [O, I]]))
    np.testing.assert_array_equal(system.B, np.vstack([O, 0.1 * I]))
    assert system.dt == 0.1


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_exact_chain_is_the_matrix_exponential(order):
    continuous, exact = integrator(2, None, order), integrator(2, 0.3, order, exact=True)
    n = 2 * order
    held = np.zeros((n + 2, n + 2))
    held[:n, :n], held[:n, n:] = continuous.A, continuous.B
    held = expm(0.3 * held)
    np.testing.assert_allclose(exact.A, held[:n, :n], atol=1e-14)
    np.testing.assert_allclose(exact.B, held[:n, n:], atol=1e-14)


def test_euler_chain_converges_to_the_exact_one():
    gaps = []
    for steps in (10, 100):
        euler, state = integrator(1, 1.0 / steps, 3), np.zeros(3)
        for _ in range(steps):
            state = euler.step(state, np.ones(1))
        gaps.append(abs(state[0] - 1 / factorial(3)))
    assert gaps[1] < 0.12 * gaps[0]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: integrator(0, 0.1), "at least 1"),
        (lambda: integrator(2, 0.1, order=0), "at least 1"),
        (lambda: integrator(2, -0.1), "positive step"),
        (lambda: LinearSystem(np.eye(2), np.ones(2), 0.1), "give A"),
        (lambda: LinearSystem(np.eye(2) * np.nan, np.ones((2, 1)), 0.1), "NaN"),
    ],
)
def test_bad_systems_are_refused(make, message):
    with pytest.raises(ArgumentError, match=message):
        make()
