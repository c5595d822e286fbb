"""Pictures of the study of tracking: sections of its report, sequences of its film."""

from collections.abc import Callable
from functools import partial
from typing import cast

import numpy as np

from tpsim.film.clip import Clip
from tpsim.study import plot
from tpsim.study.record import Record, Records
from tpsim.study.report import Picture, Section
from tpsim.study.study import Lab
from tpsim.tasks.tracking.body import SIDES, Teaching
from tpsim.tasks.tracking.measures import distance, teaching
from tpsim.tasks.tracking.task import Tracking, behaviour

CAPTIONS = {
    "left": "the left hand has priority",
    "right": "the right hand has priority",
    "compromise": "both hands stay away alike",
}
"""What each teaching shows."""


def sections(records: Records) -> list[Section]:
    """Distance of each hand from its object over time, teaching by teaching."""
    shown = []
    taught = cast(Tracking, records.task).taught
    for label, words in (("unpushed", ""), ("pushed", ", pushed")):
        groups = {CAPTIONS[one]: found for one in taught if (found := _select(records, label, one))}
        for side in SIDES if groups else ():
            figure = plot.panels(groups, _away(side), label="distance [mm]")
            title = f"Distance of the {side} hand from its object{words}"
            shown.append(Section(title, _DISTANCE, [Picture(figure)]))
    return shown


_DISTANCE = (
    "Thin lines are trials, the thick one is their median. The objects are together at the start, "
    "in the middle and at the end, and too far apart for both hands between."
)


def _away(side: str) -> Callable[[Record], np.ndarray]:
    return lambda record: 1e3 * distance(record, side)


def _select(records: Records, label: str, one: Teaching) -> list[Record]:
    return [record for record in records.select(label, None) if teaching(record) == one]


def clips(lab: Lab, records: Records) -> list[Clip]:
    """A demonstration and a reproduction of every teaching, and a push."""
    clip, shown = partial(Clip.of, lab.world), []
    taught = cast(Tracking, lab.task).taught
    for one in taught:
        if trials := lab.taught.get(behaviour(one)):
            shown.append(clip(trials[0], "Demonstration", CAPTIONS[one], speed=3.0))
        if found := _select(records, "unpushed", one):
            shown.append(clip(found[-1].trial, "Reproduction", CAPTIONS[one], speed=2.0))
    if found := _select(records, "pushed", taught[-1]):
        shown.append(clip(found[-1].trial, "Reproduction", "a person pushes with 10 N"))
    return shown
