"""Eq. (44) as printed beside its Newton step: where a second hand comes to rest.

Two arms on one trunk; the first hand stays at its object, the second one's is out of its reach.
"""

import numpy as np
import pytest

from tpsim import projection
from tpsim.catalogue.ours import planar5
from tpsim.control.projection import nullspace, pseudoinverse
from tpsim.errors import ArgumentError
from tpsim.tasks.tracking.body import Body

ROBOT = planar5()
BODY = Body.of(ROBOT)


def objects(seed):
    """Places of both objects, 0.3 to 0.6 rad farther apart than both hands reach."""
    rng = np.random.default_rng(seed)
    heading, far = np.pi / 2 + rng.uniform(-0.4, 0.4), rng.uniform(0.72, 0.88, 2)
    half = (BODY.half_width(far).sum() + rng.uniform(0.3, 0.6)) / 2
    bearings = heading + half, heading - half
    return np.array([[r * np.cos(a), r * np.sin(a)] for r, a in zip(far, bearings, strict=True)])


def seen(q):
    """Position (2,) and Jacobian (2, 5) of both hands."""
    state = ROBOT.at(q)
    hands = ("left_hand", "right_hand")
    return [(state.pose(hand).position[:2], state.jacobian(hand)[:2]) for hand in hands]


def settled(places, steps=500, **options):
    """Posture after many small steps of Eqs (41) and (44)."""
    angle, _ = BODY.lean(places[:1], places[1:], "compromise")
    q = BODY.posture(angle[0], places[0], 0.8 * places[0] * [-1, 1])
    for _ in range(steps):
        (x, J), (x_other, J_other) = seen(q)
        first = projection.relative(J, q, x, np.eye(2), places[0], damping=0.01)
        second = projection.nullspace_relative(
            J, q, J_other, x_other, np.eye(2), places[1], damping=0.01, **options
        )
        q = q + 0.15 * np.clip(first.b + second.b - 2 * q, -0.5, 0.5)
    return q


def errors(q, places):
    return [place - x for place, (x, _) in zip(places, seen(q), strict=True)]


@pytest.mark.parametrize("seed", [0, 2])
def test_the_newton_step_rests_at_the_least_distance_and_the_printed_one_does_not(seed):
    places = objects(seed)
    angle, apart = BODY.lean(places[:1], places[1:], "left")
    assert apart[0]
    least = BODY.missing(angle, places[1:])[0]
    for options, low, high in (({"bend": 0.3}, 0.99, 1.01), ({}, 1.5, 2.2)):
        first, other = errors(settled(places, **options), places)
        assert np.linalg.norm(first) < 1e-3
        assert low < np.linalg.norm(other) / least < high


def test_the_bend_decides_how_fast_and_not_where():
    places = objects(1)
    ends = [settled(places, 900, bend=bend) for bend in (0.15, 0.3, 0.6)]
    distances = [np.linalg.norm(errors(q, places)[1]) for q in ends]
    np.testing.assert_allclose(distances, distances[0], rtol=2e-3)


def test_where_each_of_them_rests():
    """N J~' e = 0 for the Newton step; N J~' (J~ J~')^-1 e = 0 as printed."""
    places = objects(0)
    for options, weight in (({"bend": 0.3}, False), ({}, True)):
        q = settled(places, **options)
        (_, J), (_, J_other) = seen(q)
        e = errors(q, places)[1]
        N = nullspace(J, 0.01)
        weighted = np.linalg.solve(J_other @ J_other.T, e) if weight else e
        share = np.linalg.norm(N @ J_other.T @ weighted) / np.linalg.norm(J_other.T @ weighted)
        assert share < 0.02
        if weight:  # and there, the error could still be made smaller
            assert np.linalg.norm(N @ J_other.T @ e) > 0.05 * np.linalg.norm(J_other.T @ e)


def test_without_error_or_bend_it_is_the_pseudoinverse_of_what_is_free():
    """N (J~ N)^+ (A_O mu + e): the Gauss-Newton step."""
    rng = np.random.default_rng(0)
    J, J_other, q = rng.normal(size=(2, 7)), rng.normal(size=(2, 7)), rng.normal(size=7)
    x, b, A = rng.normal(size=2), rng.normal(size=2), rng.normal(size=(2, 2))
    found = projection.nullspace_relative(J, q, J_other, x, A, b, bend=0.0)
    lift = nullspace(J) @ pseudoinverse(J_other @ nullspace(J))
    np.testing.assert_allclose(found.A, lift @ A, atol=1e-4)
    np.testing.assert_allclose(found.b, q + lift @ (b - x), atol=1e-4)
    bent = projection.nullspace_relative(J, q, J_other, x, A, b, bend=10.0)
    assert np.linalg.norm(bent.b - q) < 0.5 * np.linalg.norm(found.b - q)


def test_a_bend_below_zero_is_refused():
    with pytest.raises(ArgumentError, match="bend is -1"):
        projection.nullspace_relative(
            np.eye(2), np.ones(2), np.eye(2), np.ones(2), np.eye(2), np.ones(2), bend=-1.0
        )
