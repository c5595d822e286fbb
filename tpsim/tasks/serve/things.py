"""What things see that hands take: where one is in the frame of another."""

from dataclasses import dataclass

import numpy as np

from tpsim.border import Point, checked
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.robot.views.sites import LABELS
from tpsim.robot.views.view import Seen, View


@dataclass(frozen=True)
class Thing(View):
    """Where a thing is in the frame of an object, from a place there, d = 3 [m].

    No joint moves what is in no hand: the Jacobian is zero, whoever holds it. For goals and
    measures.

    Parameters
    ----------
    name, base : str
        Of the thing, and of the object or thing from which it is seen.
    place : (3,) tuple
        Of the thing there, at which the value is zero [m].
    """

    name: str
    base: str
    place: Point = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        checked(self)

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        return LABELS["position"]

    def see(self, state: State) -> Seen:
        """Value at a state; Jacobian and drift are zero."""
        thing, base = state.objects[self.name], state.objects[self.base]
        value = base.rotation.T @ (thing.position - base.position) - self.place
        return Seen(value, np.zeros((3, state.robot.n)), np.zeros(3))
