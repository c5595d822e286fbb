"""Torque controllers: minimal intervention from learned precision, and fixed gains to compare.

The torque law is ``tau = K (q_hat - q) - D dq + bias(q, dq)``; the controllers differ in where
q_hat, K and D come from.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dsyevd

from tpsim.errors import ArgumentError, SimulationError
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim.coordinate import Coordinate, Posture
from tpsim.sim.guard import guard
from tpsim.sim.robot import Robot


@dataclass(frozen=True)
class Behaviour:
    """What was taught: a TP-GMM and the coordinates that its frames observe.

    Parameters
    ----------
    name : str
    coordinates : tuple of Coordinate
        One for each frame of the model.
    model : TPGMM
    """

    name: str
    coordinates: tuple[Coordinate, ...]
    model: TPGMM

    def __post_init__(self):
        if len(self.coordinates) != len(self.model.frames):
            raise ArgumentError(
                f"behaviour '{self.name}' has {len(self.coordinates)} coordinates for "
                f"{len(self.model.frames)} frames; give one for each"
            )


@dataclass(frozen=True)
class Impedance:
    """What a controller commands at one instant, in joint space.

    ``stiffness`` (n, n) [Nm/rad] and ``damping`` (n, n) [Nms/rad] are what a push meets;
    ``reference`` (n,) is q_hat [rad].
    """

    stiffness: np.ndarray
    damping: np.ndarray
    reference: np.ndarray


class Controller:
    """What drives the robot: joint torques after each ``robot.update``, and their impedance.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot):
        self.robot = robot
        self.feedforward = np.zeros(robot.n)

    def feedback(self) -> np.ndarray:
        """Torque (n,) [Nm] against error and velocity at the robot's last update."""
        raise NotImplementedError

    def impedance(self) -> Impedance:
        """Stiffness, damping and reference of the last command."""
        raise NotImplementedError

    def torque(self) -> np.ndarray:
        """Joint torque (n,) [Nm] wanted, before the motors' limits.

        ``feedforward`` keeps the part that is not feedback: bias and the joints' own damping.
        """
        robot = self.robot
        self.feedforward = robot.bias + robot.passive_damping * robot.dq
        return self.feedback() + guard(robot) + self.feedforward


class MinimalIntervention(Controller):
    """Infinite-horizon LQT in joint space over all frames of all behaviours (Sections 6 and 7).

    The Gaussians of every frame are projected into joint space by Table 3 and multiplied in
    information form, Eqs (5)-(6): ``Lambda = sum_j J_j^T W_j J_j``. Behaviours that were taught
    apart are combined by the same product, as in the last sequence of Fig. 9.

    The effort that is weighed against it is torque, ``r |tau|^2`` with ``tau = M ddq``. In
    ``z = M q`` this is a unit double integrator of precision ``Lambda_z = M^-1 Lambda M^-1``,
    whose optimum is closed form, ``K_z = (Lambda_z / r)^(1/2)``, ``D_z = (2 K_z)^(1/2)``: one
    symmetric eigendecomposition a step gives ``tau = K_z M (q_hat - q) - D_z M dq + bias``.
    Weighing torque, and not acceleration, keeps heavy directions as soft as light ones.

    Parameters
    ----------
    robot : Robot
    behaviours : sequence of Behaviour
    effort : float
        Cost r of torque [1/(Nm)^2], against the log-likelihood of the movement.
    prior : Gaussian, optional
        Joint posture (n,) for directions that no frame determines.
    """

    def __init__(
        self,
        robot: Robot,
        behaviours: Sequence[Behaviour],
        *,
        effort: float = 0.2,
        prior: Gaussian | None = None,
    ):
        if not behaviours:
            raise ArgumentError("no behaviour was given; give at least one")
        if not effort > 0:
            raise ArgumentError(f"effort is {effort}; it must be positive")
        super().__init__(robot)
        self.effort = float(effort)
        experts = [(b.coordinates, b.model.priors, b.model.frames) for b in behaviours]
        if prior is not None:
            posture = (Posture("prior", robot.joints),)
            frame = Gaussian(np.atleast_2d(prior.mean), prior.covariance[None])
            experts.append((posture, np.ones(1), (frame,)))
        coordinates = list(dict.fromkeys(c for group, _, _ in experts for c in group))
        self._evaluate = [c.bind(robot) for c in coordinates]
        robot.update(robot.lower.clip(-1, 1) * 0, np.zeros(robot.n))
        sizes = [evaluate()[0].size for evaluate in self._evaluate]
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
        self._check_determined()

    def _check_determined(self):
        self._solve()
        if self._eigenvalues[0] > 1e-9 * self._eigenvalues[-1]:
            return
        weakest = np.argmax(np.abs(self._eigenvectors[:, 0]))
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
            W, Wmu = (sum(terms) for terms in zip(*self._information(), strict=True))
        else:
            W, Wmu = self._fixed
        inverse_mass = self.robot.inverse_mass()
        Jz = self._J @ inverse_mass
        JW = Jz.T @ W
        self._gradient = Jz.T @ Wmu - JW @ self._y
        precision = JW @ Jz
        # LAPACK directly: numpy's wrapper costs a third of the call at this size.
        self._eigenvalues, self._eigenvectors, failed = dsyevd(precision.T, overwrite_a=1)
        if failed:
            raise SimulationError("the precision of the frames has no eigendecomposition")

    def feedback(self) -> np.ndarray:
        """Torque (n,) [Nm] against error and velocity at the robot's last update."""
        self._solve()
        V, root = self._eigenvectors, np.sqrt(self._eigenvalues)
        r = np.sqrt(self.effort)
        # K_z M (q_hat - q) = K_z Lambda_z^-1 M^-1 g in the eigenbasis of Lambda_z.
        pull = (V.T @ self._gradient) / (r * root)
        brake = np.sqrt(2 * root / r) * (V.T @ (self.robot.mass @ self.robot.dq))
        return V @ (pull - brake)

    def impedance(self) -> Impedance:
        """Stiffness, damping and reference of the last :meth:`feedback`."""
        V, values, mass = self._eigenvectors, self._eigenvalues, self.robot.mass
        step = V @ ((V.T @ self._gradient) / values)
        gains = torque_optimal(values, V, mass, self.effort)
        return Impedance(*gains, self.robot.q + np.linalg.solve(mass, step))


def torque_optimal(eigenvalues, V, mass, effort) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness K_z M and damping D_z M (n, n) of the optimum of :class:`MinimalIntervention`.

    Parameters
    ----------
    eigenvalues, V : (n,), (n, n)
        Of the precision ``Lambda_z = M^-1 Lambda M^-1``.
    mass : (n, n)
        M(q).
    effort : float
        Cost r of torque [1/(Nm)^2].
    """
    stiffness, right = np.sqrt(eigenvalues / effort), V.T @ mass
    return (V * stiffness) @ right, (V * np.sqrt(2 * stiffness)) @ right


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


class FixedImpedance(Controller):
    """The same torque law with constant gains about a constant posture: the usual impedance.

    Parameters
    ----------
    robot : Robot
    posture : (n,)
        Reference q_hat [rad].
    stiffness : float
        Of every joint, as acceleration [1/s^2]: K = stiffness M(q), critically damped.
    """

    def __init__(self, robot: Robot, posture, stiffness: float):
        if not stiffness >= 0:
            raise ArgumentError(f"stiffness is {stiffness}; it must not be negative")
        super().__init__(robot)
        self.posture, self.stiffness = np.array(posture), float(stiffness)

    def feedback(self) -> np.ndarray:
        """Torque (n,) [Nm] against error and velocity at the robot's last update."""
        robot, rate = self.robot, self.stiffness**0.5
        return robot.mass @ (rate**2 * (self.posture - robot.q) - 2 * rate * robot.dq)

    def impedance(self) -> Impedance:
        """Stiffness, damping and reference."""
        mass = self.robot.mass
        return Impedance(self.stiffness * mass, 2 * self.stiffness**0.5 * mass, self.posture)


class GravityCompensation(Controller):
    """Weightless arms for kinesthetic teaching: gravity torque, light damping, no stiffness.

    Parameters
    ----------
    robot : Robot
    damping : float
        Of every joint [Nms/rad]: without it the elbow swings.
    held : tuple of str
        Joints that are not taught and hold still.
    posture : (n,), optional
        Where the held joints are held [rad].
    """

    def __init__(self, robot: Robot, *, damping: float = 0.5, held=(), posture=None):
        super().__init__(robot)
        self._held = np.array([joint in held for joint in robot.joints])
        self._hold = FixedImpedance(robot, np.zeros(robot.n) if posture is None else posture, 400)
        self._damping = damping

    def torque(self) -> np.ndarray:
        """Joint torque (n,) [Nm]."""
        robot = self.robot
        self.feedforward = robot.gravity_torque(robot.q)
        torque = self.feedforward - self._damping * robot.dq
        if self._held.any():
            hold = self._hold.feedback() + robot.bias
            torque = np.where(self._held, hold, torque)
        return torque

    def impedance(self) -> Impedance:
        """No stiffness, light damping."""
        n = self.robot.n
        return Impedance(np.zeros((n, n)), self._damping * np.eye(n), self.robot.q)


def hand_stiffness(robot: Robot, stiffness, site: int) -> np.ndarray:
    """Physical stiffness (6, 6) at a site, from joint stiffness (n, n) [Nm/rad].

    ``(J K^-1 J^T)^-1``: what a slow push at the site meets, N/m and Nm/rad, when the rest of
    the arm is free to give way.
    """
    J = robot.jacobian(site)
    if not stiffness.any():
        return np.zeros((6, 6))
    return np.linalg.inv(J @ np.linalg.solve(stiffness, J.T))
