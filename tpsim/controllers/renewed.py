"""What most controllers share: an impedance that lasts for some steps, and fixed gains."""

from abc import ABC, abstractmethod

import numpy as np

from tpsim.border import Count, NotNegative, border
from tpsim.robot.state import State
from tpsim.world.impedance import Impedance


class RenewedImpedance(ABC):
    """A controller whose impedance lasts for some steps, while the torque follows every state.

    Subclasses compute the impedance in :meth:`renew`.

    Parameters
    ----------
    every : int
        Time steps for which an impedance lasts.
    """

    @border
    def __init__(self, every: Count):
        self.every, self._left = every, 0
        self._now: Impedance | None = None

    @abstractmethod
    def renew(self, state: State, time: float) -> Impedance:
        """Impedance from this state on."""

    def command(self, state: State, time: float) -> Impedance:
        """Impedance at a state; the same object until it is renewed."""
        if self._left == 0 or self._now is None:
            self._left, self._now = self.every, self.renew(state, time)
        self._left -= 1
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
