"""Pictures of the study of transfer: sections of its report, sequences of its film."""

from collections.abc import Mapping, Sequence

from tpsim import rotation
from tpsim.experiment import plot
from tpsim.experiment.canvas import INK, PALETTE, new_figure
from tpsim.experiment.report import Picture, Section
from tpsim.experiment.studies.study import select
from tpsim.frame import Frame
from tpsim.plot import frames as draw_frames
from tpsim.sim.trial import Trial
from tpsim.sim.video import Clip, Ellipsoid
from tpsim.tasks import docks
from tpsim.tasks.transfer import end_error

SITUATIONS = 3
"""Number of situations whose paths are drawn."""

DRAWN = 0.3
"""Size of a dock on paper, of the U that :func:`draw_frames` draws."""

DEMONSTRATION = "Demonstration: from dock to dock"

_TEXTS = {
    "unpushed": "as taught",
    "pushed": "pushed",
    "moved": "docks move",
    "far": "twice as far",
    "far pushed": "far, pushed",
}


def sections(records, models) -> list[Section]:
    """Paths from above, errors over time, stiffness, as far as the trials show them."""
    groups = {text: select(records, label) for label, text in _TEXTS.items()}
    groups = {text: trials for text, trials in groups.items() if trials}
    if not groups:
        return []
    shown = {text: trials for text, trials in groups.items() if "pushed" not in text}
    found = [Section("Paths from above", _PATHS, [Picture(_paths(records, shown))])]
    distance = plot.panels(
        groups, lambda trial: 1e3 * end_error(trial)[0], label="distance to its place [mm]"
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


def _stiffness_of(k):
    return lambda trial: trial["left_hand_stiffness"][:, k, k]


def _paths(records, groups: Mapping[str, Sequence[Trial]]):
    figure, axes = new_figure(columns=len(groups), height=3.4)
    for axis, (text, trials) in zip(axes, groups.items(), strict=True):
        taught = select(records, "unpushed", "teacher") if text == _TEXTS["unpushed"] else []
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


def _from_above(trial, name) -> Frame:
    R = rotation.from_quaternion(trial[f"{name}_quaternion"][-1])
    return Frame(DRAWN * R[:2, :2], trial[f"{name}_position"][-1, :2])


def clips(simulation, models, records, demonstrations: Mapping[str, Sequence[Trial]]) -> list[Clip]:
    """A demonstration, and a performance of each kind."""
    shown = []
    for trials in demonstrations.values():
        if trials:
            caption = DEMONSTRATION, "the weightless arm is led by hand"
            shown.append(_clip(simulation.xml, trials[0], *caption, speed=2.0))
    for label, subtitle in (
        ("unpushed", "docks where they never were"),
        ("moved", "both docks move while the arm carries"),
        ("far pushed", "docks twice as far from the taught ones; a person pushes with 10 N"),
        ("pushed", "a person pushes with 10 N"),
    ):
        if label == "pushed" and select(records, "far pushed"):
            continue
        if found := select(records, label):
            shown.append(_clip(simulation.xml, found[-1], "Reproduction", subtitle))
    return shown


def _clip(scene: str, trial: Trial, title: str, subtitle: str, speed: float = 1.0) -> Clip:
    # It would hide the docks where nothing shows that the hand is soft.
    ellipsoids = ()
    if trial["push_wrench"].any() and title != DEMONSTRATION:
        ellipsoids = (Ellipsoid(trial["left_hand_position"], trial["left_hand_stiffness"]),)
    return Clip.of(
        scene,
        trial,
        title,
        subtitle,
        docks.NAMES,
        traces=(trial["left_hand_position"],),
        ellipsoids=ellipsoids,
        camera="hands",
        speed=speed,
    )
