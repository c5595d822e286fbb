"""What springs may pull beside brakes."""

import numpy as np

from tpsim.controllers.torque_cost import share_within


def test_springs_and_brakes_together_stay_within_the_bound_and_brakes_are_no_burden():
    rng = np.random.default_rng(0)
    for _ in range(300):
        weights = rng.uniform(0.01, 1.0, 6)
        pull, brake = 5 * rng.normal(size=(2, 6))
        brake *= rng.uniform(0, 1) / np.sqrt(brake**2 @ weights)
        share, size = share_within(pull, brake, weights), pull**2 @ weights
        # At rest the pull alone is bounded; a brake never lessens what it may be.
        at_rest = share_within(pull, 0 * brake, weights)
        np.testing.assert_allclose(at_rest, min(1.0, size**-0.5))
        assert at_rest * (1 - 1e-9) <= share <= 1.0
        # Who pushes it away from its movement adds the brake, and no more.
        assert (share * pull - brake) ** 2 @ weights <= 1 + 1e-9 or np.isclose(share, at_rest)


def test_a_movement_at_the_speed_that_is_asked_for_is_not_cut():
    """Springs of a heavy arm work against its own brakes: all of them are needed."""
    weights, brake = np.full(3, 0.25), np.array([30.0, -12.0, 4.0])
    assert share_within(brake, brake, weights) == 1.0
    assert share_within(brake, 0 * brake, weights) < 0.1
