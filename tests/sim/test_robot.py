"""Pinocchio agrees with MuJoCo on every quantity that the controllers use."""

import mujoco
import numpy as np
import pytest

from tpsim.errors import SimulationError
from tpsim.sim import scene
from tpsim.sim.robot import Robot

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
    <body name="cup"><freejoint/><geom size="0.02"/></body></worldbody>
  <actuator><motor joint="a"/><motor joint="b"/><motor joint="c"/></actuator>
</mujoco>"""


@pytest.fixture(params=["awkward", "cup_and_sugar"])
def model(request):
    xml = AWKWARD if request.param == "awkward" else scene.cup_and_sugar()
    return mujoco.MjModel.from_xml_string(xml)


def test_mass_bias_poses_and_jacobians_agree(model):
    robot, data, rng = Robot(model), mujoco.MjData(model), np.random.default_rng(0)
    M = np.zeros((model.nv, model.nv))
    J = np.zeros((6, model.nv))
    sites = [s for s in range(model.nsite) if model.site(s).name in robot._sites]
    assert sites
    for _ in range(200):
        q = rng.uniform(-2, 2, robot.n)
        dq = rng.uniform(-2, 2, robot.n)
        data.qpos[robot.qpos], data.qvel[robot.dof] = q, dq
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, M)
        robot.update(q, dq)
        np.testing.assert_allclose(robot.mass, M[np.ix_(robot.dof, robot.dof)], atol=1e-10)
        np.testing.assert_allclose(robot.bias, data.qfrc_bias[robot.dof], atol=1e-10)
        for s in sites:
            handle = robot.site(model.site(s).name)
            R, p = robot.placement(handle)
            mujoco.mj_jacSite(model, data, J[:3], J[3:], s)
            np.testing.assert_allclose(p, data.site_xpos[s], atol=1e-10)
            np.testing.assert_allclose(R, data.site_xmat[s].reshape(3, 3), atol=1e-10)
            np.testing.assert_allclose(robot.jacobian(handle), J[:, robot.dof], atol=1e-10)


def test_gravity_torque_is_the_bias_at_rest(model):
    robot = Robot(model)
    q = np.full(robot.n, 0.3)
    robot.update(q, np.zeros(robot.n))
    np.testing.assert_allclose(robot.gravity_torque(q), robot.bias, atol=1e-12)


def test_unknown_site_names_the_known_ones():
    robot = Robot(mujoco.MjModel.from_xml_string(AWKWARD))
    with pytest.raises(SimulationError, match=r"no site 'hand'.*'tip'"):
        robot.site("hand")


def test_a_joint_without_motor_is_named():
    xml = AWKWARD.replace('<motor joint="b"/>', "")
    with pytest.raises(SimulationError, match="'b'"):
        Robot(mujoco.MjModel.from_xml_string(xml))
