"""Conditions: what is varied from trial to trial, as plain values."""

from dataclasses import dataclass, replace

import numpy as np

from tpsim.border import NotNegative, Point, Positive, Strength, checked
from tpsim.task.task import Situation
from tpsim.world.episode import BoundPerson
from tpsim.world.people.drag import Drag
from tpsim.world.people.guide import Grip, Guide, HandPath
from tpsim.world.people.hold import Hold
from tpsim.world.people.push import Push
from tpsim.world.people.script import straight
from tpsim.world.plant import NOMINAL, Plant
from tpsim.world.rollout import RECORD_PERIOD
from tpsim.world.simulation import Simulation
from tpsim.world.teaching import Lesson


@dataclass(frozen=True)
class Lead:
    """A person leads a site along a straight line, or off its own way, and feels what resists.

    Parameters
    ----------
    site : str
    origin : (3,) tuple
        Where the site is when the person takes hold [m].
    travel : (3,) tuple
        How far it is led [m].
    start, duration, rest : float
        When it begins, how long it takes, how long the person then stays there [s].
    stiffness : float
        Of the person's grip [N/m].
    max_force : float
        Strength of the person [N].
    carried : tuple of (3,) tuple
        Where the site would be by itself every 10 ms from ``start`` on [m]: the line is led off
        that way. By default it would stay at the origin.
    """

    site: str
    origin: Point
    travel: Point
    start: NotNegative = 1.5
    duration: Positive = 3.0
    rest: NotNegative = 0.5
    stiffness: NotNegative = 2000.0
    max_force: Strength = 60.0
    carried: tuple[Point, ...] = ()

    def __post_init__(self) -> None:
        checked(self)

    def bind(self, simulation: Simulation) -> BoundPerson:
        """Look up the names in one simulation."""
        damping = 2 * self.stiffness**0.5
        grip = Grip(self.stiffness, damping, 0.0, 0.0, self.max_force)
        path = straight(self.origin, self.travel, self.duration, self.rest, simulation.timestep)
        if self.carried:
            origin = np.array(self.origin)
            path = _off(np.array(self.carried), path, origin, simulation.timestep)
        return Guide("lead", self.site, grip, path, start=self.start).bind(simulation)


def _off(own: np.ndarray, path: HandPath, origin: np.ndarray, timestep: float) -> HandPath:
    """A path (T,) off the way (S, 3) [m] that the site goes by itself."""
    time = timestep * (1 + np.arange(len(path)))
    clock = RECORD_PERIOD * np.arange(len(own))
    way = np.stack([np.interp(time, clock, axis) for axis in own.T], axis=1)
    return replace(
        path,
        position=path.position - origin + way,
        velocity=path.velocity + np.gradient(way, timestep, axis=0),
    )


@dataclass(frozen=True)
class Condition:
    """One trial to perform: plain values, so that a recording can say how to repeat it.

    Parameters
    ----------
    label : str
        Group of conditions that it belongs to, such as ``"pushed"``.
    situation : Situation
    controller : str
        One of the study's controllers, by name.
    push : tuple of Push
        Who pushes.
    lead : tuple of Lead
        Who leads.
    drag : tuple of Drag
        Who pulled by hand, as in the playground.
    hold : tuple of Hold
        Who holds a hand still for a while.
    plant : Plant
        How the simulated robot differs from the controller's model.
    duration : float, optional
        Of the trial [s]; the task's own by default.
    shown : str, optional
        A behaviour that the teacher shows in this situation; no controller performs then.
    """

    label: str
    situation: Situation
    controller: str = "learned"
    push: tuple[Push, ...] = ()
    lead: tuple[Lead, ...] = ()
    drag: tuple[Drag, ...] = ()
    hold: tuple[Hold, ...] = ()
    plant: Plant = NOMINAL
    duration: Positive | None = None
    shown: str | None = None

    def __post_init__(self) -> None:
        checked(self)

    @property
    def people(self) -> tuple[Push | Lead | Drag | Hold, ...]:
        """All who push, lead, pull and hold."""
        return self.push + self.lead + self.drag + self.hold

    @property
    def lesson(self) -> Lesson:
        """What was led by hand under it: the same hands on weightless arms."""
        start, duration = np.array(self.situation.start), self.duration or RECORD_PERIOD
        return Lesson(start, self.drag, duration, objects=self.situation.objects)
