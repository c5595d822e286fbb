"""The study of transfer: docks at rest and moving, near and far, with and without pushes."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from tpsim.robot.views.view import View
from tpsim.study import health
from tpsim.study.condition import Condition
from tpsim.study.expert import fixed_gains
from tpsim.study.held import BY, by_progress, held_measures
from tpsim.study.measure import Measure
from tpsim.study.record import Record, Records
from tpsim.study.study import Lab, Phases, Plan, Study
from tpsim.task.task import Situation, draw_situation
from tpsim.tasks.transfer import docks, experts, pictures
from tpsim.tasks.transfer.task import SEEN, Transfer
from tpsim.tasks.transfer.teacher import lesson_between
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.hold import Hold
from tpsim.world.people.push import Push
from tpsim.world.perception import Perception
from tpsim.world.plant import Plant
from tpsim.world.teaching import Lesson
from tpsim.world.world import World

PUSH = 10.0
"""Force on the hand of an arm of size 1 [N], for two seconds or to the end."""

PUSHED = (1.0, 3.5)
"""A push begins at a time drawn from this range [s]; these and all times go with the pace."""

PUSHED_LAST = (-0.5, 0.5)
"""A push that lasts to the end of the trial begins so long after the movement's end [s]."""

TO_THE_END = "pushed to the end"
"""Label of such pushes."""

MOVED = (2.0, 4.0)
"""When docks that move leave their place, and are in another [s]."""

HIDDEN = (1.5, 4.5)
"""When the second dock cannot be seen in some of the trials with a camera [s]."""

ENDED = 0.5
"""Time [s] at the end of a trial, of which the worst moment counts."""

HOLD, HELD = 5.0, (0.5, 5.0)
"""How long a person holds the hand still [s], from a time on that is drawn from this range [s]."""

NEAR = ("unpushed", "pushed", TO_THE_END)
FAR = ("far", "far pushed", f"far {TO_THE_END}")
"""Labels of the trials within the taught range, and far from it."""

_MOVES, _HOLDS = 3, 4


def conditions(lab: Lab, plan: Plan) -> Phases:
    """Every situation beside the teacher's own way, moved and pushed; and others, far away."""
    task, found = lab.task, []
    assert isinstance(task, Transfer)
    pace = task.layout.pace
    for index in range(plan.situations):
        near = draw_situation(task, plan.seed, index)
        far = draw_situation(task, plan.seed, index, partial(task.situation, far=True))
        rng = plan.rng(_MOVES, index)
        found += [
            Condition("unpushed", near),
            Condition("taught", near, shown="transfer"),
            Condition("moved", _moved(near, _elsewhere(task, rng), pace)),
            Condition("far", far),
            *_seen(task.perception, near, index, pace),
        ]
        if task.apart:
            turned = partial(task.situation, apart=task.apart)
            found.append(Condition("turned", draw_situation(task, plan.seed, index, turned)))
        for k in range(plan.pushes):
            label, situation = ("far pushed", far) if k % 2 else ("pushed", near)
            # Of either kind every other one.
            to_the_end = k % 4 >= 2
            label = label.replace("pushed", TO_THE_END) if to_the_end else label
            push = _push(rng, task, to_the_end)
            found.append(Condition(label, situation, push=(push,)))
        start = pace * float(plan.rng(_HOLDS, index).uniform(*HELD))
        hold = (Hold(docks.GRIPPER, start, HOLD),)
        for name in BY:
            found.append(Condition("unpushed", near, name))
            found.append(Condition("held", near, name, hold=hold, duration=task.duration + HOLD))
    yield found


def _elsewhere(task: Transfer, rng: np.random.Generator) -> docks.Docks:
    """Where docks move to."""
    return docks.draw(task.stage.robot, rng, layout=task.layout)


def _seen(perception: Perception, situation: Situation, index: int, pace: float) -> list[Condition]:
    """The situation as a camera sees it, and with the second dock hidden for a while."""
    own = replace(perception, seed=perception.seed + index)
    since, until = HIDDEN
    gone = docks.NAMES[1], pace * since, pace * until
    hidden = replace(own, occluded=(*own.occluded, gone))
    return [
        Condition("seen", situation, plant=Plant(perception=own)),
        Condition("hidden", situation, plant=Plant(perception=hidden)),
    ]


def show(world: World, condition: Condition, rng: np.random.Generator, pace: float = 1.0) -> Lesson:
    """How the teacher would carry in the situation of a condition."""
    situation = condition.situation
    placed = docks.at_start(situation.objects)
    return lesson_between(world, placed, np.array(situation.start), rng, pace=pace)


def _moved(situation: Situation, elsewhere: docks.Docks, pace: float) -> Situation:
    """The situation with both docks on their way to another one while the arm carries."""
    moving = []
    for path in situation.objects:
        there = elsewhere[path.name]
        assert path.quaternions is not None
        moving.append(
            ObjectPath(
                path.name,
                (path.positions[0], tuple(there.position.tolist())),
                (pace * MOVED[0], pace * MOVED[1]),
                (path.quaternions[0], tuple(there.quaternion.tolist())),
            )
        )
    return replace(situation, objects=tuple(moving))


def _push(rng: np.random.Generator, task: Transfer, to_the_end: bool) -> Push:
    force, pace = rng.standard_normal(3), task.layout.pace
    force *= PUSH * task.size / np.linalg.norm(force)
    if to_the_end:
        start = task.layout.movement + float(rng.uniform(*PUSHED_LAST))
        return Push(docks.GRIPPER, tuple(force.tolist()), start, task.duration - start)
    return Push(docks.GRIPPER, tuple(force.tolist()), start=pace * float(rng.uniform(*PUSHED)))


def path_rms(record: Record) -> float | None:
    """Distance [mm] between the hand's path and the teacher's in the same situation, rms."""
    teacher = record.beside("taught")
    if teacher is None:
        return None
    return 1e3 * apart(record["left_hand_position"], teacher["left_hand_position"])


def apart(one: np.ndarray, other: np.ndarray) -> float:
    """Distance between two paths (T, 3), (S, 3), rms, whatever their timing.

    From all points of either path to the nearest of the other one; the larger of both counts.
    """
    away = np.linalg.norm(one[:, None] - other, axis=-1)
    return max(float(np.sqrt(np.mean(away.min(axis) ** 2))) for axis in (0, 1))


def at_the_end(view: View) -> Callable[[Record], np.ndarray]:
    """Norm of a view over the last moments of a trial [mm], [deg]."""

    def error(record: Record) -> np.ndarray:
        value = np.linalg.norm(record.see(view), axis=1)
        time = record.trial.time
        # What comes before the end does not count.
        return np.where(time >= time[-1] - ENDED, value, 0.0)

    return error


def _end(name: str, labels: str | Sequence[str], title: str) -> tuple[Measure, Measure]:
    position, orientation = (at_the_end(SEEN["end", part]) for part in ("position", "orientation"))
    return (
        Measure(
            f"{name}_mm",
            of=lambda record: 1e3 * position(record),
            unit="mm",
            label=labels,
            limit=5.0,
            title=title,
        ),
        Measure(
            f"{name}_deg",
            of=lambda record: np.degrees(orientation(record)),
            unit="deg",
            label=labels,
            limit=3.0,
            title="The same, orientation",
        ),
    )


def _held() -> tuple[Measure, ...]:
    """What comes of being held, where state and where the clock says how far the movement is."""
    ends = [at_the_end(SEEN["end", part]) for part in ("position", "orientation")]
    title = f"End after being held for {HOLD:g} s, beside unheld"
    return (
        *held_measures("by state", title, *ends),
        *held_measures("by clock", title, *ends),
    )


def unreachable(records: Records) -> int:
    """Trials that ended far from the second dock."""
    return sum(record.trial.outcome == "unreachable" for record in records.select())


def unseen(records: Records) -> int:
    """Trials in which a dock was never seen."""
    return sum(record.trial.outcome.startswith("unseen") for record in records.select())


def seen_ratio(records: Records) -> float:
    """Mean error of the end with a camera, over that of trials that are told the places."""
    away = at_the_end(SEEN["end", "position"])
    seen, told = (
        [float(away(record).max()) for record in records.select(label)]
        for label in ("seen", "unpushed")
    )
    return float(np.mean(seen) / np.mean(told)) if seen and told else np.nan


MEASURES = (
    *_end("end", NEAR, "End from the second dock, worst"),
    *_end("end_pushed", "pushed", "End after a push, worst"),
    *_end("end_while_pushed", TO_THE_END, "End while a push lasts, worst"),
    *_end("end_moved", "moved", "End where the docks have moved, worst"),
    *_end("end_far", FAR, "End twice as far from what was taught, worst"),
    *_end("end_far_while_pushed", FAR[-1], "The same while a push lasts, worst"),
    Measure(
        "path_rms_mm",
        of=path_rms,
        unit="mm",
        label="unpushed",
        limit=30.0,
        title="Path from the teacher's own, rms, worst trial",
    ),
    Measure(
        "path_pushed_rms_mm",
        of=path_rms,
        unit="mm",
        label="pushed",
        title="The same, while pushed",
    ),
    *_held(),
    health.SATURATED,
    *_end("end_seen", "seen", "End as a camera sees the docks, worst"),
    *_end("end_hidden", "hidden", "End where the second dock was hidden for 3 s, worst"),
    Measure("seen_ratio", whole=seen_ratio, limit=2.0, title="End as seen over end as told, mean"),
    Measure("unseen", whole=unseen, title="Trials in which a dock was never seen"),
    Measure("unreachable", whole=unreachable, title="Trials that ended out of reach"),
    health.DIVERGED,
    replace(
        health.CONTACTS,
        whole=partial(health.contacts, label=NEAR),
        title="Trials in which the hand or its cube touched a dock, or anything else",
    ),
    replace(
        health.CONTACTS,
        name="contacts_far",
        whole=partial(health.contacts, label=FAR),
        limit=None,
        title="The same, twice as far from what was taught",
    ),
    health.INJECTED,
    health.realtime(8.0),
)


TURNED = _end("end_turned", "turned", "End where the hand must turn far, worst")
"""Where docks are turned against each other: the task's ``apart``."""


def study(task: Transfer) -> Study:
    """The study of transfer."""
    compared = experts.contest(task)
    return Study(
        task,
        (*MEASURES, *TURNED) if task.apart else MEASURES,
        controllers=fixed_gains(compared.experts["computed"]) | by_progress(task),
        conditions=conditions,
        contest=compared,
        show=partial(show, pace=task.layout.pace),
        of=study,
        title="Transfer between two docks",
        lead=(
            "The weightless arm was led to carry a cube out of one dock into another. How to "
            "leave the first and enter the second was found in the demonstrations alone: it is "
            "what each dock saw consistently. The arm then carries between docks where they never "
            "were, twice as far from the taught places as these from each other, and while the "
            "docks move."
        ),
        sections=pictures.sections,
        clips=pictures.clips,
    )


transfer = study(Transfer())
