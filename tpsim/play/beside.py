"""What another controller does beside, pushed with the same forces among the same objects."""

import numpy as np

from tpsim.errors import TpsimError
from tpsim.play.objects import LedObjects
from tpsim.world.people.drag import BoundDrag
from tpsim.world.rollout import Rollout
from tpsim.world.simulation import Simulation


class SameForce:
    """In another simulation, the force of a hand: beside what it meets here.

    Parameters
    ----------
    drag : BoundDrag
        Whose force it is.
    going : Rollout
        The other one.
    """

    name = "push"

    def __init__(self, drag: BoundDrag, going: Rollout):
        self._drag, self._simulation = drag, going.episode.simulation
        self._body, R, p = self._simulation.attachment(drag.body)
        self._point = p + R @ np.array(drag.held_at)
        self.wrench, self.point = np.zeros(6), np.zeros(3)

    @property
    def held(self) -> bool:
        """Whether the hand holds on."""
        return self._drag.held

    def act(self, step: int, state: object) -> None:
        """Apply the wrench of this time step."""
        data = self._simulation.data
        R = data.xmat[self._body].reshape(3, 3)
        self.point, self.wrench = data.xpos[self._body] + R @ self._point, self._drag.wrench
        self._simulation.apply_wrench(self._body, self.wrench, self.point)


class SameObjects:
    """Objects where they are in another simulation."""

    def __init__(self, led: LedObjects, simulation: Simulation):
        self._led, self._data = led, simulation.data
        self.now = led.now

    def act(self, step: int) -> None:
        """Move the objects to where they are there."""
        self.now = self._led.now
        self._data.mocap_pos[:], self._data.mocap_quat[:] = self.now.positions, self.now.quaternions


def forget_hands(going: Rollout) -> None:
    """Take hands away that have let go."""
    people = going.episode.people
    holding = [person for person in people if getattr(person, "held", True)]
    if len(holding) < len(people):
        people[:] = holding
        going.episode.simulation.clear_wrenches()


def stopped(going: Rollout) -> str | None:
    """Let one time step pass; why none did, in words, where the robot or its controller ended."""
    try:
        return None if going.step() else "the robot became faster than any robot"
    except TpsimError as error:
        return str(error)
