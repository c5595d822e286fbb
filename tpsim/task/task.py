"""What a task is: a world, behaviours that are taught, situations, and a controller."""

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import ClassVar, Literal, Self

import numpy as np

from tpsim.border import Endless, Number, Positive, SeedNumber, border, checked
from tpsim.checks import instance
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError, SimulationError
from tpsim.learning.low_pass import low_pass
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.robot.views.observe import observe
from tpsim.robot.views.view import View
from tpsim.world.impedance import Controller
from tpsim.world.object_path import ObjectPath, put_objects
from tpsim.world.teaching import Teacher
from tpsim.world.trial import Trial
from tpsim.world.world import World

DRAWS = 100
"""Situations drawn before a task gives up finding one that the robot can be put in."""

_SITUATION = 1

Models = Mapping[str, TPGMM]
"""A learned model for each behaviour, by name."""

Fit = Callable[[Sequence[Demonstration]], TPGMM]
"""Learns a behaviour from its demonstrations."""


@dataclass(frozen=True)
class Situation:
    """One situation in which a task is performed: everything that was drawn for it.

    Parameters
    ----------
    start : (n,) tuple
        Start posture [rad].
    objects : tuple of ObjectPath
        Where objects are, and how they move.
    seed, index : int
        Situation ``index`` of a seed draws from ``SeedSequence(seed, spawn_key=(1, index))``;
        filled in by :func:`draw_situation`.
    """

    start: tuple[float, ...]
    objects: tuple[ObjectPath, ...] = ()
    seed: SeedNumber = 0
    index: Number = 0

    def __post_init__(self) -> None:
        checked(self)


@dataclass(frozen=True)
class Goal:
    """What counts as done well at a moment: a view that is to be near zero.

    Parameters
    ----------
    view : View
    within : float
        Norm of the view up to which all is well, in its SI unit.
    since, until : float
        When it counts [s]; of a demonstration, negative times are those before its end.
    """

    view: View
    within: Positive
    since: float = 0.0
    until: Endless = np.inf

    def __post_init__(self) -> None:
        checked(self)


Others = Literal["held", "following", "free"]
"""What becomes of the other hands while one is led."""


@dataclass(frozen=True)
class Behaviour:
    """Something that is taught apart and learned as one model.

    Parameters
    ----------
    views : mapping of str to View
        Candidate frames, Table 3: what the demonstrations are seen from. Which of them matter is
        for the demonstrations to say.
    teacher : callable
        Draws how a person shows it once: ``teacher(world, rng) -> Lesson``.
    fit : callable
        Learns a TP-GMM from demonstrations whose observations are the views' values along the
        movement (``data`` is q); one Gaussian in every frame by default.
    goals : mapping of str to Goal
        What the teacher cares about, by name: a demonstration that misses one is refused. None
        by default: whatever was led without accident is learned from.
    cutoff : float, optional
        Frequency [Hz] up to which movements are learned from, :func:`~tpsim.learning.low_pass`;
        above the tremor of people's hands nothing is left. All frequencies by default.
    asks : str
        What a person is asked to show, in a sentence.
    others : str
        What becomes of the other hands while a person leads one: ``"held"``, ``"following"`` it
        as if both held one thing, or ``"free"``.
    """

    views: Mapping[str, View]
    teacher: Teacher
    fit: Fit = field(default=partial(fit_tp_gmm, components=1))
    goals: Mapping[str, Goal] = field(default_factory=dict)
    cutoff: float | None = None
    asks: str = ""
    others: Others = "held"


class Task(ABC):
    """A task; a subclass is a frozen dataclass, and its fields are its parameters.

    The fields are options on the command line and part of ``run.json``; a variation of a task is
    ``dataclasses.replace(task, field=value)``.

    Attributes
    ----------
    duration : float
        Of a performance [s].
    demonstrations : int
        How often a whole run teaches each behaviour.
    """

    duration: ClassVar[float] = 6.0
    demonstrations: ClassVar[int] = 6

    @property
    def name(self) -> str:
        """Name in recordings and reports."""
        return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", type(self).__name__).lower()

    @abstractmethod
    def world(self) -> World:
        """Robot, objects and scene."""

    @abstractmethod
    def behaviours(self) -> Mapping[str, Behaviour]:
        """What is taught, by name; a task may perform the product of several behaviours."""

    @abstractmethod
    def situation(self, world: World, rng: np.random.Generator) -> Situation:
        """Draw a situation that was never taught; one that cannot be reached is drawn anew."""

    @abstractmethod
    def controller(self, world: World, models: Models, situation: Situation) -> Controller:
        """What drives the robot, from the learned models: a new one for every trial."""

    def sites(self) -> Mapping[str, str]:
        """Sites that recordings keep, by the name that they have there; the hands by default."""
        return self.stage.robot.hands

    def goals(self) -> Mapping[str, Goal]:
        """What is rewarded in environments; nothing by default."""
        return {}

    def outcome(self, trial: Trial) -> str:
        """How a trial ended, where a task can say more than ``trial.outcome``."""
        return instance("trial", trial, Trial).outcome

    @cached_property
    def stage(self) -> World:
        """The task's world, made once."""
        return self.world()

    @border
    def in_world(self, world: World) -> Self:
        """The same task in another world, such as that of a recording."""
        task = replace(self)  # type: ignore[type-var]  # subclasses are dataclasses
        # Not a field of the value, so the frozen dataclass does not mind.
        task.__dict__["stage"] = world
        return task

    def __getstate__(self) -> dict[str, object]:
        """The fields travel to other processes, the compiled world does not."""
        return {name: value for name, value in self.__dict__.items() if name != "stage"}


def controller_of(task: Task, models: Models, situation: Situation) -> Controller:
    """The task's own controller; an ArgumentError where a behaviour has no model."""
    try:
        return task.controller(task.stage, models, situation)
    except KeyError as error:
        missing = [name for name in task.behaviours() if name not in models]
        if not missing or error.args[0] not in missing:
            raise
        raise ArgumentError(f"models hold no '{missing[0]}', only {list(models)}") from None


@border
def draw_situation(
    task: Task, seed: SeedNumber, index: Number, draw: Callable[..., Situation] | None = None
) -> Situation:
    """Situation ``index`` of a seed: drawn until the robot can be put in it freely.

    Parameters
    ----------
    task : Task
    seed, index : int
    draw : callable, optional
        ``draw(world, rng) -> Situation``, for other kinds of situations than the task's own.

    Raises
    ------
    SimulationError
        If no start posture is found that can be reached, touches nothing, keeps off the joint
        limits and leaves the motors torque to spare.
    """
    world, draw = task.stage, draw or task.situation
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_SITUATION, index)))
    simulation = world.simulation()
    for _ in range(DRAWS):
        try:
            found = instance("draw(world, rng)", draw(world, rng), Situation)
            start = np.array(found.start)
            simulation.reset(start)
            put_objects(found.objects, simulation)
        except SimulationError as error:
            why = str(error)
            continue
        if simulation.touches:
            why = f"{simulation.touching} touch"
        elif not world.robot.is_comfortable(start):
            why = "a joint is near its limit, or gravity takes most of a motor's torque"
        else:
            return replace(found, seed=seed, index=index)
    raise SimulationError(
        f"task '{task.name}' found no start posture that the robot can reach without contact "
        f"in {DRAWS} draws; give its workspace less range. The last draw: {why}"
    )


def demonstration(
    world: World, trial: Trial, views: Mapping[str, View], cutoff: float | None = None
) -> Demonstration:
    """One taught trial as it is seen in every view, up to a frequency [Hz] where one is given.

    Returns
    -------
    Demonstration
        ``data`` is q (T, n), ``observations`` holds every view's value (T, d_j).
    """
    q = trial["q"] if cutoff is None else low_pass(trial.time, trial["q"], cutoff)
    seen = observe(world.robot, list(views.values()), q, trial.objects)
    return Demonstration(trial.time, q, observations=tuple(seen))
