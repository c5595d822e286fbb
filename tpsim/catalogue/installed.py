"""Robots of installed packages, whose files nobody here wrote."""

from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np

from tpsim.catalogue.arms import Arms
from tpsim.catalogue.openarm import openarm as openarm
from tpsim.robot.gripper import Gripper

_APART = 0.938
"""Between the two ViperX [m]."""

_VIPERX_WRIST = {".*/wrist_angle": 30.0, ".*/wrist_rotate": 30.0}
"""Torque limits [Nm] of the joints for which gym-aloha's file states none."""


def jaco() -> Arms:
    """Kinova's Jaco of dm_control: one arm of six joints, three fingers; limits are Kinova's."""
    # The package itself is not imported: it looks for a screen.
    found = find_spec("dm_control")
    assert found is not None and found.submodule_search_locations
    folder = Path(next(iter(found.submodule_search_locations))) / "third_party" / "kinova"
    spec = mujoco.MjSpec.from_file(str(folder / "jaco_arm.xml"))
    hand = mujoco.MjSpec.from_file(str(folder / "jaco_hand.xml"))
    spec.attach(hand, site=spec.site("wristsite"), prefix="hand_")
    return Arms(
        spec,
        # The Jaco's fingers close along the site's x axis.
        {"left": Gripper("hand_gripsite", reach=(0, 0, 1), across=(1, 0, 0))},
        {"left": "b_3"},
        torque_limit={"joint_[123]": 30.5, "joint_[456]": 6.8},
        velocity_limit={"joint_[123]": 0.63, "joint_[456]": 0.84},
    )


_IDENTIFIED = {
    # joint: friction [Nm], damping [Nms/rad], armature [kg m^2], torque limit [Nm]
    "waist": (0.0, 5.76, 0.0, 35.0),
    "shoulder": (2.0, 20.0, 0.395, 144.0),
    "elbow": (1.15, 18.49, 0.383, 59.0),
    "forearm_roll": (0.0, 6.78, 0.14, 22.0),
    "wrist_angle": (0.0, 6.28, 0.008, 35.0),
    "wrist_rotate": (0.0, 1.2, 0.0, 35.0),
}
"""Joints of Aloha's ViperX as MuJoCo Menagerie's model ``aloha`` states them."""


def aloha() -> Arms:
    """Aloha's two ViperX of gym-aloha with joints that a hand can move, as they are identified."""
    arms = viperx()
    spec = arms.file
    assert isinstance(spec, mujoco.MjSpec)
    for joint in spec.joints:
        if (kind := joint.name.rpartition("/")[2]) in _IDENTIFIED:
            joint.frictionloss, joint.damping[0], joint.armature, _ = _IDENTIFIED[kind]
    limits = {f".*/{kind}": limit for kind, (*_, limit) in _IDENTIFIED.items()}
    return replace(arms, torque_limit=limits)


def viperx() -> Arms:
    """Aloha's two ViperX 300 of gym-aloha: six joints each, on either side of a table."""
    import gym_aloha

    folder = Path(str(gym_aloha.__file__)).parent / "assets"
    spec = mujoco.MjSpec.from_file(str(folder / "bimanual_viperx_transfer_cube.xml"))
    for name in ("box", "table"):
        spec.delete(spec.body(name))
    for kind in (spec.keys, spec.lights, spec.worldbody.cameras):
        for element in list(kind):
            spec.delete(element)
    for side, way in (("left", 1), ("right", -1)):
        # Beside each other along y, as the arms of other robots are; they still face each other.
        base = spec.body(f"vx300s_{side}")
        base.pos = (0, way * _APART / 2, 0)
        base.quat = (np.sqrt(0.5), 0, 0, -way * np.sqrt(0.5))
        base.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    return Arms(
        spec,
        {
            side: Gripper(f"vx300s_{side}/gripper_link", (0.15, 0, 0), (1, 0, 0), (0, 1, 0))
            for side in ("left", "right")
        },
        {side: f"vx300s_{side}/upper_forearm_link" for side in ("left", "right")},
        torque_limit=_VIPERX_WRIST,
        home=2 * (0, -0.96, 1.16, 0, -0.3, 0),
    )
