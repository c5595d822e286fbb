"""What is around the controller at every time step: clock, objects, motors, people, physics."""

from collections.abc import Sequence

import numpy as np

from tpsim.sim.hand import Guide
from tpsim.sim.objects import MovingObjects, ObjectPath
from tpsim.sim.push import Push
from tpsim.sim.simulation import Simulation

DIVERGED_SPEED = 30.0
"""Joint speed [rad/s] beyond which a robot is given up as diverged."""


class Surroundings:
    """The rest of the world that a controller drives its robot in, one time step after another.

    A step is :meth:`sense`, :meth:`act`, :meth:`advance`, in this order: whoever decides about
    the torque meanwhile, the same torques give the same movement, bit for bit.

    Parameters
    ----------
    simulation : Simulation
    people : sequence of Push or Guide
        Who pushes and leads the robot.
    objects : sequence of ObjectPath
        Where movable objects are; those without a path stay where the scene has them.

    Attributes
    ----------
    people : list
        Those people at work: each has ``name``, ``wrench`` (6,) and ``point`` (3,).
    saturated, contacts : int
        Time steps so far in which a motor was at its limit, and in which something touched.
    """

    def __init__(
        self,
        simulation: Simulation,
        people: Sequence[Push | Guide] = (),
        objects: Sequence[ObjectPath] = (),
    ):
        self._simulation = simulation
        self._limit = simulation.robot.torque_limit
        self.people = [person.bind(simulation) for person in people]
        self._objects = MovingObjects(objects, simulation)
        self._step = self.saturated = self.contacts = 0

    def reset(self, start) -> None:
        """Put the robot at rest at a start posture (n,) [rad], and the clock at zero."""
        self._simulation.reset(start)
        self._step = self.saturated = self.contacts = 0

    def sense(self) -> None:
        """Move the objects to where they are now, and update the robot."""
        simulation = self._simulation
        self._objects.act(self._step)
        simulation.robot.update(simulation.q, simulation.dq)

    @property
    def diverged(self) -> bool:
        """Whether the last :meth:`sense` found the robot wild, or its state lost."""
        simulation = self._simulation
        # MuJoCo starts over where the state is lost: its clock then disagrees with ours.
        lost = simulation.time < (self._step - 1) * simulation.timestep
        return bool(lost or not np.abs(simulation.robot.dq).max() < DIVERGED_SPEED)

    def act(self, wanted) -> np.ndarray:
        """Let people act; torque (n,) [Nm] that the motors give when (n,) is wanted."""
        if self.people:
            self._simulation.clear_wrenches()
            for person in self.people:
                person.act(self._step)
        # Not a number is not within the limit either.
        if np.count_nonzero(np.abs(wanted) <= self._limit) == len(wanted):
            return wanted
        self.saturated += 1
        return np.minimum(np.maximum(wanted, -self._limit), self._limit)

    def advance(self, torque) -> None:
        """Let one time step pass with joint torques (n,) [Nm] within the motors' limits."""
        self._simulation.step(torque)
        self.contacts += self._simulation.data.ncon > 0
        self._step += 1
