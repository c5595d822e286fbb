"""Robots as users have them: a planar arm in a string, an arm of servos, the Kinova Jaco."""

from importlib.util import find_spec
from pathlib import Path

import mujoco
import pytest

_LINK = """
<body name="link{i}" pos="{x} 0 0">
  <joint name="joint{i}" axis="0 0 1" damping="0.1" armature="0.01"/>
  <geom type="capsule" fromto="0 0 0 0.25 0 0" size="0.02" mass="1"/>
  {inner}
</body>"""

SERVO_ARM = """
<mujoco model="servo">
  <compiler autolimits="true"/>
  <default>
    <joint damping="1"/>
    <position kp="1000" kv="10"/>
    <motor gear="3"/>
  </default>
  <worldbody>
    <body name="base" euler="0 0 30">
      <geom size="0.05" mass="2"/>
      <body name="upper" pos="0 0 0.1" euler="10 20 0">
        <joint name="shoulder" axis="0 1 0" range="-120 120" armature="0.1"/>
        <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="2"/>
        <body name="lower" pos="0.3 0 0">
          <joint name="elbow" axis="0 1 0" range="-150 10" ref="-30" frictionloss="0.1"/>
          <joint name="roll" axis="1 0 0" pos="0.05 0 0"/>
          <geom type="capsule" fromto="0 0 0 0.25 0 0" size="0.025" mass="1"/>
          <body name="wrist" pos="0.25 0 0">
            <joint name="wrist" axis="0 0 1" range="-90 90"/>
            <geom size="0.03" mass="0.4"/>
            <site name="tool" pos="0.1 0 0"/>
            <frame euler="0 0 20">
              <body name="left" pos="0.05 0.03 0" axisangle="1 0 0 15">
                <joint name="left" type="slide" axis="0 1 0" range="0 0.04"/>
                <joint name="pad" axis="0 0 1" pos="0.02 0 0" range="-40 40" stiffness="0.1"/>
                <geom type="box" size="0.03 0.005 0.01" pos="0.03 0.03 0" mass="0.05"/>
              </body>
            </frame>
            <body name="right" pos="0.05 -0.03 0">
              <joint name="right" type="slide" axis="0 -1 0" range="0 0.04"/>
              <geom type="box" size="0.03 0.005 0.01" pos="0.03 -0.03 0" mass="0.05"/>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <contact><exclude body1="left" body2="right"/></contact>
  <tendon>
    <fixed name="grip"><joint joint="left" coef="1"/><joint joint="right" coef="1"/></fixed>
  </tendon>
  <equality><joint joint1="right" joint2="left"/></equality>
  <actuator>
    <motor name="gripper" tendon="grip" gear="1" ctrlrange="-20 20"/>
    <position name="shoulder_servo" joint="shoulder" gear="2" forcerange="-30 30"/>
    <motor name="elbow_drive" joint="elbow" gear="50" ctrlrange="-1 1"/>
    <general name="roll_servo" joint="roll" gainprm="200" biastype="affine"
             biasprm="0 -200 -5" forcerange="-12 12"/>
    <motor name="wrist_torque" joint="wrist" gear="1" ctrlrange="-6 6"/>
  </actuator>
  <sensor>
    <jointpos joint="elbow"/><jointpos joint="left"/><actuatorfrc actuator="shoulder_servo"/>
    <tendonpos tendon="grip"/>
  </sensor>
  <keyframe>
    <key name="home" qpos="0.3 -1 0.2 0.1 0.01 0.1 0.01" ctrl="5 0 0 0 0"/>
    <key name="zero"/>
  </keyframe>
</mujoco>"""


def planar(links: int = 4) -> str:
    """An arm in the horizontal plane, without actuators."""
    inner = '<site name="tip" pos="0.25 0 0"/>'
    for i in range(links, 0, -1):
        inner = _LINK.format(i=i, x=0.25 if i > 1 else 0, inner=inner)
    return f'<mujoco model="planar"><worldbody>{inner}</worldbody></mujoco>'


@pytest.fixture
def planar_arm() -> str:
    return planar()


@pytest.fixture
def servo_arm() -> str:
    """Position servos, gears, a motor, and a gripper of two fingers that a tendon closes."""
    return SERVO_ARM


@pytest.fixture(scope="session")
def jaco_folder() -> Path:
    package = find_spec("dm_control")
    if package is None or not package.submodule_search_locations:
        pytest.skip("dm-control is not installed")
    return Path(package.submodule_search_locations[0]) / "third_party" / "kinova"


@pytest.fixture
def jaco(jaco_folder) -> mujoco.MjSpec:
    """Arm and hand, each of its own file with an include and a folder of meshes."""
    arm = mujoco.MjSpec.from_file(str(jaco_folder / "jaco_arm.xml"))
    hand = mujoco.MjSpec.from_file(str(jaco_folder / "jaco_hand.xml"))
    arm.attach(hand, site=arm.site("wristsite"), prefix="hand/")
    return arm
