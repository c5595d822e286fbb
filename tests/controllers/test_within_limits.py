"""Joints at their limits: the others do what a precision asks, as far as they can."""

import numpy as np
import pytest

from tpsim.controllers.within_limits import nearest_within
from tpsim.gaussian import Gaussian

N = 5
FREE = np.full(N, np.inf)


@pytest.fixture
def root():
    return np.random.default_rng(0).normal(size=(N, N))


def test_a_step_within_the_limits_is_made_as_it_is(root):
    step = np.linspace(-1.0, 1.0, N)
    assert nearest_within(step, root, step - 0.1, step + 0.1) is step


def test_one_joint_at_its_limit_is_the_gaussian_conditioned_on_it(root):
    step, upper = np.ones(N), FREE.copy()
    upper[3] = 0.4
    found = nearest_within(step, root, -FREE, upper)
    others = [0, 1, 2, 4]
    given = Gaussian(step, np.linalg.inv(root.T @ root)).condition(np.array([0.4]), [3])
    assert found[3] == pytest.approx(0.4)
    np.testing.assert_allclose(found[others], given.mean, rtol=1e-8)


def test_what_is_precise_is_kept_by_the_joints_that_have_room():
    """Two joints whose sum is a thousand times as precise as their difference."""
    root = np.array([[1e3, 1e3], [1.0, -1.0]])
    found = nearest_within(np.array([0.5, 0.5]), root, -FREE[:2], np.array([0.2, np.inf]))
    np.testing.assert_allclose(found, [0.2, 0.8], atol=1e-5)


def test_no_step_within_the_limits_is_more_likely(root):
    rng = np.random.default_rng(1)
    lower, upper = -np.full(N, 0.3), np.full(N, 0.5)
    for _ in range(20):
        step = rng.normal(size=N)
        found = nearest_within(step, root, lower, upper)
        assert (lower - 1e-12 <= found).all() and (found <= upper + 1e-12).all()
        others = rng.uniform(lower, upper, (200, N))
        costs = np.linalg.norm((others - step) @ root.T, axis=1)
        assert np.linalg.norm(root @ (found - step)) <= costs.min() + 1e-9
