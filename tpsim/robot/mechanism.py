"""A robot as its controllers know it: kinematics, dynamics and limits, without a simulator."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

RUBBING = 0.05
"""Speed [rad/s] about which friction is compensated: below it, less of it is."""


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Arms of hinges and slides; n joints.

    Parameters
    ----------
    model : pinocchio.Model
        Its q (n,) and v (n,) are the joints in their order; armature is included.
    sites : dict of str to int
        Pinocchio's frame id of every site that the robot carries, and of those in the world.
    joints, hands, lower, upper, velocity_limit, torque_limit, home, damping, friction
        As :class:`tpsim.robot.robot.Robot` has them.
    springs, slack : (n,)
        Stiffness [Nm/rad] of the joints' own springs, and where they are slack [rad].
    """

    model: pin.Model
    sites: dict[str, int]
    joints: tuple[str, ...]
    hands: dict[str, str]
    lower: np.ndarray
    upper: np.ndarray
    velocity_limit: np.ndarray
    torque_limit: np.ndarray
    home: np.ndarray
    damping: np.ndarray
    friction: np.ndarray
    springs: np.ndarray
    slack: np.ndarray
