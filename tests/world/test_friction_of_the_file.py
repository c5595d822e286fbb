"""Friction that a file states: the plant has it, controllers and teachers' arms know it."""

import numpy as np
import pytest

from tpsim import lab
from tpsim.robot.mechanism import RUBBING

ARM = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast" gravity="0 0 0"/>
  <worldbody>
    <body name="upper"><joint name="one" axis="0 0 1" armature=".05" frictionloss="{f}"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" mass="1" contype="0" conaffinity="0"/>
      <body name="lower" pos=".3 0 0"><joint name="two" axis="0 0 1" armature=".05"
       frictionloss="{f}"/>
        <geom type="capsule" fromto="0 0 0 .25 0 0" size=".03" mass="1" contype="0"
         conaffinity="0"/>
        <site name="tip" pos=".25 0 0"/></body></body>
  </worldbody>
  <actuator>
    <motor joint="one" ctrlrange="-40 40"/><motor joint="two" ctrlrange="-40 40"/>
  </actuator>
</mujoco>"""

HOME = (0.3, 0.9)


def arm(friction):
    return lab.World.compose(
        lab.Robot.from_mjcf(ARM.format(f=friction), {"hand": "tip"}, home=HOME)
    )


def test_the_model_knows_it_and_never_gives_more_than_it_takes():
    robot = arm(0.3).robot
    np.testing.assert_allclose(robot.friction, 0.3)
    dq = np.linspace(-3, 3, 61)[:, None] * np.ones(2)
    torque = robot.friction_torque(dq)
    assert (torque * dq >= 0).all() and np.abs(torque).max() <= 0.3
    h = 1e-7
    slope = (robot.friction_torque(np.full(2, h)) - robot.friction_torque(np.full(2, -h))) / (2 * h)
    np.testing.assert_allclose(slope, 0.3 / RUBBING, rtol=1e-6)


def test_with_it_an_arm_yields_as_one_without():
    push = lab.Push("tip", (0.0, 8.0, 0.0), start=0.05, duration=0.6)

    def moved(world, plant):
        hold = lab.FixedImpedance(np.array(HOME), 30.0)
        trial = lab.rollout(world, hold, HOME, 0.65, people=[push], plant=plant)
        return np.linalg.norm(np.ptp(trial["hand_position"], axis=0))

    free, known = moved(arm(0.0), lab.Plant()), moved(arm(0.4), lab.Plant())
    unknown = moved(arm(0.0), lab.Plant(friction=0.4))
    assert known == pytest.approx(free, rel=0.05)
    assert unknown < 0.92 * free


def test_a_weightless_arm_is_led_as_easily():
    def force(friction):
        world = arm(friction)
        start = world.robot.at_home.pose("tip").position
        lead = lab.Lead("tip", tuple(start.tolist()), (0.08, -0.08, 0.0), start=0.0, duration=1.0)
        weightless = lab.Weightless(world.robot, damping=0.2)
        trial = lab.rollout(world, weightless, HOME, 1.0, people=[lead])
        return np.linalg.norm(trial["lead_wrench"][10:90, :3], axis=1).mean()

    assert force(0.4) < 1.35 * force(0.0)


def test_what_friction_takes_does_not_empty_the_tank():
    world = arm(0.4)
    push = lab.Push("tip", (0.0, 8.0, 0.0), start=0.05, duration=0.4)
    hold = lab.FixedImpedance(np.array(HOME), 30.0)
    trial = lab.rollout(world, hold, HOME, 1.2, people=[push])
    assert trial["energy_injected"].max() < 1e-3
