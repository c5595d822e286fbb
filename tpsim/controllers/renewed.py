"""What most controllers share: an impedance that lasts for a while, and fixed gains."""

from abc import ABC, abstractmethod

import numpy as np

from tpsim.border import NotNegative, Positive, border
from tpsim.robot.state import State
from tpsim.world.impedance import Impedance

_ROUNDING = 1e-9
"""Error [s] of a clock that adds up time steps."""


class RenewedImpedance(ABC):
    """A controller whose impedance lasts for a while, while the torque follows every state.

    Subclasses compute the impedance in :meth:`renew`.

    Parameters
    ----------
    period : float
        Time for which an impedance lasts [s], to the next state that is sensed.
    """

    @border
    def __init__(self, period: Positive):
        self.period, self._since = period, np.inf
        self._now: Impedance | None = None

    @abstractmethod
    def renew(self, state: State, time: float) -> Impedance:
        """Impedance from this state on."""

    def command(self, state: State, time: float) -> Impedance:
        """Impedance at a state; the same object until it is renewed."""
        age = time - self._since
        if self._now is None or not 0 <= age < self.period - _ROUNDING:
            self._since, self._now = time, self.renew(state, time)
        return self._now


class FixedImpedance:
    """Constant gains about a constant posture: the usual impedance control.

    Parameters
    ----------
    posture : (n,)
        Reference q_hat [rad].
    stiffness : float
        Of every joint, as acceleration [1/s^2]: K = stiffness M(q), critically damped.
    """

    @border
    def __init__(self, posture: np.ndarray, stiffness: NotNegative):
        self.posture, self.stiffness = np.array(posture), stiffness

    def command(self, state: State, time: float) -> Impedance:
        """Impedance at a state."""
        mass = state.mass
        return Impedance(self.stiffness * mass, 2 * self.stiffness**0.5 * mass, self.posture)
