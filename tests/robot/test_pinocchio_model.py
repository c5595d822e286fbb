import mujoco
import numpy as np
import pinocchio as pin
import pytest

from tpsim.errors import SimulationError
from tpsim.paths import MODELS
from tpsim.robot.intake import take_in
from tpsim.robot.pinocchio_model import pinocchio_model

_JACO_LIMIT = {"joint_[123]": 40, "joint_[456]": 15}


def _ours(name):
    return mujoco.MjModel.from_xml_path(str(MODELS / f"{name}.xml"))


@pytest.fixture(params=["baxter", "planar3", "planar5", "planar_arm", "servo_arm", "jaco"])
def robot(request):
    """Compiled robot, the joints that move, and where the others stand."""
    if request.param in ("baxter", "planar3", "planar5"):
        model = _ours(request.param)
        return model, tuple(model.joint(j).name for j in range(model.njnt)), {}
    source = request.getfixturevalue(request.param)
    if request.param == "planar_arm":
        found = take_in(source, hands={"hand": "tip"}, torque_limit=5)
    elif request.param == "servo_arm":
        found = take_in(source, hands={"hand": "tool"}, others="servo")
    else:
        found = take_in(source, hands={"hand": "hand/gripsite"}, torque_limit=_JACO_LIMIT)
    return found.spec.compile(), found.joints, found.others


def _state(model, joints, fixed, rng):
    """MuJoCo data at a random state in which the other joints stand still."""
    data = mujoco.MjData(model)
    ids = [model.joint(j).id for j in joints]
    q, v = rng.normal(size=(2, len(ids)))
    for name, position in fixed.items():
        data.qpos[model.jnt_qposadr[model.joint(name).id]] = position
    data.qpos[model.jnt_qposadr[ids]], data.qvel[model.jnt_dofadr[ids]] = q, v
    mujoco.mj_forward(model, data)
    return data, model.jnt_dofadr[ids], q, v


def test_inertia_and_bias_are_mujocos(robot):
    model, joints, fixed = robot
    built = pinocchio_model(model, joints, fixed)
    rng = np.random.default_rng(0)
    for _ in range(5):
        data, dofs, q, v = _state(model, joints, fixed, rng)
        M = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, M)
        P = pin.crba(built.model, built.model.createData(), q)
        P = np.triu(P) + np.triu(P, 1).T
        np.testing.assert_allclose(P, M[np.ix_(dofs, dofs)], atol=1e-10)
        bias = pin.nonLinearEffects(built.model, built.model.createData(), q, v)
        np.testing.assert_allclose(bias, data.qfrc_bias[dofs], atol=1e-10)


def test_sites_and_jacobians_are_mujocos(robot):
    model, joints, fixed = robot
    built = pinocchio_model(model, joints, fixed)
    assert len(built.sites) == model.nsite
    data, dofs, q, _ = _state(model, joints, fixed, np.random.default_rng(1))
    computed = built.model.createData()
    pin.computeJointJacobians(built.model, computed, q)
    pin.updateFramePlacements(built.model, computed)
    for name, frame in built.sites.items():
        site = model.site(name).id
        at = computed.oMf[frame]
        np.testing.assert_allclose(at.translation, data.site_xpos[site], atol=1e-10)
        np.testing.assert_allclose(at.rotation.ravel(), data.site_xmat[site], atol=1e-10)
        J = np.zeros((6, model.nv))
        mujoco.mj_jacSite(model, data, J[:3], J[3:], site)
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        mine = pin.getFrameJacobian(built.model, computed, frame, axes)
        np.testing.assert_allclose(mine, J[:, dofs], atol=1e-10)


def test_free_and_mocap_bodies_are_objects():
    spec = mujoco.MjSpec.from_file(str(MODELS / "planar3.xml"))
    box = spec.worldbody.add_body(name="box")
    box.add_freejoint()
    box.add_geom(size=(0.1, 0.1, 0.1), mass=1)
    lid = box.add_body(name="lid")
    lid.add_joint(name="hinge")
    lid.add_geom(size=(0.1, 0.1, 0.1), mass=1)
    lid.add_site(name="lid")
    spec.worldbody.add_body(name="marker", mocap=True).add_site(name="marker")
    model = spec.compile()
    built = pinocchio_model(model, ["joint1", "joint2", "joint3"], {})
    assert built.model.nq == 3
    assert not {"lid", "marker"} & set(built.sites)
    with pytest.raises(SimulationError, match="no joints hinge on the robot"):
        pinocchio_model(model, ["joint1", "hinge"], {})


def test_armature_of_an_actuator_counts_behind_its_gear():
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><joint name="j" armature="0.5"/><geom size="0.1"/></body>'
        '</worldbody><actuator><general joint="j" gear="5" armature="0.1"/></actuator></mujoco>'
    )
    built = pinocchio_model(model, ["j"], {})
    assert pin.crba(built.model, built.model.createData(), np.zeros(1))[0, 0] == pytest.approx(
        model.dof_M0[0]
    )


def test_a_ball_joint_does_not_move():
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><joint name="j" type="ball"/><geom size="0.1"/></body>'
        "</worldbody></mujoco>"
    )
    with pytest.raises(SimulationError, match="'j' is a mjJNT_BALL"):
        pinocchio_model(model, ["j"], {})
