"""The finite-horizon controller of a hand: its law, its impedance, what it does at the end."""

import numpy as np
import pytest

from tpsim import Frame, Gaussian, RiemannianGaussian, rotation
from tpsim.controllers.finite_horizon import FiniteHorizon
from tpsim.controllers.seen_poses import POSE
from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.world.impedance import Drive, hand_stiffness
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.push import Push
from tpsim.world.rollout import rollout

DOCK = Pose(np.eye(3), np.array([0.75, 0.0, 0.0]))
SITES = {"left_hand": "left_gripper"}


@pytest.fixture
def world(dock_world):
    return dock_world


def controller(world, offset=(0.0, 0.0, 0.0), joints=None, deviation=0.005):
    """Stay at an offset [m] from the home pose of the left hand, as the dock sees it."""
    robot = world.robot
    R, p = robot.at_home.pose("left_gripper")
    seen = DOCK.inverse @ Pose(R, p + offset)
    mean = np.tile(np.append(seen.position, seen.quaternion), (30, 1))
    return FiniteHorizon(
        robot,
        ["end"],
        [RiemannianGaussian(POSE, mean, deviation**2 * np.eye(6))],
        Gaussian(np.tile(robot.home[:7], (30, 1)), 0.04 * np.eye(7)),
        joints=robot.joints[:7] if joints is None else joints,
        site="left_gripper",
        dt=0.03,
        effort=0.05,
    )


def test_at_its_reference_it_holds_still(world):
    trial = rollout(world, controller(world), world.robot.home, 0.5, sites=SITES)
    assert np.abs(trial["q"] - world.robot.home).max() < 1e-6


def test_nothing_depends_on_the_axes_of_an_object_or_on_the_sign_of_quaternions(world):
    """The same dock with other axes sees other numbers; torques are the same up to rounding."""
    law = controller(world, (0.03, 0.02, -0.04))
    state = world.robot.at(world.robot.home + 0.05, objects={"end": DOCK})
    wanted = Drive(world.robot, 1e-3).torque(law.renew(state, 0.3), state)
    for turn in ([0.0, 0.0, np.pi], [1.0, -2.0, 1.5], [0.0, np.radians(179), 0.0]):
        axes = Pose(rotation.exp(turn), np.array([0.3, -0.1, 0.2]))
        dock, again = DOCK @ axes, controller(world, (0.03, 0.02, -0.04))
        seen = POSE.frame(Frame(*axes)).to_local(again.movements[0].mean)
        seen[::2, 3:] *= -1
        back = np.kron(np.eye(2), axes.rotation.T)
        covariance = back @ again.movements[0].covariance @ back.T
        again.movements = (RiemannianGaussian(POSE, seen, covariance),)
        there = world.robot.at(world.robot.home + 0.05, objects={"end": dock})
        found = Drive(world.robot, 1e-3).torque(again.renew(there, 0.3), there)
        np.testing.assert_allclose(found, wanted, atol=1e-7 * np.abs(wanted).max())


def test_it_goes_where_the_movement_ends_and_stays(world):
    offset, home = np.array([0.03, -0.05, 0.04]), world.robot.home
    trial = rollout(world, controller(world, offset), home, 2.5, sites=SITES)
    way = trial["left_hand_position"][-1] - trial["left_hand_position"][0]
    np.testing.assert_allclose(way, offset, atol=2e-4)
    assert np.abs(trial["q"][:, 7:] - home[7:]).max() < 1e-3


def test_it_follows_the_object(world):
    moved = np.array([0.0, 0.06, 0.03])
    there = ObjectPath.at("end", DOCK.position + moved)
    trial = rollout(world, controller(world), world.robot.home, 2.5, sites=SITES, objects=[there])
    way = trial["left_hand_position"][-1] - world.robot.at_home.pose("left_gripper").position
    np.testing.assert_allclose(way, moved, atol=5e-4)


def test_the_impedance_is_the_slope_of_the_torque(world):
    robot, objects, h = world.robot, {"end": DOCK}, 1e-5
    law = controller(world, (0.004, 0.002, -0.003))
    now = law.renew(robot.at(robot.home, objects=objects), 0.0)

    def torque(state):
        again = law.renew(state, 0.0)  # with the inertia of this very posture
        return Drive(robot, 1e-3).torque(again, state) - state.bias - robot.damping * state.dq

    for k in range(14):
        for part, matrix in ((0, now.stiffness), (1, now.damping)):
            torques = []
            for sign in (1, -1):
                x = np.array([robot.home, np.zeros(14)])
                x[part, k] += sign * h
                torques.append(torque(robot.at(*x, objects=objects)))
            slope = (torques[0] - torques[1]) / (2 * h)
            # Near the reference the Jacobian's own change adds little.
            np.testing.assert_allclose(slope, -matrix[:, k], atol=0.02 * np.abs(matrix).max())


def test_a_push_meets_the_stiffness_that_is_recorded(world):
    """With acceleration as effort a push of 10 N moved the light wrist by 20 cm."""
    force = (0.0, 1.0, 0.0)
    push = Push("left_gripper", force, start=0.0, duration=10.0)
    law, home = controller(world, deviation=0.03), world.robot.home
    trial = rollout(world, law, home, 1.5, sites=SITES, people=[push])
    way = trial["left_hand_position"][-1] - trial["left_hand_position"][0]
    J = world.robot.at(trial["q"][-1]).jacobian("left_gripper")
    state = world.robot.at(trial["q"][-1], objects={"end": DOCK})
    compliance = np.linalg.inv(hand_stiffness(J, law.renew(state, 1.5).stiffness))
    expected = compliance[:3, :3] @ force
    np.testing.assert_allclose(way, expected, atol=0.1 * np.linalg.norm(way))
    assert 10 * np.linalg.norm(way) < 0.1


def test_joints_of_an_arm_follow_each_other(world):
    with pytest.raises(ArgumentError, match="do not follow each other"):
        controller(world, joints=("left_s0", "left_e0"))
