"""Pictures of the study of cup and sugar: sections of its report, sequences of its film."""

from collections.abc import Mapping, Sequence

import numpy as np

from tpsim.experiment import plot
from tpsim.experiment.conditions import Condition, Lead
from tpsim.experiment.report import Picture, Section
from tpsim.experiment.studies import cup_and_sugar_measures as measures
from tpsim.experiment.studies.study import select
from tpsim.sim.push import Push
from tpsim.sim.trial import Trial
from tpsim.sim.video import Clip, Ellipsoid

_NAMES = {"learned": "learned", "stiff": "fixed, stiff", "soft": "fixed, soft"}


def sections(records, models) -> list[Section]:
    """Tilt, offset, yielding and stiffness, as far as the trials show them."""
    found = []
    groups = {name: select(records, "pushed", key) for key, name in _NAMES.items()}
    groups = {name: trials for name, trials in groups.items() if trials}
    if not groups:
        groups = {"unpushed": select(records, "unpushed")}
    shown = {name: groups[name] for name in list(groups)[:2]}
    if "cup" in models:
        figure = plot.panels(shown, measures.tilt, label="cup tilt [deg]", limit=5.0)
        found.append(Section("The cup stays level", _TILT, [Picture(figure)]))
    if "sugar" in models:
        place = measures.taught_place(models)

        def offset(trial):
            return measures.offset(trial, place)

        figure = plot.panels(shown, offset, label="sugar offset [mm]", limit=15.0)
        found.append(Section("The sugar stays above it", _OFFSET, [Picture(figure)]))
    found.append(_yielding(records))
    found.append(_stiffness(records))
    return [section for section in found if section is not None]


_TILT = (
    "Angle of the cup's axis from the vertical while a person pushes the left hand with 20 N. "
    "Thin lines are trials, the thick one their median."
)
_OFFSET = (
    "Distance of the sugar from the place above the cup where it was taught to be. The stiff "
    "controller holds the hand itself; the learned one lets the hand go and takes the sugar along."
)


def _yielding(records):
    twins = {c.situation.index: t for c, t in records if c.label == "unpushed"}
    pushed = [(c, t) for c, t in records if c.label == "pushed"]
    if not pushed or not twins:
        return None
    bars = {}
    for condition, trial in pushed:
        hand = trial["left_hand_position"]
        if condition.controller == "learned":
            rest = twins[condition.situation.index]["left_hand_position"][: len(hand)]
        else:
            rest = hand[:1]
        way = 1e3 * np.linalg.norm(hand[: len(rest) if len(rest) > 1 else None] - rest, axis=1)
        axis = int(np.argmax(np.abs(condition.push.force)))
        direction = ("+" if condition.push.force[axis] > 0 else "−") + "xyz"[axis]
        group = bars.setdefault(_NAMES[condition.controller], {})
        group.setdefault(direction, []).append(way.max())
    means = {name: {d: np.mean(v) for d, v in group.items()} for name, group in bars.items()}
    figure = plot.paired_bars(means, label="peak displacement [mm]")
    text = (
        "How far the left hand gives way to 20 N, by direction. The fixed stiff gain keeps the "
        "sugar about as near to its place as the learned controller does, and hardly yields; the "
        "fixed soft one yields, and loses the sugar."
    )
    return Section("The hand gives way", text, [Picture(figure)])


def _stiffness(records):
    trials = select(records, "pushed") or select(records, "unpushed")
    if not trials:
        return None
    scalars = {
        f"{hand} hand, {axis}": _stiffness_of(hand, k)
        for hand in ("left", "right")
        for k, axis in enumerate("xyz")
    }
    figure = plot.signals(trials[0], scalars, label="stiffness [N/m]")
    text = "What a slow push at each hand meets along the world's axes, in the first trial."
    return Section("Stiffness over time", text, [Picture(figure)])


def _stiffness_of(hand, k):
    return lambda trial: trial[f"{hand}_hand_stiffness"][:, k, k]


def clips(simulation, models, demonstrations: Mapping[str, Sequence[Trial]], task, tasks):
    """The four sequences of Fig. 9: two demonstrations, one behaviour led, both pushed."""
    shown = []
    captions = {
        "cup": ("Demonstration: holding a cup level", "the weightless left arm is led by hand"),
        "sugar": ("Demonstration: holding sugar above the cup", "both arms are led by hand"),
    }
    for name, (title, subtitle) in captions.items():
        if demonstrations.get(name):
            shown.append(clip(simulation.xml, demonstrations[name][0], title, subtitle, speed=2.0))
    if "sugar" in models:
        led = _led(simulation, models, tasks.load("sugar"))
        caption = "Reproduction: sugar above the cup", "a person leads the left hand by 15 cm"
        shown.append(clip(simulation.xml, led, *caption))
    pushed = _pushed(simulation, models, task)
    caption = "Reproduction: " + " + ".join(task.behaviours), "pushes of 20 N on the left hand"
    shown.append(clip(simulation.xml, pushed, *caption))
    return shown


def _led(simulation, models, task):
    situation = task.situation(simulation, 0, 0)
    twin = Condition("unpushed", situation, duration=1.5).perform(task, simulation, models)
    origin = tuple(twin["left_hand_position"][-1].tolist())
    lead = Lead("left_gripper", origin, (0.0, measures.TRAVEL, 0.0), start=1.5, duration=2.5)
    condition = Condition("led", situation, lead=lead, duration=6.0)
    return condition.perform(task, simulation, models)


def _pushed(simulation, models, task):
    forces = measures.PUSH * measures.DIRECTIONS[[0, 2, 4]]
    pushes = [
        Push("left_gripper", tuple(force.tolist()), start=1.2 + 2.6 * k, duration=1.4)
        for k, force in enumerate(forces)
    ]
    situation = task.situation(simulation, 0, 1)
    return task.perform(simulation, models, situation, people=pushes, duration=9.0)


def clip(scene: str, trial: Trial, title: str, subtitle: str, *, speed: float = 1.0) -> Clip:
    """A recorded trial with forces as arrows, hand traces and stiffness ellipsoids."""
    ellipsoids = [
        Ellipsoid(trial[f"{hand}_hand_position"], trial[f"{hand}_hand_stiffness"])
        for hand in ("left", "right")
        if f"{hand}_hand_stiffness" in trial.arrays
    ]
    return Clip.of(
        scene,
        trial,
        title,
        subtitle,
        traces=(trial["cup_position"], trial["sugar_position"]),
        ellipsoids=tuple(ellipsoids),
        speed=speed,
    )
