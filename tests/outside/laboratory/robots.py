"""Three robots: an arm in a string, an arm of servos with a gripper, and Kinova's Jaco."""

from importlib.util import find_spec
from pathlib import Path

from tpsim import lab

_LINK = """<body pos="{x} 0 0"><joint name="j{k}" axis="0 0 1" damping="0.1" armature="0.01"/>
<geom type="capsule" fromto="0 0 0 0.25 0 0" size="0.02" mass="1" contype="0" conaffinity="0"/>
{inner}</body>"""


def planar() -> lab.Robot:
    """Four links in the horizontal plane, of an MJCF text without any actuator."""
    inner = '<site name="tip" pos="0.25 0 0"/>'
    for k in (4, 3, 2, 1):
        inner = _LINK.format(k=k, x=0.25 if k > 1 else 0, inner=inner)
    text = f"<mujoco><worldbody>{inner}</worldbody></mujoco>"
    home = (0.3, 0.9, 0.7, 0.5)
    return lab.Robot.from_mjcf(text, {"hand": "tip"}, torque_limit=20, velocity_limit=4, home=home)


def servo_arm() -> lab.Robot:
    """Five joints of an MJCF file; the gripper keeps its own servo."""
    file = Path(__file__).with_name("servo_arm.xml")
    return lab.Robot.from_mjcf(file, {"hand": "tool"}, velocity_limit=3, others="servo")


def jaco() -> lab.Robot:
    """Kinova's Jaco from dm_control: meshes, includes, and no actuators in its file."""
    package = find_spec("dm_control")
    assert package is not None and package.submodule_search_locations
    folder = Path(package.submodule_search_locations[0]) / "third_party" / "kinova"
    return lab.Robot.from_mjcf(
        folder / "jaco_arm.xml",
        {"hand": "wristsite"},
        torque_limit=40,
        velocity_limit=2,
        home=(0.0, 2.9, 1.3, -2.07, 1.4, 0.0),
    )
