"""One file through MuJoCo and Pinocchio: inertia, bias and Jacobians agree on every robot."""

from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np
import pytest

from tpsim.catalogue.hands import arms_in
from tpsim.catalogue.robots import CATALOGUE
from tpsim.robot.urdf import read_urdf

URDFS = ("panda_description/urdf/panda.urdf", "ur_description/urdf/ur5_robot.urdf")


def agree(robot, seed=0):
    model, rng = robot.model, np.random.default_rng(seed)
    dofs, qpos = robot.simulated.dof, robot.simulated.qpos
    low, high = np.maximum(robot.lower, -3), np.minimum(robot.upper, 3)
    for _ in range(3):
        q, dq = rng.uniform(low, high), rng.normal(size=robot.n)
        data = mujoco.MjData(model)
        data.qpos[qpos], data.qvel[dofs] = q, dq
        mujoco.mj_forward(model, data)
        state = robot.at(q, dq)
        M = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, M)
        np.testing.assert_allclose(state.mass, M[np.ix_(dofs, dofs)], rtol=0, atol=1e-10)
        np.testing.assert_allclose(state.bias, data.qfrc_bias[dofs], rtol=0, atol=1e-10)
        for site in robot.hands.values():
            J, number = np.zeros((6, model.nv)), model.site(site).id
            mujoco.mj_jacSite(model, data, J[:3], J[3:], number)
            np.testing.assert_allclose(state.jacobian(site), J[:, dofs], rtol=0, atol=1e-10)
            np.testing.assert_allclose(
                state.pose(site).position, data.site_xpos[number], rtol=0, atol=1e-10
            )


@pytest.mark.parametrize("name", CATALOGUE)
def test_mujoco_and_pinocchio_agree(name, robot_of):
    agree(robot_of(name))


@pytest.mark.parametrize("name", ["openarm", "jaco", "viperx"])
def test_armature_damping_and_friction_are_those_of_the_file(name, robot_of):
    robot = robot_of(name)
    dofs = robot.simulated.dof
    np.testing.assert_array_equal(robot.friction, robot.model.dof_frictionloss[dofs])
    np.testing.assert_array_equal(robot.damping, robot.model.dof_damping[dofs])
    np.testing.assert_array_equal(robot.mechanism.model.armature, robot.model.dof_armature[dofs])
    assert robot.friction.min() > 0


@pytest.mark.parametrize("path", URDFS)
def test_they_agree_on_a_urdf_of_example_robot_data(path):
    if find_spec("example_robot_data") is None:
        pytest.skip("example-robot-data is not installed")
    from example_robot_data.robots_loader import getModelPath

    file = Path(getModelPath(path)) / path
    agree(arms_in(read_urdf(file).spec, path).robot())
