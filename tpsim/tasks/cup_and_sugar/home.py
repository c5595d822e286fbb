"""Where arms are at home: cup level before the chest, sugar 8 cm above the middle of its rim."""

import json
from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path

import numpy as np

from tpsim.errors import ArgumentError, SimulationError
from tpsim.robot.robot import Robot
from tpsim.robot.views.sites import Site
from tpsim.robot.views.view import View
from tpsim.scene.compose import Held, world
from tpsim.tasks.cup_and_sugar import cup, sugar
from tpsim.tasks.cup_and_sugar.hands import Hands, Workspace
from tpsim.tasks.workplace import Workplace, size_of
from tpsim.world.comfort import comfortable
from tpsim.world.world import World

WAYS: Sequence[Mapping[str, Held]] = [
    {
        # By its handle, which points along -z of the gripper; its axis is the gripper's x or -x:
        # fingers hold as well turned by half a turn, and wrists may not be able to.
        "cup": Held("cup", "left_gripper", (0, 0, 0.056), ((0, 0, 1), (0, across, 0))),
        "sugar": Held("sugar", "right_gripper", (0, 0, 0.006)),
    }
    for across in (-1, 1)
]
"""How hands may hold cup and sugar."""

KNOWN: Mapping[str, Sequence[float]] = json.loads(
    Path(__file__).with_name("homes.json").read_text(encoding="utf-8")
)
"""Homes that were found before, by robot, and stay, so that figures can be compared [rad]."""

PLACE = (0.0, 0.0, 0.08)
"""Of the sugar, in the cup's frame [m]."""

AHEAD, BELOW = (0.56, 0.42, 0.7), (0.0, 0.25, 0.5)
"""Where the cup may be at home, from between the shoulders of arms of size 1 [m]."""

STARTS, APART = 6, 0.3
"""Starts of the search for each place, and how far postures have to be from each other [rad]."""

DRAWS = 12
"""Situations that are tried from a home."""

HALF = 0.5
"""Least share of them that arms have to reach."""

LESS = (0.75, 0.5, 0.25)
"""Shares of the workspace that are tried where it is too large."""


def home(robot: Robot, name: str, room: float) -> tuple[Mapping[str, Held], Robot]:
    """How a robot holds cup and sugar, and the robot that does, at home.

    From there most situations can be reached.

    Raises
    ------
    ArgumentError
        If there is none from which at least half of them can be reached; says how much room
        there is.
    """
    found: list[World] = []
    ways: list[Mapping[str, Held]] = []
    why = "in no posture its motors carry both, and its arms keep off each other and the table"
    for way in WAYS:
        stage = world(robot, held=way)
        if name in KNOWN:
            known = stage.with_home(np.array(KNOWN[name])).robot
            if known.at_home.pose("cup").rotation[2, 2] > 0:
                return way, known
            continue
        try:
            found += [stage.with_home(q) for q in _candidates(stage)]
        except SimulationError as error:
            why = str(error)
        ways += [way] * (len(found) - len(ways))
    if not found:
        raise ArgumentError(f"{name} cannot hold a cup with sugar above it: {why}")
    best, share = _best(found, room)
    if share >= HALF:
        return ways[best], found[best].robot
    advice = "these arms are no good for it"
    for less in LESS:
        if _best(found, less * room)[1] >= HALF:
            advice = f"they reach enough of {100 * less:.0f} % of it: give --room {less * room:.2g}"
            break
    raise ArgumentError(
        f"{name} reaches {100 * share:.0f} % of the situations of its workspace, of "
        f"+-{100 * room * size_of(robot) * Workspace().position[0]:.0f} cm ahead; {advice}"
    )


def _best(worlds: Sequence[World], room: float) -> tuple[int, float]:
    """Number of the world from whose home most can be reached, and what share."""
    best, share = 0, 0.0
    for k, stage in enumerate(worlds):
        found = reached(stage, room, share)
        if found > share:
            best, share = k, found
    return best, share


def reached(stage: World, room: float, least: float = 0.0) -> float:
    """Share of situations whose start arms can take without contact, and with torque to spare.

    Zero, where it is no more than ``least``, which may be seen early.
    """
    hands, simulation, missed = Hands(stage, room=room), stage.simulation(), 0
    for k in range(DRAWS):
        rng = np.random.default_rng(np.random.SeedSequence(0, spawn_key=(0, k)))
        try:
            q = (cup.start if k % 2 else sugar.start)(hands, rng)
            simulation.reset(q)
            good = not simulation.data.ncon and stage.robot.is_comfortable(q)
        except SimulationError:
            good = False
        missed += not good
        if DRAWS - missed <= least * DRAWS:
            return 0.0
    return (DRAWS - missed) / DRAWS


def _candidates(stage: World) -> list[np.ndarray]:
    """Postures with the cup ahead and the right hand reaching down, without contact."""
    robot, place = stage.robot, Workplace.of(stage.robot)
    exact: list[View] = [cup.LEVEL, sugar.ABOVE.position.minus(PLACE)]
    down = Site(sugar.RIGHT.name).axis("z", reference=np.diag([1.0, -1.0, -1.0]))
    simulation = stage.simulation()
    free: list[np.ndarray] = []
    for x, z in product(AHEAD, BELOW):
        liked: dict[View, float] = {cup.CUP.position.minus(place.at(x, 0, -z)): 20.0, down: 0.5}
        for q in comfortable(robot, exact, liked, starts=STARTS):
            simulation.reset(q)
            apart = all(np.abs(q - other).max() > APART for other in free)
            if apart and not simulation.data.ncon and _holds(robot, q):
                free.append(q)
    return free


def _holds(robot: Robot, q: np.ndarray) -> bool:
    return bool((np.abs(robot.gravity_torque(q)) < robot.torque_limit).all())
