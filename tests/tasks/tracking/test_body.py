"""How a trunk leans between two points: against a search over all its angles."""

import numpy as np
import pytest

from tpsim.catalogue.ours import planar5
from tpsim.errors import ArgumentError
from tpsim.tasks.tracking.body import Body

BODY = Body(0.35, 0.3)
ANGLES = np.linspace(-np.pi / 2, 3 * np.pi / 2, 40001)


@pytest.fixture
def points():
    rng = np.random.default_rng(0)
    bearing, distance = rng.uniform(0.0, np.pi, (2, 40)), rng.uniform(0.75, 0.9, (2, 40))
    return distance[..., None] * np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)


def searched(points, cost):
    """Least cost over all trunk angles, point pair by point pair."""
    missing = [BODY.missing(ANGLES[:, None], point) for point in points]
    return cost(*missing).min(axis=0)


def test_the_body_is_that_of_the_robot():
    body = Body.of(planar5())
    assert (body.trunk, body.link) == pytest.approx((0.35, 0.3))


def test_a_span_is_where_the_point_is_in_reach(points):
    low, high = BODY.span(points)
    for angle, inside in ((low + 1e-6, True), (high - 1e-6, True), (low - 1e-3, False)):
        assert ((BODY.missing(angle, points) == 0) == inside).all()


@pytest.mark.parametrize(
    ("teaching", "cost"),
    [
        ("left", lambda left, right: 1e6 * left + right),
        ("right", lambda left, right: left + 1e6 * right),
        ("compromise", lambda left, right: left**2 + right**2),
    ],
)
def test_a_teacher_finds_the_best_lean(points, teaching, cost):
    angle, apart = BODY.lean(*points, teaching)
    chosen = cost(*(BODY.missing(angle, point) for point in points))
    assert 5 < apart.sum() < 35
    # A grid never meets the end of the first hand's interval: it pays for half a step.
    np.testing.assert_array_less(chosen, searched(points, cost) * (1 + 1e-6) + 1e-6)
    assert (chosen[~apart] < 1e-12).all() and (chosen[apart] > 0).all()


def test_a_posture_brings_both_hands_to_their_points():
    left, right = np.array([-0.4, 0.5]), np.array([0.35, 0.6])
    angle, apart = BODY.lean(left[None], right[None], "left")
    assert not apart.any()
    state = planar5().at(BODY.posture(angle[0], left, right))
    for side, point in (("left", left), ("right", right)):
        np.testing.assert_allclose(state.pose(f"{side}_hand").position[:2], point)


def test_a_teaching_that_does_not_exist_is_refused():
    with pytest.raises(ArgumentError, match="nobody"):
        BODY.lean(np.ones((1, 2)), np.ones((1, 2)), "nobody")
