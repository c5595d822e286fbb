"""What is known of an arm from its mechanism alone."""

import numpy as np
import pytest

from tpsim.robot.anatomy import felt
from tpsim.robot.robot import Robot

GANTRY = """<mujoco><worldbody><body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
<joint name="x" type="slide" axis="1 0 0"/>
<body><inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/>
<joint name="y" type="slide" axis="0 1 0"/>
<body><inertial pos="0 0 0" mass="1" diaginertia="3 3 5"/>
<joint name="turn" axis="0 0 1"/><site name="tool"/></body></body></body></worldbody></mujoco>"""


def test_a_gantry_is_felt_as_what_it_carries_along():
    """Along x all 4 kg move, along y 3 kg; only the last body turns."""
    robot = Robot.from_mjcf(GANTRY, hands={"hand": "tool"}, torque_limit=100, velocity_limit=1)
    assert felt(robot.at_home, "tool") == pytest.approx((3.5, 5.0))


def test_a_felt_mass_is_what_a_force_accelerates(cup_world):
    """The mean over orthogonal directions of force over acceleration, where these are alike."""
    state = cup_world.robot.at_home
    J = state.jacobian("left_gripper")[:3]
    mobility = J @ np.linalg.solve(state.mass, J.T)
    directions = np.linalg.eigh(mobility)[1].T
    ways = [J @ np.linalg.solve(state.mass, J.T @ d) for d in directions]
    masses = [1 / (d @ way) for d, way in zip(directions, ways, strict=True)]
    assert felt(state, "left_gripper")[0] == pytest.approx(np.mean(masses))
