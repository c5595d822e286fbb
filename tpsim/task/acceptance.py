"""Whether a teacher showed what was to be shown: demonstrations judged by a behaviour's goals."""

from collections.abc import Mapping

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.robot.robot import Robot
from tpsim.robot.views.observe import observe
from tpsim.robot.views.view import View
from tpsim.task.task import Goal
from tpsim.world.teaching import Refusal
from tpsim.world.trial import Trial


def errors(robot: Robot, trial: Trial, goals: Mapping[str, Goal]) -> dict[str, np.ndarray]:
    """How far a trial was from every goal while it counted: norms (T,) in the view's SI unit.

    NaN at the times at which a goal does not count.
    """
    values = observe(robot, [goal.view for goal in goals.values()], trial["q"], trial.objects)
    found = {}
    for (name, goal), value in zip(goals.items(), values, strict=True):
        since, until = (t + trial.time[-1] if t < 0 else t for t in (goal.since, goal.until))
        counts = (trial.time >= since) & (trial.time <= until)
        found[name] = np.where(counts, np.linalg.norm(value, axis=1), np.nan)
    return found


def refusal(robot: Robot, trial: Trial, goals: Mapping[str, Goal]) -> Refusal | None:
    """Why a demonstration is refused: the first goal that it misses at its worst moment."""
    for name, error in errors(robot, trial, goals).items():
        worst, goal = float(np.nanmax(np.append(error, -np.inf))), goals[name]
        if worst > goal.within:
            return Refusal(name, worded(robot, name, goal, worst))
    return None


def worded(robot: Robot, name: str, goal: Goal, error: float) -> str:
    """An error [SI unit of the goal's view] in words, beside what is allowed."""
    unit, scale = _read(robot, goal.view)
    return f"{name} {scale * error:.3g} {unit}, {scale * goal.within:.3g} allowed"


def _read(robot: Robot, view: View) -> tuple[str, float]:
    """Unit that people read for a view, and how many of it go into its own."""
    for unit in ("mm", "deg"):
        try:
            return unit, view.scale(robot, unit)
        except ArgumentError:
            continue
    return "", 1.0
