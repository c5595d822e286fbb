"""Pictures of the study of transfer: sections of its report, sequences of its film."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from tpsim.film.clip import Clip, Ellipsoid
from tpsim.frame import Frame
from tpsim.plot import frames as draw_frames
from tpsim.study import plot
from tpsim.study.canvas import INK, PALETTE, new_figure
from tpsim.study.record import Record, Records
from tpsim.study.report import Picture, Section
from tpsim.study.study import Lab
from tpsim.tasks.transfer import docks
from tpsim.tasks.transfer.task import SEEN
from tpsim.world.trial import Trial
from tpsim.world.world import World

SITUATIONS = 3
"""Number of situations whose paths are drawn."""

DRAWN = 0.3
"""Size of a dock on paper, of the U that :func:`draw_frames` draws."""

DEMONSTRATION = "Demonstration: from dock to dock"

_TEXTS = {
    "unpushed": "as taught",
    "pushed": "pushed",
    "pushed to the end": "pushed to the end",
    "moved": "docks move",
    "far": "twice as far",
    "far pushed": "far, pushed",
    "far pushed to the end": "far, pushed to the end",
}


def sections(records: Records) -> list[Section]:
    """Paths from above, errors over time, stiffness, as far as the trials show them."""
    groups = records.groups(_TEXTS)
    if not groups:
        return []
    shown = {text: trials for text, trials in groups.items() if "pushed" not in text}
    found = [Section("Paths from above", _PATHS, [Picture(_paths(records, shown))])]
    distance = plot.panels(
        groups,
        lambda record: 1e3 * np.linalg.norm(record.see(SEEN["end", "position"]), axis=1),
        label="distance to its place [mm]",
    )
    found.append(Section("On the way into the dock", _DISTANCE, [Picture(distance)]))
    first = next(iter(groups.values()))[0]
    scalars = {axis: _stiffness_of(k) for k, axis in enumerate("xyz")}
    stiffness = plot.signals(first, scalars, label="stiffness of the hand [N/m]")
    found.append(Section("Stiffness over time", _STIFFNESS, [Picture(stiffness)]))
    return found


_PATHS = (
    "Where the hand went, seen from above, in some situations of each kind; the docks as U "
    "in their last place. Grey is the teacher's own demonstration for the same situation, which "
    "the model was not shown."
)
_DISTANCE = (
    "Distance of the hand from its place in the second dock, wherever the dock is at that time. "
    "Thin lines are trials, the thick one their median."
)
_STIFFNESS = (
    "What a slow push at the hand meets along the world's axes in the first trial: stiff in both "
    "docks, where the demonstrations agreed, and soft on the way."
)


def _stiffness_of(k: int) -> Callable[[Record], np.ndarray]:
    return lambda record: record["left_hand_stiffness"][:, k, k]


def _paths(records: Records, groups: Mapping[str, Sequence[Record]]) -> Figure:
    figure, axes = new_figure(columns=len(groups), height=3.4)
    for axis, (text, trials) in zip(axes, groups.items(), strict=True):
        taught = records.select("taught") if text == _TEXTS["unpushed"] else []
        for trial in taught[:SITUATIONS]:
            axis.plot(*trial["left_hand_position"][:, :2].T, color=INK, lw=3, alpha=0.25)
        for trial in trials[:SITUATIONS]:
            axis.plot(*trial["left_hand_position"][:, :2].T, color=PALETTE[0], lw=1.4)
            draw_frames(axis, [_from_above(trial, name) for name in docks.NAMES], PALETTE[1:])
        axis.set_aspect("equal")
        axis.set_title(text, color=INK, fontsize=9.5, loc="left", fontweight="bold")
        axis.set_xlabel("x [m]", color=INK)
    axes[0].set_ylabel("y [m]", color=INK)
    return figure


def _from_above(record: Record, name: str) -> Frame:
    R, p = record.trial.pose(name)
    return Frame(DRAWN * R[-1, :2, :2], p[-1, :2])


def clips(lab: Lab, records: Records) -> list[Clip]:
    """A demonstration, and a performance of each kind."""
    shown = []
    for trials in lab.taught.values():
        if trials:
            caption = DEMONSTRATION, "the weightless arm is led by hand"
            shown.append(_clip(lab.world, trials[0], *caption, speed=2.0))
    for label, subtitle in (
        ("unpushed", "docks where they never were"),
        ("moved", "both docks move while the arm carries"),
        ("far pushed", "docks twice as far from the taught ones; a person pushes"),
        ("pushed", "a person pushes with 10 N"),
    ):
        if label == "pushed" and records.select("far pushed"):
            continue
        if found := records.select(label):
            shown.append(_clip(lab.world, found[-1].trial, "Reproduction", subtitle))
    return shown


def _clip(world: World, trial: Trial, title: str, subtitle: str, speed: float = 1.0) -> Clip:
    # It would hide the docks where nothing shows that the hand is soft.
    ellipsoids: tuple[Ellipsoid, ...] = ()
    if trial["push_wrench"].any() and title != DEMONSTRATION:
        ellipsoids = (Ellipsoid(trial["left_hand_position"], trial["left_hand_stiffness"]),)
    return Clip.of(
        world,
        trial,
        title,
        subtitle,
        traces=(trial["left_hand_position"],),
        ellipsoids=ellipsoids,
        camera="hands",
        speed=speed,
    )
