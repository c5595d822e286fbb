"""Where arms are at home: cup level before the chest, sugar 8 cm above the middle of its rim."""

import numpy as np

from tpsim.errors import ArgumentError, SimulationError
from tpsim.robot.robot import Robot
from tpsim.robot.views.sites import Site
from tpsim.robot.views.view import View
from tpsim.tasks.cup_and_sugar import cup, sugar
from tpsim.tasks.cup_and_sugar.hands import Hands
from tpsim.tasks.workplace import DEFAULT, Workplace
from tpsim.world.comfort import comfortable
from tpsim.world.world import World

KNOWN = {
    DEFAULT: (
        *(0.77643, 0.48409, -0.91141, 2.06775, -0.10938, 0.33157, -0.67192),
        *(0.49732, -0.90217, 1.1919, 1.40747, -0.61722, 1.47197, 0.00951),
    )
}
"""Homes that were found before, and stay, so that figures can be compared over the years [rad]."""

PLACE = (0.0, 0.0, 0.08)
"""Of the sugar, in the cup's frame [m]."""

AHEAD = (0.56, 0.0, 0.02)
"""Where the cup is best, from between the shoulders of arms of size 1 [m]."""

DRAWS = 12
"""Situations that are tried from a home."""

HALF = 0.5
"""Least share of them that arms have to reach."""


def at_home(stage: World, name: str, room: float) -> World:
    """The world of a robot at home: the posture from which most situations can be reached.

    Raises
    ------
    ArgumentError
        If there is none from which at least half of them can be reached; says how much room
        there is.
    """
    if name in KNOWN:
        return stage.with_home(np.array(KNOWN[name]))
    try:
        found = [stage.with_home(q) for q in _apart(_candidates(stage))]
    except SimulationError as error:
        raise ArgumentError(f"{name} cannot hold a cup with sugar above it: {error}") from None
    shares = [reached(world, room) for world in found]
    best = max(shares, default=0.0)
    if best < HALF:
        shares = [max(reached(world, less * room) for world in found) for less in _LESS]
        enough = next((less for less, s in zip(_LESS, shares, strict=True) if s >= HALF), None)
        advice = "these arms are no good for it"
        if enough is not None:
            advice = f"{100 * enough:.0f} % of it is within reach: give --room {enough * room:.2g}"
        raise ArgumentError(
            f"{name} reaches {100 * best:.0f} % of the situations of cup and sugar; {advice}"
        )
    return found[shares.index(best)]


_LESS = (0.75, 0.5, 0.25)


def reached(world: World, room: float) -> float:
    """Share of situations whose start arms can take without contact, and with torque to spare."""
    hands, simulation, good = Hands(world, room=room), world.simulation(), 0
    for k in range(DRAWS):
        rng = np.random.default_rng(np.random.SeedSequence(0, spawn_key=(0, k)))
        try:
            q = (cup.start if k % 2 else sugar.start)(hands, rng)
            simulation.reset(q)
        except SimulationError:
            continue
        good += not simulation.data.ncon and world.robot.is_comfortable(q)
    return good / DRAWS


def _candidates(stage: World) -> list[np.ndarray]:
    """Postures with the cup ahead and the right hand reaching down, without contact."""
    robot, place = stage.robot, Workplace.of(stage.robot)
    exact: list[View] = [cup.LEVEL, sugar.ABOVE.position.minus(PLACE)]
    down = Site(sugar.RIGHT.name).axis("z", reference=np.diag([1.0, -1.0, -1.0]))
    liked: dict[View, float] = {cup.CUP.position.minus(place.at(*AHEAD)): 20.0, down: 0.5}
    simulation = stage.simulation()
    free = []
    for q in comfortable(robot, exact, liked, starts=16):
        simulation.reset(q)
        if not simulation.data.ncon and _holds(robot, q):
            free.append(q)
    return free


def _holds(robot: Robot, q: np.ndarray) -> bool:
    return bool((np.abs(robot.gravity_torque(q)) < robot.torque_limit).all())


def _apart(postures: list[np.ndarray], most: int = 4) -> list[np.ndarray]:
    """The best of postures that are not almost the same."""
    kept: list[np.ndarray] = []
    for q in postures:
        if all(np.abs(q - other).max() > 0.3 for other in kept):
            kept.append(q)
    return kept[:most]
