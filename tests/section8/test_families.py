import numpy as np
import pytest

from tpsim.section8.families import FAMILIES

EVERY = pytest.mark.parametrize("name", list(FAMILIES))


@EVERY
def test_demonstrations_reach_their_goal_and_are_those_of_the_seed(name):
    family = FAMILIES[name]
    few, many = (family.demonstrations(count, 40, 7) for count in (2, 4))
    for first, again in zip(few, many, strict=False):
        np.testing.assert_array_equal(first.data, again.data)
    other = family.demonstrations(2, 40, 8)
    assert np.abs(other[0].data - few[0].data).max() > 0.01
    goal = {"via point": 2}.get(name, 1)
    for demonstration in many:
        np.testing.assert_allclose(demonstration.data[-1], demonstration.frames[goal].b, atol=1e-9)
        np.testing.assert_allclose(demonstration.data[0], demonstration.frames[0].b, atol=1e-9)


@EVERY
def test_situations_of_one_seed_differ_in_distance_alone(name):
    family = FAMILIES[name]
    near, far = (family.situations(3, spread, 30, 0) for spread in (1.0, 4.0))
    usual = np.array([-1.2, -0.5])
    for a, b in zip(near, far, strict=True):
        moved = [s.truth.frames[0].b - usual for s in (a, b)]
        np.testing.assert_allclose(moved[1], 4 * moved[0], atol=1e-9)
        assert [f is None for f in a.frames] == [f is None for f in b.frames]
        np.testing.assert_allclose(a.truth.data[[0, -1]], a.drawn.data[[0, -1]], atol=1e-9)


def test_the_via_point_is_passed():
    for situation in FAMILIES["via point"].situations(5, 2.0, 101, 0):
        away = np.linalg.norm(situation.truth.data - situation.truth.frames[1].b, axis=1)
        assert away.min() < 0.02


def test_the_hidden_frame_can_be_told_from_the_one_that_is_seen():
    """The marker is fixed to the second object; one of both is hidden, in turn."""
    situations = FAMILIES["missing frame"].situations(4, 1.0, 30, 0)
    hidden = [[j for j, f in enumerate(s.frames) if f is None] for s in situations]
    assert hidden == [[1], [2], [1], [2]]
    seen = [s.truth.frames[1].to_local(s.truth.frames[2].b) for s in situations]
    np.testing.assert_allclose(seen, np.tile(seen[0], (4, 1)), atol=1e-9)
