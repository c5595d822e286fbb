"""Impedance of a hand in Cartesian space, as controllers of real arms take it, within limits."""

from dataclasses import dataclass, fields

import numpy as np
import pinocchio as pin

from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.robot.state import State
from tpsim.world.impedance import Impedance, hand_stiffness

Pair = tuple[float, float]


@dataclass(frozen=True)
class CartesianLimits:
    """Bounds of Cartesian gains: a number for translation, and one for rotation.

    Parameters
    ----------
    stiffness : float, float
        Most in any direction [N/m], [Nm/rad].
    damping : float, float
        Most in any direction [Ns/m], [Nms/rad].
    stiffness_rate : float, float
        Most change in any direction [N/m/s], [Nm/rad/s]. Gains start at zero.
    damping_rate : float, float
        Most change in any direction [N/m], [Nm/rad].
    pull : float, float
        Force [N] and torque [Nm] that the spring does not exceed: targets come nearer instead.

    Raises
    ------
    ArgumentError
        If one is not positive.
    """

    stiffness: Pair = (3000.0, 300.0)
    damping: Pair = (300.0, 30.0)
    stiffness_rate: Pair = (6000.0, 600.0)
    damping_rate: Pair = (600.0, 60.0)
    pull: Pair = (60.0, 20.0)

    def __post_init__(self) -> None:
        for field in fields(self):
            pair = getattr(self, field.name)
            if len(pair) != 2 or not all(value > 0 for value in pair):
                raise ArgumentError(
                    f"{field.name} is {pair}; give two positive numbers, for translation and "
                    "for rotation"
                )


@dataclass(frozen=True, eq=False)
class HandImpedance:
    """What a Cartesian impedance controller follows, in the world's axes about the hand's site.

    The wrench is ``stiffness (target - pose) + damping (twist - velocity)``; the difference of two
    poses is that of their positions over the rotation vector ``log(R_target R^T)``.

    Parameters
    ----------
    stiffness : (6, 6)
        Translation over rotation [N/m], [Nm/rad]; symmetric, positive semi-definite.
    damping : (6, 6)
        [Ns/m], [Nms/rad]
    target : Pose
    twist : (6,)
        At which the target moves [m/s], [rad/s]; zero but for what follows moving objects.
    """

    stiffness: np.ndarray
    damping: np.ndarray
    target: Pose
    twist: np.ndarray


class HandFilter:
    """Impedance of one hand from that of the joints, step by step, within limits.

    Parameters
    ----------
    site : str
    limits : CartesianLimits
    """

    def __init__(self, site: str, limits: CartesianLimits):
        self._site, self._limits = site, limits
        self._stiffness = self._damping = np.zeros((6, 6))

    def follow(self, now: Impedance, state: State, since: float, period: float) -> HandImpedance:
        """Impedance of the hand at a state.

        Parameters
        ----------
        now : Impedance
            That of the joints.
        state : State
        since : float
            Time [s] since ``now`` was commanded: its reference has moved on.
        period : float
            Time [s] since the last call, for the rates.
        """
        J, limits = state.jacobian(self._site), self._limits
        K = _below(_symmetric(hand_stiffness(J, now.stiffness)), limits.stiffness)
        D = _below(_symmetric(hand_stiffness(J, now.damping)), limits.damping)
        self._stiffness = _nearer(self._stiffness, K, limits.stiffness_rate, period)
        self._damping = _nearer(self._damping, D, limits.damping_rate, period)
        velocity = np.zeros(len(state.q)) if now.velocity is None else now.velocity
        way = J @ (now.reference + since * velocity - state.q)
        pull = self._stiffness @ way
        share = max(
            np.linalg.norm(pull[:3]) / limits.pull[0], np.linalg.norm(pull[3:]) / limits.pull[1]
        )
        way = way / max(1.0, float(share))
        R, p = state.pose(self._site)
        target = Pose(pin.exp3(way[3:]) @ R, p + way[:3])
        return HandImpedance(self._stiffness, self._damping, target, J @ velocity)


def _symmetric(K: np.ndarray) -> np.ndarray:
    return 0.5 * (K + K.T)


def _roots(bound: Pair) -> np.ndarray:
    """Square roots (6,) of the bounds of every axis."""
    return np.sqrt(np.repeat(bound, 3))


def _below(K: np.ndarray, bound: Pair) -> np.ndarray:
    """K (6, 6) with no direction stiffer than its bound, and none that pushes away."""
    s = _roots(bound)
    values, V = np.linalg.eigh(K / np.outer(s, s))
    if values[0] >= 0 and values[-1] <= 1:
        return K
    clipped = (V * np.clip(values, 0, 1)) @ V.T
    return _symmetric(clipped * np.outer(s, s))


def _nearer(before: np.ndarray, K: np.ndarray, rate: Pair, period: float) -> np.ndarray:
    """From one spring as far towards another as the rate allows; between two is a spring, too."""
    s, change = _roots(rate), K - before
    fastest = np.abs(np.linalg.eigvalsh(change / np.outer(s, s))).max()
    return K if fastest <= period else before + period / fastest * change
