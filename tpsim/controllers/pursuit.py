"""Minimal intervention towards what moves: the reference has a velocity too."""

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
from scipy.linalg.lapack import dgesv

from tpsim.border import Positive, border
from tpsim.controllers.intervention import Intervention
from tpsim.controllers.product import Information, Skill
from tpsim.robot.state import State
from tpsim.robot.views.nullspace import eye
from tpsim.world.impedance import Impedance

STEADY = 0.1
"""Standard deviation [rad] from which on a frame is too vague to lead the joints' velocity."""


class Pursuit(Intervention):
    """Minimal intervention in frames of moving objects: it damps what lags behind, not what moves.

    The joint velocity that keeps up with all frames solves, in the precisions W of their product,

        (sum_j J_j^T W_j K_j + I / STEADY^2) dq_hat = -sum_j J_j^T W_j d_j,

    where view j changes by ``dy_j = K_j dq + d_j``, with the drift d_j of its objects. The
    reference moves with it from one solution to the next.

    Parameters
    ----------
    skills : sequence of Skill
    effort, bandwidth : float, optional
        Cost of acceleration [s^4/(kg m^2)], and the natural frequency [Hz] that no direction
        exceeds; as of :class:`~tpsim.controllers.minimal_intervention.MinimalIntervention`.
    period : float
        Time for which stiffness, damping and velocity last [s].
    """

    strength: ClassVar[float] = 0.6
    """Share of the motors' torque that springs do not exceed: the rest is left for brakes."""

    @border
    def __init__(
        self,
        skills: Sequence[Skill],
        *,
        effort: Positive | None = None,
        bandwidth: Positive | None = None,
        period: Positive = 0.025,
    ):
        # What moves must be led in every direction: here a frame counts as it was learned.
        whole = [Skill(s.views, replace(s.model, relevance=())) for s in skills]
        super().__init__(whole, None, period, effort, bandwidth)
        self._was: np.ndarray | None = None

    def renew(self, state: State, time: float) -> Impedance:
        """Optimum for the product of all frames at a state, moving with them."""
        state = self._ahead(state)
        product, robot = self.product(state), state.robot
        now = self.optimum(product, state)
        pull = now.stiffness.dot(now.reference - state.q)
        # At this speed spring and damper are in balance.
        speed = dgesv(now.damping, pull)[2]
        share = np.abs(pull) / (self.strength * robot.torque_limit)
        excess = max(share.max(), (np.abs(speed) / robot.velocity_limit).max())
        held = now if excess <= 1 else now.weaker(excess)
        return Impedance(
            held.stiffness, held.damping, held.reference, self._keep_up(product, state)
        )

    def _ahead(self, state: State) -> State:
        """The state with the objects' velocities in the middle of the period to come.

        What is seen of a velocity is half a period old on average, so it is extrapolated by a
        whole one; in the objects' own axes: hands that follow an object turn with it, and there
        their Jacobians hardly change.
        """
        objects = state.objects
        if objects.twists is None:
            return state
        R = objects.rotations
        own = objects.twists.reshape(-1, 2, 3) @ R
        ahead = own if self._was is None else 2 * own - self._was
        self._was = own
        twists = (ahead @ R.mT).reshape(-1, 6)
        return State(state.robot, state.x, objects.moving(twists), state.time)

    def _keep_up(self, product: Information, state: State) -> np.ndarray:
        """Joint velocity (n,) [rad/s] that keeps up with the frames."""
        assert self._product is not None
        drift, K = self._product.stack.follow(state)
        JW = product.jacobian.T.dot(product.precision)
        steady = eye(state.robot.n, STEADY**-2)
        velocity = dgesv(JW.dot(K) + steady, -JW.dot(drift))[2]
        limit = state.robot.velocity_limit
        return np.minimum(np.maximum(velocity, -limit), limit)
