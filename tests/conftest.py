"""Worlds that many tests share; nothing changes them."""

import pytest


@pytest.fixture(scope="session")
def cup_world():
    """Baxter with cup and sugar."""
    from tpsim.tasks.cup_and_sugar.task import CupAndSugar

    return CupAndSugar().stage


@pytest.fixture(scope="session")
def dock_world():
    """Baxter with a dock."""
    from tpsim.catalogue.ours import baxter
    from tpsim.scene.compose import Placed, world

    return world(baxter(), objects={"end": Placed("dock", (0.75, 0.0, 0.0))})


@pytest.fixture(scope="session")
def planar3_world():
    """The arm of three links and two pucks."""
    from tpsim.catalogue.ours import planar3
    from tpsim.scene.compose import Placed, world

    spots = {"first": (-0.35, 0.606, -0.054), "second": (0.35, 0.606, -0.054)}
    return world(planar3(), objects={name: Placed("marker", at) for name, at in spots.items()})


@pytest.fixture(scope="session")
def planar5_world():
    """The trunk with two arms and two pucks."""
    from tpsim.catalogue.ours import planar5
    from tpsim.scene.compose import Placed, world

    spots = {"left_object": (-0.35, 0.606, -0.054), "right_object": (0.35, 0.606, -0.054)}
    return world(planar5(), objects={name: Placed("marker", at) for name, at in spots.items()})


@pytest.fixture(scope="session")
def jaco_robot():
    """The Kinova Jaco of dm_control with its hand: six joints, fingers locked."""
    from importlib.util import find_spec
    from pathlib import Path

    import mujoco

    from tpsim.robot.robot import Robot

    package = find_spec("dm_control")
    if package is None or not package.submodule_search_locations:
        pytest.skip("dm-control is not installed")
    folder = Path(package.submodule_search_locations[0]) / "third_party" / "kinova"
    arm = mujoco.MjSpec.from_file(str(folder / "jaco_arm.xml"))
    hand = mujoco.MjSpec.from_file(str(folder / "jaco_hand.xml"))
    arm.attach(hand, site=arm.site("wristsite"), prefix="hand/")
    home = (0.0, 2.9, 1.3, -2.07, 1.4, 0.0)
    return Robot.from_mjcf(arm, {"hand": "hand/pinchsite"}, torque_limit=40.0, home=home)
