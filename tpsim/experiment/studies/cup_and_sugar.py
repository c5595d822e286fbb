"""The study of cup and sugar: pushes, a pushed elbow, a led hand, beside fixed gains."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tpsim import tasks
from tpsim.experiment.conditions import Condition, Lead
from tpsim.experiment.identify import identify_stiffness
from tpsim.experiment.metrics import displacement, mean_force, rms
from tpsim.experiment.studies.cup_and_sugar_measures import (
    DIRECTIONS,
    ELBOW_PUSH,
    PUSH,
    TRAVEL,
    offset,
    taught_place,
    tilt,
)
from tpsim.experiment.studies.cup_and_sugar_pictures import clips, sections
from tpsim.experiment.studies.study import Phases, Records, Study, health, select
from tpsim.sim.push import Push
from tpsim.sim.trial import Trial
from tpsim.tasks.task import Situation

CONTROLLERS = ("learned", "stiff", "soft")


_WORDS = (
    ("tilt_max_deg", "Cup tilt, largest", "deg", 5.0, False),
    ("tilt_rms_deg", "Cup tilt, rms", "deg", 2.5, False),
    ("offset_max_mm", "Sugar from its taught place, largest", "mm", 15.0, False),
    ("offset_rms_mm", "Sugar from its taught place, rms", "mm", 8.0, False),
    ("displacement_mean_mm", "Pushed hand yields, mean of peaks", "mm", 40.0, True),
    ("stiff_displacement_mean_mm", "The same under stiff fixed gains", "mm", None, False),
    ("soft_displacement_mean_mm", "The same under soft fixed gains", "mm", None, False),
    ("stiff_offset_max_mm", "Sugar offset under stiff fixed gains, largest", "mm", None, False),
    ("soft_offset_max_mm", "Sugar offset under soft fixed gains, largest", "mm", None, False),
    ("force_ratio", "Force for the same displacement, stiff over learned", "x", 3.0, True),
    ("elbow_displacement_min_mm", "Pushed elbow moves, least", "mm", 20.0, True),
    ("elbow_offset_max_mm", "Sugar offset while the elbow is pushed", "mm", 5.0, False),
    ("lead_offset_max_mm", "Sugar offset while the left hand is led 15 cm", "mm", 20.0, False),
    ("lead_force_mean_N", "Force that the leading person feels, mean", "N", 15.0, False),
    ("stiffness_error_percent", "Stiffness felt against commanded, error", "%", 3.0, False),
    ("saturated_percent", "Time steps with a saturated motor", "%", 1.0, False),
    ("diverged", "Diverged trials", "", 0, False),
    ("contacts", "Trials in which something touched", "", 0, False),
    ("realtime_factor", "Faster than real time, one core", "x", 8.0, True),
)


class CupAndSugarStudy(Study):
    """Ten unseen situations, six pushes each, every push beside its unpushed twin."""

    title = "Cup and sugar"
    words = _WORDS
    lead = (
        "Two behaviours were taught apart by leading the weightless arms: hold the cup level, "
        "and keep the sugar above it. The robot performs both at once where it was never shown, "
        "stiff where the teacher was precise and soft where the teacher did not care."
    )
    sections = staticmethod(sections)

    def phases(self, simulation, models, seed, situations, pushes) -> Phases:
        """Unpushed first; where each then rests, the fixed gains to compare with begin."""
        drawn = [self.task.situation(simulation, seed, i) for i in range(situations)]
        twins = yield [Condition("unpushed", situation) for situation in drawn]
        conditions = []
        for situation, twin in zip(drawn, twins, strict=True):
            rest = replace(situation, start=tuple(twin["q"][-1].tolist()))
            conditions += self._pushed(situation, rest, pushes)
            if "sugar" in self.task.behaviours:
                conditions += self._elbow(situation)
                conditions.append(self._led(situation, twin, seed))
        yield conditions

    def _pushed(self, situation: Situation, rest: Situation, pushes):
        for k in range(pushes):
            push = Push("left_gripper", tuple((PUSH * DIRECTIONS[k % 6]).tolist()))
            for controller in CONTROLLERS:
                start = situation if controller == "learned" else rest
                yield Condition("pushed", start, controller, push)

    def _elbow(self, situation: Situation):
        """Two pushes across the arm, the way in which the elbow is free to swivel."""
        for sign in (1.0, -1.0):
            force = (0.0, sign * ELBOW_PUSH, 0.0)
            yield Condition("elbow", situation, push=Push("right_elbow", force))

    def _led(self, situation: Situation, twin: Trial, seed):
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(2, situation.index)))
        heading = rng.uniform(0, 2 * np.pi)
        travel = TRAVEL * np.array([np.cos(heading), np.sin(heading), 0.0])
        origin = twin["left_hand_position"][-1]
        lead = Lead("left_gripper", tuple(origin.tolist()), tuple(travel.tolist()))
        return Condition("led", situation, lead=lead)

    def figures(self, records: Records, models) -> dict:
        """Tilt, offset, yielding and comparison; of those trials that there are."""
        trials = [t for c, t in records if c.controller == "learned"]
        pushed = select(records, "pushed") or select(records, "unpushed") or trials
        figures = {}
        if "cup" in self.task.behaviours:
            tilts = np.concatenate([tilt(t) for t in pushed])
            figures |= {"tilt_max_deg": tilts.max(), "tilt_rms_deg": rms(tilts)}
        if "sugar" in self.task.behaviours:
            place = taught_place(models)
            offsets = np.concatenate([offset(t, place) for t in pushed])
            figures |= {"offset_max_mm": offsets.max(), "offset_rms_mm": rms(offsets)}
        figures |= self._yielding(records, models)
        steps = sum(round(t["time"][-1] * 1000) for t in trials)
        figures |= health(trials)
        figures["saturated_percent"] = 100 * figures["saturated_steps"] / steps
        return {k: v if isinstance(v, int) else float(v) for k, v in figures.items()}

    def _yielding(self, records, models):
        twins = {c.situation.index: t for c, t in records if c.label == "unpushed"}
        moved, led, figures = {}, [], {}
        for condition, trial in records:
            if condition.label not in ("pushed", "elbow") or not twins:
                continue
            point = "right_elbow" if condition.label == "elbow" else "left_hand"
            twin = twins[condition.situation.index]
            if condition.controller != "learned":
                # A fixed gain starts where it stays: its own first pose is its twin.
                twin = Trial({n: np.repeat(a[:1], len(a), 0) for n, a in trial.arrays.items()})
                twin.arrays["time"][:] = trial["time"]
            way = 1e3 * displacement(trial, twin, f"{point}_position").max()
            moved.setdefault((condition.label, condition.controller), []).append(way)
        for controller in CONTROLLERS:
            if ("pushed", controller) in moved:
                name = "displacement" if controller == "learned" else f"{controller}_displacement"
                figures[f"{name}_mean_mm"] = np.mean(moved["pushed", controller])
        if ("pushed", "stiff") in moved:
            stiff = figures["stiff_displacement_mean_mm"]
            figures["force_ratio"] = figures["displacement_mean_mm"] / stiff
        if "sugar" not in self.task.behaviours:
            return figures
        place = taught_place(models)
        for controller in CONTROLLERS[1:]:
            if found := select(records, "pushed", controller):
                worst = max(offset(t, place).max() for t in found)
                figures[f"{controller}_offset_max_mm"] = worst
        if ("elbow", "learned") in moved:
            pushed = select(records, "elbow")
            figures["elbow_displacement_min_mm"] = min(moved["elbow", "learned"])
            figures["elbow_offset_max_mm"] = max(_while_pushed(t, place) for t in pushed)
        if led := select(records, "led"):
            figures["lead_offset_max_mm"] = max(offset(t, place).max() for t in led)
            figures["lead_force_mean_N"] = np.mean([mean_force(t["lead_wrench"]) for t in led])
        return figures

    def probe(self, simulation, models) -> dict:
        """Physical stiffness of both hands beside the commanded one, largest error [%]."""
        errors = []
        arms = ("left", "right") if len(self.task.behaviours) == 2 else ("left",)
        for arm in arms:
            controller = self.task.controller(simulation, models, simulation.home, "learned")
            measured, commanded = identify_stiffness(
                simulation, controller, simulation.home, f"{arm}_gripper"
            )
            errors.append(np.linalg.norm(measured - commanded) / np.linalg.norm(commanded))
        return {"stiffness_error_percent": float(100 * max(errors))}

    def clips(self, simulation, models, records, demonstrations: Mapping[str, Sequence[Trial]]):
        """The four sequences of Fig. 9."""
        return clips(simulation, models, demonstrations, self.task, tasks)


def _while_pushed(trial, place):
    """Largest offset [mm] from the push on: what comes before is the way from the start."""
    return offset(trial, place)[trial["time"] >= 2.0].max()


def study(task) -> CupAndSugarStudy:
    """The study of ``cup``, ``sugar`` or ``cup-and-sugar``."""
    return CupAndSugarStudy(task)
