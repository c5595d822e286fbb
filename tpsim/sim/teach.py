"""Simulated kinesthetic teaching: weightless arms, led by a person's hands."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from tpsim.errors import ArgumentError, SimulationError
from tpsim.sim.controllers.controller import GravityCompensation
from tpsim.sim.hand import Guide
from tpsim.sim.objects import ObjectPath
from tpsim.sim.rollout import rollout
from tpsim.sim.simulation import Simulation
from tpsim.sim.trial import Trial

LIMIT_MARGIN = 0.05
"""Distance to a joint limit [rad] at which a demonstration counts as having hit it."""

COMMANDED = ("stiffness", "left_hand_stiffness", "right_hand_stiffness", "reference", "beyond")
"""Signals of a controller's will, which a weightless arm has not: they are not kept."""

ATTEMPTS = 10
"""Demonstrations tried for each one wanted, before teaching gives up."""


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
    duration: float
    held: tuple[str, ...] = ()
    objects: tuple[ObjectPath, ...] = ()


def demonstrate(simulation: Simulation, lesson: Lesson, sites: Mapping[str, str]) -> Trial:
    """Show one lesson on the weightless robot and record it.

    The outcome is ``"done"``, or why the demonstration is useless: ``"joint limit"``,
    ``"saturated"``, ``"too fast"``, ``"contact"``, ``"diverged"``.
    """
    robot = simulation.robot
    controller = GravityCompensation(robot, held=lesson.held, posture=lesson.start)
    trial = rollout(
        simulation,
        controller,
        lesson.start,
        lesson.duration,
        sites=sites,
        people=lesson.guides,
        objects=lesson.objects,
    )
    arrays = {n: a for n, a in trial.arrays.items() if not n.startswith(COMMANDED)}
    return Trial(arrays, _verdict(robot, trial), trial.about)


def _verdict(robot, trial):
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


def teach(
    simulation: Simulation,
    plan: Callable[[Simulation, np.random.Generator], Lesson],
    count: int,
    *,
    seed: int,
    sites: Mapping[str, str],
    progress: Callable[[int, str], None] | None = None,
) -> list[Trial]:
    """Teach until ``count`` demonstrations are good; those that are not are shown again.

    Attempt i draws from ``SeedSequence(seed, spawn_key=(i,))``, so any demonstration can be
    repeated alone.

    Parameters
    ----------
    simulation : Simulation
    plan : callable
        Draws a lesson.
    count : int
        Demonstrations wanted.
    seed : int
    sites : mapping
        Sites to record, by name.
    progress : callable, optional
        Told the attempt's number and its outcome.

    Raises
    ------
    SimulationError
        If too many demonstrations in a row are useless.
    """
    if count < 1:
        raise ArgumentError(f"{count} demonstrations were asked for; ask for at least 1")
    trials, outcomes = [], []
    for attempt in range(ATTEMPTS * count):
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(attempt,)))
        try:
            trial = demonstrate(simulation, plan(simulation, rng), sites)
        except SimulationError:
            outcome = "unreachable"
        else:
            outcome = trial.outcome
            if outcome == "done":
                about = {"seed": seed, "attempt": attempt}
                trials.append(Trial(trial.arrays, outcome, about))
        outcomes.append(outcome)
        if progress is not None:
            progress(attempt, outcome)
        if len(trials) == count:
            return trials
    raise SimulationError(
        f"only {len(trials)} of {count} demonstrations were good; "
        f"the last attempts ended with {outcomes[-5:]}"
    )
