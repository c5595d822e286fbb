"""A push: a wrench on a body for a while, the test of compliance."""

from dataclasses import dataclass

import numpy as np

from tpsim.border import NotNegative, Point, checked
from tpsim.robot.state import State
from tpsim.world.simulation import Simulation

_NOTHING = np.zeros(6)


@dataclass(frozen=True)
class Push:
    """A constant force and torque at a point of a body, between two times.

    Parameters
    ----------
    body : str
        Body that is pushed, or a site: the push then acts there.
    force : (3,) tuple
        Force [N] in the world.
    start, duration : float
        When it begins and how long it lasts [s].
    point : (3,) tuple
        Where it acts, in the frame of the body or site [m].
    torque : (3,) tuple
        Torque [Nm] in the world.
    ramp : float
        Time [s] of the smooth rise and fall at the two ends, a hand's and not a hammer's.
    """

    body: str
    force: Point
    start: NotNegative = 2.0
    duration: NotNegative = 2.0
    point: Point = (0.0, 0.0, 0.0)
    torque: Point = (0.0, 0.0, 0.0)
    ramp: NotNegative = 0.05

    def __post_init__(self) -> None:
        checked(self)

    def wrench(self, time: float) -> np.ndarray:
        """Force and torque (6,) at a time [s]."""
        level = self.level(time)
        return level * np.concatenate([self.force, self.torque]) if level else np.zeros(6)

    def level(self, time: float) -> float:
        """Share of the whole wrench that acts at a time [s]."""
        inside = min(time - self.start, self.start + self.duration - time)
        if inside <= 0:
            return 0.0
        if inside >= self.ramp:
            return 1.0
        return float(np.sin(np.pi * inside / (2 * self.ramp)) ** 2)

    def bind(self, simulation: Simulation) -> "BoundPush":
        """Look up the names in one simulation."""
        return BoundPush(self, simulation)


class BoundPush:
    """A push in one simulation: ``act`` applies it; ``wrench`` and ``point`` are its last."""

    name = "push"

    def __init__(self, push: Push, simulation: Simulation):
        self._push, self._simulation = push, simulation
        self._body, R, p = simulation.attachment(push.body)
        self._point = p + R @ push.point
        self._whole = np.concatenate([push.force, push.torque])
        # Views of MuJoCo's own memory: looking them up costs more than reading.
        self._position = simulation.data.xpos[self._body]
        self._rotation = simulation.data.xmat[self._body].reshape(3, 3)
        self._level, self.wrench = 0.0, _NOTHING
        self._period, self._first, self._last = (
            simulation.timestep,
            push.start,
            push.start + push.duration,
        )

    def act(self, step: int, state: State) -> None:
        """Apply the wrench of this time step."""
        time = step * self._period
        level = self._push.level(time) if self._first < time < self._last else 0.0
        if level != self._level:
            self._level, self.wrench = level, level * self._whole if level else _NOTHING
        if level:
            self._simulation.apply_wrench(self._body, self.wrench, self.point)

    @property
    def point(self) -> np.ndarray:
        """Where it acts (3,) [m], in the world as it is."""
        point: np.ndarray = self._position + self._rotation.dot(self._point)
        return point
