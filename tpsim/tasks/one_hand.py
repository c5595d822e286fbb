"""Worlds of tasks that one hand performs: the left one, or the only one."""

from collections.abc import Mapping

import numpy as np

from tpsim.errors import ArgumentError, SimulationError
from tpsim.robot import anatomy
from tpsim.robot.robot import Robot
from tpsim.robot.views.sites import Site
from tpsim.robot.views.view import View
from tpsim.scene.compose import Held, Placed, world
from tpsim.tasks.workplace import DEFAULT, Workplace, between
from tpsim.world.comfort import comfortable
from tpsim.world.world import World

GRIPPER = "left_gripper"
"""Site of the hand."""

AHEAD = (0.52, 0.05, 0.0)
"""Where the hand is at home, from the shoulder of an arm of size 1 [m]."""


def one_handed(robot: Robot, name: str) -> Robot:
    """The robot, if it has the hand and the elbow by which tasks of one hand know an arm.

    Raises
    ------
    ArgumentError
        If the robot has no hand at ``left_gripper``, or no site at its elbow.
    """
    missing = [site for site in (GRIPPER, "left_elbow") if site not in robot.sites]
    if missing or GRIPPER not in robot.hands.values():
        raise ArgumentError(
            f"{name} has hands at {', '.join(robot.hands.values())}; tasks of one hand need one at "
            f"'{GRIPPER}', and a site 'left_elbow': describe its arms by lab.Arms, as "
            "docs/recipes/robot.md shows"
        )
    return robot


def furnished(
    robot: Robot,
    name: str,
    objects: Mapping[str, Placed],
    held: Mapping[str, Held],
    middle: np.ndarray | None = None,
    home: np.ndarray | None = None,
) -> World:
    """World of a robot at a table, its hand at home ahead and pointing down.

    Where the hand works about another ``middle`` (3,) [m], table and cameras go there; a ``home``
    (n,) that was found for that is taken.

    Raises
    ------
    ArgumentError
        If the robot cannot hold its hand there.
    """
    place = Workplace.of(robot)
    lowest = np.inf if middle is None else float(middle[2])
    stage = world(
        robot,
        objects=dict(objects) | place.furniture(lowest),
        held=held,
        floor=place.floor,
        cameras=place.cameras(between(robot) if middle is None else middle),
    )
    if home is not None:
        return stage.with_home(home)
    return stage if name == DEFAULT else stage.with_home(_home(stage, name))


def _home(stage: World, name: str) -> np.ndarray:
    """Posture (n,) with the hand ahead and pointing down, without contact."""
    robot, simulation = stage.robot, stage.simulation()
    size, shoulder = Workplace.of(robot).size, anatomy.shoulder(robot, GRIPPER)
    down = Site(GRIPPER).axis("z", reference=np.diag([1.0, -1.0, -1.0]))
    ahead = Site(GRIPPER).position.minus(shoulder + size * np.array(AHEAD))
    liked: dict[View, float] = {ahead: 20.0}
    try:
        for q in comfortable(robot, [down], liked):
            simulation.reset(q)
            if not simulation.data.ncon and robot.is_comfortable(q):
                return q
    except SimulationError as error:
        raise ArgumentError(f"{name} cannot point down before itself: {error}") from None
    raise ArgumentError(
        f"{name} has no posture with its hand ahead and pointing down that is free of contact and "
        "leaves its motors torque to spare"
    )
