"""Scenes: what they hold, where it stands at the start, and that a text repeats its model."""

import mujoco
import numpy as np
import pytest

from tpsim.catalogue import ours
from tpsim.errors import SimulationError
from tpsim.robot.robot import Robot
from tpsim.scene import parts
from tpsim.scene.compose import Held, Placed, world
from tpsim.world.world import World


def start(world):
    simulation = world.simulation()
    simulation.reset(world.robot.home)
    return world.model, simulation.data


@pytest.fixture(scope="module")
def home(cup_world):
    return start(cup_world)


def test_home_holds_the_cup_level_and_the_sugar_above(home):
    _, data = home
    np.testing.assert_allclose(data.site("cup").xmat.reshape(3, 3)[:, 2], [0, 0, 1], atol=1e-4)
    above = data.site("sugar").xpos - data.site("cup").xpos
    np.testing.assert_allclose(above, [0, 0, 0.08], atol=1e-4)


@pytest.mark.parametrize("fixture", ["cup_world", "dock_world"])
def test_home_is_far_from_every_limit(fixture, request):
    model, data = start(request.getfixturevalue(fixture))
    low, high = model.jnt_range.T
    assert np.minimum(data.qpos - low, high - data.qpos).min() >= 0.4
    assert (np.abs(data.qfrc_bias) <= 0.75 * model.actuator_ctrlrange[:, 1]).all()
    assert data.ncon == 0


def test_gripper_is_horizontal_at_the_handle(home):
    _, data = home
    grip, cup = data.site("left_gripper"), data.site("cup")
    assert abs(grip.xmat.reshape(3, 3)[2, 2]) <= 1e-4
    handle = cup.xmat.reshape(3, 3).T @ (grip.xpos - cup.xpos)
    np.testing.assert_allclose(handle[:2], [-0.056, 0], atol=1e-6)


def test_objects_are_held_rigidly_and_the_model_knows_their_mass(home, cup_world):
    model, _ = home
    assert model.nv == model.nu == 14
    for held, hand in (("cup", "left_hand"), ("sugar", "right_hand")):
        assert model.body(held).weldid == model.body(hand).weldid
    empty = ours.baxter(cup_world.robot.home)
    assert np.abs(empty.at_home.bias - cup_world.robot.at_home.bias).max() > 0.5


def test_objects_can_be_moved():
    objects = {"goal": "dock", "spot": Placed("marker", (0.5, 0.1, 0.0), (1, 0, 0))}
    model, _ = start(found := world(ours.baxter(), objects=objects))
    assert found.objects == ("goal", "spot")
    for name in objects:
        assert model.body(name).mocapid[0] >= 0
        assert model.site(name).bodyid[0] == model.body(name).id
    np.testing.assert_allclose(model.mat("spot_paint").rgba[:3], [1, 0, 0])


@pytest.mark.parametrize("make", [ours.planar3, ours.planar5])
def test_planar_arms_move_in_the_plane_without_load(make):
    model, data = start(world(make(), objects={"puck": "marker"}))
    assert np.abs(data.qfrc_bias).max() <= 1e-12
    assert data.ncon == 0
    data.qpos = np.random.default_rng(0).uniform(-2, 2, model.nq)
    mujoco.mj_forward(model, data)
    on_robot = model.body_mocapid[model.site_bodyid] < 0
    assert np.abs(data.site_xpos[on_robot, 2]).max() <= 1e-12


def test_planar3_is_a_chain_that_points_along_its_last_link():
    pose = ours.planar3().at([0.4, -0.7, 0.9]).pose("tip")
    angles = np.cumsum([0.4, -0.7, 0.9])
    tip = np.array([0.30, 0.30, 0.20]) @ np.stack([np.cos(angles), np.sin(angles)], axis=1)
    np.testing.assert_allclose(pose.position[:2], tip, atol=1e-6)
    heading = [np.cos(angles[-1]), np.sin(angles[-1])]
    np.testing.assert_allclose(pose.rotation[:2, 0], heading, atol=1e-6)


def test_planar5_has_two_arms_on_one_trunk():
    robot = ours.planar5()
    assert robot.joints == (
        "trunk",
        "left_shoulder",
        "left_elbow",
        "right_shoulder",
        "right_elbow",
    )
    left, right = (robot.at_home.pose(f"{side}_hand").position for side in ("left", "right"))
    np.testing.assert_allclose(left, right * [-1, 1, 1], atol=1e-4)
    assert left[0] < 0 < left[1]


def test_a_world_repeats_from_its_text_bit_for_bit(cup_world):
    again = World(cup_world.xml, cup_world.description, cup_world.assets)
    for name in ("body_pos", "body_quat", "body_inertia", "site_pos", "geom_size"):
        assert getattr(again.model, name).tobytes() == getattr(cup_world.model, name).tobytes()


def test_any_mjcf_can_be_held_and_placed(tmp_path):
    ball = '<body name="ball"><geom size=".02" mass=".1"/></body>'
    text = f"<mujoco><worldbody>{ball}</worldbody></mujoco>"
    file = tmp_path / "stick.xml"
    file.write_text(text.replace("ball", "stick"))
    held = {"ball": Held(text, "tip")}
    found = world(ours.planar3(), held=held, objects={"post": Placed(str(file), (1, 0, 0))})
    assert found.model.body("ball").mass[0] == pytest.approx(0.1)
    np.testing.assert_allclose(found.model.body("post").pos, [1, 0, 0])


@pytest.mark.parametrize("turn", ['quat=".1 .7 -.5 .3"', 'euler="0.3 -1 2"', 'zaxis="1 2 -1"'])
def test_what_is_held_is_placed_in_the_axes_of_its_site(turn):
    arm = f"""<mujoco><worldbody><body name="arm"><joint name="j" range="-1 1" limited="true"/>
      <geom size=".1" mass="1"/><site name="tip" pos=".1 .2 .3" {turn}/>
      </body></worldbody><actuator><motor joint="j" ctrlrange="-9 9"/></actuator></mujoco>"""
    ball = """<mujoco><worldbody><body name="ball"><geom size=".02"/><site name="ball"/></body>
      </worldbody></mujoco>"""
    robot = Robot.from_mjcf(arm, {"hand": "tip"}, velocity_limit=1.0)
    held = Held(ball, "tip", (0.01, 0.02, 0.03), ((0, 1, 0), (0, 0, 1)))
    found = world(robot, held={"ball": held}).robot.at_home
    tip, ball = found.pose("tip"), found.pose("ball")
    there = tip.position + tip.rotation @ [0.01, 0.02, 0.03]
    # Scenes are text, of six digits.
    np.testing.assert_allclose(ball.position, there, atol=2e-6)
    np.testing.assert_allclose(ball.rotation, tip.rotation[:, [1, 2, 0]], atol=2e-6)


def test_a_camera_is_placed_by_the_robots_size():
    model = world(ours.planar3()).model
    assert [model.camera(i).name for i in range(model.ncam)] == ["hero"]


def test_unknown_model_names_those_that_exist():
    with pytest.raises(SimulationError, match=r"'pot': no model 'teapot'.*baxter.*cup.*sugar"):
        parts.read("teapot", "pot")


def test_unknown_site_names_those_that_exist():
    with pytest.raises(SimulationError, match=r"no site 'third_hand'.*left_gripper"):
        world(ours.baxter(), held={"cup": Held("cup", "third_hand")})
