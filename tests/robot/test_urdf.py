import shutil

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from tpsim.errors import ArgumentError
from tpsim.robot.intake import take_in_urdf
from tpsim.robot.pinocchio_model import pinocchio_model

_INERTIAL = """<inertial><origin xyz="0.1 0.02 0" rpy="0.1 0.2 0.3"/><mass value="{mass}"/>
<inertia ixx="0.01" iyy="0.02" izz="0.025" ixy="0.001" ixz="0" iyz="0.002"/></inertial>"""

_GRAM = """<inertial><mass value="1e-3"/>
<inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial>"""

_ARM = f"""<robot name="arm">
  <link name="world"/>
  <link name="base">{_INERTIAL.format(mass=3)}
    <visual><geometry><mesh filename="package://maker/meshes/base.stl"/></geometry></visual>
    <collision><geometry><mesh filename="package://maker/meshes/base.dae"/></geometry></collision>
  </link>
  <link name="upper">{_INERTIAL.format(mass=2)}
    <collision><geometry><box size="0.3 0.05 0.05"/></geometry></collision></link>
  <link name="elbow_frame"/>
  <link name="lower">{_INERTIAL.format(mass=1)}
    <visual><geometry><sphere radius="0.1"/></geometry></visual></link>
  <link name="flange"/>
  <link name="slider"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="tool"/>
  <link name="finger">{_INERTIAL.format(mass=0.1)}</link>
  <joint name="mount" type="fixed"><origin xyz="0 0 0.2" rpy="0 0 0.5"/>
    <parent link="world"/><child link="base"/></joint>
  <joint name="shoulder" type="revolute"><origin xyz="0 0 0.3" rpy="0.3 0 0"/>
    <parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="1.5" effort="60" velocity="2"/>
    <dynamics damping="0.7" friction="0.2"/></joint>
  <joint name="offset" type="fixed"><origin xyz="0.3 0 0"/>
    <parent link="upper"/><child link="elbow_frame"/></joint>
  <joint name="elbow" type="continuous"><parent link="elbow_frame"/><child link="lower"/>
    <axis xyz="0 0.6 0.8"/><limit effort="25" velocity="3"/></joint>
  <joint name="wrist" type="fixed"><origin xyz="0.2 0 0" rpy="0 1 0"/>
    <parent link="lower"/><child link="flange"/></joint>
  <joint name="reach" type="prismatic"><parent link="flange"/><child link="slider"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="0.2" effort="40" velocity="0.5"/></joint>
  <joint name="tool" type="fixed"><origin xyz="0.1 0 0"/>
    <parent link="slider"/><child link="tool"/></joint>
  <joint name="grip" type="prismatic"><parent link="tool"/><child link="finger"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.1" effort="5" velocity="1"/>
    <mimic joint="reach" multiplier="0.5"/></joint>
</robot>"""

_HANDS = {"hand": "tool"}


@pytest.fixture
def arm(tmp_path, jaco_folder):
    """A URDF in a package folder, its meshes beside it."""
    package = tmp_path / "maker"
    for folder in ("meshes", "urdf"):
        (package / folder).mkdir(parents=True)
    shutil.copy(jaco_folder / "meshes_decimated" / "base.stl", package / "meshes" / "base.stl")
    path = package / "urdf" / "arm.urdf"
    path.write_text(_ARM)
    return path


def test_limits_damping_and_links_are_taken_over(arm):
    source = take_in_urdf(arm, hands=_HANDS)
    assert source.joints == ("shoulder", "elbow", "reach")
    np.testing.assert_array_equal(source.velocity_limit, (2, 3, 0.5))
    model = source.spec.compile()
    np.testing.assert_array_equal(model.actuator_ctrlrange[:, 1], (60, 25, 40))
    np.testing.assert_array_equal(model.jnt_range, ((-2, 1.5), (0, 0), (0, 0.2)))
    assert not model.jnt_limited[1]
    np.testing.assert_array_equal(model.dof_damping, (0.7, 0, 0))
    np.testing.assert_array_equal(model.dof_frictionloss, (0.2, 0, 0))
    for link in ("elbow_frame", "flange", "tool", "finger"):
        assert model.body(link).jntnum[0] == 0
    assert "joint 'grip' is no arm joint: locked at 0" in source.changes


def test_limits_of_the_user_win(arm):
    source = take_in_urdf(
        arm, hands=_HANDS, torque_limit={"elbow": 70}, velocity_limit={"reach": 0.1}
    )
    np.testing.assert_array_equal(source.velocity_limit, (2, 3, 0.1))
    model = source.spec.compile()
    data = mujoco.MjData(model)
    data.ctrl[:] = 1000
    mujoco.mj_forward(model, data)
    np.testing.assert_array_equal(data.qfrc_actuator, (60, 70, 40))


def test_dynamics_are_those_that_pinocchio_reads_from_the_file(arm):
    """The robot's bias torque and hand are those of an independent reader of URDF."""
    source = take_in_urdf(arm, hands=_HANDS, torque_limit=100)
    ours = pinocchio_model(source.spec.compile(), source.joints, {})
    text = _ARM.replace('<mimic joint="reach" multiplier="0.5"/>', "")
    text = text.replace('<link name="slider">', f'<link name="slider">{_GRAM}')
    full = pin.buildModelFromXML(text)
    theirs = pin.buildReducedModel(full, [full.getJointId("grip")], pin.neutral(full))
    rng = np.random.default_rng(0)
    for _ in range(5):
        q, v = rng.normal(size=(2, 3))
        turned = np.array([q[0], np.cos(q[1]), np.sin(q[1]), q[2]])
        a, b = (
            pin.nonLinearEffects(m, m.createData(), x, v)
            for m, x in ((ours.model, q), (theirs, turned))
        )
        np.testing.assert_allclose(a, b, atol=1e-9)
        data, other = ours.model.createData(), theirs.createData()
        pin.framesForwardKinematics(ours.model, data, q)
        pin.framesForwardKinematics(theirs, other, turned)
        expected = other.oMf[theirs.getFrameId("tool", pin.FrameType.BODY)]
        np.testing.assert_allclose(
            data.oMf[ours.sites["tool"]].homogeneous, expected.homogeneous, atol=1e-9
        )


def test_meshes_are_found_kept_and_dropped_with_a_word(arm, tmp_path, monkeypatch):
    source = take_in_urdf(arm, hands=_HANDS)
    assert set(source.assets) == {"base.stl"}
    assert "meshes that MuJoCo cannot read: removed (base.dae)" in source.changes
    moved = tmp_path / "elsewhere"
    shutil.move(arm.parents[1], moved)
    named = take_in_urdf(moved / "urdf" / "arm.urdf", hands=_HANDS, packages={"maker": moved})
    shutil.rmtree(moved)
    monkeypatch.chdir(tmp_path)
    model = mujoco.MjModel.from_xml_string(named.spec.to_xml(), dict(named.assets))
    assert model.nmesh == 1


def test_links_without_inertia_weigh_nothing_or_a_gram(arm):
    arm.write_text(
        _ARM.replace(
            f'<link name="finger">{_INERTIAL.format(mass=0.1)}</link>', '<link name="finger"/>'
        )
    )
    source = take_in_urdf(arm, hands=_HANDS)
    model = source.spec.compile()
    assert "links slider, finger move but have no mass: 1 g given" in source.changes
    masses = {name: model.body(name).mass[0] for name in ("flange", "tool", "slider", "finger")}
    assert masses == {"flange": 0, "tool": 0, "slider": 1e-3, "finger": 1e-3}


def test_links_that_touch_at_home_do_not_collide(arm):
    overlap = '<collision><geometry><sphere radius="0.6"/></geometry></collision>'
    arm.write_text(_ARM.replace('<link name="tool"/>', f'<link name="tool">{overlap}</link>'))
    source = take_in_urdf(arm, hands=_HANDS)
    assert "'tool' and 'upper' touch at home: no contact" in source.changes
    model = source.spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = source.home
    mujoco.mj_forward(model, data)
    assert data.ncon == 0


@pytest.mark.parametrize(
    ("old", "new", "arguments", "message"),
    [
        ("", "", {"hands": {}}, "hands is empty: name a link.*flange"),
        ("", "", {"hands": {"hand": "grasp"}}, "'grasp', which is no link: .*flange.* are"),
        ("base.stl", "lost.stl", {}, "mesh package://maker/meshes/lost.stl .* pass packages="),
        ("prismatic", "floating", {}, "joint 'reach' .* is floating: a robot has"),
        ("<robot", "<robots", {}, "cannot be read: mismatched tag"),
        ('effort="25"', 'effort="0"', {}, "no torque limit for elbow"),
        ('<link name="base">', '<link name="upper">', {}, "cannot be read: .*repeated URDF name"),
    ],
)
def test_what_cannot_be_taken_in_is_one_line(arm, old, new, arguments, message):
    arm.write_text(_ARM.replace(old, new) if old else _ARM)
    with pytest.raises(ArgumentError, match=message) as caught:
        take_in_urdf(arm, **{"hands": _HANDS, **arguments})
    assert "\n" not in str(caught.value)


def test_a_file_that_is_no_urdf(tmp_path):
    with pytest.raises(ArgumentError, match=r"no file .*nowhere\.urdf"):
        take_in_urdf(tmp_path / "nowhere.urdf", hands=_HANDS)
    path = tmp_path / "arm.xml"
    path.write_text("<mujoco/>")
    with pytest.raises(ArgumentError, match="is no URDF: its root is <mujoco>"):
        take_in_urdf(path, hands=_HANDS)
