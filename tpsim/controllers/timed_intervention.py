"""A movement retrieved in time from moving frames, by Gaussian mixture regression, as torque."""

from dataclasses import replace

import numpy as np
from scipy.linalg.lapack import dpotrf, dsyevd, dtrtrs

from tpsim.border import Positive, border
from tpsim.checks import affordable
from tpsim.controllers.optimal import OptimalImpedance
from tpsim.controllers.product import Skill
from tpsim.controllers.progress import Patience, Progress
from tpsim.controllers.timed_product import TimedProduct
from tpsim.controllers.torque_cost import share_within
from tpsim.controllers.within_limits import nearest_within
from tpsim.errors import SimulationError
from tpsim.gaussian import Gaussian
from tpsim.retrieval.tp_gmr import Order
from tpsim.robot.state import State
from tpsim.world.guard import unguarded
from tpsim.world.impedance import Impedance

PULL = 0.12
"""Share of the motors' torque that springs ask for where progress stands still."""

STRENGTH = 0.6
"""Share that springs ask for beyond brakes at any time, as after a jump of what is wanted."""

FASTEST = 10.0
"""Speed [rad/s] at which a reference moves on at most, where joints have no limit of their own: an
object that jumps is for a moment as fast as nothing is."""

PERIOD = 0.03
"""Time [s] between two adaptations of the mixture to the frames: as often as a camera looks."""


class TimedIntervention(OptimalImpedance):
    """GMR over time under minimal intervention (Eqs 5-6, 13-20 and Table 3).

    The model's frames observe time and a view, Eq. (20). At every period what all frames retrieve
    at this time becomes one Gaussian of the posture (:class:`TimedProduct`), around the present
    posture and the present objects; it sets reference, stiffness and damping for one period by
    the optimum (:class:`~tpsim.controllers.optimal.OptimalImpedance`). The reference moves on as
    the movement goes on and as its objects move: dampers slow what lags behind, not what moves.

    Parameters
    ----------
    skill : Skill
        Its model's frames have time before the view.
    until : float
        Time [s] at which the movement was over; its end then lasts.
    effort, bandwidth : float, optional
        Cost of acceleration [s^4/(kg m^2)], and the natural frequency [Hz] that no direction
        exceeds; as of :class:`~tpsim.controllers.minimal_intervention.MinimalIntervention`.
    prior : Gaussian (n,), optional
        Joint posture [rad] for directions that no frame determines.
    period : float
        Time [s] between two adaptations.
    progress : Progress, optional
        What says how far the movement has come, and at what rate it goes on; where it stands still
        springs grow weak. By default the clock says it.
    order : str
        Of :func:`~tpsim.retrieval.tp_gmr.tp_gmr`. The covariance is stiffness here: moments of a
        mixture would be soft wherever a precise component meets a vague one, so that precisions
        are added up instead.
    """

    @border
    def __init__(
        self,
        skill: Skill,
        *,
        until: Positive,
        effort: Positive | None = None,
        bandwidth: Positive | None = None,
        prior: Gaussian | None = None,
        period: Positive = PERIOD,
        progress: Progress | None = None,
        order: Order = "pooled",
    ):
        super().__init__(period, effort, bandwidth)
        self.skill, self.until = skill, until
        self.prior, self.order, self.progress = prior, order, progress
        self._patience = Patience(PULL)
        affordable(
            "until over period", int(until / period), skill.model.frames[0].dim ** 2, least=0
        )
        self._times = np.unique(np.minimum(np.arange(0.0, until + period, period), until))
        self._product = TimedProduct(skill, prior, order, self._times)

    def renew(self, state: State, time: float) -> Impedance:
        """Optimum for the posture that the movement asks for now."""
        place, rate = (time, 1.0) if self.progress is None else self.progress.at(state, time)
        step, velocity = self._between(state, place, rate)
        L = dpotrf(state.mass, lower=1)[0]
        # L' Sigma L is the inverse of Lambda_z: the same eigenvectors, without an inverse.
        variances, V, failed = dsyevd(L.T @ step.covariance @ L, overwrite_a=1)
        if failed or not variances[0] > 0:
            raise SimulationError("the covariance of the movement has no eigendecomposition")
        modes, stiffness = L @ V, self.stiffness(1 / variances, state.robot)
        # Where joints can go no further, the others do what they can in their place.
        lower, upper = (limit - state.q for limit in unguarded(state.robot))
        root = modes.T / np.sqrt(variances)[:, None]
        way = nearest_within(step.mean, root, lower, upper)
        lead = (lower - way) / self.period, (upper - way) / self.period
        velocity = nearest_within(velocity, root, *lead)
        now = replace(Impedance.of_modes(modes, stiffness, state.q + way), velocity=velocity)
        # Far away the spring gives way, so that spring against damper asks for no wild speed.
        pace = np.sqrt(stiffness / 2) * (modes.T @ way)
        speed = dtrtrs(L, V @ pace, lower=1, trans=1)[0]
        excess = float((np.abs(speed) / state.robot.velocity_limit).max())
        pull, limit = now.stiffness @ way, state.robot.torque_limit
        if self.progress is not None:
            strength = self._patience.strength(time, place, rate)
            excess = max(excess, float((np.abs(pull) / limit).max()) / strength)
        brake = now.damping @ (state.dq - velocity)
        within = share_within(pull, brake, (STRENGTH * limit) ** -2.0)
        excess = max(excess, 1 / within)
        return now if excess <= 1 else now.weaker(excess)

    def _between(self, state: State, place: float, rate: float) -> tuple[Gaussian, np.ndarray]:
        """Step (n,) that the movement asks for at a place [s], and how fast it goes on [rad/s]."""
        place = min(max(place, 0.0), self.until)
        # At times that are known already, since others take longer.
        first = min(int(place / self.period + 1e-9), len(self._times) - 2)
        begin, end = self._times[first : first + 2].tolist()
        share = (place - begin) / (end - begin)
        before, after = (self._product.step(state, t) for t in (begin, end))
        near, near_time = (after, end) if share > 0.5 else (before, begin)
        on = after.mean - before.mean
        step = Gaussian.trusted(before.mean + share * on, near.covariance)
        velocity = self._product.drift(state, near_time)
        if place < self.until:
            velocity = velocity + rate / (end - begin) * on
        limit = np.minimum(state.robot.velocity_limit, FASTEST)
        return step, np.minimum(np.maximum(velocity, -limit), limit)
