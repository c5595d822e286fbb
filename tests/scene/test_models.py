"""The files of models/: Baxter against the figures of its description."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from tpsim.catalogue import ours
from tpsim.paths import MODELS

REFERENCE = Path(__file__).parents[1] / "reference"
ARM = ("s0", "s1", "e0", "e1", "w0", "w1", "w2")
JOINTS = [f"{side}_{joint}" for side in ("left", "right") for joint in ARM]
LOWER = (-1.70167993878, -2.147, -3.05417993878, -0.05, -3.059, -1.57079632679, -3.059)
UPPER = (1.70167993878, 1.047, 3.05417993878, 2.618, 3.059, 2.094, 3.059)
EFFORT = (50, 50, 50, 50, 15, 15, 15)
VELOCITY = (1.5, 1.5, 1.5, 1.5, 4, 4, 4)
MASSES = {
    "upper_shoulder": 5.70044,
    "lower_shoulder": 3.22698,
    "upper_elbow": 4.31272,
    "lower_elbow": 2.07206,
    "upper_forearm": 2.24665,
    "lower_forearm": 1.60979,
    "wrist": 0.35093,
    "hand": 0.551,
}


@pytest.fixture(scope="module")
def baxter():
    return mujoco.MjModel.from_xml_path(str(MODELS / "baxter.xml"))


def test_gripper_poses_agree_with_the_description(baxter):
    with np.load(REFERENCE / "baxter_fk.npz") as figures:
        for i, q in enumerate(figures["q"]):
            data = mujoco.MjData(baxter)
            data.qpos = q
            mujoco.mj_kinematics(baxter, data)
            for side in ("left", "right"):
                site = data.site(f"{side}_gripper")
                assert np.abs(site.xpos - figures[f"{side}_position"][i]).max() <= 1e-6
                rotation = site.xmat.reshape(3, 3)
                assert np.abs(rotation - figures[f"{side}_rotation"][i]).max() <= 1e-6


def test_joints_and_motors_come_left_first(baxter):
    assert [baxter.joint(i).name for i in range(baxter.njnt)] == JOINTS
    assert [baxter.actuator(i).name for i in range(baxter.nu)] == JOINTS


def test_limits(baxter):
    np.testing.assert_allclose(baxter.jnt_range[:, 0], LOWER * 2, atol=1e-9)
    np.testing.assert_allclose(baxter.jnt_range[:, 1], UPPER * 2, atol=1e-9)
    np.testing.assert_allclose(baxter.actuator_ctrlrange[:, 1], EFFORT * 2)
    np.testing.assert_allclose(baxter.actuator_ctrlrange[:, 0], -np.array(EFFORT * 2))
    np.testing.assert_allclose(ours.baxter().velocity_limit, VELOCITY * 2)
    assert baxter.jnt_limited.all()
    assert baxter.actuator_ctrllimited.all()


def test_masses_and_inertia(baxter):
    for side in ("left", "right"):
        for link, mass in MASSES.items():
            assert baxter.body(f"{side}_{link}").mass[0] == pytest.approx(mass)
    trace = 0.04709102262 + 0.03766976455 + 0.03595988478
    assert baxter.body("left_upper_shoulder").inertia.sum() == pytest.approx(trace)
    moving = [b for b in range(baxter.nbody) if baxter.body_weldid[b]]
    assert baxter.body_mass[moving].sum() == pytest.approx(2 * sum(MASSES.values()))


def test_joint_physics(baxter):
    np.testing.assert_allclose(baxter.dof_damping, 0.7)
    np.testing.assert_allclose(baxter.dof_armature, [0.1, 0.1, 0.1, 0.1, 0.03, 0.03, 0.03] * 2)
    assert not baxter.dof_frictionloss.any()
    assert baxter.opt.timestep == 0.001
    assert baxter.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert baxter.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC


def test_the_torso_frame_is_the_origin(baxter):
    assert not baxter.site("torso").pos.any()
    assert baxter.body_weldid[baxter.site("torso").bodyid[0]] == 0


def test_cup_collides_as_one_cylinder_below_its_site():
    cup = mujoco.MjModel.from_xml_path(str(MODELS / "cup.xml"))
    (solid,) = np.flatnonzero(cup.geom_contype)
    assert cup.geom_type[solid] == mujoco.mjtGeom.mjGEOM_CYLINDER
    assert cup.site("cup").pos[2] == cup.geom_size[solid, 1]


def test_sugar_is_a_cube_around_its_site():
    sugar = mujoco.MjModel.from_xml_path(str(MODELS / "sugar.xml"))
    np.testing.assert_allclose(sugar.geom("sugar").size, 0.009)
    assert not sugar.site("sugar").pos.any()
