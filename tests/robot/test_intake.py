import os

import mujoco
import numpy as np
import pytest

from tpsim.paths import MODELS
from tpsim.robot.holding import holding_torque
from tpsim.robot.intake import take_in

_OURS = {
    "baxter": {"left": "left_gripper", "right": "right_gripper"},
    "planar3": {"hand": "tip"},
    "planar5": {"left": "left_hand", "right": "right_hand"},
}
_TOOL = {"hand": "tool"}


def _limits(model):
    return {model.actuator(a).name: model.actuator_ctrlrange[a, 1] for a in range(model.nu)}


def _home_data(source, model):
    data = mujoco.MjData(model)
    positions = dict(zip(source.joints, source.home, strict=True)) | dict(source.others)
    for name, position in positions.items():
        data.joint(name).qpos = position
    mujoco.mj_forward(model, data)
    return data


@pytest.mark.parametrize("name", _OURS)
def test_a_robot_of_motors_stays_exactly_as_it_is(name):
    path = MODELS / f"{name}.xml"
    source = take_in(path, hands=_OURS[name])
    before, after = mujoco.MjModel.from_xml_path(str(path)), source.spec.compile()
    for field in dir(before):
        value = getattr(before, field)
        if isinstance(value, np.ndarray):
            np.testing.assert_array_equal(getattr(after, field), value, err_msg=field)
    assert source.joints == tuple(before.joint(j).name for j in range(before.njnt))
    assert not source.assets and not source.others
    assert source.changes == ("home posture: found in the middle of the ranges",)


def test_a_found_home_is_inside_the_ranges_regular_and_easily_held():
    source = take_in(MODELS / "baxter.xml", hands=_OURS["baxter"])
    model = source.spec.compile()
    low, high = model.jnt_range.T
    margin = np.minimum(source.home - low, high - source.home) / (high - low)
    assert margin.min() > 0.09
    torque = holding_torque(
        model, source.joints, dict(zip(source.joints, source.home, strict=True))
    )
    assert (np.abs(torque) < 0.8 * model.actuator_ctrlrange[:, 1]).all()
    data = _home_data(source, model)
    assert data.ncon == 0
    for hand in source.hands.values():
        J = np.zeros((6, model.nv))
        mujoco.mj_jacSite(model, data, J[:3], J[3:], model.site(hand).id)
        assert np.linalg.svd(J, compute_uv=False)[5] > 0.05


def test_a_planar_arm_in_a_string_gets_motors(planar_arm):
    source = take_in(planar_arm, hands={"hand": "tip"}, torque_limit={"joint[12]": 20, ".*": 5})
    model = source.spec.compile()
    assert source.joints == ("joint1", "joint2", "joint3", "joint4")
    assert _limits(model) == {
        "joint1_motor": 20,
        "joint2_motor": 20,
        "joint3_motor": 5,
        "joint4_motor": 5,
    }
    assert np.isinf(source.velocity_limit).all()
    data = _home_data(source, model)
    data.ctrl[:] = (1, 2, 3, 4)
    mujoco.mj_forward(model, data)
    np.testing.assert_array_equal(data.qfrc_actuator, (1, 2, 3, 4))


@pytest.mark.parametrize("others", ["locked", "servo"])
def test_servos_gears_and_a_tendon_become_torque_motors(servo_arm, others):
    source = take_in(servo_arm, hands=_TOOL, others=others)
    model = source.spec.compile()
    assert source.joints == ("shoulder", "elbow", "roll", "wrist")
    np.testing.assert_allclose(source.home, (0.3, -1, 0.2, 0.1))
    limits = _limits(model)
    arms = {"shoulder_motor": 60, "elbow_motor": 50, "roll_motor": 36, "wrist_torque": 6}
    assert limits == (arms if others == "locked" else {"gripper": 20, **arms})
    data = _home_data(source, model)
    for joint, torque in zip(source.joints, (10, -20, 3, 6), strict=True):
        motor = f"{joint}_motor" if joint != "wrist" else "wrist_torque"
        data.actuator(motor).ctrl = torque
    mujoco.mj_forward(model, data)
    dofs = [model.joint(joint).dofadr[0] for joint in source.joints]
    np.testing.assert_allclose(data.qfrc_actuator[dofs], (10, -20, 3, 6))
    assert "keyframes: removed; 'home' is home" in source.changes


def test_a_gripper_under_its_own_servo_stays(servo_arm):
    source = take_in(servo_arm, hands=_TOOL, others="servo")
    model = source.spec.compile()
    assert source.others == {"left": 0.01, "pad": 0.1, "right": 0.01}
    assert source.controls == {"gripper": 5}
    assert (model.ntendon, model.neq, model.nsensor, model.nexclude) == (1, 1, 3, 1)


def test_a_locked_gripper_keeps_its_place_and_weight(servo_arm):
    source = take_in(servo_arm, hands=_TOOL)
    model, original = source.spec.compile(), mujoco.MjModel.from_xml_string(servo_arm)
    assert (model.ntendon, model.neq, model.nkey, model.nexclude) == (0, 0, 0, 1)
    assert [model.sensor(i).type[0] for i in range(model.nsensor)] == [
        mujoco.mjtSensor.mjSENS_JOINTPOS
    ]
    assert not source.others and not source.controls
    before, after = mujoco.MjData(original), _home_data(source, model)
    mujoco.mj_resetDataKeyframe(original, before, 0)
    mujoco.mj_forward(original, before)
    np.testing.assert_allclose(after.xpos, before.xpos, atol=1e-12)
    np.testing.assert_allclose(after.xmat, before.xmat, atol=1e-12)
    np.testing.assert_allclose(after.qfrc_bias, before.qfrc_bias[:4], atol=1e-12)


def test_a_follower_is_locked_where_its_leader_puts_it(servo_arm):
    source = take_in(servo_arm, hands=_TOOL, home={"left": 0.03})
    assert "joint 'left' is no arm joint: locked at 0.03" in source.changes
    assert "joint 'right' is no arm joint: locked at 0.01" in source.changes
    bare = servo_arm[: servo_arm.index("<keyframe>")] + "</mujoco>"
    source = take_in(bare, hands=_TOOL, home={"left": 0.03})
    assert "joint 'right' is no arm joint: locked at 0.03" in source.changes


def test_only_the_arms_of_the_named_hands_move():
    source = take_in(MODELS / "planar5.xml", hands={"left": "left_hand"})
    assert source.joints == ("trunk", "left_shoulder", "left_elbow")
    model = source.spec.compile()
    assert (model.nq, model.nu) == (3, 3)


def test_the_jaco_takes_torque_limits_and_compiles_anywhere(jaco, tmp_path, monkeypatch):
    before = jaco.compile()
    source = take_in(
        jaco,
        hands={"hand": "hand/gripsite"},
        torque_limit={"joint_[123]": 40, "joint_[456]": 15},
        velocity_limit=1,
    )
    assert len(source.assets) == 9 and (source.velocity_limit == 1).all()
    monkeypatch.chdir(tmp_path)
    assert not os.listdir()
    text = mujoco.MjModel.from_xml_string(source.spec.to_xml(), dict(source.assets))
    alone = source.spec.copy().compile()
    for model in (text, alone):
        assert (model.njnt, model.nu, model.nmesh) == (6, 6, 9)
        np.testing.assert_allclose(model.body_mass, before.body_mass, rtol=1e-5)
        np.testing.assert_allclose(model.dof_armature, (4, 4, 4, 2, 2, 2))
        np.testing.assert_allclose(model.dof_frictionloss, (2, 2, 2, 1, 1, 1))
    assert [bool(limited) for limited in text.jnt_limited] == [False, True, True, *[False] * 3]
    # The user's spec is as it was.
    after = jaco.compile()
    assert (after.njnt, after.nu) == (before.njnt, 0)
    assert not jaco.assets


def test_files_of_the_same_name_in_different_folders_stay_apart(jaco_folder, tmp_path):
    shapes = {"one": "base.stl", "two": "wrist.stl"}
    for folder, mesh in shapes.items():
        (tmp_path / folder).mkdir()
        content = (jaco_folder / "meshes_decimated" / mesh).read_bytes()
        (tmp_path / folder / "shape.stl").write_bytes(content)
    text = """
    <mujoco><asset><mesh name="a" file="one/shape.stl"/><mesh name="b" file="two/shape.stl"/>
    </asset><worldbody><body><joint name="j"/><geom type="mesh" mesh="a" mass="1"/>
    <geom type="mesh" mesh="b" mass="1"/><site name="s"/></body></worldbody>
    <actuator><motor joint="j" ctrlrange="-90 90"/></actuator></mujoco>"""
    path = tmp_path / "robot.xml"
    path.write_text(text)
    source = take_in(path, hands={"hand": "s"})
    assert len(source.assets) == 2
    loaded = mujoco.MjModel.from_xml_string(source.spec.to_xml(), dict(source.assets))
    np.testing.assert_array_equal(
        loaded.mesh_vertnum, mujoco.MjModel.from_xml_path(str(path)).mesh_vertnum
    )


_ONE = """
<mujoco><worldbody><body name="b"><joint name="j" axis="0 1 0"{joint}/>
<geom type="capsule" fromto="0 0 0 1 0 0" size="0.05" mass="1"/><site name="s" pos="1 0 0"/>
</body></worldbody><actuator>{actuators}</actuator></mujoco>"""
_DOWN = {"j": np.pi / 2}


@pytest.mark.parametrize(
    ("actuators", "joint", "given", "limit"),
    [
        ('<motor joint="j" ctrlrange="-2 2" gear="10"/>', "", None, 20),
        ('<motor joint="j" ctrlrange="-2 2" gear="-10"/>', "", None, 20),
        ('<motor joint="j" ctrlrange="-9 9" forcerange="-2 2"/>', "", None, 2),
        ('<motor joint="j"/>', ' actuatorfrcrange="-7 7"', None, 7),
        ('<motor joint="j" ctrlrange="-9 9"/>', ' actuatorfrcrange="-7 7"', 30, 30),
        ('<velocity joint="j" kv="5" forcerange="-6 4" gear="2"/>', "", None, 8),
        ('<intvelocity joint="j" kp="5" actrange="-1 1" forcerange="-6 6"/>', "", None, 6),
        ('<position joint="j" kp="9" ctrlrange="-1 1"/>', "", 11, 11),
        (
            '<position joint="j" forcerange="-5 5"/><velocity joint="j" forcerange="-5 5"/>',
            "",
            None,
            5,
        ),
        ('<position joint="j" kp="9"/><motor joint="j" ctrlrange="-3 3"/>', "", None, 3),
    ],
)
def test_the_torque_limit_is_what_the_file_states(actuators, joint, given, limit):
    text = _ONE.format(actuators=actuators, joint=joint)
    source = take_in(text, hands={"h": "s"}, torque_limit=given, home=_DOWN)
    model = source.spec.compile()
    assert list(_limits(model).values()) == [limit]
    data = mujoco.MjData(model)
    data.ctrl[:] = 1000
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.qfrc_actuator, limit)


def test_armature_and_damping_of_a_removed_servo_stay_with_the_joint():
    servo = '<position joint="j" kp="9" gear="3" armature="0.2" damping="0.5" forcerange="-9 9"/>'
    text = _ONE.format(actuators=servo, joint="")
    after = take_in(text, hands={"h": "s"}, home=_DOWN).spec.compile()
    before = mujoco.MjModel.from_xml_string(text)
    assert after.dof_M0[0] == pytest.approx(before.dof_M0[0])
    assert after.dof_damping[0] == pytest.approx(0.5 * 9)


def test_gravity_compensation_of_the_file_is_left_to_the_controller():
    motor = '<motor joint="j" ctrlrange="-9 9"/>'
    text = _ONE.format(actuators=motor, joint="").replace('name="b"', 'name="b" gravcomp="1"')
    source = take_in(text, hands={"h": "s"}, home=[0.0])
    assert source.spec.compile().ngravcomp == 0
    assert "gravity compensation of 1 bodies: removed" in source.changes


def test_openarm_is_taken_in_as_its_makers_ship_it():
    openarm = pytest.importorskip("openarm_mujoco.v2", reason="openarm-mujoco is not installed")
    hands = {side: f"{side}_ee_control_point" for side in ("left", "right")}
    source = take_in(openarm.openarm_bimanual_xml(), hands=hands)
    model = mujoco.MjModel.from_xml_string(source.spec.to_xml(), dict(source.assets))
    assert (model.nq, model.nu) == (14, 14)
    np.testing.assert_allclose(model.actuator_ctrlrange[:7, 1], (40, 40, 27, 27, 7, 7, 7))
