"""Poses seen from objects: charts of orientation, and frames that are affine about a pose."""

import numpy as np
import pytest

from tpsim import rotation
from tpsim.pose import coordinates, object_frame

RNG = np.random.default_rng(5)
REFERENCE, COMMON = rotation.exp(RNG.normal(size=(2, 3)))


def random_pose(shape=(), spread=1.0):
    return rotation.exp(spread * RNG.normal(size=(*shape, 3))), RNG.normal(size=(*shape, 3))


def common_of(local, dock):
    """Common coordinates of poses that an object sees, without any frame."""
    R, p = dock
    seen = rotation.exp(local[..., 3:]) @ REFERENCE
    return coordinates((R @ seen, p + local[..., :3] @ R.T), COMMON)


@pytest.mark.parametrize("size", [0.0, 1e-6, 1e-3, 0.5, 3.0])
def test_the_left_jacobian_has_its_inverse(size):
    w = size * np.array([0.6, -0.48, 0.64])
    product = rotation.left_jacobian(w) @ rotation.left_jacobian_inverse(w)
    np.testing.assert_allclose(product, np.eye(3), atol=1e-9)
    rate = np.array([[0.3, -1.0, 0.2], [0.0, 0.4, 0.1]])
    np.testing.assert_allclose(
        rotation.angular_velocity(np.array([w, w]), rate),
        rate @ rotation.left_jacobian(w).T,
        atol=1e-14,
    )


def test_coordinates_are_zero_at_the_reference_of_the_object():
    R, p = random_pose()
    np.testing.assert_allclose(
        coordinates((R @ REFERENCE, p), REFERENCE, seen_from=(R, p)), 0, atol=1e-12
    )


def test_coordinates_do_not_change_when_world_and_object_move_together():
    hand, dock = random_pose((7,)), random_pose()
    Q, shift = random_pose()
    moved = [(Q @ R, p @ Q.T + shift) for R, p in (hand, dock)]
    np.testing.assert_allclose(
        coordinates(*moved[:1], REFERENCE, seen_from=moved[1]),
        coordinates(hand, REFERENCE, seen_from=dock),
        atol=1e-9,
    )


def test_the_frame_is_exact_at_the_pose_and_to_first_order_about_it():
    dock, hand = random_pose(), random_pose((5,), spread=0.6)
    y, local = coordinates(hand, COMMON), coordinates(hand, REFERENCE, seen_from=dock)
    frame = object_frame(dock, REFERENCE, COMMON, y)
    np.testing.assert_allclose(frame.to_common(local), y, atol=1e-9)
    h = 1e-5
    for k, step in enumerate(h * np.eye(6)):
        slope = (common_of(local + step, dock) - common_of(local - step, dock)) / (2 * h)
        np.testing.assert_allclose(frame.A[..., k], slope, atol=1e-7)


def test_frames_move_with_the_object():
    docks, hand = random_pose((4,), 0.5), random_pose((4,), 0.5)
    y = coordinates(hand, COMMON)
    moving = object_frame(docks, REFERENCE, COMMON, y)
    for t in range(4):
        still = object_frame((docks[0][t], docks[1][t]), REFERENCE, COMMON, y[t])
        np.testing.assert_allclose(moving.A[t], still.A, atol=1e-12)
        np.testing.assert_allclose(moving.b[t], still.b, atol=1e-12)
