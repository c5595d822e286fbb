"""Arms of any file, with the names by which tasks know their parts."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import mujoco

from tpsim.border import checked
from tpsim.checks import shown
from tpsim.errors import ArgumentError
from tpsim.robot.anatomy import elbow
from tpsim.robot.gripper import Gripper, add_frame
from tpsim.robot.holding import exclude_touching
from tpsim.robot.home import Home
from tpsim.robot.limits import Limit
from tpsim.robot.reading import Draft, read
from tpsim.robot.robot import Robot
from tpsim.robot.urdf import read_urdf

Side = Literal["left", "right"]

SLOW = 3.0
"""Speed of a joint [rad/s] that is not passed where a file states no limit."""

TIMESTEP = 0.001
"""Of the physics [s]."""


@dataclass(frozen=True)
class Arms:
    """One arm or two of a file; a robot of one arm has a left one.

    As a robot its hands are ``left_hand`` and ``right_hand`` with the sites ``left_gripper`` and
    ``right_gripper``, whose z axis is where the hand reaches to; ``left_elbow`` and ``right_elbow``
    are sites, too.

    Parameters
    ----------
    file : str, Path or MjSpec
        MJCF: path, text or specification; or the path of a URDF.
    grippers : mapping of side to Gripper
        Where each hand grips.
    elbows : mapping of side to str
        Body of the file that turns about the elbow; found, where it is not given.
    torque_limit, velocity_limit, home
        As :meth:`Robot.from_mjcf <tpsim.robot.robot.Robot.from_mjcf>` takes them; joints turn no
        faster than their URDF says, or 3 rad/s, by default.

    Raises
    ------
    ArgumentError
        Sides that are none, or a right arm alone.
    """

    file: Any
    grippers: Mapping[Side, Gripper]
    elbows: Mapping[Side, str] = field(default_factory=dict)
    torque_limit: Limit = None
    velocity_limit: Limit = SLOW
    home: Home = None

    def __post_init__(self) -> None:
        checked(self)
        if not isinstance(self.file, str | Path | mujoco.MjSpec):
            raise ArgumentError(f"file is {shown(self.file)}; give MJCF: path, text or a MjSpec")
        if "left" not in self.grippers:
            raise ArgumentError("arms without a left one: a robot of one arm has a left one")

    def robot(self) -> Robot:
        """The robot, taken in; errors are those of ``Robot.from_mjcf``."""
        draft, hands = draft_of(self.file), {}
        spec, velocity_limit = draft.spec, self.velocity_limit
        if velocity_limit == SLOW and draft.velocity_limit:
            velocity_limit = draft.velocity_limit
        for side, gripper in self.grippers.items():
            hands[f"{side}_hand"] = f"{side}_gripper"
            add_frame(spec, f"{side}_gripper", gripper)
            if side in self.elbows:
                add_frame(spec, f"{side}_elbow", Gripper(self.elbows[side]))
        spec.option.timestep = TIMESTEP
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        robot = Robot.from_mjcf(
            spec,
            hands,
            torque_limit=self.torque_limit,
            velocity_limit=velocity_limit,
            home=self.home,
        )
        return _with_elbows(robot, [side for side in self.grippers if side not in self.elbows])


def draft_of(file: str | Path | mujoco.MjSpec) -> Draft:
    """What an MJCF says, or a URDF by its path, whose neighbours do not collide."""
    if not isinstance(file, str | Path) or not str(file).lower().endswith(".urdf"):
        return read(file)
    draft = read_urdf(file)
    exclude_touching(draft.spec, {})
    return draft


def _with_elbows(robot: Robot, sides: list[Side]) -> Robot:
    """The robot with sites at elbows that have to be found."""
    if not sides:
        return robot
    spec, model = robot.source.spec.copy(), robot.model
    for side in sides:
        joint = model.joint(elbow(robot, f"{side}_gripper")).id
        add_frame(spec, f"{side}_elbow", Gripper(model.body(int(model.jnt_bodyid[joint])).name))
    return Robot.of_source(replace(robot.source, spec=spec))
