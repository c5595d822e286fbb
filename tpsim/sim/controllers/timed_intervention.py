"""A movement retrieved in time from moving frames, by Gaussian mixture regression, as torque."""

import numpy as np
from scipy.linalg.lapack import dpotrf, dsyevd, dtrtrs

from tpsim.errors import ArgumentError, SimulationError
from tpsim.gaussian import Gaussian
from tpsim.retrieval.gmr import Regression
from tpsim.sim.controllers.controller import Behaviour, Impedance, RenewedImpedance
from tpsim.sim.simulation import Simulation

PERIOD = 0.03
"""Time [s] between two adaptations of the mixture to the frames: as often as a camera looks."""


class TimedIntervention(RenewedImpedance):
    """GMR over time under minimal intervention (Eqs 5-6, 13-20 and Table 3).

    The model's frames observe time and a coordinate, Eq. (20). At every period the components are
    carried from all frames into joint space, around the present posture and the present objects,
    and multiplied in information form; the mixture over (t, q) is conditioned on the time. What
    comes out, a Gaussian of the posture, sets reference, stiffness and damping for one period by
    the optimum of :mod:`~tpsim.sim.controllers.minimal_intervention`.

    Parameters
    ----------
    simulation : Simulation
        Gives the time and shows the objects.
    behaviour : Behaviour
        Its model's frames have time before the coordinate.
    effort : float
        Cost r of acceleration [s^4/(kg m^2)], against the log-likelihood of the movement.
    until : float
        Time [s] at which the movement was over; its end then lasts.
    prior : Gaussian, optional
        Joint posture (n,) for directions that no frame determines.
    period : float
        Time [s] between two adaptations.
    """

    def __init__(
        self,
        simulation: Simulation,
        behaviour: Behaviour,
        *,
        effort: float,
        until: float,
        prior: Gaussian | None = None,
        period: float = PERIOD,
    ):
        for name, value in (("effort", effort), ("until", until), ("period", period)):
            if not value > 0:
                raise ArgumentError(f"{name} is {value}; it must be positive")
        robot = simulation.robot
        super().__init__(robot, max(1, round(period / simulation.timestep)))
        self._simulation, self._effort, self._until = simulation, effort, until
        self._mixture = _Mixture(behaviour, robot.n)
        self._evaluate = [coordinate.bind(robot) for coordinate in behaviour.coordinates]
        self._prior = prior

    def renew(self) -> Impedance:
        """Optimum for the posture that the movement asks for now."""
        robot = self.robot
        time = min(self._simulation.time, self._until)
        views = [evaluate() for evaluate in self._evaluate]
        step = self._mixture.at(time, views, *self._beforehand())
        L = dpotrf(robot.mass, lower=1)[0]
        # L' Sigma L is the inverse of Lambda_z: the same eigenvectors, without an inverse.
        variances, V, failed = dsyevd(L.T @ step.covariance @ L, overwrite_a=1)
        if failed or not variances[0] > 0:
            raise SimulationError("the covariance of the movement has no eigendecomposition")
        modes, stiffness = L @ V, 1 / np.sqrt(self._effort * variances)
        now = Impedance.of_modes(modes, stiffness, robot.q + step.mean)
        # Far away the spring gives way, so that spring against damper asks for no wild speed.
        pace = np.sqrt(stiffness / 2) * (modes.T @ step.mean)
        speed = dtrtrs(L, V @ pace, lower=1, trans=1)[0]
        excess = (np.abs(speed) / robot.velocity_limit).max()
        return now if excess <= 1 else now.weaker(excess)

    def _beforehand(self):
        """Precision and information vector of the prior, from the present posture."""
        if self._prior is None:
            return 0.0, 0.0
        precision = self._prior.precision
        return precision, precision @ (self._prior.mean - self.robot.q)


class _Mixture:
    """A model over time and coordinates, laid out over stacked views, seen from joint space."""

    def __init__(self, behaviour, n):
        model = behaviour.model
        sizes = np.array(model.dims)
        ends = np.cumsum(sizes)
        K, size = model.components, int(ends[-1])
        self._log_priors = np.log(np.maximum(model.priors, np.finfo(float).tiny))
        self._times = ends - sizes
        self._rows = [slice(e - s + 1, e) for s, e in zip(sizes, ends, strict=True)]
        self._W = np.zeros((K, size, size))
        self._mu = np.concatenate([frame.mean for frame in model.frames], axis=-1)
        for frame, start, end in zip(model.frames, self._times, ends, strict=True):
            self._W[:, start:end, start:end] = frame.precision
        self._y = np.zeros(size)
        self._J = np.zeros((size, 1 + n))
        self._J[self._times, 0] = 1.0

    def at(self, time, views, precision, information) -> Gaussian:
        """Step (n,) from the present posture that the movement asks for at a time.

        ``precision`` (n, n) and ``information`` (n,) of a prior join every component.
        """
        for (y, J), rows in zip(views, self._rows, strict=True):
            self._y[rows], self._J[rows, 1:] = y, J
        WJ = self._W @ self._J
        product = self._J.T @ WJ
        target = ((self._mu - self._y)[:, None] @ WJ).mT
        product[:, 1:, 1:] += precision
        target[:, 1:, 0] += information
        return _regression(self._log_priors, product, target).at(time)


def _regression(log_priors, precision, information) -> Regression:
    """Regression of the other variables on the first, Eqs 14-16, of Gaussians in information form.

    ``precision`` (K, 1 + n, 1 + n) and ``information`` (K, 1 + n, 1).
    """
    covariance = np.linalg.inv(precision[:, 1:, 1:])
    cross = precision[:, :1, 1:]
    slope = -(covariance @ cross.mT)
    rest = covariance @ information[:, 1:]
    input_precision = precision[:, :1, :1] + cross @ slope
    input_mean = (information[:, :1] - cross @ rest) / input_precision
    return Regression(
        input_mean[..., 0],
        (rest + slope * input_mean)[..., 0],
        np.concatenate((np.sqrt(input_precision), slope), axis=1),
        covariance,
        log_priors + 0.5 * np.log(input_precision[:, 0, 0]),
    )
