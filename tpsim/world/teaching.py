"""Simulated kinesthetic teaching: weightless arms, led by a person's hands."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from tpsim.border import Duration, checked
from tpsim.errors import ArgumentError, SimulationError
from tpsim.robot.robot import Robot
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.guide import Guide
from tpsim.world.rollout import rollout
from tpsim.world.trial import Trial
from tpsim.world.weightless import Weightless
from tpsim.world.world import World

LIMIT_MARGIN = 0.05
"""Distance to a joint limit [rad] at which a demonstration counts as having hit it."""

ATTEMPTS = 10
"""Demonstrations tried for each one wanted, before teaching gives up."""

Teacher = Callable[[World, np.random.Generator], "Lesson"]
"""Draws a lesson: what a person is about to show once."""


@dataclass(frozen=True)
class Lesson:
    """What a person is about to show once.

    Parameters
    ----------
    start : (n,)
        Posture in which the arms are when the hands take hold [rad].
    guides : tuple of Guide
        The hands.
    duration : float
        Time [s].
    held : tuple of str
        Joints that are not taught and hold still.
    objects : tuple of ObjectPath
        Where movable objects are meanwhile.
    """

    start: np.ndarray
    guides: tuple[Guide, ...]
    duration: Duration
    held: tuple[str, ...] = ()
    objects: tuple[ObjectPath, ...] = ()

    def __post_init__(self) -> None:
        checked(self)


def demonstrate(world: World, lesson: Lesson, sites: Mapping[str, str] | None = None) -> Trial:
    """Show one lesson on the weightless robot and record it.

    The outcome is ``"done"``, or why the demonstration is useless: ``"joint limit"``,
    ``"saturated"``, ``"too fast"``, ``"contact"``, ``"diverged"``.
    """
    robot = world.robot
    trial = rollout(
        world,
        Weightless(robot, held=lesson.held, posture=lesson.start),
        lesson.start,
        lesson.duration,
        sites=sites,
        people=lesson.guides,
        objects=lesson.objects,
    )
    return trial.with_about(_verdict(robot, trial))


def _verdict(robot: Robot, trial: Trial) -> str:
    q = trial["q"]
    if trial.outcome != "done":
        return trial.outcome
    if min((q - robot.lower).min(), (robot.upper - q).min()) < LIMIT_MARGIN:
        return "joint limit"
    if trial["saturated_steps"][-1]:
        return "saturated"
    if (np.abs(trial["dq"]) > robot.velocity_limit).any():
        return "too fast"
    return "done"


def show(
    world: World,
    teacher: Teacher,
    attempt: int,
    *,
    seed: int,
    sites: Mapping[str, str] | None = None,
) -> Trial:
    """Attempt ``attempt`` of a seed: draws from ``SeedSequence(seed, spawn_key=(attempt,))``."""
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(attempt,)))
    trial = demonstrate(world, teacher(world, rng), sites)
    return trial.with_about(seed=seed, attempt=attempt)


def teach(
    world: World,
    teacher: Teacher,
    count: int,
    *,
    seed: int,
    sites: Mapping[str, str] | None = None,
    progress: Callable[[int, str], None] | None = None,
) -> list[Trial]:
    """Teach until ``count`` demonstrations are good; those that are not are shown again.

    Any attempt can be repeated alone by :func:`show`.

    Parameters
    ----------
    world : World
    teacher : callable
        Draws a lesson.
    count : int
        Demonstrations wanted.
    seed : int
    sites : mapping of str to str, optional
        Sites to record, by name; the hands by default.
    progress : callable, optional
        Told the attempt's number and its outcome.

    Returns
    -------
    list of Trial
        ``about`` holds the attempt's number, and how the attempts before it ended.

    Raises
    ------
    SimulationError
        If too many demonstrations in a row are useless.
    """
    if count < 1:
        raise ArgumentError(f"{count} demonstrations were asked for; ask for at least 1")
    trials: list[Trial] = []
    failures: Counter[str] = Counter()
    last = ""
    for attempt in range(ATTEMPTS * count):
        try:
            trial = show(world, teacher, attempt, seed=seed, sites=sites)
        except SimulationError as error:
            outcome = "unreachable"
            failures[outcome], last = failures[outcome] + 1, f"; the last error: {error}"
        else:
            outcome = trial.outcome
            if outcome == "done":
                trials.append(trial)
            else:
                failures[f"contact of {trial.touched}" if trial.touched else outcome] += 1
        if progress is not None:
            progress(attempt, outcome)
        if len(trials) == count:
            return trials
    raise SimulationError(
        f"only {len(trials)} of {count} demonstrations were good; the others: "
        + ", ".join(f"{times} {why}" for why, times in failures.most_common(3))
        + last
    )
