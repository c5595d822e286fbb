"""Torque controllers: what they share, fixed gains to compare with, and weightlessness.

The torque law is ``tau = K (q_hat - q) - D dq + bias(q, dq)``; the controllers differ in where
q_hat, K and D come from.
"""

from dataclasses import dataclass

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim.coordinate import Coordinate
from tpsim.sim.guard import Guard
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
        self.robot, self._guard = robot, Guard(robot)
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
        return self.feedback() + self._guard.torque() + self.feedforward


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
