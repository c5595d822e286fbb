"""A person who holds a hand of the robot still for a while, then lets go."""

from dataclasses import dataclass

import numpy as np

from tpsim.border import NotNegative, Positive, checked
from tpsim.pose import Pose
from tpsim.robot.state import State
from tpsim.world.people.guide import Grip
from tpsim.world.simulation import Simulation

FIRM = Grip(3000.0, 150.0, 60.0, 3.0, 150.0, 15.0)
"""Both hands around the robot's."""


@dataclass(frozen=True)
class Hold:
    """A hand that takes hold of a site where it is, keeps it there, and lets go.

    Parameters
    ----------
    site : str
    start, duration : float
        When it takes hold, and for how long [s].
    grip : Grip
        Spring and damper between it and the site, and its strength.
    """

    site: str
    start: NotNegative = 2.0
    duration: Positive = 5.0
    grip: Grip = FIRM

    def __post_init__(self) -> None:
        checked(self)

    def bind(self, simulation: Simulation) -> "BoundHold":
        """Look up the names in one simulation."""
        return BoundHold(self, simulation)


class BoundHold:
    """A hold in one simulation: ``act`` applies it; ``wrench`` and ``point`` are its last."""

    name = "hold"

    def __init__(self, hold: Hold, simulation: Simulation):
        self._hold, self._simulation = hold, simulation
        self._body = simulation.attachment(hold.site)[0]
        h = simulation.timestep
        self._first = round(hold.start / h)
        self._steps = round(hold.duration / h)
        self._taken: Pose | None = None
        self.wrench, self.point = np.zeros(6), np.zeros(3)

    def act(self, step: int, state: State) -> None:
        """Apply the wrench of this time step."""
        pose = state.pose(self._hold.site)
        self.point, self.wrench = pose.position, np.zeros(6)
        if not 0 <= step - self._first < self._steps:
            return
        if self._taken is None:
            self._taken = pose
        twist = state.twist(self._hold.site)
        self.wrench = self._hold.grip.wrench(pose, twist, self._taken, np.zeros(6))
        self._simulation.apply_wrench(self._body, self.wrench, pose.position)
