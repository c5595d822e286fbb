"""A push: a wrench on a body for a while, the test of compliance."""

from dataclasses import dataclass

import numpy as np

from tpsim.border import NotNegative, Point, checked
from tpsim.robot.state import State
from tpsim.world.simulation import Simulation


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
        inside = min(time - self.start, self.start + self.duration - time)
        if inside <= 0:
            return np.zeros(6)
        level = 1.0 if inside >= self.ramp else np.sin(np.pi * inside / (2 * self.ramp)) ** 2
        return level * np.concatenate([self.force, self.torque])

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
        self.wrench, self.point = np.zeros(6), np.zeros(3)

    def act(self, step: int, state: State) -> None:
        """Apply the wrench of this time step."""
        simulation, body = self._simulation, self._body
        self.wrench = self._push.wrench(step * simulation.timestep)
        R = simulation.data.xmat[body].reshape(3, 3)
        self.point = simulation.data.xpos[body] + R @ self._point
        if self.wrench.any():
            simulation.apply_wrench(body, self.wrench, self.point)
