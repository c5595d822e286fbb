"""A movement retrieved in time from moving frames, by Gaussian mixture regression, as torque."""

import numpy as np
from scipy.linalg.lapack import dpotrf, dsyevd, dtrtrs

from tpsim.border import Positive, border
from tpsim.controllers.product import Skill, Stack, StackedModel
from tpsim.controllers.renewed import RenewedImpedance
from tpsim.errors import SimulationError
from tpsim.gaussian import Gaussian
from tpsim.retrieval.gmr import Regression
from tpsim.robot.state import State
from tpsim.world.impedance import Impedance

PERIOD = 0.03
"""Time [s] between two adaptations of the mixture to the frames: as often as a camera looks."""


class TimedIntervention(RenewedImpedance):
    """GMR over time under minimal intervention (Eqs 5-6, 13-20 and Table 3).

    The model's frames observe time and a view, Eq. (20). At every period the components are
    carried from all frames into joint space, around the present posture and the present objects,
    and multiplied in information form; the mixture over (t, q) is conditioned on the time. What
    comes out, a Gaussian of the posture, sets reference, stiffness and damping for one period by
    the optimum of :mod:`~tpsim.controllers.minimal_intervention`.

    Parameters
    ----------
    skill : Skill
        Its model's frames have time before the view.
    effort : float
        Cost r of acceleration [s^4/(kg m^2)], against the log-likelihood of the movement.
    until : float
        Time [s] at which the movement was over; its end then lasts.
    prior : Gaussian (n,), optional
        Joint posture [rad] for directions that no frame determines.
    period : float
        Time [s] between two adaptations.
    timestep : float
        Of the control [s].
    """

    @border
    def __init__(
        self,
        skill: Skill,
        *,
        effort: Positive,
        until: Positive,
        prior: Gaussian | None = None,
        period: Positive = PERIOD,
        timestep: Positive = 1e-3,
    ):
        super().__init__(max(1, round(period / timestep)))
        self.skill, self.effort, self.until = skill, effort, until
        sizes = [frame.dim - 1 for frame in skill.model.frames]
        self._stack = Stack(list(skill.views.values()), sizes, inputs=1)
        self._model = StackedModel(skill, self._stack)
        self.prior = prior

    def renew(self, state: State, time: float) -> Impedance:
        """Optimum for the posture that the movement asks for now."""
        step = self._posture(state, min(time, self.until))
        L = dpotrf(state.mass, lower=1)[0]
        # L' Sigma L is the inverse of Lambda_z: the same eigenvectors, without an inverse.
        variances, V, failed = dsyevd(L.T @ step.covariance @ L, overwrite_a=1)
        if failed or not variances[0] > 0:
            raise SimulationError("the covariance of the movement has no eigendecomposition")
        modes, stiffness = L @ V, 1 / np.sqrt(self.effort * variances)
        now = Impedance.of_modes(modes, stiffness, state.q + step.mean)
        # Far away the spring gives way, so that spring against damper asks for no wild speed.
        pace = np.sqrt(stiffness / 2) * (modes.T @ step.mean)
        speed = dtrtrs(L, V @ pace, lower=1, trans=1)[0]
        excess = float((np.abs(speed) / state.robot.velocity_limit).max())
        return now if excess <= 1 else now.weaker(excess)

    def _posture(self, state: State, time: float) -> Gaussian:
        """Step (n,) from the present posture that the movement asks for at a time."""
        n, size = state.robot.n, self._stack.size
        y, J = np.zeros(size), np.zeros((size, 1 + n))
        self._stack.see(state, y, J[:, 1:])
        J[[block.start for block in self._stack.blocks.values()], 0] = 1.0
        WJ = self._model.precision @ J
        product = J.T @ WJ
        target = ((self._model.mean - y)[:, None] @ WJ).mT
        if self.prior is not None:
            precision = self.prior.precision
            product[:, 1:, 1:] += precision
            target[:, 1:, 0] += precision @ (self.prior.mean - state.q)
        return _regression(self._model.log_priors, product, target).at(time)


def _regression(
    log_priors: np.ndarray, precision: np.ndarray, information: np.ndarray
) -> Regression:
    """Regression of the other variables on the first, Eqs 14-16, of Gaussians in information form.

    ``precision`` (K, 1 + n, 1 + n) and ``information`` (K, 1 + n, 1).
    """
    covariance = np.linalg.inv(precision[:, 1:, 1:])
    cross = precision[:, :1, 1:]
    slope = -(covariance @ cross.mT)
    rest = covariance @ information[:, 1:]
    input_precision = precision[:, :1, :1] + cross @ slope
    input_mean = (information[:, :1] - cross @ rest) / input_precision
    return Regression.trusted(
        input_mean[..., 0],
        (rest + slope * input_mean)[..., 0],
        np.concatenate((np.sqrt(input_precision), slope), axis=1),
        covariance,
        log_priors + 0.5 * np.log(input_precision[:, 0, 0]),
    )
