"""What a person showed in the playground, and what is learned from it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from tpsim.errors import ArgumentError, SimulationError
from tpsim.learning.tp_gmm import TPGMM
from tpsim.play.recording import Recorded
from tpsim.play.seen import Seen, look
from tpsim.study.study import Study
from tpsim.study.workers import Death, Workers
from tpsim.task.acceptance import refusal
from tpsim.task.task import Models, Task
from tpsim.task.verbs import Taught, learn
from tpsim.world.teaching import fault
from tpsim.world.trial import Trial
from tpsim.world.world import World

SHORTEST = 0.5
"""Time [s] below which a demonstration shows nothing."""

FEWEST = 2
"""Demonstrations from which something can be learned: what they share, and in what they differ."""


@dataclass(frozen=True)
class Learned:
    """What was learned, and from what.

    Parameters
    ----------
    models : mapping of str to TPGMM
    counts : mapping of str to int
        Demonstrations of each behaviour.
    by_hand : tuple of str
        Behaviours of which they were shown here.
    seen : mapping of str to sequence of Demonstration
        What every frame saw of them.
    """

    models: Models
    counts: Mapping[str, int]
    by_hand: tuple[str, ...]
    seen: Seen

    @property
    def log_likelihood(self) -> dict[str, float]:
        """Mean log-likelihood of a sample, of every behaviour that was fitted by EM."""
        found = {name: model.history for name, model in self.models.items()}
        return {name: float(history[-1]) for name, history in found.items() if len(history)}


class Lessons:
    """Demonstrations by behaviour: those shown here count before those that were given.

    All is computed in a world of its own, beside the one that is simulated meanwhile.

    Parameters
    ----------
    study : Study
    given : mapping of str to sequence of Trial, optional
        Demonstrations that were recorded before.
    apart : bool
        Whether learning has a process of its own, which leaves this one to the simulation.

    Attributes
    ----------
    shown : dict of str to list of Recorded
        What was shown here and kept.
    """

    def __init__(self, study: Study, given: Taught | None = None, *, apart: bool = False):
        world = study.task.stage
        self._world = World(world.xml, world.description, dict(world.assets))
        self._workers: Workers[Work, tuple[Models, Seen]] = Workers(
            1, _learner, self._world, apart=apart
        )
        self._workers.__enter__()
        self._given: Taught = given or {}
        self.shown: dict[str, list[Recorded]] = {name: [] for name in study.task.behaviours()}

    def close(self) -> None:
        """End the process that learns."""
        self._workers.__exit__(KeyboardInterrupt, None, None)

    def judge(self, task: Task, recorded: Recorded) -> Recorded:
        """The same, saying what speaks against learning from it.

        Raises
        ------
        ArgumentError
            If it is so short that it shows nothing.
        """
        trial = recorded.trial
        seconds = recorded.condition.duration or 0.0
        if seconds < SHORTEST:
            raise ArgumentError(
                f"that took {seconds:.1f} s and shows nothing: hold on for {SHORTEST:g} s at least"
            )
        task, lesson = task.in_world(self._world), recorded.condition.lesson
        robot = task.stage.robot
        found = fault(robot, trial, lesson)
        if found is None:
            goals = task.behaviours()[recorded.behaviour].goals
            found = refusal(robot, trial, goals)
        return replace(recorded, fault="" if found is None else found.words)

    def keep(self, recorded: Recorded) -> int:
        """Keep a demonstration; how many there are of its behaviour now."""
        kept = self.shown[recorded.behaviour]
        kept.append(recorded)
        return len(kept)

    def throw_away(self, behaviour: str) -> None:
        """Throw the last one of a behaviour away."""
        if not self.shown[behaviour]:
            raise ArgumentError(f"there is no demonstration of '{behaviour}' to throw away")
        self.shown[behaviour].pop()

    def of(self, behaviour: str) -> Sequence[Trial]:
        """Demonstrations to learn a behaviour from."""
        by_hand = [recorded.trial for recorded in self.shown[behaviour]]
        return by_hand or list(self._given.get(behaviour, ()))

    @property
    def missing(self) -> dict[str, int]:
        """How many more demonstrations are needed, of every behaviour that lacks some."""
        lacking = {name: FEWEST - len(self.of(name)) for name in self.shown}
        return {name: count for name, count in lacking.items() if count > 0}

    def learn(self, task: Task, without: Mapping[str, Sequence[str]] | None = None) -> Learned:
        """Learn all behaviours.

        Parameters
        ----------
        task : Task
            Its fields say how, such as with how many components.
        without : mapping of str to sequence of str, optional
            Frames of each behaviour that shall not matter.

        Raises
        ------
        ArgumentError
            If there are too few demonstrations, or no frame is left.
        """
        for name, count in self.missing.items():
            raise ArgumentError(
                f"'{name}' was shown {FEWEST - count} times; show it {FEWEST} times at least: "
                "what differs between them is what does not matter"
            )
        taught = {name: self.of(name) for name in task.behaviours()}
        models, seen = self._done(Work(task, taught, without or {}))
        return Learned(
            models,
            {name: len(trials) for name, trials in taught.items()},
            tuple(name for name, shown in self.shown.items() if shown),
            seen,
        )

    def look(self, task: Task) -> Seen:
        """What every frame saw of what was shown here."""
        shown = {name: [each.trial for each in found] for name, found in self.shown.items()}
        return self._done(Work(task, {name: t for name, t in shown.items() if t}))[1]

    def _done(self, work: "Work") -> tuple[Models, Seen]:
        (done,) = self._workers.map([work])
        if isinstance(done, Death):
            raise SimulationError(f"nothing was learned: {done}")
        return done


@dataclass(frozen=True)
class Work:
    """Demonstrations to look at, and to learn from.

    Parameters
    ----------
    task : Task
    taught : mapping of str to sequence of Trial
    without : mapping of str to sequence of str, optional
        Frames that shall not matter; None to look only.
    """

    task: Task
    taught: Taught
    without: Mapping[str, Sequence[str]] | None = None


def _learner(world: World) -> Callable[[Work], tuple[Models, Seen]]:
    return partial(_learn, world)


def _learn(world: World, work: Work) -> tuple[Models, Seen]:
    task, models = work.task.in_world(world), {}
    if work.without is not None:
        models = learn(task, work.taught)
        for name, frames in work.without.items():
            models[name] = _without(models[name], list(task.behaviours()[name].views), frames)
    return models, look(task, work.taught)


def _without(model: TPGMM, views: list[str], frames: Sequence[str]) -> TPGMM:
    """The model with frames that do not matter: they bring no precision to control."""
    if not frames:
        return model
    if len(set(frames)) >= len(views):
        raise ArgumentError("every frame is off; leave one on at least")
    off = [view in frames for view in views]
    if model.relevance:
        parts = (
            replace(part, precision=np.zeros_like(part.precision)) if gone else part
            for part, gone in zip(model.relevance, off, strict=True)
        )
        return replace(model, relevance=tuple(parts))
    wide = (
        replace(frame, covariance=frame.covariance * FLAT) if gone else frame
        for frame, gone in zip(model.frames, off, strict=True)
    )
    return replace(model, frames=tuple(wide))


FLAT = 1e6
"""Factor on the covariance of a frame that shall not matter, where relevance was not looked at."""
