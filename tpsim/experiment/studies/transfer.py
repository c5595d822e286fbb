"""The study of transfer: docks at rest and moving, near and far, with and without pushes."""

from dataclasses import asdict, replace

import numpy as np

from tpsim import rotation
from tpsim.experiment.conditions import Condition
from tpsim.experiment.studies.study import Phases, Records, Study, health, select
from tpsim.experiment.studies.transfer_pictures import clips, sections
from tpsim.sim.objects import ObjectPath
from tpsim.sim.push import Push
from tpsim.sim.trial import Trial
from tpsim.tasks import docks
from tpsim.tasks.task import Situation
from tpsim.tasks.transfer import end_error

PUSH = 10.0
"""Force [N] on the hand, for two seconds."""

PUSHED = (1.0, 3.5)
"""A push begins at a time drawn from this range [s]."""

MOVED = (2.0, 4.0)
"""When docks that move leave their place, and are in another [s]."""

ENDED = 0.5
"""Time [s] at the end of a trial, of which the worst moment counts."""

LABELS = ("unpushed", "pushed", "moved", "far", "far pushed")


def end(trial: Trial) -> tuple[float, float]:
    """Largest distance [mm] and angle [deg] of the hand from its place in the second dock."""
    distance, angle = end_error(trial)
    last = trial["time"] >= trial["time"][-1] - ENDED
    return 1e3 * float(distance[last].max()), float(np.degrees(angle[last].max()))


def path_rms(trial: Trial, teacher: Trial) -> float:
    """Distance [mm] between the hand's path and the teacher's in the same situation, rms.

    From all points of either path to the nearest of the other one; the larger of both counts.
    """
    hand, taught = (t["left_hand_position"] for t in (trial, teacher))
    apart = np.linalg.norm(hand[:, None] - taught, axis=-1)
    return 1e3 * max(float(np.sqrt(np.mean(apart.min(axis) ** 2))) for axis in (0, 1))


_WORDS = (
    ("end_mm", "End from the second dock, worst", "mm", 5.0, False),
    ("end_deg", "The same, orientation", "deg", 3.0, False),
    ("end_pushed_mm", "End after a push of 10 N, worst", "mm", 5.0, False),
    ("end_pushed_deg", "The same, orientation", "deg", 3.0, False),
    ("end_moved_mm", "End where the docks have moved, worst", "mm", 5.0, False),
    ("end_moved_deg", "The same, orientation", "deg", 3.0, False),
    ("end_far_mm", "End twice as far from what was taught, worst", "mm", 5.0, False),
    ("end_far_deg", "The same, orientation", "deg", 3.0, False),
    ("path_rms_mm", "Path from the teacher's own, rms, worst trial", "mm", 30.0, False),
    ("path_pushed_rms_mm", "The same, while pushed with 10 N", "mm", None, False),
    ("saturated_steps", "Time steps with a saturated motor", "", None, False),
    ("unreachable", "Trials that ended out of reach", "", None, False),
    ("diverged", "Diverged trials", "", 0, False),
    ("contacts", "Trials in which something touched", "", 0, False),
    ("realtime_factor", "Faster than real time, one core", "x", 8.0, True),
)


class TransferStudy(Study):
    """Unseen docks, as near to each other as taught and twice as far; moved; pushed."""

    title = "Transfer between two docks"
    words = _WORDS
    lead = (
        "The weightless arm was led to carry a cube out of one dock into another. How to leave "
        "the first and enter the second was found in the demonstrations alone: it is what each "
        "dock saw consistently. The arm then carries between docks where they never were, twice "
        "as far from the taught places as these from each other, and while the docks move."
    )
    sections = staticmethod(sections)
    clips = staticmethod(clips)

    def phases(self, simulation, models, seed, situations, pushes) -> Phases:
        """Every situation beside the teacher's own way, moved and pushed; and others, far away."""
        conditions = []
        for index in range(situations):
            near = self.task.situation(simulation, seed, index)
            far = self.task.situation(simulation, seed, index, far=True)
            rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(3, index)))
            conditions += [
                Condition("unpushed", near),
                Condition("unpushed", near, "teacher"),
                Condition("moved", _moved(near, docks.draw(rng))),
                Condition("far", far),
            ]
            for k in range(pushes):
                label, situation = ("far pushed", far) if k % 2 else ("pushed", near)
                conditions.append(Condition(label, situation, push=_push(rng)))
        yield conditions

    def figures(self, records: Records, models) -> dict:
        """Errors at the end and along the path; the worst of all trials that there are."""
        figures = {}
        for name, labels in _ENDS.items():
            ends = [end(t) for label in labels for t in select(records, label)]
            if ends:
                figures[f"{name}_mm"], figures[f"{name}_deg"] = np.max(ends, axis=0).tolist()
        teacher = {c.situation.index: t for c, t in records if c.controller == "teacher"}
        for name, label in (("path_rms_mm", "unpushed"), ("path_pushed_rms_mm", "pushed")):
            paths = [
                path_rms(trial, teacher[condition.situation.index])
                for condition, trial in records
                if condition.label == label
                and condition.controller == "learned"
                and condition.situation.index in teacher
            ]
            if paths:
                figures[name] = max(paths)
        trials = [t for c, t in records if c.controller == "learned"]
        missed = sum(t.outcome == "unreachable" for t in trials)
        return figures | health(trials) | {"unreachable": missed}


def _moved(situation: Situation, elsewhere: docks.Docks) -> Situation:
    """The situation with both docks on their way to another one while the arm carries."""
    paths = [ObjectPath(**path) for path in situation.details["objects"]]
    moving = [
        asdict(
            ObjectPath(
                path.name,
                (path.positions[0], tuple(elsewhere[path.name][1].tolist())),
                MOVED,
                (
                    path.quaternions[0],
                    tuple(rotation.to_quaternion(elsewhere[path.name][0]).tolist()),
                ),
            )
        )
        for path in paths
    ]
    return replace(situation, details=situation.details | {"objects": moving})


def _push(rng) -> Push:
    force = rng.standard_normal(3)
    force *= PUSH / np.linalg.norm(force)
    return Push(docks.GRIPPER, tuple(force.tolist()), start=float(rng.uniform(*PUSHED)))


_ENDS = {
    "end": ("unpushed", "pushed"),
    "end_pushed": ("pushed",),
    "end_moved": ("moved",),
    "end_far": ("far", "far pushed"),
}
"""Which trials count for which figure."""


def study(task) -> TransferStudy:
    """The study of ``transfer``."""
    return TransferStudy(task)
