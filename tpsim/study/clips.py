"""The film of a study that shows nothing itself."""

from collections.abc import Sequence

import numpy as np

from tpsim.film.clip import Clip, Ellipsoid
from tpsim.study.measure import Measure, concerns
from tpsim.study.record import Record, Records
from tpsim.study.study import Lab
from tpsim.world.trial import Trial

TEACHING_SPEED = 3.0
"""How much faster than they were demonstrations are shown."""


def clip_of(lab: Lab, trial: Trial, title: str, subtitle: str = "", *, speed: float = 1.0) -> Clip:
    """A trial with forces as arrows, traces of the hands, and their stiffness as ellipsoids."""
    hands = [name for name in lab.world.robot.hands if name in trial.channels.sites]
    ellipsoids = [
        Ellipsoid(trial[f"{hand}_position"], trial[f"{hand}_stiffness"])
        for hand in trial.channels.hands
    ]
    traces = tuple(trial[f"{hand}_position"] for hand in hands)
    return Clip.of(
        lab.world,
        trial,
        title,
        subtitle,
        traces=traces,
        ellipsoids=tuple(ellipsoids),
        speed=speed,
    )


def clips(lab: Lab, records: Records) -> list[Clip]:
    """One demonstration of every behaviour, the first unpushed trial, the worst pushed one."""
    led, speed = "the robot is led by hand", TEACHING_SPEED
    found = [
        clip_of(lab, trials[0], f"Demonstration: {name}", led, speed=speed)
        for name, trials in lab.taught.items()
        if trials
    ]
    performed = [record for record in records if record.condition.shown is None]
    unpushed = [record for record in performed if not record.condition.people]
    if unpushed:
        found.append(_performance(lab, unpushed[0], "where it was never shown"))
    pushed = [record for record in performed if record.condition.people]
    if pushed:
        worst, why = _worst(pushed, lab.study.all_measures)
        found.append(_performance(lab, worst, why))
    return found


def _performance(lab: Lab, record: Record, why: str) -> Clip:
    title = f"Performance: {record.condition.label}"
    if record.condition.controller != "learned":
        title += f", {record.condition.controller}"
    return clip_of(lab, record.trial, title, why)


def _worst(records: Sequence[Record], measures: Sequence[Measure]) -> tuple[Record, str]:
    """The record that comes nearest to a limit, or farthest beyond it, and which limit that is."""
    learned = [r for r in records if r.condition.controller == "learned"] or list(records)
    strains = [_strain(record, measures) for record in learned]
    number = int(np.argmax([share for share, _ in strains]))
    words = strains[number][1]
    return learned[number], f"the worst trial: {words}" if words else "a person pushes"


def _strain(record: Record, measures: Sequence[Measure]) -> tuple[float, str]:
    """Of all limits, the largest share that a trial takes up, -1 without any; and in words."""
    share, words = -1.0, ""
    for measure in measures:
        if measure.limit is None or measure.at_least or measure.of is None:
            continue
        value = measure.number(record)
        if value is not None and value / (measure.limit or 1.0) > share:
            share = value / (measure.limit or 1.0)
            words = f"{measure.title or measure.name} {value:.3g} {measure.unit}".strip()
    return share, words


def best_median_worst(lab: Lab, records: Records) -> dict[str, Clip]:
    """The learned controller's trials that keep farthest from their limits, least so, and between.

    Parameters
    ----------
    lab : Lab
    records : Records

    Returns
    -------
    dict
        By what they are; fewer where there are fewer trials, or no limits.
    """
    learned = [record for record in records.select() if record.condition.shown is None]
    measures, judged = lab.study.all_measures, []
    for record in learned:
        label = record.condition.label
        share, _ = _strain(record, [m for m in measures if concerns(m, label)])
        judged.append((np.inf if record.trial.outcome == "diverged" else share, record))
    judged.sort(key=lambda each: each[0])
    if not judged:
        return {}
    if judged[0][0] == judged[-1][0]:
        places = {"a trial": 0}
    else:
        places = {"best": 0, "median": (len(judged) - 1) // 2, "worst": len(judged) - 1}
    found, taken = {}, set()
    for name, place in places.items():
        share, record = judged[place]
        if place in taken:
            continue
        taken.add(place)
        about = f"{name}: {record.condition.label}, situation {record.condition.situation.index}"
        if np.isinf(share):
            about += "; diverged"
        elif share >= 0:
            about += f"; at {100 * share:.0f} % of its nearest limit"
        found[about] = clip_of(lab, record.trial, name)
    return found
