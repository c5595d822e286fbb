"""Pictures of the study of serving: sections of its report, sequences of its film."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tpsim.film.clip import Clip, Reading
from tpsim.study import plot
from tpsim.study.record import Record, Records
from tpsim.study.report import Picture, Section
from tpsim.study.study import Lab
from tpsim.tasks.serve.measures import faults
from tpsim.world.trial import Trial
from tpsim.world.world import World

DEMONSTRATION = "Demonstration: serving"

_KINDS = {
    "as taught": ("unpushed", "learned"),
    "pushed": ("pushed", "learned"),
    "held": ("held", "learned"),
    "held, by clock": ("held", "by clock"),
}
"""Label and controller of the trials of each kind."""

_FAULTS = "How many trials of each kind succeeded, and what went wrong in the others."
_TILT = (
    "Tilt of the cup from the vertical: level while it is carried, though nobody said that it has "
    "to be, and tilted over the bowl. Thin lines are trials, the thick one their median."
)
_STIFFNESS = (
    "What a slow push at the left hand meets along the world's axes in the first trial: it changes "
    "with the phase, stiff where the demonstrations agreed."
)


def tilt(trial: Trial) -> np.ndarray:
    """Tilt (T,) of the cup [deg]."""
    axis = trial.pose("cup").rotation[:, 2, 2]
    return np.asarray(np.degrees(np.arccos(np.clip(axis, -1, 1))))


def sections(records: Records) -> list[Section]:
    """What went wrong, tilt over time, stiffness, as far as the trials show them."""
    kinds = {text: records.select(*kind) for text, kind in _KINDS.items()}
    groups = {text: trials for text, trials in kinds.items() if trials}
    if not groups:
        return []
    rows = []
    for text, trials in groups.items():
        counted = faults(trials)
        wrong = ", ".join(f"{count} {fault}" for fault, count in counted.items()) or "nothing"
        rows.append({"trials": text, "number": len(trials), "what went wrong": wrong})
    found = [Section("What went wrong", _FAULTS, table=rows)]
    figure = plot.panels(groups, lambda record: tilt(record.trial), label="tilt of the cup [deg]")
    found.append(Section("Level, but over the bowl", _TILT, [Picture(figure)]))
    first = next(iter(groups.values()))[0]
    scalars = {axis: _stiffness_of(k) for k, axis in enumerate("xyz")}
    stiffness = plot.signals(first, scalars, label="stiffness of the left hand [N/m]")
    found.append(Section("Stiffness over time", _STIFFNESS, [Picture(stiffness)]))
    return found


def _stiffness_of(k: int) -> Callable[[Record], np.ndarray]:
    return lambda record: record["left_hand_stiffness"][:, k, k]


def clips(lab: Lab, records: Records) -> list[Clip]:
    """A demonstration, and a performance of each kind."""
    shown = []
    for trials in lab.taught.values():
        if trials:
            caption = DEMONSTRATION, "both weightless arms are led by hand"
            shown.append(_clip(lab.world, trials[0], *caption, speed=3.0))
    for kind, subtitle in (
        ("as taught", "dock, sugar and bowl where they never were"),
        ("pushed", "a person pushes with 10 N"),
        ("held", "a person holds the hand for 5 s"),
    ):
        if found := records.select(*_KINDS[kind]):
            shown.append(_clip(lab.world, found[-1].trial, "Reproduction", subtitle, speed=2.0))
    return shown


def _clip(world: World, trial: Trial, title: str, subtitle: str, speed: float) -> Clip:
    clip = Clip.of(
        world,
        trial,
        title,
        subtitle,
        traces=(trial["left_hand_position"], trial["right_hand_position"]),
        camera="hands",
        speed=speed,
    )
    return replace(clip, readings=(Reading("cup tilt", tilt(trial), "deg"),))
