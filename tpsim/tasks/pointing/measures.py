"""What is measured of pointing: angles to the objects, final posture, recovery from jumps."""

from dataclasses import replace
from typing import cast

import numpy as np

from tpsim.study import health
from tpsim.study.measure import Measure
from tpsim.study.metrics import push_interval
from tpsim.study.record import Record
from tpsim.task.task import Task
from tpsim.tasks.pointing.task import FLAT, Pointing
from tpsim.tasks.pointing.teacher import PHASES

RECOVERED = 3.0
"""Angle [deg] under which a jump counts as made good."""


def angle(record: Record, name: str) -> np.ndarray:
    """Angle (T,) [deg] between the axis that points and the way to an object."""
    bearing = cast(Pointing, record.task).pointer.bearing(name)
    return np.degrees(np.linalg.norm(record.see(bearing), axis=1))


def pointing_angle(record: Record) -> float | None:
    """Largest angle [deg] to an object in the phase in which it is pointed at.

    Where somebody pushes, only while they do; None where nobody pushes in a phase.
    """
    time, push, found = record.trial.time, push_interval(record.trial), []
    for name, (start, end) in PHASES.items():
        counts = (time >= start) & (time < end)
        if push is not None:
            counts &= (time >= push[0]) & (time <= push[1])
        if counts.any():
            found.append(float(angle(record, name)[counts].max()))
    return max(found) if found else np.inf if record.trial.outcome == "diverged" else None


def farthest_joint(record: Record) -> float | None:
    """Farthest joint [rad] from rest at the end of a whole trial."""
    if record.trial.time[-1] < record.task.duration - 0.1:
        return None
    return float(np.abs(record["q"][-1] - record.task.stage.robot.home).max())


def recovery(record: Record) -> float:
    """Time [s] from a jump of an object until the angle stays small, the longer of both.

    It must stay so as long as nothing in the teacher's timing says to leave.
    """
    hurry = cast(Pointing, record.task).hurry
    times = []
    for path in record.condition.situation.objects:
        clock = record.trial.time - path.times[-1]
        stay = PHASES[path.name][1] - 3 * hurry - path.times[-1]
        after = (clock >= 0) & (clock < stay)
        wide = np.flatnonzero(angle(record, path.name)[after] > RECOVERED)
        first = wide[-1] + 1 if wide.size else None
        clock = clock[after]
        if first is None:
            times.append(0.0)
        else:
            times.append(float(clock[first]) if first < len(clock) else np.inf)
    return max(times)


_ANGLES = {
    "angle": (("unpushed", "moving"), 3.0, "Angle while pointing, objects at rest or moving"),
    "angle_moving": (("moving",), 3.0, "The same, moving objects only"),
    "angle_pushed": (("pushed", "moving pushed"), 5.0, "Angle while pointing and pushed"),
    "angle_moving_pushed": (("moving pushed",), 5.0, "The same, moving objects only"),
}
"""Which trials count, the most allowed [deg], and a title, by the measure's name."""


def _angle_measures() -> list[Measure]:
    found = []
    for name, (labels, limit, title) in _ANGLES.items():
        largest = Measure(
            f"{name}_deg",
            of=pointing_angle,
            unit="deg",
            label=labels,
            limit=limit,
            title=f"{title}, largest",
        )
        median = f"{title}, median of the trials' largest"
        found += [
            largest,
            replace(largest, name=f"{name}_median_deg", across=np.median, limit=None, title=median),
        ]
    return found


def measures(task: Task) -> tuple[Measure, ...]:
    """Measures of pointing; a small arm is asked to be faster than one with fourteen joints."""
    return (
        *_angle_measures(),
        Measure(
            "posture_rad",
            of=farthest_joint,
            unit="rad",
            limit=0.1,
            title="Final posture from the taught one, farthest joint",
        ),
        Measure(
            "jump_recovery_s",
            of=recovery,
            unit="s",
            label="jump",
            limit=0.5,
            title="Time to make good a jump of an object, longest",
        ),
        health.SATURATED,
        health.UNREACHABLE,
        health.DIVERGED,
        health.CONTACTS,
        health.INJECTED,
        health.realtime(25.0 if cast(Pointing, task).robot == FLAT else 8.0),
    )
