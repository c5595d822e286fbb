"""The finite-horizon controller of a hand: its law, its impedance, what it does at the end."""

import numpy as np
import pytest

from tpsim import Gaussian, rotation
from tpsim.control.poses import SeenMovement
from tpsim.errors import ArgumentError
from tpsim.pose import coordinates
from tpsim.sim import scene
from tpsim.sim.controllers.controller import hand_stiffness
from tpsim.sim.controllers.finite_horizon import FiniteHorizon
from tpsim.sim.rollout import rollout
from tpsim.sim.simulation import Simulation

SITES = {"left_hand": "left_gripper"}


@pytest.fixture(scope="module")
def simulation():
    return Simulation(scene.baxter({"end": "dock"}))


def controller(simulation, offset=(0.0, 0.0, 0.0), joints=None, deviation=0.005):
    """Stay at an offset [m] from the home pose of the left hand, as the dock sees it."""
    robot, dock = simulation.robot, simulation.objects["end"]
    simulation.reset(simulation.home)
    robot.update(simulation.home, 0 * simulation.home)
    R, p = (part.copy() for part in robot.placement(robot.site("left_gripper")))
    turn, place = rotation.from_quaternion(dock[1]), dock[0].copy()
    reference = turn.T @ R
    mean = np.tile(coordinates((R, p + offset), reference, seen_from=(turn, place)), (30, 1))
    joints = robot.joints[:7] if joints is None else joints
    return FiniteHorizon(
        simulation,
        ["end"],
        [SeenMovement(mean, np.tile(np.eye(6) / deviation**2, (30, 1, 1)), reference)],
        Gaussian(np.tile(simulation.home[:7], (30, 1)), 0.04 * np.eye(7)),
        joints=joints,
        site="left_gripper",
        dt=0.03,
        effort=0.05,
    )


def test_at_its_reference_it_holds_still(simulation):
    trial = rollout(simulation, controller(simulation), simulation.home, 0.5, sites=SITES)
    assert np.abs(trial["q"] - simulation.home).max() < 1e-6


def test_it_goes_where_the_movement_ends_and_stays(simulation):
    offset = np.array([0.03, -0.05, 0.04])
    law = controller(simulation, offset)
    trial = rollout(simulation, law, simulation.home, 2.5, sites=SITES)
    way = trial["left_hand_position"][-1] - trial["left_hand_position"][0]
    np.testing.assert_allclose(way, offset, atol=2e-4)
    assert np.abs(trial["q"][:, 7:] - simulation.home[7:]).max() < 1e-3


def test_it_follows_the_object(simulation):
    law = controller(simulation)
    simulation.reset(simulation.home)
    position, _ = simulation.objects["end"]
    robot, site = simulation.robot, simulation.robot.site("left_gripper")
    start = robot.placement(site)[1].copy()
    moved = np.array([0.0, 0.06, 0.03])
    position += moved
    for _ in range(2500):
        robot.update(simulation.q.copy(), simulation.dq.copy())
        simulation.step(law.torque())
    np.testing.assert_allclose(robot.placement(site)[1] - start, moved, atol=5e-4)


def test_the_impedance_is_the_slope_of_the_torque(simulation):
    law = controller(simulation, (0.004, 0.002, -0.003))
    robot = simulation.robot
    robot.update(simulation.home, np.zeros(14))
    law.feedback()
    impedance = law.impedance()
    h = 1e-5
    for k in range(14):
        for part, matrix in ((0, impedance.stiffness), (1, impedance.damping)):
            torques = []
            for sign in (1, -1):
                state = np.array([simulation.home, np.zeros(14)])
                state[part, k] += sign * h
                robot.update(*state)
                law._left = 0  # the inertia of this very posture
                torques.append(law.feedback())
            slope = (torques[0] - torques[1]) / (2 * h)
            # Near the reference the Jacobian's own change adds little.
            np.testing.assert_allclose(slope, -matrix[:, k], atol=0.02 * np.abs(matrix).max())


def test_a_push_meets_the_stiffness_that_is_recorded(simulation):
    """With acceleration as effort a push of 10 N moved the light wrist by 20 cm."""
    law = controller(simulation, deviation=0.03)
    robot, site = simulation.robot, simulation.robot.site("left_gripper")
    simulation.reset(simulation.home)
    body = simulation.attachment("left_gripper")[0]
    start = robot.placement(site)[1].copy()
    wrench = np.array([0, 1.0, 0, 0, 0, 0])
    for _ in range(1500):
        robot.update(simulation.q.copy(), simulation.dq.copy())
        torque = law.torque()
        simulation.clear_wrenches()
        simulation.apply_wrench(body, wrench, robot.placement(site)[1])
        simulation.step(torque)
    way = robot.placement(site)[1] - start
    compliance = np.linalg.inv(hand_stiffness(robot.jacobian(site), law.impedance().stiffness))
    np.testing.assert_allclose(way, (compliance @ wrench)[:3], atol=0.1 * np.linalg.norm(way))
    assert 10 * np.linalg.norm(way) < 0.1


def test_joints_of_an_arm_follow_each_other(simulation):
    with pytest.raises(ArgumentError, match="do not follow each other"):
        controller(simulation, joints=("left_s0", "left_e0"))
