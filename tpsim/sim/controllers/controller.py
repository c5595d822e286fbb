"""Torque controllers: what they share, fixed gains to compare with, and weightlessness.

The torque law is ``tau = K (q_hat - q) + D (dq_hat - dq) + bias(q, dq)``; the controllers differ
in where q_hat, dq_hat, K and D come from.
"""

from dataclasses import dataclass, replace

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim.controllers.guard import Guard
from tpsim.sim.coordinates.coordinate import Coordinate
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
    ``reference`` (n,) is q_hat [rad], and ``velocity`` (n,) is dq_hat [rad/s], none for rest.
    """

    stiffness: np.ndarray
    damping: np.ndarray
    reference: np.ndarray
    velocity: np.ndarray | None = None

    @classmethod
    def of_modes(cls, modes, stiffness, reference) -> "Impedance":
        """Optimum of unit double integrators: damping is the root of twice the stiffness.

        Parameters
        ----------
        modes : (n, n)
            In the columns; with M = modes modes^T they are independent unit masses.
        stiffness : (n,)
            Of each mode [1/s^2].
        reference : (n,)
            Posture [rad].
        """
        damping = np.sqrt(2 * stiffness)
        return cls((modes * stiffness) @ modes.T, (modes * damping) @ modes.T, reference)

    def weaker(self, factor: float) -> "Impedance":
        """The same with springs that pull less by a factor: the damper holds what they move."""
        return replace(self, stiffness=self.stiffness / factor)


class Controller:
    """What drives the robot: joint torques after each ``robot.update``, and their impedance.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot):
        self.robot, self._guard = robot, Guard(robot)

    def feedback(self) -> np.ndarray:
        """Torque (n,) [Nm] against error and velocity at the robot's last update."""
        raise NotImplementedError

    def impedance(self) -> Impedance:
        """Stiffness, damping and reference of the last command."""
        raise NotImplementedError

    @property
    def feedforward(self) -> np.ndarray:
        """Torque (n,) [Nm] that is not feedback: bias and the joints' own damping."""
        robot = self.robot
        return robot.bias + robot.passive_damping * robot.dq

    def torque(self) -> np.ndarray:
        """Joint torque (n,) [Nm] wanted, before the motors' limits."""
        torque = self.feedback() + self.feedforward
        return torque + self._guard.torque() if self._guard.wakes() else torque


class RenewedImpedance(Controller):
    """An impedance that lasts for some steps, while the torque follows the state at every one.

    A reference that moves goes on at its velocity meanwhile. Who derives from this says what the
    impedance is: :meth:`renew`.

    Parameters
    ----------
    robot : Robot
    every : int
        Time steps for which an impedance lasts.
    """

    def __init__(self, robot: Robot, every: int):
        super().__init__(robot)
        self._every, self._left, self._timestep = every, 0, robot.model.opt.timestep

    def renew(self) -> Impedance:
        """Impedance from the robot's last update on."""
        raise NotImplementedError

    def feedback(self) -> np.ndarray:
        """Torque (n,) [Nm] against error and velocity at the robot's last update."""
        if self._left == 0:
            self._left = self._every
            self._begin(self.renew())
        elif self._lead is not None:
            self._wanted = self._wanted + self._lead
        self._left -= 1
        # For a matrix so small, @ costs twice as much.
        return self._wanted - self._gain.dot(self.robot.state)

    def _begin(self, now):
        self._now, self._gain = now, np.concatenate((now.stiffness, now.damping), axis=1)
        self._wanted, self._lead = now.stiffness @ now.reference, None
        if now.velocity is not None:
            self._wanted += now.damping @ now.velocity
            self._lead = now.stiffness @ (self._timestep * now.velocity)

    def impedance(self) -> Impedance:
        """Stiffness, damping and reference of the last :meth:`feedback`."""
        return self._now


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

    @property
    def feedforward(self) -> np.ndarray:
        """Torque (n,) [Nm] of gravity."""
        return self.robot.gravity_torque(self.robot.q)

    def torque(self) -> np.ndarray:
        """Joint torque (n,) [Nm]."""
        robot = self.robot
        torque = self.feedforward - self._damping * robot.dq
        if self._held.any():
            hold = self._hold.feedback() + robot.bias
            torque = np.where(self._held, hold, torque)
        return torque

    def impedance(self) -> Impedance:
        """No stiffness, light damping."""
        n = self.robot.n
        return Impedance(np.zeros((n, n)), self._damping * np.eye(n), self.robot.q)


def hand_stiffness(J, stiffness) -> np.ndarray:
    """Physical stiffness (..., 6, 6) of a hand, from joint stiffness (..., n, n) [Nm/rad].

    ``(J K^-1 J^T)^-1`` with the hand's Jacobian J (..., 6, n): what a slow push meets, N/m and
    Nm/rad, when the rest of the arm is free to give way. Without stiffness it is zero.
    """
    J, stiffness = np.asarray(J), np.asarray(stiffness)
    felt = np.zeros((*J.shape[:-2], 6, 6))
    stiff = stiffness.any(axis=(-1, -2))
    compliance = J[stiff] @ np.linalg.solve(stiffness[stiff], J[stiff].mT)
    felt[stiff] = np.linalg.inv(compliance)
    return felt
