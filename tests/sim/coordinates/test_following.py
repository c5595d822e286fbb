"""Hands seen from moving objects, one beneath the other: Eqs (41), (44) and their motion."""

import numpy as np
import pytest

from tpsim.control import projection
from tpsim.sim import scene
from tpsim.sim.coordinates.following import Following, FollowingBeneath, PostureBeneathHands
from tpsim.sim.simulation import Simulation

LEFT = Following("left", "left_hand", "left_object")
RIGHT = Following("right", "right_hand", "right_object")
BENEATH = FollowingBeneath("right beneath left", LEFT, RIGHT)
Q = np.array([1.4, 0.8, -1.2, -0.7, 1.0])


@pytest.fixture
def simulation():
    simulation = Simulation(scene.planar5())
    place(simulation, 0.0)
    simulation.robot.update(Q, np.zeros(5))
    return simulation


def place(simulation, time):
    """Both objects on circles, turning on the way."""
    for k, (position, quaternion) in enumerate(simulation.objects.values()):
        angle = 1.0 + k + 0.3 * time
        position[:2] = 0.6 * np.cos(angle), 0.6 * np.sin(angle)
        quaternion[:] = np.cos(angle / 2), 0, 0, np.sin(angle / 2)


def derivative(simulation, view, dq, v=0.0, h=1e-6):
    """Central difference of y while joints and objects move."""
    ends = []
    for t in (-h, h):
        place(simulation, v * t)
        simulation.robot.update(Q + t * dq, dq)
        ends.append(view()[0].copy())
    return (ends[1] - ends[0]) / (2 * h)


def hand(simulation, side):
    """Jacobian (2, n), place (2,) and the object's axes and place of a hand."""
    robot = simulation.robot
    site, (b, (w, _, _, z)) = robot.site(f"{side}_hand"), robot.objects[f"{side}_object"]
    A = np.array([[w * w - z * z, -2 * w * z], [2 * w * z, w * w - z * z]])
    return robot.jacobian(site)[:2].copy(), robot.placement(site)[1][:2].copy(), A, b[:2].copy()


def test_following_is_the_frame_of_equation_41(simulation):
    y, W = LEFT.bind(simulation.robot)()
    J, x, A, b = hand(simulation, "left")
    frame = projection.relative(J, Q, x, A, b)
    # What the frame carries to the posture now is what the hand is seen at.
    np.testing.assert_allclose(frame.A @ y + frame.b, Q, atol=1e-12)
    np.testing.assert_allclose(W @ frame.A, np.eye(2), atol=1e-12)


def test_beneath_is_the_frame_of_equation_44_in_the_nullspace(simulation):
    J, _, _, _ = hand(simulation, "left")
    J_other, x, A, _ = hand(simulation, "right")
    # Near the object the whole error counts.
    simulation.objects["right_object"][0][:2] = x + 1e-7
    y, JN = BENEATH.bind(simulation.robot)()
    N = projection.nullspace(J, damping=1e-2)
    np.testing.assert_allclose(JN, A.T @ J_other @ N, atol=2e-3)
    frame = projection.nullspace_relative(J, Q, J_other @ N, x, A, x + 1e-7)
    np.testing.assert_allclose(JN @ frame.A, np.eye(2), atol=2e-2)
    np.testing.assert_allclose(y, A.T @ np.full(2, -1e-7), rtol=2e-2)


def test_beneath_says_what_a_stretched_arm_can_still_do(simulation):
    """Both arms nearly straight, the object far ahead of the second: exact to second order."""
    robot, bend = simulation.robot, 0.05
    q = np.array([np.pi / 2, 1.2, -1e-4, -1.2, bend])
    robot.update(q, np.zeros(5))
    shoulder = robot.placement(robot.site("right_shoulder"))[1][:2]
    tip = robot.placement(robot.site("right_hand"))[1][:2]
    way = (tip - shoulder) / np.linalg.norm(tip - shoulder)
    position, quaternion = robot.objects["right_object"]
    position[:2], quaternion[:] = tip + 0.15 * way, (1, 0, 0, 0)
    y, _ = BENEATH.bind(robot)()
    missing = 0.6 - np.linalg.norm(tip - shoulder)
    assert 0.5 * missing < -y @ way < 3 * missing < 0.01


def test_motion_is_what_joints_and_objects_change(simulation):
    dq, rng = np.array([0.3, -0.2, 0.4, 0.1, -0.5]), np.random.default_rng(0)
    view = LEFT.bind(simulation.robot)
    # Seen to move twice, it is expected to go on.
    for k in range(3):
        place(simulation, 1e-6 * k)
        view()
        K, v = view.motion(1e-6 * (k > 0))
    np.testing.assert_allclose(derivative(simulation, view, dq, 1.0), K @ dq - v, atol=1e-5)
    joints = rng.standard_normal(5)
    np.testing.assert_allclose(derivative(simulation, view, joints), K @ joints, atol=1e-5)


def test_a_jump_is_not_chased(simulation):
    view = BENEATH.bind(simulation.robot)
    view(), view.motion(0.0)
    simulation.objects["right_object"][0][0] += 0.2
    view()
    assert not view.motion(0.01)[1].any()


def test_posture_is_seen_through_the_nullspace_of_both_hands(simulation):
    robot = simulation.robot
    arms = ("left_shoulder", "left_elbow", "right_shoulder", "right_elbow")
    y, N = PostureBeneathHands("posture", arms, (LEFT, RIGHT)).bind(robot)()
    np.testing.assert_array_equal(y, Q[1:])
    J = np.vstack([hand(simulation, side)[0] for side in ("left", "right")])
    np.testing.assert_allclose(N @ J.T, 0, atol=2e-3)
    # One freedom is left, and the arms take part in it.
    singular = np.linalg.svd(N, compute_uv=False)
    assert singular[0] > 0.5 and singular[1] < 1e-2
