"""The controller's model agrees with MuJoCo on every quantity, and says what it cannot be."""

import mujoco
import numpy as np
import pytest

from tpsim.errors import ArgumentError
from tpsim.robot.robot import Robot

# Everything that model conversions get wrong: references, off-centre anchors, two joints on one
# body, massive geoms without contact, sites on fixed bodies nested in fixed bodies, armature.
AWKWARD = """
<mujoco><compiler angle="radian"/>
  <worldbody><body name="base" pos="0.1 0 0.3" euler="0.1 0.2 0.3">
    <joint name="a" axis="0 1 0" pos="0.02 0 0.1" ref="0.4" armature="0.1"/>
    <joint name="b" axis="1 0 0" pos="0 0.03 0"/>
    <geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.3"/>
    <body pos="0 0 0.3" quat="0.9 0.1 0.3 0">
      <joint name="c" type="slide" axis="0 0.6 0.8" ref="0.05"/>
      <geom type="box" size="0.05 0.03 0.04" contype="0" conaffinity="0" mass="0.5"/>
      <body pos="0.1 0 0.02" euler="0 0.5 0"><body pos="0 0.2 0" euler="0.3 0 0.1">
        <geom type="sphere" size="0.05" mass="0.3"/><site name="tip" pos="0.01 0.02 0.1"/>
      </body></body></body></body>
    <body name="cup" mocap="true"><geom size="0.02"/></body></worldbody>
  <actuator><motor joint="a"/><motor joint="b"/><motor joint="c"/></actuator>
</mujoco>"""


LIMITS = {"a": 90.0, "b": 90.0, "c": 90.0}


@pytest.fixture(scope="module")
def awkward():
    return Robot.from_mjcf(AWKWARD, {"hand": "tip"}, torque_limit=LIMITS, home=(0.1, 0.2, 0.0))


@pytest.fixture(params=["awkward", "baxter", "jaco"])
def robot(request, awkward, cup_world, jaco_robot):
    return {"awkward": awkward, "baxter": cup_world.robot, "jaco": jaco_robot}[request.param]


def test_mass_bias_poses_and_jacobians_agree(robot):
    model, rng, dof = robot.model, np.random.default_rng(0), robot.simulated.dof
    data, M, J = mujoco.MjData(model), np.zeros((model.nv, model.nv)), np.zeros((6, model.nv))
    for _ in range(50):
        q, dq = rng.uniform(-2, 2, (2, robot.n))
        data.qpos[robot.simulated.qpos], data.qvel[dof] = q, dq
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, M)
        state = robot.at(q, dq)
        np.testing.assert_allclose(state.mass, M[np.ix_(dof, dof)], atol=1e-10)
        np.testing.assert_allclose(state.bias, data.qfrc_bias[dof], atol=1e-10)
        for name in robot.sites:
            site, pose = model.site(name).id, state.pose(name)
            mujoco.mj_jacSite(model, data, J[:3], J[3:], site)
            np.testing.assert_allclose(pose.position, data.site_xpos[site], atol=1e-10)
            np.testing.assert_allclose(pose.rotation.ravel(), data.site_xmat[site], atol=1e-10)
            np.testing.assert_allclose(state.jacobian(name), J[:, dof], atol=1e-10)
            np.testing.assert_allclose(state.twist(name), J[:, dof] @ dq, atol=1e-9)


def test_gravity_torque_is_the_bias_at_rest(robot):
    q = np.full(robot.n, 0.3)
    np.testing.assert_allclose(robot.gravity_torque(q), robot.at(q).bias, atol=1e-12)


def test_springs_of_joints_belong_to_the_bias():
    xml = AWKWARD.replace('name="a"', 'name="a" stiffness="7" springref="0.2"')
    robot = Robot.from_mjcf(xml, {"hand": "tip"}, torque_limit=LIMITS, home=(0.1, 0.2, 0.0))
    data = mujoco.MjData(robot.model)
    data.qpos[robot.simulated.qpos] = q = np.array([0.5, -0.3, 0.1])
    mujoco.mj_forward(robot.model, data)
    held = data.qfrc_bias - data.qfrc_spring
    np.testing.assert_allclose(robot.at(q).bias, held[robot.simulated.dof], atol=1e-10)


def test_states_need_the_right_number_of_joints(awkward):
    with pytest.raises(ArgumentError, match="3 joints"):
        awkward.at([0.0, 1.0])


def test_chains_are_the_joints_that_move_a_site(cup_world):
    robot = cup_world.robot
    np.testing.assert_array_equal(robot.chain("cup"), np.arange(7))
    np.testing.assert_array_equal(robot.chain("right_elbow"), [7, 8, 9, 10])


def test_home_comfort_knows_limits_and_weight(cup_world):
    robot = cup_world.robot
    assert robot.is_comfortable(robot.home)
    assert not robot.is_comfortable(robot.upper - 0.1)
    assert not robot.is_comfortable(robot.home, load=0.1)
