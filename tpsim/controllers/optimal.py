"""What controllers share whose stiffness is an optimum: what it costs, and how fast it may be."""

from math import atan, pi, sqrt
from typing import ClassVar

import numpy as np

from tpsim.border import Positive
from tpsim.checks import number
from tpsim.controllers.renewed import RenewedImpedance
from tpsim.controllers.torque_cost import STRENGTH, acceleration_effort
from tpsim.robot.robot import Robot


class OptimalImpedance(RenewedImpedance):
    """A controller whose stiffness is the root of precision over effort (Eq. 34, Section 6).

    Parameters
    ----------
    period : float
        Time for which an impedance lasts [s].
    effort : float, optional
        Cost r of acceleration [s^4/(kg m^2)], against the log-likelihood of the movement. By
        default that with which a usual deviation is worth what the motors' springs may pull
        (:func:`~tpsim.controllers.torque_cost.acceleration_effort`).
    bandwidth : float, optional
        Natural frequency [Hz] that no direction exceeds, however precise; by default as fast as
        a loop allows whose torque comes 5 ms after what it answers (:func:`bandwidth_for`).

    Attributes
    ----------
    strength : float
        Share of the motors' torque that a usual deviation is worth, by default.
    """

    strength: ClassVar[float] = STRENGTH

    def __init__(self, period: Positive, effort: Positive | None, bandwidth: Positive | None):
        super().__init__(period)
        self.effort = effort
        self.bandwidth = bandwidth_for() if bandwidth is None else bandwidth
        self._stiffest = (2 * pi * self.bandwidth) ** 2
        self._cost = effort

    def stiffness(self, precision: np.ndarray, robot: Robot) -> np.ndarray:
        """Stiffness (n,) [1/s^2] of directions of unit inertia, of precision (n,) [1/(kg m^2)]."""
        if self._cost is None:
            self._cost = acceleration_effort(robot, self.strength)
        return np.minimum(np.sqrt(precision / self._cost), self._stiffest)


def bandwidth_for(delay: float = 0.005) -> float:
    """Natural frequency [Hz] that a loop with a delay [s] may have, with half its margin left.

    The optimum of a unit mass, K = w^2 and D = sqrt(2) w, crosses unit gain at c w with
    c = sqrt(1 + sqrt(2)); there its phase is atan(sqrt(2) c) above -180 degrees, which a delay of
    atan(sqrt(2) c) / (c w) uses up. Half of that is allowed. The delay is the time between what is
    sensed and the torque that answers it: latency, filters of velocity, half a control period.
    """
    delay = number("delay", delay, above=0, what="time [s]")
    c = sqrt(1 + sqrt(2))
    return 0.5 * atan(sqrt(2) * c) / c / (2 * pi * delay)
