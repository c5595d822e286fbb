"""Simulated kinesthetic teaching: weightless arms, led by a person's hands."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tpsim.border import Duration, checked
from tpsim.errors import SimulationError
from tpsim.robot.robot import Robot
from tpsim.world.course import Course, Shown
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.drag import Drag
from tpsim.world.people.guide import Guide
from tpsim.world.rollout import rollout
from tpsim.world.threads import one_thread
from tpsim.world.trial import Trial
from tpsim.world.weightless import Weightless
from tpsim.world.world import World

LIMIT_MARGIN = 0.05
"""Distance to a joint limit [rad] at which a demonstration counts as having hit it."""

AT_ITS_STRENGTH = 0.1
"""Share of a demonstration for which a teacher may pull as hard as its grip allows."""

Teacher = Callable[[World, np.random.Generator], "Lesson"]
"""Draws a lesson: what a person is about to show once."""


class Refusal(NamedTuple):
    """Why a demonstration is not learned from.

    Parameters
    ----------
    reason : str
        By which refusals are counted, such as ``"tilt"``.
    words : str
        All that there is to say, such as ``"tilt 37 deg, 5 allowed"``.
    """

    reason: str
    words: str


Judge = Callable[[Trial], Refusal | None]
"""Says whether a demonstration that went well shows what it is to show."""


@dataclass(frozen=True)
class Lesson:
    """What a person is about to show once.

    Parameters
    ----------
    start : (n,)
        Posture in which the arms are when the hands take hold [rad].
    guides : tuple of Guide or Drag
        The hands.
    duration : float
        Time [s].
    held : tuple of str
        Joints that are not taught and hold still.
    objects : tuple of ObjectPath
        Where movable objects are meanwhile.
    """

    start: np.ndarray
    guides: tuple[Guide | Drag, ...]
    duration: Duration
    held: tuple[str, ...] = ()
    objects: tuple[ObjectPath, ...] = ()

    def __post_init__(self) -> None:
        checked(self)


def demonstrate(world: World, lesson: Lesson, sites: Mapping[str, str] | None = None) -> Trial:
    """Show one lesson on the weightless robot and record it.

    The outcome is ``"done"``, or why the demonstration is useless: ``"joint limit"``,
    ``"saturated"``, ``"too fast"``, ``"at its strength"``, ``"contact"``, ``"diverged"``.
    """
    return _demonstrate(world, lesson, sites)[0]


def _demonstrate(
    world: World, lesson: Lesson, sites: Mapping[str, str] | None
) -> tuple[Trial, Refusal | None]:
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
    refusal = fault(robot, trial, lesson)
    if trial.outcome == "done" and refusal is not None:
        trial = trial.with_about(refusal.reason)
    return trial, refusal


def fault(robot: Robot, trial: Trial, lesson: Lesson) -> Refusal | None:
    """What went wrong while a lesson was shown, whatever it was to show; None where nothing did."""
    q, reason = trial["q"], ""
    if trial.outcome != "done":
        reason = f"contact of {trial.touched}" if trial.touched else trial.outcome
    elif joints := at_limits(robot, q):
        return Refusal("joint limit", f"joint limit of {', '.join(joints)}")
    elif trial["saturated_steps"][-1]:
        reason = "saturated"
    elif (np.abs(trial["dq"]) > robot.velocity_limit).any():
        reason = "too fast"
    if reason:
        return Refusal(reason, reason)
    share = strained(trial, lesson)
    if share > AT_ITS_STRENGTH:
        reason, allowed = "at its strength", 100 * AT_ITS_STRENGTH
        return Refusal(
            reason, f"teacher {reason} {100 * share:.0f} % of the time, {allowed:g} allowed"
        )
    return None


def at_limits(robot: Robot, q: np.ndarray, margin: float = LIMIT_MARGIN) -> tuple[str, ...]:
    """Joints that come as near to a limit as ``margin`` [rad], in posture(s) q (..., n)."""
    room = np.minimum(q - robot.lower, robot.upper - q).reshape(-1, robot.n).min(axis=0)
    return tuple(joint for joint, left in zip(robot.joints, room, strict=True) if left < margin)


def strained(trial: Trial, lesson: Lesson) -> float:
    """Largest share of a demonstration for which one of its hands gave all of its strength."""
    shares = [guide.grip.spends(trial[f"{guide.name}_wrench"]).mean() for guide in lesson.guides]
    return float(max(shares, default=0.0))


@one_thread()
def show(
    world: World,
    teacher: Teacher,
    attempt: int,
    *,
    seed: int,
    sites: Mapping[str, str] | None = None,
) -> Trial:
    """Attempt ``attempt`` of a seed: draws from ``SeedSequence(seed, spawn_key=(attempt,))``."""
    return _show(world, teacher, attempt, seed, sites)[0]


def _show(
    world: World, teacher: Teacher, attempt: int, seed: int, sites: Mapping[str, str] | None
) -> tuple[Trial, Refusal | None]:
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(attempt,)))
    trial, refusal = _demonstrate(world, teacher(world, rng), sites)
    return trial.with_about(seed=seed, attempt=attempt), refusal


class Attempt(NamedTuple):
    """What came of showing something once.

    Parameters
    ----------
    trial : Trial or None
        What was recorded; None where the arm cannot even begin.
    refusal : Refusal or None
        Why it is not learned from.
    """

    trial: Trial | None
    refusal: Refusal | None


def attempted(
    world: World,
    teacher: Teacher,
    attempt: int,
    *,
    seed: int,
    sites: Mapping[str, str] | None = None,
    judge: Judge | None = None,
) -> Attempt:
    """Show once, as :func:`show` does, and judge it.

    Parameters
    ----------
    world, teacher, seed, sites, judge
        As for :func:`teach`.
    attempt : int
        Its number.
    """
    try:
        trial, refusal = _show(world, teacher, attempt, seed, sites)
        if refusal is None and judge is not None:
            refusal = judge(trial)
    except SimulationError as error:
        return Attempt(None, Refusal("unreachable", f"unreachable: {error}"))
    return Attempt(trial, refusal)


def teach(
    world: World,
    teacher: Teacher,
    count: int,
    *,
    seed: int,
    sites: Mapping[str, str] | None = None,
    judge: Judge | None = None,
    progress: Callable[[int, str], None] | None = None,
) -> Shown:
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
    judge : callable, optional
        Refuses demonstrations that do not show what they are to show; none by default.
    progress : callable, optional
        Told the attempt's number and how it ended: ``"done"``, or why it was refused.

    Raises
    ------
    SimulationError
        If too many demonstrations are useless.
    """
    course = Course(count, progress)
    while wanted := course.wanted:
        course.add(attempted(world, teacher, wanted[0], seed=seed, sites=sites, judge=judge))
    return course.shown
