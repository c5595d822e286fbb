"""Minimal intervention at torque level: precise where it was learned, soft elsewhere."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tpsim.border import NotNegative, Positive, border
from tpsim.controllers.friction import damping, felt_mass
from tpsim.controllers.intervention import Intervention, UnitInertia
from tpsim.controllers.product import Skill
from tpsim.gaussian import Gaussian
from tpsim.learning.free_movement import against_free, free_share
from tpsim.robot.state import State
from tpsim.world.impedance import Impedance

NONE = 1e-6
"""Share of free movement's precision that is none."""


class MinimalIntervention(Intervention):
    """The product of all frames of all skills, as stiffness and damping (Eqs 5-6, 34, Section 6).

    Stiffness is the optimum (:meth:`~tpsim.controllers.intervention.Intervention.optimum`), up to
    a bandwidth. Directions in which no frame matters (:mod:`tpsim.learning.free_movement`),
    whatever motions of the arm they are part of, have none: there the arm stays where it is put,
    and friction is what a person feels who leads it (:mod:`~tpsim.controllers.friction`).

    Parameters
    ----------
    skills : sequence of Skill
    effort : float, optional
        Cost r of acceleration [s^4/(kg m^2)], against the log-likelihood of the movement. By
        default that with which a usual deviation is worth what the motors' springs may pull
        (:func:`~tpsim.controllers.torque_cost.acceleration_effort`).
    bandwidth : float, optional
        Natural frequency [Hz] that no direction exceeds, however precise; by default as fast as a
        loop allows whose torque comes 5 ms after what it answers
        (:func:`~tpsim.controllers.optimal.bandwidth_for`): half of what makes the arm unstable.
    friction : float
        What a person feels who leads a hand where it is free [Ns/m]: 18 N at 0.1 m/s.
    prior : Gaussian (n,), optional
        Joint posture [rad] for directions that no frame determines. Like a frame, it counts where
        it is more precise than free movement.
    period : float
        Time for which stiffness, damping and reference last [s]; the torque follows every state.
        The default is as often as a camera looks; the largest errors under a push are those of
        16 ms within 1 %.
    """

    @border
    def __init__(
        self,
        skills: Sequence[Skill],
        *,
        effort: Positive | None = None,
        bandwidth: Positive | None = None,
        friction: NotNegative = 180.0,
        prior: Gaussian | None = None,
        period: Positive = 0.03,
    ):
        super().__init__(skills, prior, period, effort, bandwidth)
        self.friction = friction
        self._rate: float | None = None

    def renew(self, state: State, time: float) -> Impedance:
        """Optimum for the product of all frames at a state."""
        seen = UnitInertia.of(self.product(state), state)
        kept = self._beyond_free(seen)
        modes = kept.modes()
        if self._rate is None:
            self._rate = self.friction / felt_mass(state)
        L, V = modes.inertia_root, modes.vectors
        left = (V * kept.precision.dot(V)).sum(0).clip(0.0)
        K = self.stiffness(left, state.robot)
        D = damping(state, L, V, K, self._free(seen, V, left), self.friction, self._rate)
        root = L.dot(V)
        return Impedance((root * K).dot(root.T), D, state.q + modes.way)

    def _beyond_free(self, seen: UnitInertia) -> UnitInertia:
        """What is left of a product in the directions that are more precise than free movement.

        A direction that is free in a share has the square of one less that of its precision, and
        so one less that of its spring, K = (Lambda / r)^1/2. Directions are those of the product
        against free movement, not the modes of the arm: these move what matters together with what
        is free.
        """
        assert self._product is not None
        if not self._product.free_precision.any():
            return seen
        J = seen.jacobian
        X, Y = against_free(seen.precision, J.T.dot(self._product.free_precision).dot(J))
        precision = (X * seen.precision.dot(X)).sum(0).clip(0.0)
        keep = (1 - free_share(precision, self._product.free(J.dot(X)))) ** 2
        left = (Y * (keep * precision)).dot(Y.T)
        return replace(seen, precision=left, gradient=Y.dot(keep * X.T.dot(seen.gradient)))

    def _free(self, seen: UnitInertia, modes: np.ndarray, left: np.ndarray) -> np.ndarray:
        """Share (n,) in which modes (n, n) are free, by the precision (n,) that is left of them."""
        assert self._product is not None
        whole = (modes * seen.precision.dot(modes)).sum(0)
        whole += NONE * self._product.free(seen.jacobian.dot(modes))
        return 1 - np.sqrt(np.minimum(left / np.maximum(whole, 1e-300), 1.0))
