"""Scenes: what they hold, where it stands at the start, and that a text repeats its model."""

import mujoco
import numpy as np
import pytest

from tpsim.errors import SimulationError
from tpsim.sim import scene


@pytest.fixture(scope="module")
def home():
    model = mujoco.MjModel.from_xml_string(scene.cup_and_sugar())
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)
    return model, data


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


def test_text_repeats_the_model_bit_for_bit():
    first = mujoco.MjModel.from_xml_string(scene.cup_and_sugar())
    second = mujoco.MjModel.from_xml_string(scene.cup_and_sugar())
    for name in ("body_pos", "body_quat", "body_inertia", "site_pos", "key_qpos", "geom_size"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()


def test_unknown_model_names_those_that_exist():
    with pytest.raises(SimulationError, match=r"no model 'teapot'.*baxter.*cup.*sugar"):
        scene.read("teapot")


def test_unknown_site_names_those_that_exist():
    with pytest.raises(SimulationError, match=r"no site 'third_hand'.*left_gripper"):
        scene.hold(scene.read("baxter"), "cup", "third_hand", (0, 0, 0))
