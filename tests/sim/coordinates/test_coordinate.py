"""Jacobians of the task coordinates against finite differences, and Table 3."""

import numpy as np
import pytest

from tpsim.control import projection
from tpsim.errors import ArgumentError
from tpsim.sim import scene
from tpsim.sim.coordinates.coordinate import HandPose, Posture, RelativePose, SelfMotion
from tpsim.sim.simulation import Simulation
from tpsim.tasks.bimanual import Hands


@pytest.fixture(scope="module")
def simulation():
    return Simulation(scene.cup_and_sugar())


@pytest.fixture(scope="module")
def frames(simulation):
    return Hands(simulation).coordinates()


@pytest.mark.parametrize("name", ["cup in base", "sugar in base", "sugar from cup"])
def test_jacobians_are_the_derivatives(simulation, frames, name):
    robot, rng, h = simulation.robot, np.random.default_rng(1), 1e-6
    evaluate = frames[name].bind(robot)
    for _ in range(5):
        q = simulation.home + 0.4 * rng.standard_normal(robot.n)
        robot.update_kinematics(q)
        J = evaluate()[1].copy()
        for k in range(robot.n):
            ends = []
            for sign in (1, -1):
                robot.update_kinematics(q + sign * h * np.eye(robot.n)[k])
                ends.append(evaluate()[0].copy())
            np.testing.assert_allclose(J[:, k], (ends[0] - ends[1]) / (2 * h), atol=1e-7)


def test_coordinates_are_zero_turned_at_home(simulation, frames):
    robot = simulation.robot
    robot.update_kinematics(simulation.home)
    for name in ("cup in base", "sugar in base", "sugar from cup"):
        np.testing.assert_allclose(frames[name].bind(robot)()[0][3:], 0, atol=1e-9)


def test_self_motion_is_the_nullspace_of_the_hand(simulation, frames):
    robot, rng = simulation.robot, np.random.default_rng(2)
    q = simulation.home + 0.2 * rng.standard_normal(robot.n)
    evaluate = frames["left posture"].bind(robot)
    robot.update_kinematics(q)
    n = evaluate()[1][0, :7]
    J = robot.jacobian(robot.site("left_gripper"))[:, :7]
    np.testing.assert_allclose(J @ n, 0, atol=1e-3)
    np.testing.assert_allclose(np.outer(n, n), projection.nullspace(J), atol=1e-3)


def test_posture_is_a_selection(simulation):
    robot = simulation.robot
    robot.update_kinematics(simulation.home)
    y, J = Posture("two", ("left_e1", "right_w2")).bind(robot)()
    np.testing.assert_array_equal(y, simulation.home[[3, 13]])
    np.testing.assert_array_equal(J @ np.arange(14), [3, 13])


def test_relative_pose_does_not_see_what_both_do_together(simulation):
    robot = simulation.robot
    relative = RelativePose("r", "left_gripper", "cup")
    robot.update_kinematics(simulation.home)
    # The cup is fixed in the left gripper: nothing moves one against the other.
    np.testing.assert_allclose(relative.bind(robot)()[1], 0, atol=1e-12)


def test_an_arm_without_a_joint_to_spare_is_refused(simulation):
    with pytest.raises(ArgumentError, match="one to spare"):
        SelfMotion("s", ("left_s0",), "left_gripper", (0.0,)).bind(simulation.robot)


def test_observations_are_the_values_along_a_path(simulation):
    q = np.linspace(simulation.home, simulation.home + 0.1, 4)
    y, J = HandPose("cup", "cup").observe(simulation.robot, q)
    assert y.shape == (4, 6) and J.shape == (4, 6, 14)
    np.testing.assert_allclose(y[1] - y[0], J[0] @ (q[1] - q[0]), atol=5e-3)
