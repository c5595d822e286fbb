"""The catalogue: what is found by a name, what hands are, and what is said where there is none."""

import mujoco
import numpy as np
import pytest

from tpsim import lab
from tpsim.catalogue import entry as entries
from tpsim.catalogue import menagerie
from tpsim.catalogue.hands import arms_in
from tpsim.catalogue.robots import CATALOGUE, entry, find
from tpsim.errors import ArgumentError
from tpsim.robot import anatomy
from tpsim.robot.gripper import Gripper
from tpsim.robot.indices import Chain
from tpsim.study.reference import load_study
from tpsim.tasks import STUDIES

ARM = """
<mujoco model="panda">
  <compiler autolimits="true"/>
  <default><joint range="-2 2" armature="0.05" damping="0.5" frictionloss="0.2"/></default>
  <worldbody><body name="base"><geom size=".05"/>
    <body name="one" pos="0 0 .3"><joint axis="0 0 1"/><geom size=".04" mass="2"/>
      <body name="two"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>
        <body name="three" pos=".3 0 0"><joint axis="0 1 0"/>
          <geom type="capsule" fromto="0 0 0 .25 0 0" size=".03"/>
          <body name="four" pos=".25 0 0"><joint axis="1 0 0"/><geom size=".03" mass=".3"/>
            <body name="five"><joint axis="0 1 0"/><geom size=".02" mass=".2"/>
              <body name="palm" pos=".05 0 0"><joint axis="1 0 0"/><geom size=".02" mass=".2"/>
                <body name="thumb" pos=".05 .02 0">
                  <joint type="slide" axis="0 1 0" range="0 .04" frictionloss="0"/>
                  <geom type="box" size=".03 .005 .01" mass=".02"/></body>
                <body name="finger" pos=".05 -.02 0">
                  <joint type="slide" axis="0 -1 0" range="0 .04" frictionloss="0"/>
                  <geom type="box" size=".03 .005 .01" mass=".02"/></body>
              </body></body></body></body></body></body></body>
  </worldbody>
  <actuator>
    <position joint="joint1" forcerange="-60 60" kp="100"/>
    <position joint="joint2" forcerange="-60 60" kp="100"/>
    <position joint="joint3" forcerange="-40 40" kp="100"/>
    <position joint="joint4" forcerange="-12 12" kp="50"/>
    <position joint="joint5" forcerange="-12 12" kp="50"/>
    <position joint="joint6" forcerange="-12 12" kp="50"/>
  </actuator>
</mujoco>"""


def named(text):
    """The joints and actuators of the arm with names."""
    for kind, count in (("joint", 6),):
        for i in range(1, count + 1):
            text = text.replace(f"<{kind} axis", f'<{kind} name="{kind}{i}" axis', 1)
    return text


@pytest.fixture(scope="module")
def small():
    """Robot of an arm whose hand has to be found."""
    return arms_in(mujoco.MjSpec.from_string(named(ARM)), "panda").robot()


def test_hands_are_found_where_fingers_begin(small):
    assert small.n == 6
    pose, palm = small.at_home.pose("left_gripper"), small.at_home
    assert small.hands == {"left_hand": "left_gripper"}
    # It reaches along the hand's x axis, which is the wrist's, and fingers open along its y.
    wrist = palm.jacobian("left_gripper")[3:, -1]
    np.testing.assert_allclose(pose.rotation[:, 2], wrist, atol=1e-12)
    assert anatomy.elbow(small, "left_gripper") == "joint3"
    assert anatomy.length(small, "left_gripper") == pytest.approx(0.3 + 0.25 + 0.05 + 0.06)


def test_strength_is_what_the_weakest_joint_holds(small):
    q = small.home
    force = anatomy.strength(small, "left_gripper", q)
    state = small.at(q)
    J, spare = state.jacobian("left_gripper")[:3], small.torque_limit - np.abs(state.gravity)
    directions = np.random.default_rng(0).normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    assert (np.abs(force * directions @ J) <= spare + 1e-9).all()
    worst = np.abs(J.T @ (J[:, k := int((np.linalg.norm(J, axis=0) / spare).argmax())]))
    assert force * worst[k] / np.linalg.norm(J[:, k]) == pytest.approx(spare[k])


def test_a_gripper_is_a_frame_on_a_site_or_a_body(small):
    spec = mujoco.MjSpec.from_string(named(ARM))
    frame = Gripper("palm", (0.1, 0, 0), reach=(2, 0, 0), across=(0, 0, -1))
    robot = lab.Robot.from_mjcf(spec, {"hand": frame})
    hand, own = robot.at_home.pose("hand"), small.at_home
    R = frame.rotation
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1)
    np.testing.assert_allclose(R[:, 2], [1, 0, 0])
    np.testing.assert_allclose(R[:, 1], [0, 0, -1])
    assert hand.position.shape == own.pose("left_gripper").position.shape
    with pytest.raises(ArgumentError, match="orthogonal"):
        Gripper("palm", reach=(1, 0, 0), across=(1, 1, 0))
    with pytest.raises(ArgumentError, match=r"'nail', which is neither site nor body.*thumb"):
        lab.Robot.from_mjcf(spec, {"hand": Gripper("nail")})


def test_a_chain_names_the_joints_of_a_hand(small):
    np.testing.assert_array_equal(small.index(Chain("left_gripper")), np.arange(6))
    assert lab.Joints(Chain("left_gripper"))(small.at_home).value.shape == (6,)


def test_an_unknown_robot_is_said_with_the_nearest_names():
    with pytest.raises(ArgumentError, match=r"'openarms'; did you mean openarm"):
        entry("openarms")
    with pytest.raises(ArgumentError, match=r"there is no file nowhere\.xml"):
        find("nowhere.xml")


def test_a_missing_package_is_said_with_how_to_install_it(monkeypatch):
    monkeypatch.setattr(entries, "find_spec", lambda name: None)
    with pytest.raises(ArgumentError, match="pip install openarm-mujoco"):
        CATALOGUE["openarm"].robot()
    assert CATALOGUE["baxter"].is_at_hand
    monkeypatch.setattr(menagerie, "find_spec", lambda name: None)
    with pytest.raises(ArgumentError, match="pip install mujoco-menagerie"):
        entry("menagerie:franka_emika_panda")


def test_menagerie_is_read_from_a_local_folder(monkeypatch, tmp_path):
    pytest.importorskip("mujoco_menagerie")
    folder = tmp_path / "franka_emika_panda"
    folder.mkdir()
    (folder / "panda.xml").write_text(named(ARM))
    monkeypatch.setenv("MENAGERIE_ROOT", str(tmp_path))
    robot = entry("menagerie:franka_emika_panda").robot()
    assert robot.n == 6 and "left_elbow" in robot.sites


def test_a_download_that_fails_is_one_line(monkeypatch, tmp_path):
    pytest.importorskip("mujoco_menagerie")
    monkeypatch.setenv("MENAGERIE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("MENAGERIE_BASE_URL", f"file://{tmp_path}/nothing")
    with pytest.raises(ArgumentError, match="cannot be downloaded") as told:
        entry("menagerie:franka_emika_panda").robot()
    assert "\n" not in str(told.value)
    with pytest.raises(ArgumentError, match="quadruped"):
        entry("menagerie:anybotics_anymal_b")
    with pytest.raises(ArgumentError, match="Did you mean 'franka_fr3'"):
        entry("menagerie:franka_fr4")


def test_a_file_of_a_user_is_a_robot(tmp_path):
    (tmp_path / "arm.xml").write_text(named(ARM))
    assert find(str(tmp_path / "arm.xml")).n == 6
    (tmp_path / "mine.py").write_text(
        "from tpsim import lab\n"
        f"ARM = {str(tmp_path / 'arm.xml')!r}\n"
        "arms = lab.Arms(ARM, {'left': lab.Gripper('palm', reach=(1, 0, 0))}, {'left': 'three'})\n"
        "number = 3\n"
    )
    robot = find(f"{tmp_path / 'mine.py'}:arms")
    assert robot.velocity_limit.max() == 3.0 and "left_elbow" in robot.sites
    with pytest.raises(ArgumentError, match=r"is int; name lab\.Arms"):
        find(f"{tmp_path / 'mine.py'}:number")


def urdf(joints=5):
    """An arm of a URDF, whose links touch each other where they meet."""
    inertial = (
        '<inertial><mass value="1"/><origin xyz="0 0 .1"/>'
        '<inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    shape = (
        '<collision><origin xyz="0 0 .1"/><geometry><cylinder radius=".03" length=".2"/>'
        "</geometry></collision>"
    )
    text = f'<robot name="arm"><link name="base">{inertial}</link>'
    before = "base"
    for k in range(joints):
        axis = "0 0 1" if k % 2 == 0 else "0 1 0"
        text += (
            f'<link name="l{k}">{inertial}{shape}</link><joint name="j{k}" type="revolute">'
            f'<parent link="{before}"/><child link="l{k}"/><origin xyz="0 0 .2"/>'
            f'<axis xyz="{axis}"/><limit lower="-2" upper="2" effort="50" velocity="{1 + k / 10}"/>'
            "</joint>"
        )
        before = f"l{k}"
    return text + "</robot>"


def test_hands_of_a_urdf_are_found_and_it_moves_as_fast_as_it_says(tmp_path):
    file = tmp_path / "arm.urdf"
    file.write_text(urdf())
    found = find(str(file))
    assert found.hands == {"left_hand": "left_gripper"} and "left_elbow" in found.sites
    np.testing.assert_allclose(found.velocity_limit, 1 + np.arange(5) / 10)
    named = lab.Arms(file, {"left": Gripper("l4", (0, 0, 0.2))}).robot()
    np.testing.assert_allclose(named.velocity_limit, found.velocity_limit)
    data = mujoco.MjData(named.model)
    mujoco.mj_forward(named.model, data)
    assert not data.ncon


def test_a_name_that_is_not_in_a_file_is_said_with_those_that_are(tmp_path):
    file = tmp_path / "my_arms.py"
    file.write_text("from tpsim.catalogue.ours import planar3\nmine = planar3()\n")
    with pytest.raises(ArgumentError, match=r"no 'nope' in .*its arms and robots are mine"):
        find(f"{file}:nope")


@pytest.mark.parametrize("task", ["pointing", "transfer"])
def test_a_robot_without_the_hand_of_a_task_is_told_what_is_missing(task, tmp_path):
    file = tmp_path / "bare.py"
    file.write_text("from tpsim.catalogue.ours import planar5\nrobot = planar5()\n")
    with pytest.raises(ArgumentError, match=r"need one at 'left_gripper', and a site 'left_elbow'"):
        load_study(task, STUDIES).with_task(robot=str(file)).task.world()
