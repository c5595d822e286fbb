"""Scenes: what they hold, where it stands at the start, and that a text repeats its model."""

import mujoco
import numpy as np
import pytest

from tpsim.errors import SimulationError
from tpsim.sim import scene, stage


def start(xml):
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)
    return model, data


@pytest.fixture(scope="module")
def home():
    return start(scene.cup_and_sugar())


def test_home_holds_the_cup_level_and_the_sugar_above(home):
    _, data = home
    np.testing.assert_allclose(data.site("cup").xmat.reshape(3, 3)[:, 2], [0, 0, 1], atol=1e-4)
    above = data.site("sugar").xpos - data.site("cup").xpos
    np.testing.assert_allclose(above, [0, 0, 0.08], atol=1e-4)


def test_home_is_far_from_every_limit(home):
    model, data = home
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


def test_objects_are_held_rigidly(home):
    model, _ = home
    assert model.nv == model.nu == 14
    for held, hand in (("cup", "left_hand"), ("sugar", "right_hand")):
        assert model.body(held).weldid == model.body(hand).weldid


def test_baxter_is_ready_with_empty_hands_and_movable_objects():
    model, data = start(scene.baxter({"start": "dock", "goal": "dock", "spot": "marker"}))
    assert model.nmocap == 3
    for name in ("start", "goal", "spot"):
        assert model.body(name).mocapid[0] >= 0
        assert model.site(name).bodyid[0] == model.body(name).id
    low, high = model.jnt_range.T
    assert np.minimum(data.qpos - low, high - data.qpos).min() >= 0.4
    assert (np.abs(data.qfrc_bias) <= 0.75 * model.actuator_ctrlrange[:, 1]).all()
    assert data.ncon == 0


@pytest.mark.parametrize("make", [scene.planar3, scene.planar5])
def test_planar_arms_move_in_the_plane_without_load(make):
    model, data = start(make())
    assert np.abs(data.qfrc_bias).max() <= 1e-12
    assert data.ncon == 0
    rng = np.random.default_rng(0)
    data.qpos = rng.uniform(-2, 2, model.nq)
    mujoco.mj_forward(model, data)
    on_robot = model.body_mocapid[model.site_bodyid] < 0
    assert np.abs(data.site_xpos[on_robot, 2]).max() <= 1e-12


def test_planar3_is_a_chain_that_points_along_its_last_link():
    model, data = start(scene.planar3(["a"]))
    data.qpos = [0.4, -0.7, 0.9]
    mujoco.mj_kinematics(model, data)
    angles = np.cumsum(data.qpos)
    tip = np.array([0.30, 0.30, 0.20]) @ np.stack([np.cos(angles), np.sin(angles)], axis=1)
    np.testing.assert_allclose(data.site("tip").xpos[:2], tip, atol=1e-6)
    direction = data.site("tip").xmat.reshape(3, 3)[:2, 0]
    np.testing.assert_allclose(direction, [np.cos(angles[-1]), np.sin(angles[-1])], atol=1e-6)
    assert model.body("a").mocapid[0] == 0


def test_planar5_has_two_arms_on_one_trunk():
    model, data = start(scene.planar5())
    names = ["trunk", "left_shoulder", "left_elbow", "right_shoulder", "right_elbow"]
    assert [model.joint(i).name for i in range(model.njnt)] == names
    assert [model.actuator(i).name for i in range(model.nu)] == names
    left, right = data.site("left_hand").xpos, data.site("right_hand").xpos
    np.testing.assert_allclose(left, right * [-1, 1, 1], atol=1e-4)
    assert left[0] < 0 < left[1]


@pytest.mark.parametrize("make", [scene.cup_and_sugar, scene.baxter, scene.planar3, scene.planar5])
def test_text_repeats_the_model_bit_for_bit(make):
    first = mujoco.MjModel.from_xml_string(make())
    second = mujoco.MjModel.from_xml_string(make())
    for name in ("body_pos", "body_quat", "body_inertia", "site_pos", "key_qpos", "geom_size"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()


def test_unknown_model_names_those_that_exist():
    with pytest.raises(SimulationError, match=r"no model 'teapot'.*baxter.*cup.*sugar"):
        stage.read("teapot")


def test_unknown_site_names_those_that_exist():
    with pytest.raises(SimulationError, match=r"no site 'third_hand'.*left_gripper"):
        stage.hold(stage.read("baxter"), "cup", "third_hand", (0, 0, 0))
