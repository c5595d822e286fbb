"""Pictures of the study of cup and sugar: sections of its report, sequences of its film."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from tpsim.film.clip import Clip, Ellipsoid, Reading
from tpsim.study import plot
from tpsim.study.clips import TEACHING_SPEED
from tpsim.study.condition import Condition, Lead
from tpsim.study.record import Record, Records
from tpsim.study.report import Picture, Section
from tpsim.study.study import Lab
from tpsim.task.task import Situation, Task, draw_situation
from tpsim.task.verbs import perform
from tpsim.tasks.cup_and_sugar import conditions
from tpsim.tasks.cup_and_sugar.measures import offset, tilt, yielding
from tpsim.tasks.workplace import size_of
from tpsim.world.people.push import Push
from tpsim.world.trial import Trial

_NAMES = {"learned": "learned", "stiff": "fixed, stiff", "soft": "fixed, soft"}


def sections(records: Records) -> list[Section]:
    """Tilt, offset, yielding and stiffness, as far as the trials show them."""
    groups = {name: records.select("pushed", key) for key, name in _NAMES.items()}
    groups = {name: found for name, found in groups.items() if found}
    if not groups:
        groups = {"unpushed": records.select("unpushed")}
    shown = {name: groups[name] for name in list(groups)[:2]}
    found = []
    if "cup" in records.models:
        figure = plot.panels(shown, tilt, label="cup tilt [deg]", limit=3.0)
        found.append(Section("The cup stays level", _TILT, [Picture(figure)]))
    if "sugar" in records.models:
        figure = plot.panels(shown, offset, label="sugar offset [mm]", limit=6.0)
        found.append(Section("The sugar stays above it", _OFFSET, [Picture(figure)]))
    more = _yielding(records), _stiffness(records)
    return found + [section for section in more if section is not None]


_TILT = (
    "Angle of the cup's axis from the vertical while a person pushes the left hand. "
    "Thin lines are trials, the thick one their median."
)
_OFFSET = (
    "Distance of the sugar from the place above the cup where it was taught to be. The stiff "
    "controller holds the hand itself; the learned one lets the hand go and takes the sugar along."
)


def _yielding(records: Records) -> Section | None:
    moved = yielding("left_hand")
    bars: dict[str, dict[str, list[float]]] = {}
    for record in records.select("pushed", None):
        way = moved(record)
        if way is None or record.condition.controller not in _NAMES:
            continue
        (push,) = record.condition.push
        axis = int(np.argmax(np.abs(push.force)))
        direction = ("+" if push.force[axis] > 0 else "−") + "xyz"[axis]
        group = bars.setdefault(_NAMES[record.condition.controller], {})
        group.setdefault(direction, []).append(way.max())
    if not bars:
        return None
    means = {name: {d: float(np.mean(v)) for d, v in group.items()} for name, group in bars.items()}
    figure = plot.paired_bars(means, label="peak displacement [mm]")
    text = (
        "How far the left hand gives way to a push, by direction. The fixed stiff gain keeps the "
        "sugar about as near to its place as the learned controller does, and hardly yields; the "
        "fixed soft one yields, and loses the sugar."
    )
    return Section("The hand gives way", text, [Picture(figure)])


def _stiffness(records: Records) -> Section | None:
    found = records.select("pushed") or records.select("unpushed")
    if not found:
        return None
    scalars = {
        f"{hand} hand, {axis}": _stiffness_of(hand, k)
        for hand in ("left", "right")
        for k, axis in enumerate("xyz")
    }
    figure = plot.signals(found[0], scalars, label="stiffness [N/m]")
    text = "What a slow push at each hand meets along the world's axes, in the first trial."
    return Section("Stiffness over time", text, [Picture(figure)])


def _stiffness_of(hand: str, k: int) -> Callable[[Record], np.ndarray]:
    return lambda record: record[f"{hand}_hand_stiffness"][:, k, k]


_CAPTIONS: Mapping[str, tuple[str, str]] = {
    "cup": ("Demonstration: holding a cup level", "the weightless left arm is led by hand"),
    "sugar": ("Demonstration: holding sugar above the cup", "both arms are led by hand"),
}


def clips(lab: Lab, records: Records) -> list[Clip | Sequence[Clip]]:
    """The four sequences of Fig. 9, and the same push met by other controllers."""
    shown: list[Clip | Sequence[Clip]] = []
    for name, caption in _CAPTIONS.items():
        if lab.taught.get(name):
            shown.append(clip(lab, lab.taught[name][0], *caption, of=(name,), speed=TEACHING_SPEED))
    task = lab.task
    if "sugar" in lab.models:
        alone = replace(task, taught=("sugar",)).in_world(task.stage)  # type: ignore[type-var]
        way = 100 * conditions.TRAVEL * size_of(lab.world.robot)
        said = f"a person leads the left hand by {way:.0f} cm"
        caption = "Reproduction: sugar above the cup", said
        shown.append(clip(lab, _led(lab, alone), *caption, of=("sugar",)))
    force = conditions.PUSH * size_of(lab.world.robot)
    caption = "Reproduction: " + " + ".join(lab.models), f"pushes of {force:.0f} N on the left hand"
    shown.append(clip(lab, _pushed(lab, task), *caption))
    return [*shown, *_compared(lab, records)]


def _compared(lab: Lab, records: Records) -> list[Sequence[Clip]]:
    """The first push that all of them met: learned, expert, stiff."""
    for learned in records.select("pushed"):
        same = {
            name: next(
                (
                    record
                    for record in records.select("pushed", name)
                    if record.condition.push == learned.condition.push
                    and record.condition.situation.index == learned.condition.situation.index
                ),
                None,
            )
            for name in ("cartesian", "stiff")
        }
        found = {"learned": learned, "expert": same["cartesian"], "stiff joints": same["stiff"]}
        if all(found.values()):
            return [[_narrow(lab, r.trial, name) for name, r in found.items() if r is not None]]
    return []


def _narrow(lab: Lab, trial: Trial, title: str) -> Clip:
    """A trial seen from nearer, without what there is no room for side by side."""
    shown = clip(lab, trial, title, "")
    assert shown.close is not None
    return replace(shown, centre=shown.close[0], legend=(), close=None)


def _led(lab: Lab, task: Task) -> Trial:
    situation = draw_situation(task, 0, 0)
    twin = perform(task, lab.models, situation, duration=1.5)
    origin = tuple(twin["left_hand_position"][-1].tolist())
    travel = conditions.way_led(task, np.pi / 2)
    lead = Lead("left_gripper", origin, travel, start=1.5, duration=2.5)
    return perform(task, lab.models, situation, people=[lead], duration=6.0)


def _pushed(lab: Lab, task: Task) -> Trial:
    forces = conditions.PUSH * size_of(lab.world.robot) * conditions.DIRECTIONS[[0, 2, 4]]
    pushes = [
        Push("left_gripper", tuple(force.tolist()), start=1.2 + 2.6 * k, duration=1.4)
        for k, force in enumerate(forces)
    ]
    situation = draw_situation(task, 0, 1)
    return perform(task, lab.models, situation, people=pushes, duration=9.0)


def clip(
    lab: Lab,
    trial: Trial,
    title: str,
    subtitle: str,
    *,
    of: Collection[str] = ("cup", "sugar"),
    speed: float = 1.0,
) -> Clip:
    """A trial with forces, traces, stiffness; tilt and offset as measured; the cup from near."""
    ellipsoids = [
        Ellipsoid(trial[f"{hand}_position"], trial[f"{hand}_stiffness"])
        for hand in trial.channels.hands
    ]
    shown = Clip.of(
        lab.world,
        trial,
        title,
        subtitle,
        traces=(trial["cup_position"], trial["sugar_position"]),
        ellipsoids=tuple(ellipsoids),
        speed=speed,
    )
    start = Situation(tuple(trial["q"][0].tolist()))
    record = Records(lab.task, lab.models).add(Condition("film", start), trial)
    readings = {
        "cup": lambda: Reading("cup tilt", tilt(record), "deg", 3.0),
        "sugar": lambda: Reading("sugar off its place", offset(record), "mm", 6.0),
    }
    return replace(
        shown,
        readings=tuple(make() for name, make in readings.items() if name in {*of} & {*lab.models}),
        legend=("path of the cup", "path of the sugar"),
        close=(trial["cup_position"] + trial["sugar_position"]) / 2,
    )
