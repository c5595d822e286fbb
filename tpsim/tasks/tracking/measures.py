"""What is measured of tracking: how near the hands come to their objects, beside the least."""

from collections.abc import Callable
from dataclasses import replace
from typing import cast

import numpy as np

from tpsim.study import health
from tpsim.study.measure import Measure
from tpsim.study.record import Record
from tpsim.tasks.tracking.body import SIDES, Body, Teaching
from tpsim.tasks.tracking.outcome import Outcome
from tpsim.tasks.tracking.task import HANDS, Tracking, behaviour

FOLLOWED = ("unpushed", "pushed")
"""Conditions in which the learned behaviours follow their objects; others compare."""


def distance(record: Record, side: str) -> np.ndarray:
    """Distance (T,) [m] of a hand from its object."""
    return np.linalg.norm(record.see(HANDS[side]), axis=1)


def teaching(record: Record) -> Teaching:
    """Which teaching a trial performs."""
    taught = cast(Tracking, record.task).taught
    names = {behaviour(one): one for one in taught}
    return names.get(record.condition.controller, taught[0])


def outcome(record: Record) -> Outcome:
    """Outcome of a trial, for the teaching that it performs."""
    return Outcome.of(
        {side: distance(record, side) for side in SIDES},
        {side: record[f"{side}_object_position"][:, :2] for side in SIDES},
        Body.of(record.task.stage.robot),
        teaching(record),
    )


def both(record: Record) -> float:
    """Distance [mm] of the hands while both objects are in reach, rms of the worse one."""
    return 1e3 * max(outcome(record).together.values())


def first(record: Record) -> float | None:
    """Distance [mm] of the hand that has priority while not both are in reach, rms."""
    side = teaching(record)
    return None if side == "compromise" else 1e3 * outcome(record).apart[side]


def other(record: Record) -> float | None:
    """Distance of the other hand over the least possible."""
    side = teaching(record)
    if side == "compromise":
        return None
    ratio = outcome(record).ratio[SIDES[1 - SIDES.index(side)]]
    return ratio if np.isfinite(ratio) else None


def split(record: Record) -> float | None:
    """How far the hands of a compromise are off the split that was taught, the worse one."""
    if teaching(record) != "compromise":
        return None
    off = [abs(r - 1) for r in outcome(record).ratio.values() if np.isfinite(r)]
    return max(off, default=None)


def _twice(
    name: str,
    of: Callable[[Record], float | None],
    unit: str,
    limit: float,
    titles: tuple[str, str],
) -> tuple[Measure, Measure]:
    """The same measure unpushed and pushed; trials of all behaviours count."""
    unpushed = Measure(
        name, of=of, unit=unit, label="unpushed", controller=None, limit=limit, title=titles[0]
    )
    name = name.replace("_mm", "_pushed_mm") if unit else f"{name}_pushed"
    pushed = Measure(
        name, of=of, unit=unit, label="pushed", controller=None, limit=limit, title=titles[1]
    )
    return unpushed, pushed


_BOTH = "Both objects in reach: distance of a hand, rms, worst", "Both in reach, pushed with 10 N"
_FIRST = "Not both: distance of the first hand, rms, worst", "The first hand, pushed with 10 N"
_OTHER = "The other hand, over the least possible, worst", "The other hand, pushed with 10 N"
_SPLIT = "A compromise: off the taught split, worst", "A compromise, pushed with 10 N"

MEASURES = (
    *_twice("rms_mm", both, "mm", 10.0, _BOTH),
    *_twice("priority_rms_mm", first, "mm", 15.0, _FIRST),
    *_twice("other_distance_ratio", other, "", 1.1, _OTHER),
    *_twice("compromise_ratio", split, "", 0.15, _SPLIT),
    health.of_all(health.SATURATED, FOLLOWED),
    health.of_all(health.UNREACHABLE, FOLLOWED),
    health.of_all(health.DIVERGED, FOLLOWED),
    health.of_all(health.CONTACTS, FOLLOWED),
    replace(health.INJECTED, controller=None),
    health.realtime(25.0),
)
