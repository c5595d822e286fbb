"""Minimal intervention at torque level: precise where it was learned, soft elsewhere."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg.lapack import dtrtrs

from tpsim.border import NotNegative, Positive, border
from tpsim.controllers.friction import damping, felt_mass
from tpsim.controllers.intervention import Intervention, Modes
from tpsim.controllers.product import Information, Skill
from tpsim.gaussian import Gaussian
from tpsim.learning.free_movement import free_share
from tpsim.robot.state import State
from tpsim.world.impedance import Impedance


class MinimalIntervention(Intervention):
    """The product of all frames of all skills, as stiffness and damping (Eqs 5-6, 34, Section 6).

    Stiffness is the optimum (:meth:`~tpsim.controllers.intervention.Intervention.optimum`), up to
    a bandwidth. Directions in which no frame matters (:mod:`tpsim.learning.free_movement`) have
    none: there the arm stays where it is put, and friction is what a person feels who leads it
    (:mod:`~tpsim.controllers.friction`).

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
        product = self.product(state)
        modes = Modes.of(product, state)
        if self._rate is None:
            self._rate = self.friction / felt_mass(state)
        share = self._free(product, modes)
        K = self.stiffness(modes.precision, state.robot) * (1 - share)
        L, V = modes.inertia_root, modes.vectors
        root = L.dot(V)
        D = damping(state, L, V, K, share, self.friction, self._rate)
        return Impedance((root * K).dot(root.T), D, state.q + modes.way)

    def _free(self, product: Information, modes: Modes) -> np.ndarray:
        """Share (n,) in which the modes are free."""
        assert self._product is not None
        along = dtrtrs(modes.inertia_root, modes.vectors, lower=1, trans=1)[0]
        return free_share(modes.precision, self._product.free(product.jacobian.dot(along)))
