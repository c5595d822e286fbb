"""Minimal intervention: the learned precision of all frames, as torque."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg.lapack import dpotrf, dsyevd, dtrtrs

from tpsim.errors import ArgumentError, SimulationError
from tpsim.gaussian import Gaussian
from tpsim.sim.controllers.controller import Behaviour, Impedance, RenewedImpedance
from tpsim.sim.coordinates.coordinate import Posture
from tpsim.sim.robot import Robot


class MinimalIntervention(RenewedImpedance):
    """Infinite-horizon LQT in joint space over all frames of all behaviours (Sections 6 and 7).

    The Gaussians of every frame are projected into joint space by Table 3 and multiplied in
    information form, Eqs (5)-(6): ``Lambda = sum_j J_j^T W_j J_j``. Behaviours that were taught
    apart are combined by the same product, as in the last sequence of Fig. 9.

    The effort that is weighed against it is acceleration in the metric of the arm's own inertia,
    ``r ddq^T M ddq``. With M = L L^T the arm is a unit double integrator in ``z = L^T q``, of
    precision ``Lambda_z = L^-1 Lambda L^-T``, whose optimum is closed form,
    ``K_z = (Lambda_z / r)^(1/2)`` and ``D_z = (2 K_z)^(1/2)``: one symmetric eigendecomposition a
    step gives ``tau = L [ K_z L^T (q_hat - q) - D_z L^T dq ] + bias``. The gains do not depend on
    the choice of joint coordinates, the stiffness ``L K_z L^T`` is symmetric, a spring that gives
    back what it takes, and all modes are damped alike.

    Parameters
    ----------
    robot : Robot
    behaviours : sequence of Behaviour
    effort : float
        Cost r of acceleration [s^4/(kg m^2)], against the log-likelihood of the movement.
    prior : Gaussian, optional
        Joint posture (n,) for directions that no frame determines.
    every : int
        Control steps for which stiffness, damping and reference last; the torque follows the
        robot's state at every step.
    """

    def __init__(
        self,
        robot: Robot,
        behaviours: Sequence[Behaviour],
        *,
        effort: float = 0.2,
        prior: Gaussian | None = None,
        every: int = 8,
    ):
        if not behaviours:
            raise ArgumentError("no behaviour was given; give at least one")
        if not effort > 0:
            raise ArgumentError(f"effort is {effort}; it must be positive")
        super().__init__(robot, every)
        self.effort = float(effort)
        experts = [(b.coordinates, b.model.priors, b.model.frames) for b in behaviours]
        if prior is not None:
            posture = (Posture("prior", robot.joints),)
            frame = Gaussian(np.atleast_2d(prior.mean), prior.covariance[None])
            experts.append((posture, np.ones(1), (frame,)))
        coordinates = list(dict.fromkeys(c for group, _, _ in experts for c in group))
        self._evaluate = [c.bind(robot) for c in coordinates]
        dims = {
            c: f.dim for group, _, frames in experts for c, f in zip(group, frames, strict=True)
        }
        sizes = [dims[c] for c in coordinates]
        ends = np.cumsum(sizes)
        self._slices = [slice(e - s, e) for s, e in zip(sizes, ends, strict=True)]
        where = dict(zip(coordinates, self._slices, strict=True))
        self._mixtures = [_Mixture(*expert, where, int(ends[-1])) for expert in experts]
        self._y = np.zeros(ends[-1])
        self._J = np.zeros((ends[-1], robot.n))
        if all(mixture.single for mixture in self._mixtures):
            self._fixed = tuple(sum(terms) for terms in zip(*self._information(), strict=True))
        else:
            self._fixed = None
        self._checked = False

    def _check_determined(self):
        self._checked = True
        if self._eigenvalues[0] > 1e-9 * self._eigenvalues[-1]:
            return
        weakest = np.argmax(np.abs(dtrtrs(self._L, self._V[:, 0], lower=1, trans=1)[0]))
        raise ArgumentError(
            f"no frame determines the motion of joint '{self.robot.joints[weakest]}'; "
            "give a prior Gaussian on the joint posture"
        )

    def _information(self):
        return [mixture.information(self._y) for mixture in self._mixtures]

    def _solve(self):
        for evaluate, rows in zip(self._evaluate, self._slices, strict=True):
            self._y[rows], self._J[rows] = evaluate()
        if self._fixed is None:
            self._W, Wmu = (sum(terms) for terms in zip(*self._information(), strict=True))
        else:
            self._W, Wmu = self._fixed
        self._L = dpotrf(self.robot.mass, lower=1)[0]
        # (J L^-T)^T: the Jacobian with respect to z.
        Jz = dtrtrs(self._L, self._J.T, lower=1)[0]
        JW = Jz @ self._W
        gradient = Jz @ Wmu - JW @ self._y
        # LAPACK directly: numpy's wrapper costs a third of the call at this size.
        self._eigenvalues, self._V, failed = dsyevd(JW @ Jz.T, overwrite_a=1)
        if failed:
            raise SimulationError("the precision of the frames has no eigendecomposition")
        if not self._checked:
            self._check_determined()
        # At a singular posture a frame may lose its last direction: no pull there, not infinity.
        np.maximum(self._eigenvalues, 1e-9 * self._eigenvalues[-1], out=self._eigenvalues)
        # Way to the optimum of each mode: Lambda_z^-1 times the gradient.
        self._way = (self._V.T @ gradient) / self._eigenvalues

    def renew(self) -> Impedance:
        """Optimum for the product of all frames at the robot's last update."""
        self._solve()
        way = dtrtrs(self._L, self._V @ self._way, lower=1, trans=1)[0]
        stiffness = np.sqrt(self._eigenvalues / self.effort)
        return Impedance.of_modes(self._L @ self._V, stiffness, self.robot.q + way)


class _Mixture:
    """One behaviour's precisions, laid out over the stacked coordinates of the controller."""

    def __init__(self, coordinates, priors, frames, where, size):
        K = len(priors)
        self.single = K == 1
        self._W = np.zeros((K, size, size))
        self._mu = np.zeros((K, size))
        self._bias = np.log(priors)
        for coordinate, gaussian in zip(coordinates, frames, strict=True):
            rows = where[coordinate]
            self._W[:, rows, rows] = gaussian.precision
            self._mu[:, rows] = gaussian.mean
            self._bias = self._bias + 0.5 * np.linalg.slogdet(gaussian.precision)[1]
        self._Wmu = np.einsum("kab,kb->ka", self._W, self._mu)

    def information(self, y):
        """Precision and information vector at the stacked observation y: Eq. (49) mixes them."""
        if self.single:
            return self._W[0], self._Wmu[0]
        e = y - self._mu
        h = self._bias - 0.5 * np.einsum("ka,kab,kb->k", e, self._W, e)
        h = np.exp(h - h.max())
        h /= h.sum()
        return np.tensordot(h, self._W, 1), h @ self._Wmu
