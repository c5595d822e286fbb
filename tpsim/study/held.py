"""What comes of holding a robot's hand still for a while and letting go."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tpsim.study.measure import Measure
from tpsim.study.record import Record, Records
from tpsim.study.study import ControllerFactory
from tpsim.task.task import Task

BY = {"by state": "state", "by clock": "clock"}
"""Controllers that are held, and what says how far their movement has come."""

SUDDEN = 0.1
"""Time [s] after letting go within which torque that changes counts as a jump."""


def by_progress(task: Task) -> dict[str, ControllerFactory]:
    """The controllers of a task whose field ``progress`` is the state or the clock, as in BY."""
    return {name: replace(task, **{"progress": by}).controller for name, by in BY.items()}  # type: ignore[type-var]


def release_jump(record: Record) -> float | None:
    """Largest change of a motor's torque just after letting go, in percent of its limit."""
    if not record.condition.hold:
        return None
    hold, trial = record.condition.hold[-1], record.trial
    let_go = hold.start + hold.duration
    time, torque = trial.time, trial["torque"]
    just_after = (time > let_go - 1e-9) & (time < let_go + SUDDEN + 1e-9)
    if not just_after.any():
        return None
    before = torque[max(0, int(np.argmax(just_after)) - 1)]
    change = np.abs(torque[just_after] - before) / record.task.stage.robot.torque_limit
    return 100 * float(change.max())


def held_ratio(
    controller: str, *ends: Callable[[Record], np.ndarray]
) -> Callable[[Records], float | None]:
    """How many times as far from its goal a hand ends that was held: the worst of some errors.

    Parameters
    ----------
    controller : str
        Whose trials ``"held"`` and ``"unpushed"`` are compared.
    ends : callable
        ``end(record) -> (T,)``: errors; of each the largest of all trials counts.
    """

    def ratio(records: Records) -> float | None:
        held, free = (records.select(label, controller) for label in ("held", "unpushed"))
        if not held or not free:
            return None
        worst = [[max(end(r).max() for r in some) for some in (held, free)] for end in ends]
        return float(max(one / other for one, other in worst))

    return ratio


def held_measures(
    controller: str, title: str, *ends: Callable[[Record], np.ndarray]
) -> tuple[Measure, Measure]:
    """``held_ratio`` and ``release_jump_percent`` of a controller.

    Parameters
    ----------
    controller : str
        ``"learned"``, the task's own, or ``"by state"``, of which 1.3 times and 20 % of a motor's
        torque are asked at most; figures ``"by clock"`` end in that, and are there to compare.
    title : str
        What reports call the ratio.
    ends : callable
        As for :func:`held_ratio`.
    """
    suffix = "_by_clock" if controller == "by clock" else ""
    named = "" if controller == "learned" else f", {controller}"
    return (
        Measure(
            f"held_ratio{suffix}",
            whole=held_ratio(controller, *ends),
            limit=None if suffix else 1.3,
            title=f"{title}{named}",
        ),
        Measure(
            f"release_jump{suffix}_percent",
            of=release_jump,
            unit="%",
            label="held",
            controller=controller,
            limit=None if suffix else 20.0,
            title=f"Largest jump of torque at letting go, of the motors' limits{named}",
        ),
    )
