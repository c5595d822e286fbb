"""Poses: one seen from the other, and back."""

import numpy as np
import pytest

from tpsim import rotation
from tpsim.pose import Pose

RNG = np.random.default_rng(5)


def some(shape=()):
    return Pose(rotation.exp(RNG.normal(size=(*shape, 3))), RNG.normal(size=(*shape, 3)))


@pytest.mark.parametrize("size", [0.0, 1e-6, 1e-3, 0.5, 3.0])
def test_the_left_jacobian_has_its_inverse(size):
    w = size * np.array([0.6, -0.48, 0.64])
    product = rotation.left_jacobian(w) @ rotation.left_jacobian_inverse(w)
    np.testing.assert_allclose(product, np.eye(3), atol=1e-9)


@pytest.mark.parametrize("shape", [(), (4,)])
def test_what_is_seen_from_an_object_is_found_again(shape):
    dock, hand = some(shape), some(shape)
    seen = dock.inverse @ hand
    again = dock @ seen
    np.testing.assert_allclose(again.rotation, hand.rotation, atol=1e-12)
    np.testing.assert_allclose(again.position, hand.position, atol=1e-12)
    there = Pose.of_quaternion(hand.position, hand.quaternion)
    np.testing.assert_allclose(there.rotation, hand.rotation, atol=1e-12)


def test_what_an_object_sees_does_not_change_when_both_move_together():
    dock, hand, world = some(), some(), some()
    seen, again = dock.inverse @ hand, (world @ dock).inverse @ (world @ hand)
    np.testing.assert_allclose(again.rotation, seen.rotation, atol=1e-12)
    np.testing.assert_allclose(again.position, seen.position, atol=1e-12)
