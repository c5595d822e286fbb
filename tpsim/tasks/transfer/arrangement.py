"""Docks before an arm: where its teacher can lead it between them, and how fast."""

import json
from collections.abc import Iterator
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tpsim.catalogue.robots import find
from tpsim.errors import ArgumentError, SimulationError
from tpsim.pose import Pose
from tpsim.robot.robot import Robot
from tpsim.scene.compose import Held, Placed, world
from tpsim.tasks.one_hand import furnished, one_handed
from tpsim.tasks.transfer import docks
from tpsim.tasks.transfer.teacher import lesson_between
from tpsim.tasks.workplace import DEFAULT, size_of
from tpsim.world.object_path import put_objects
from tpsim.world.reach import reach
from tpsim.world.rehearsal import haste, hindrance
from tpsim.world.world import World

TILTS = (0.0, 0.4, 0.8, 1.2)
"""Angles [rad] by which docks may be tilted, so that the hand reaches ahead more than down."""

BELOW, NEARER, ASIDE = (0.0, 0.2, 0.4, 0.6), (0.0, 0.15), (0.0, 0.1)
"""How far they may be lower, nearer and more to the left than usual, for an arm of size 1 [m]."""

STARTS = 3
"""Postures from which each layout is tried: an arm comes to the same pose bent in several ways."""

DRAWS = 8
"""Places of the docks that are tried in a layout."""

ENOUGH = 0.75
"""Share of these between which the teacher is to lead the arm."""

SLOWEST = 4.0
"""Pace beyond which some other layout is looked for: the arm is nearly singular in this one."""

SLOWED = 4
"""How often a way is slowed down until it is easy."""

ITERATIONS = 150
"""Steps of inverse kinematics while layouts are tried."""


class Arrangement(NamedTuple):
    """A layout of the docks, and the posture of the arm before them.

    Parameters
    ----------
    layout : Layout
    home : (n,), optional
        With the hand between the docks [rad]; the robot's own by default.
    """

    layout: docks.Layout
    home: np.ndarray | None = None


@lru_cache(maxsize=8)
def arranged(name: str) -> Arrangement:
    """Arrangement for a robot by its name: one that was kept, or else searched for.

    Raises
    ------
    ArgumentError
        If its teacher can lead it between docks nowhere.
    """
    if name == DEFAULT:
        return Arrangement(docks.STANDARD)
    kept = json.loads(Path(__file__).with_name("layouts.json").read_text(encoding="utf-8"))
    if name in kept:
        shift, tilt, pace, home = (kept[name][key] for key in ("shift", "tilt", "pace", "home"))
        return Arrangement(docks.Layout(tuple(shift), tilt, pace), np.array(home))
    robot = one_handed(find(name), name)
    return search(_world(robot, docks.STANDARD, solid=False), name)


def search(stage: World, name: str) -> Arrangement:
    """Arrangement for a robot: the most usual in which its teacher can lead it often enough.

    Raises
    ------
    ArgumentError
        If there is none.
    """
    best, found = 0.0, None
    rng = np.random.default_rng(0)
    for layout in candidates():
        for home in homes(stage.robot, layout, rng):
            share, pace = led(stage.with_home(home), layout)
            worth = share * min(1.0, SLOWEST / pace)
            if worth > best:
                found = docks.Layout(layout.shift, layout.tilt, pace)
                best, arrangement = worth, Arrangement(found, home)
        if best >= ENOUGH:
            break
    if found is None or best < ENOUGH / 2:
        raise ArgumentError(
            f"{name} can be led between docks in {100 * best:.0f} % of their places at most, "
            f"wherever they are before it; {100 * ENOUGH:.0f} % are needed: "
            "transfer needs an arm with more reach or joints"
        )
    return arrangement


def candidates() -> list[docks.Layout]:
    """Layouts, the most usual first."""
    found = [
        docks.Layout((-nearer, aside, -below), tilt)
        for tilt, below, nearer, aside in product(TILTS, BELOW, NEARER, ASIDE)
    ]
    return sorted(found, key=lambda layout: layout.tilt + float(np.linalg.norm(layout.shift)))


def homes(robot: Robot, layout: docks.Layout, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Postures (n,) with the hand about between the docks, from which it comes into both."""
    via = docks.via_poses(docks.home(robot, layout), size_of(robot))
    carries = robot.chain(docks.GRIPPER)
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    for k in range(STARTS):
        q, passed = robot.home.copy(), []
        if k:
            q[carries] = rng.uniform(low, high)[carries]
        try:
            for R, p in zip(*via, strict=True):
                pose = {docks.GRIPPER: Pose(R, p)}
                q = reach(
                    robot, pose, start=q, posture=q, margin=docks.MARGIN, iterations=ITERATIONS
                )
                passed.append(q)
        except SimulationError:
            continue
        home = np.mean(passed[1:3], axis=0)
        if robot.is_comfortable(home):
            yield _unwound(robot, home)


def _unwound(robot: Robot, q: np.ndarray) -> np.ndarray:
    """The same posture without whole turns of joints that have no limits."""
    endless = ~(np.isfinite(robot.lower) & np.isfinite(robot.upper))
    return np.where(endless, (q + np.pi) % (2 * np.pi) - np.pi, q)


def led(stage: World, layout: docks.Layout) -> tuple[float, float]:
    """Share of drawn docks between which the teacher can lead the arm, and at which pace.

    At this pace three of four ways ask for easy speeds of all joints.
    """
    ways = []
    for k in range(DRAWS):
        rng = np.random.default_rng(k)
        placed = docks.draw(stage.robot, rng, layout=layout)
        try:
            ways.append((k, placed, docks.start_posture(stage, placed, rng)))
        except SimulationError:
            if (k + 1 - len(ways)) > (1 - ENOUGH / 2) * DRAWS:
                return 0.0, 1.0

    def lessons(pace: float) -> Iterator:  # type: ignore[type-arg]
        for k, placed, start in ways:
            rng = np.random.default_rng(k)
            yield lesson_between(stage, placed, start, rng, pace=pace)

    pace = 1.0
    # What makes up for wandering does not slow down, so that once is not enough.
    for _ in range(SLOWED):
        asked = np.quantile([haste(stage, lesson) for lesson in lessons(pace)], ENOUGH)
        pace = max(1.0, round(pace * float(asked), 1))
        if asked < 1.05 or pace > SLOWEST:
            break
    good = sum(not hindrance(stage, lesson) for lesson in lessons(pace))
    return good / DRAWS, pace


@lru_cache(maxsize=4)
def furnished_with_docks(name: str) -> World:
    """The world of a robot with its docks: solid, unless its hand is too wide for them."""
    robot, (layout, home) = find(name), arranged(name)
    for solid in (True, False):
        found = _world(robot, layout, solid=solid, name=name, home=home)
        if _fits(found, layout):
            break
    return found


def _world(
    robot: Robot,
    layout: docks.Layout,
    solid: bool,
    name: str = "",
    home: np.ndarray | None = None,
) -> World:
    """A robot with sugar in its hand and docks; without a name no furniture stands about."""
    held = {"sugar": Held("sugar", docks.GRIPPER, (0, 0, 0.006))}
    size = size_of(robot)
    objects = {
        dock: Placed("dock", tuple(pose.position.tolist()), size=size, solid=solid)
        for dock, pose in docks.home(robot, layout).items()
    }
    if not name:
        return world(robot, objects=objects, held=held)
    middle = None if layout.shift == docks.STANDARD.shift else layout.middle(robot)
    return furnished(robot, name, objects, held, middle, home)


def _fits(stage: World, layout: docks.Layout) -> bool:
    """Whether the hand is in the first dock without touching it."""
    simulation, placed = stage.simulation(), docks.home(stage.robot, layout)
    try:
        simulation.reset(docks.start_posture(stage, placed, np.random.default_rng(0)))
    except SimulationError:
        return True  # so far away nothing is said about its size
    put_objects(docks.at_rest(placed), simulation)
    return not simulation.touches
