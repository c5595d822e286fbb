"""Views that change with time: one that hands over to another, and a site on its path."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from tpsim.border import checked
from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.robot.views.sites import LABELS
from tpsim.robot.views.view import Seen, View
from tpsim.timeline import rest_to_rest, rest_to_rest_rate

Path = Callable[[State], tuple[Pose, np.ndarray]]
"""Pose and twist (6,) [m/s], [rad/s], world-aligned, at a state's time among its objects; a value
that can be compared, such as a frozen dataclass."""


@dataclass(frozen=True)
class Handover(View):
    """A view that becomes another one over a while, with minimum jerk: (1 - s) y_1 + s y_2.

    Parameters
    ----------
    first, then : View
        Of the same dimension.
    start, end : float
        When the second one begins to count, and when it alone does [s].
    """

    first: View
    then: View
    start: float
    end: float

    def __post_init__(self) -> None:
        checked(self)
        if not self.start < self.end:
            raise ArgumentError(
                f"handover from start {self.start:g} s to end {self.end:g} s; give start < end"
            )

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        return self.first.labels(robot)

    def see(self, state: State) -> Seen:
        """Value, Jacobian and drift at a state; the change of the shares is drift."""
        phase = (state.time - self.start) / (self.end - self.start)
        if phase <= 0:
            return self.first(state)
        if phase >= 1:
            return self.then(state)
        s = float(rest_to_rest(np.array(phase)))
        rate = float(rest_to_rest_rate(np.array(phase))) / (self.end - self.start)
        (y1, J1, d1, _), (y2, J2, d2, _) = self.first(state), self.then(state)
        drift = (1 - s) * d1 + s * d2 + rate * (y2 - y1)
        return Seen((1 - s) * y1 + s * y2, (1 - s) * J1 + s * J2, drift)


@dataclass(frozen=True)
class OnPath(View):
    """How far a site is from its place on a path, d = 6: position [m] and rotation vector [rad].

    The rotation vector is ``log(R R_path^T)``, world-aligned, and zero on the path, however far
    the path turns; so is the value as a whole.

    Parameters
    ----------
    site : str
    path : callable
        ``path(state) -> (Pose, twist (6,))``.
    """

    site: str
    path: Path

    def __post_init__(self) -> None:
        checked(self)

    def labels(self, robot: Robot) -> tuple[str, ...]:
        """Names of the dimensions."""
        return LABELS["pose"]

    def see(self, state: State) -> Seen:
        """Value, Jacobian and drift at a state; the path's own motion is drift."""
        (R, p), J = state.pose(self.site), state.jacobian(self.site)
        place, twist = self.path(state)
        error = R @ place.rotation.T
        # d/dt log(R R_path^T): the site turns it from the left, the path from the right.
        turning = pin.Jlog3(error)
        drift = -np.concatenate((twist[:3], turning @ twist[3:]))
        jacobian = np.concatenate((J[:3], turning.T @ J[3:]))
        return Seen(np.concatenate((p - place.position, pin.log3(error))), jacobian, drift)
