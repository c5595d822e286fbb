"""Minimal intervention towards what moves: the reference has a velocity too."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg.lapack import dgesv

from tpsim.sim.controllers.controller import Behaviour, Impedance
from tpsim.sim.controllers.minimal_intervention import MinimalIntervention
from tpsim.sim.simulation import Simulation

STEADY = 0.1
"""Standard deviation [rad] from which on a frame is too vague to lead the joints' velocity."""

STRENGTH = 0.6
"""Share of the motors' torque that springs do not exceed: the rest is left for brakes."""


class Pursuit(MinimalIntervention):
    """Minimal intervention in frames of moving objects: it damps what lags behind, not what moves.

    The joint velocity that keeps up with all frames solves, in the precisions W of their product,

        (sum_j J_j^T W_j K_j + I / STEADY^2) dq_hat = sum_j J_j^T W_j v_j,

    with the motion ``dy_j = K_j dq - v_j`` of every view. The reference moves with it from one
    solution to the next.

    Parameters
    ----------
    simulation : Simulation
        Gives the time and shows the objects.
    behaviours : sequence of Behaviour
        Their coordinates are those of :mod:`tpsim.sim.coordinates.following`.
    effort : float
        Cost r of acceleration [s^4/(kg m^2)], against the log-likelihood of the movement.
    every : int
        Control steps for which stiffness, damping and velocity last.
    """

    def __init__(
        self,
        simulation: Simulation,
        behaviours: Sequence[Behaviour],
        *,
        effort: float,
        every: int = 25,
    ):
        super().__init__(simulation.robot, behaviours, effort=effort, every=every)
        self._simulation, self._solved = simulation, None
        self._K, self._v = np.zeros_like(self._J), np.zeros_like(self._y)
        self._steady = np.eye(simulation.robot.n) / STEADY**2

    def renew(self) -> Impedance:
        """Optimum for the product of all frames at the robot's last update, moving with them."""
        now, robot = super().renew(), self.robot
        pull = now.stiffness @ (now.reference - robot.q)
        # At this speed spring and damper are in balance.
        speed = dgesv(now.damping, pull)[2]
        share = np.abs(pull) / (STRENGTH * robot.torque_limit)
        excess = max(share.max(), (np.abs(speed) / robot.velocity_limit).max())
        held = now if excess <= 1 else now.weaker(excess)
        return replace(held, velocity=self._keep_up())

    def _keep_up(self):
        """Joint velocity (n,) [rad/s] that keeps up with the frames."""
        now = self._simulation.time
        dt = 0.0 if self._solved is None else now - self._solved
        self._solved = now
        for view, rows in zip(self._evaluate, self._slices, strict=True):
            self._K[rows], self._v[rows] = view.motion(dt)
        JW = self._J.T @ self._W
        velocity = dgesv(JW @ self._K + self._steady, JW @ self._v)[2]
        limit = self.robot.velocity_limit
        return np.minimum(np.maximum(velocity, -limit), limit)
