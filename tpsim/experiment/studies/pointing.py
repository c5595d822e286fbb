"""The study of pointing: objects at rest, moving and jumping, with and without pushes."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace

import numpy as np

from tpsim import rotation
from tpsim.experiment import plot
from tpsim.experiment.conditions import Condition
from tpsim.experiment.report import Picture, Section
from tpsim.experiment.studies.study import (
    Phases,
    Records,
    Study,
    health,
    select,
    unreachable_samples,
)
from tpsim.sim.objects import ObjectPath
from tpsim.sim.push import Push
from tpsim.sim.trial import Trial
from tpsim.sim.video import Clip
from tpsim.tasks.pointers import OBJECTS, Pointer
from tpsim.tasks.pointing import APPROACH, HURRY, PHASES
from tpsim.tasks.task import Situation

PUSH = 10.0
"""Force [N] on what points, for two seconds."""

SPEED, JUMP = 0.1, 0.15
"""How fast an object moves [m/s] while the arm turns and points to it, and how far it jumps [m]."""

RECOVERED = 3.0
"""Angle [deg] under which a jump counts as made good."""

_LABELS = {
    "unpushed": "objects at rest",
    "pushed": "pushed",
    "moving": "moving",
    "moving pushed": "moving, pushed",
    "jump": "jumping",
}


def angle(trial: Trial, pointer: Pointer, name: str) -> np.ndarray:
    """Angle (T,) [deg] between the axis that points and the way to an object."""
    tip = next(name for name, site in pointer.sites.items() if site == pointer.site)
    R = rotation.from_quaternion(trial[f"{tip}_quaternion"])
    way = trial[f"{name}_position"] - trial[f"{tip}_position"]
    seen = np.einsum("tji,tj->ti", R, way)[:, list(pointer.axes)]
    return np.degrees(np.arctan2(np.linalg.norm(seen[:, 1:], axis=1), seen[:, 0]))


def phase_angle(trial: Trial, pointer: Pointer, name: str) -> float:
    """Angle [deg] to an object, mean of the last third of the phase in which it is pointed at."""
    start, end = PHASES[name]
    time = trial["time"]
    last = (time >= end - (end - start) / 3) & (time < end)
    return float(angle(trial, pointer, name)[last].mean()) if last.any() else np.inf


def recovery(trial: Trial, pointer: Pointer, name: str, jump: float) -> float:
    """Time [s] from a jump of an object until the angle stays small.

    It must stay so as long as nothing in the teacher's timing says to leave.
    """
    time = trial["time"]
    after = (time >= jump) & (time < PHASES[name][1] - 3 * HURRY)
    wide = np.flatnonzero(angle(trial, pointer, name)[after] > RECOVERED)
    if wide.size == 0:
        return 0.0
    clock = time[after] - jump
    return float(clock[wide[-1] + 1]) if wide[-1] + 1 < len(clock) else np.inf


_WORDS = (
    ("angle_deg", "Angle error, objects at rest or moving, worst phase", "deg", 1.5, False),
    ("angle_moving_deg", "The same, moving objects only", "deg", 1.5, False),
    ("angle_pushed_deg", "Angle error pushed with 10 N, worst phase", "deg", 4.0, False),
    ("angle_moving_pushed_deg", "The same, moving objects only", "deg", 4.0, False),
    ("posture_rad", "Final posture from the taught one, farthest joint", "rad", 0.1, False),
    ("jump_recovery_s", "Time to make good a jump of an object, longest", "s", 0.5, False),
    ("saturated_steps", "Time steps with a saturated motor", "", None, False),
    ("unreachable_samples", "Samples that asked for a posture beyond limits", "", None, False),
    ("diverged", "Diverged trials", "", 0, False),
    ("contacts", "Trials in which something touched", "", 0, False),
)


def _speed(task):
    """The speed asked of a small arm, and of one with fourteen joints."""
    least = 25.0 if len(task.rest) < 7 else 8.0
    return "realtime_factor", "Faster than real time, one core", "x", least, True


class PointingStudy(Study):
    """Unseen objects: at rest, moving, jumping; pushes in both phases."""

    title = "Pointing at two objects"
    lead = (
        "The weightless arm was led to point at one object, at another, and back to rest. What "
        "must be precise when, and in which frame, the posture, the robot or an object, was "
        "found in the demonstrations alone. The arm then points where it was never shown, at "
        "objects that move while it does, and gives way to pushes that do not spoil the pointing."
    )

    @property
    def words(self):
        """What the report says of each figure."""
        return *_WORDS, _speed(self.task)

    def phases(self, simulation, models, seed, situations, pushes) -> Phases:
        """Every situation at rest, moving and jumping; the same pushes at rest and moving."""
        conditions = []
        for index in range(situations):
            situation = self.task.situation(simulation, seed, index)
            rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(2, index)))
            moving = _moved(situation, rng, self._heading, _passing)
            jumping = _moved(situation, rng, self._heading, _jumping)
            conditions += [
                Condition("unpushed", situation),
                Condition("moving", moving),
                Condition("jump", jumping),
            ]
            for k in range(pushes):
                push = self._push(rng, PHASES[OBJECTS[k % 2]][0])
                conditions.append(Condition("pushed", situation, push=push))
                conditions.append(Condition("moving pushed", moving, push=push))
        yield conditions

    def _heading(self, rng, dims=2):
        """A direction (3,): in the plane on which the objects lie, or any."""
        heading = np.append(rng.standard_normal(dims), np.zeros(3 - dims))
        return heading / np.linalg.norm(heading)

    def _push(self, rng, start):
        pointer = self.task.pointer
        force = PUSH * self._heading(rng, len(pointer.axes))
        return Push(pointer.site, tuple(force.tolist()), start=start)

    def figures(self, records: Records, models) -> dict:
        """Angles, final posture, recovery from jumps; the worst of all trials that there are."""
        angles = {label: self._angles(select(records, label)) for label in _LABELS}
        trials = [trial for _, trial in records]
        figures = {}
        for name, labels in (
            ("angle_deg", ("unpushed", "moving")),
            ("angle_moving_deg", ("moving",)),
            ("angle_pushed_deg", ("pushed", "moving pushed")),
            ("angle_moving_pushed_deg", ("moving pushed",)),
        ):
            if found := [a for label in labels for a in angles[label]]:
                figures[name] = max(found)
                figures[name.replace("_deg", "_median_deg")] = float(np.median(found))
        if whole := [t for t in trials if t["time"][-1] > self.task.duration - 0.1]:
            figures["posture_rad"] = max(self._posture(t) for t in whole)
        if jumps := [self._recovery(c, t) for c, t in records if c.label == "jump"]:
            figures["jump_recovery_s"] = max(jumps)
        return figures | health(trials) | {"unreachable_samples": unreachable_samples(trials)}

    def _angles(self, trials):
        return [phase_angle(t, self.task.pointer, name) for t in trials for name in OBJECTS]

    def _posture(self, trial):
        """Farthest joint [rad] from the rest posture that was taught, at the end."""
        return float(np.abs(trial["q"][-1] - self.task.rest).max())

    def _recovery(self, condition, trial):
        paths = [ObjectPath(**path) for path in condition.situation.details["objects"]]
        pointer = self.task.pointer
        return max(recovery(trial, pointer, path.name, path.times[-1]) for path in paths)

    def sections(self, records: Records, models) -> list[Section]:
        """Angles to both objects over time, and the learned precision of the frames."""
        sections = []
        for name in OBJECTS:
            groups = {text: select(records, label) for label, text in _LABELS.items()}
            groups = {text: trials for text, trials in groups.items() if trials}
            if not groups:
                continue

            def to(trial, name=name):
                return angle(trial, self.task.pointer, name)

            start, end = PHASES[name]
            text = (
                f"Angle between the arm's axis and the way to the {name} object, which is to be "
                f"pointed at from {start:g} s to {end:g} s. Thin lines are trials, the thick one "
                "is their median."
            )
            figure = plot.panels(groups, to, label="angle [deg]", limit=RECOVERED)
            sections.append(Section(f"Pointing at the {name} object", text, [Picture(figure)]))
        sections += [self._frames(models[name]) for name in models]
        return sections

    def _frames(self, model):
        names = ("posture", "direction in base", *(f"direction to {name}" for name in OBJECTS))
        rows = [
            {"component": k + 1, "time [s]": model.frames[0].mean[k, 0]}
            | {
                f"{name} [deg]": float(np.degrees(_spread(gaussian, k)))
                for name, gaussian in zip(names, model.frames, strict=True)
            }
            for k in range(model.components)
        ]
        text = (
            "Standard deviation that remains in every frame once the time is known: small where "
            "the teacher was precise. The arm is stiff there and soft elsewhere."
        )
        return Section("What the demonstrations say", text, table=rows)

    def clips(
        self, simulation, models, records, demonstrations: Mapping[str, Sequence[Trial]]
    ) -> list[Clip]:
        """A demonstration, moving objects, a jump, and a push in each phase."""
        scene, shown = simulation.xml, []
        for trials in demonstrations.values():
            if trials:
                shown.append(
                    self._clip(scene, trials[0], "Demonstration", "the arm is led by hand", 2.0)
                )
        for label, subtitle in (
            ("moving", "the objects move while the arm points"),
            ("jump", "each object jumps while it is pointed at"),
            ("moving pushed", "the objects move, and a person pushes with 10 N"),
        ):
            if found := select(records, label):
                shown.append(self._clip(scene, found[-1], "Reproduction", subtitle, 1.0))
        return shown

    def _clip(self, scene, trial, title, subtitle, speed) -> Clip:
        camera = self.task.pointer.camera
        return Clip.of(scene, trial, title, subtitle, OBJECTS, camera=camera, speed=speed)


def _moved(situation: Situation, rng, heading, move) -> Situation:
    """The situation with every object moving as ``move`` says, some way."""
    placed = (ObjectPath(**path) for path in situation.details["objects"])
    paths = [asdict(move(path, heading(rng))) for path in placed]
    return replace(situation, details=situation.details | {"objects": paths})


def _passing(path: ObjectPath, heading) -> ObjectPath:
    """Past its place at even speed, while the arm turns to it and points."""
    place, (start, end) = np.array(path.positions[0]), PHASES[path.name]
    start -= APPROACH
    way = SPEED * (end - start) / 2 * heading
    return ObjectPath(path.name, (place - way, place + way), (start, end))


def _jumping(path: ObjectPath, heading) -> ObjectPath:
    """Elsewhere all at once, in the middle of its phase."""
    place, moment = np.array(path.positions[0]), float(np.mean(PHASES[path.name]))
    return ObjectPath(path.name, (place, place, place + JUMP * heading), (0.0, moment, moment))


def _spread(gaussian, k):
    """Root mean square deviation of a component's coordinates when the time is known."""
    rest = gaussian[k].condition([gaussian.mean[k, 0]], [0]).covariance
    return np.sqrt(np.trace(rest) / len(rest))


def study(task) -> PointingStudy:
    """The study of ``pointing`` or ``pointing-baxter``."""
    return PointingStudy(task)
