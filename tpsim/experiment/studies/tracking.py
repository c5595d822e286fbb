"""The study of tracking: unseen paths of two objects, each followed as each teaching has it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tpsim.experiment import plot
from tpsim.experiment.conditions import Condition
from tpsim.experiment.report import Picture, Section
from tpsim.experiment.studies.study import Phases, Records, Study, health, unreachable_samples
from tpsim.sim.push import Push
from tpsim.sim.trial import Trial
from tpsim.sim.video import Clip
from tpsim.tasks.leaning import Body
from tpsim.tasks.tracking import SECONDS, SIDES, VIAS, teaching

PUSH = 10.0
"""Force [N] on one of the hands, for two seconds."""

EARLIER = (0.5, 1.5)
"""How long before the objects are at a via a push begins, drawn from this range [s]."""

CAPTIONS = {
    "left": "the left hand has priority",
    "right": "the right hand has priority",
    "compromise": "both hands stay away alike",
}
"""What each teaching shows."""


def distance(trial: Trial, side: str) -> np.ndarray:
    """Distance (T,) [m] of a hand from its object."""
    way = trial[f"{side}_position"] - trial[f"{side}_object_position"]
    return np.linalg.norm(way[:, :2], axis=1)


@dataclass(frozen=True)
class Outcome:
    """How one trial followed both objects, hand by hand.

    Parameters
    ----------
    together : dict of str to float
        Distance [m] to the object while both are in reach, rms.
    apart : dict of str to float
        The same while they are not.
    ratio : dict of str to float
        Mean distance while they are not, over the one that the teaching asks for; NaN where it
        asks for none.
    """

    together: Mapping[str, float]
    apart: Mapping[str, float]
    ratio: Mapping[str, float]

    @classmethod
    def of(cls, trial: Trial, body: Body, rule: str) -> "Outcome":
        """Compare a trial with what the body can reach at most, as a teaching has it."""
        points = {side: trial[f"{side}_object_position"][:, :2] for side in SIDES}
        angle, apart = body.lean(points["left"], points["right"], rule)
        reached = {side: distance(trial, side) for side in SIDES}
        least = {side: body.missing(angle, points[side])[apart].sum() for side in SIDES}
        return cls(
            {side: _rms(away[~apart]) for side, away in reached.items()},
            {side: _rms(away[apart]) for side, away in reached.items()},
            {
                side: float(away[apart].sum() / least[side]) if least[side] > 1e-6 else np.nan
                for side, away in reached.items()
            },
        )


def _rms(values):
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0


_WORDS = (
    ("rms_mm", "Both objects in reach: distance of a hand, rms, worst", "mm", 10.0, False),
    ("rms_pushed_mm", "Both in reach, pushed with 10 N", "mm", 10.0, False),
    ("priority_rms_mm", "Not both: distance of the first hand, rms, worst", "mm", 15.0, False),
    ("priority_rms_pushed_mm", "The first hand, pushed with 10 N", "mm", 15.0, False),
    ("other_distance_ratio", "The other hand, over the least possible, worst", "", 1.1, False),
    ("other_distance_ratio_pushed", "The other hand, pushed with 10 N", "", 1.1, False),
    ("compromise_ratio", "A compromise: off the taught split, worst", "", 0.15, False),
    ("compromise_ratio_pushed", "A compromise, pushed with 10 N", "", 0.15, False),
    ("saturated_steps", "Time steps with a saturated motor", "", None, False),
    ("unreachable_samples", "Samples that asked for a posture beyond limits", "", None, False),
    ("diverged", "Diverged trials", "", 0, False),
    ("contacts", "Trials in which something touched", "", 0, False),
    ("realtime_factor", "Faster than real time, one core", "x", 25.0, True),
)


class TrackingStudy(Study):
    """Unseen paths of both objects, followed as each of the three teachings has it; pushes."""

    title = "Tracking two objects with priorities"
    words = _WORDS
    lead = (
        "Two hands that share a trunk were led after two moving objects, which at times could not "
        "both be reached. The teacher then gave priority to the left hand, to the right hand, or "
        "to neither. Who gives way was found in the demonstrations alone: it is how precise they "
        "are in four candidate frames, each hand seen from its object, and each in the nullspace "
        "of the other."
    )

    def __init__(self, task):
        super().__init__(task)
        self._body = Body.of(task.simulation())

    def phases(self, simulation, models, seed, situations, pushes) -> Phases:
        """Every situation by every teaching; the pushes go round the teachings."""
        conditions, behaviours = [], self.task.behaviours
        for index in range(situations):
            situation = self.task.situation(simulation, seed, index)
            rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(4, index)))
            conditions += [Condition("unpushed", situation, name) for name in behaviours]
            for k in range(pushes):
                name, turn = behaviours[k % len(behaviours)], k // len(behaviours)
                # In turn when the objects are farthest from each other, and when they are not.
                via = 1 + (2 * rng.integers(VIAS // 2) if turn % 2 == 0 else 1)
                push = _push(rng, int(via))
                conditions.append(Condition("pushed", situation, name, push=push))
        yield conditions

    def _behaviour(self, condition) -> str:
        names = self.task.behaviours
        return condition.controller if condition.controller in names else names[0]

    def figures(self, records: Records, models) -> dict:
        """Distances of the hands; the worst of all trials that there are."""
        figures = {}
        for label, suffix in (("unpushed", ""), ("pushed", "_pushed")):
            found = [
                (teaching(name), Outcome.of(trial, self._body, teaching(name)))
                for name in self.task.behaviours
                for trial in self._select(records, label, name)
            ]
            figures |= _worst(found, suffix)
        trials = [trial for _, trial in records]
        return figures | health(trials) | {"unreachable_samples": unreachable_samples(trials)}

    def sections(self, records: Records, models) -> list[Section]:
        """Distance of each hand from its object over time, teaching by teaching."""
        sections = []
        for label, words in (("unpushed", ""), ("pushed", ", pushed")):
            groups = {
                CAPTIONS[teaching(name)]: trials
                for name in self.task.behaviours
                if (trials := self._select(records, label, name))
            }
            for side in SIDES if groups else ():

                def away(trial, side=side):
                    return 1e3 * distance(trial, side)

                figure = plot.panels(groups, away, label="distance [mm]")
                title = f"Distance of the {side} hand from its object{words}"
                sections.append(Section(title, _DISTANCE, [Picture(figure)]))
        return sections

    def _select(self, records, label, name) -> list[Trial]:
        return [t for c, t in records if c.label == label and self._behaviour(c) == name]

    def clips(
        self, simulation, models, records, demonstrations: Mapping[str, Sequence[Trial]]
    ) -> list[Clip]:
        """A demonstration and a reproduction of every teaching, and a push."""
        scene, shown = simulation.xml, []
        objects = [f"{side}_object" for side in SIDES]
        for name in self.task.behaviours:
            caption = CAPTIONS[teaching(name)]
            if trials := demonstrations.get(name):
                shown.append(
                    Clip.of(scene, trials[0], "Demonstration", caption, objects, speed=3.0)
                )
            if trials := self._select(records, "unpushed", name):
                shown.append(
                    Clip.of(scene, trials[-1], "Reproduction", caption, objects, speed=2.0)
                )
        if trials := self._select(records, "pushed", self.task.behaviours[-1]):
            words = "a person pushes with 10 N"
            shown.append(Clip.of(scene, trials[-1], "Reproduction", words, objects, speed=1.0))
        return shown


def _push(rng, via) -> Push:
    """Somewhere in the plane on one of the hands, about the time of a via."""
    bearing = rng.uniform(0, 2 * np.pi)
    force = (PUSH * np.cos(bearing), PUSH * np.sin(bearing), 0.0)
    start = via * SECONDS / (VIAS - 1) - rng.uniform(*EARLIER)
    return Push(f"{SIDES[rng.integers(2)]}_hand", force, start=start)


def _worst(outcomes: Sequence[tuple[str, Outcome]], suffix: str) -> dict:
    """Figures of teachings and trials: the worst of each kind, in mm and as ratios."""
    together = [1e3 * away for _, o in outcomes for away in o.together.values()]
    decided = [(o, rule) for rule, o in outcomes if rule in SIDES]
    first = [1e3 * o.apart[side] for o, side in decided]
    other = [o.ratio[SIDES[1 - SIDES.index(side)]] for o, side in decided]
    split = [abs(r - 1) for rule, o in outcomes if rule not in SIDES for r in o.ratio.values()]
    figures = {
        "rms_mm": together,
        "priority_rms_mm": first,
        "other_distance_ratio": [ratio for ratio in other if np.isfinite(ratio)],
        "compromise_ratio": [ratio for ratio in split if np.isfinite(ratio)],
    }
    return {
        name.replace("_mm", f"{suffix}_mm") if "_mm" in name else name + suffix: max(values)
        for name, values in figures.items()
        if values
    }


_DISTANCE = (
    "Thin lines are trials, the thick one is their median. The objects are together at the start, "
    "in the middle and at the end, and too far apart for both hands between."
)


def study(task) -> TrackingStudy:
    """The study of ``tracking``, or of one of its behaviours."""
    return TrackingStudy(task)
