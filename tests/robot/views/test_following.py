"""Hands seen from moving objects, one beneath the other: Eqs (41), (42), (44)."""

import numpy as np
import pytest

from tpsim import rotation
from tpsim.control import projection
from tpsim.pose import Pose
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Object, Site

LEFT, RIGHT = (
    Site(f"{side}_hand").seen_from(Object(f"{side}_object")).position[:2]
    for side in ("left", "right")
)
BENEATH = RIGHT.beneath(LEFT, bend=0.3)
Q = np.array([1.4, 0.8, -1.2, -0.7, 1.0])


@pytest.fixture
def robot(planar5_world):
    return planar5_world.robot


def turned(angle, place):
    return Pose(rotation.exp([0, 0, angle]), np.array([*place, 0.0]))


def objects(**places):
    found = {}
    for k, side in enumerate(("left", "right")):
        angle = 1.0 + k
        place = places.get(side, 0.6 * np.array([np.cos(angle), np.sin(angle)]))
        found[f"{side}_object"] = turned(angle, place)
    return found


def hand(state, side):
    """Jacobian (2, n), place (2,) and the object's axes and place of a hand."""
    thing = state.objects[f"{side}_object"]
    J, pose = state.jacobian(f"{side}_hand")[:2], state.pose(f"{side}_hand")
    return J, pose.position[:2], thing.rotation[:2, :2], thing.position[:2]


def test_following_is_the_frame_of_equation_41(robot):
    state = robot.at(Q, objects=objects())
    seen, (J, x, A, b) = LEFT(state), hand(state, "left")
    frame = projection.relative(J, Q, x, A, b)
    # What the frame carries to the posture now is what the hand is seen at.
    np.testing.assert_allclose(frame.A @ seen.value + frame.b, Q, atol=1e-12)
    np.testing.assert_allclose(seen.jacobian @ frame.A, np.eye(2), atol=1e-12)


def test_beneath_is_the_frame_of_equation_44_in_the_nullspace(robot):
    # Near the object the whole error counts.
    x = robot.at(Q).pose("right_hand").position[:2]
    state = robot.at(Q, objects=objects(right=x + 1e-7))
    J, J_other, A = hand(state, "left")[0], hand(state, "right")[0], hand(state, "right")[2]
    seen, N = BENEATH(state), projection.nullspace(J, damping=1e-2)
    np.testing.assert_allclose(seen.jacobian, A.T @ J_other @ N, atol=2e-3)
    frame = projection.nullspace_relative(J, Q, J_other @ N, x, A, x + 1e-7)
    np.testing.assert_allclose(seen.jacobian @ frame.A, np.eye(2), atol=2e-2)
    np.testing.assert_allclose(seen.value, A.T @ np.full(2, -1e-7), rtol=2e-2)


def test_beneath_says_what_a_stretched_arm_can_still_do(robot):
    """Both arms nearly straight, the object far ahead of the second: exact to second order."""
    q = np.array([np.pi / 2, 1.2, -1e-4, -1.2, 0.05])
    state = robot.at(q)
    shoulder, tip = (state.pose(f"right_{part}").position[:2] for part in ("shoulder", "hand"))
    way = (tip - shoulder) / np.linalg.norm(tip - shoulder)
    seen = objects() | {"right_object": turned(0.0, tip + 0.15 * way)}
    y = BENEATH(robot.at(q, objects=seen)).value
    missing = 0.6 - np.linalg.norm(tip - shoulder)
    assert 0.5 * missing < -y @ way < 3 * missing < 0.01


def test_without_a_bend_the_whole_error_counts(robot):
    state = robot.at(Q, objects=objects())
    np.testing.assert_array_equal(RIGHT.beneath(LEFT)(state).value, RIGHT(state).value)


def test_posture_is_seen_through_the_nullspace_of_both_hands(robot):
    arms = ("left_shoulder", "left_elbow", "right_shoulder", "right_elbow")
    state = robot.at(Q, objects=objects())
    y, N, *_ = Joints(arms).beneath(LEFT, RIGHT)(state)
    np.testing.assert_array_equal(y, Q[1:])
    J = np.vstack([hand(state, side)[0] for side in ("left", "right")])
    np.testing.assert_allclose(N @ J.T, 0, atol=2e-3)
    # One freedom is left, and the arms take part in it.
    singular = np.linalg.svd(N, compute_uv=False)
    assert singular[0] > 0.5 and singular[1] < 1e-2
