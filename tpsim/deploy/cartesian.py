"""Impedance of a hand in Cartesian space, as controllers of real arms take it, within limits."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from tpsim.border import Positive, checked
from tpsim.covariance import symmetric
from tpsim.pose import Pose
from tpsim.robot.state import State
from tpsim.world.impedance import Impedance, compliance, hand_stiffness

Pair = tuple[Positive, Positive]


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
        checked(self)


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
        At which the target moves [m/s], [rad/s]; zero for one hand that follows nothing moving.
    """

    stiffness: np.ndarray
    damping: np.ndarray
    target: Pose
    twist: np.ndarray


class HandFilter:
    """Impedances of all hands from that of the joints, step by step, within limits.

    The joints' impedance also ties hands to each other, which controllers of separate arms cannot
    do: every stiffness is that of a hand while the other hands are held and the rest gives way,
    and what the other hands ask of it moves its target and its twist.

    Parameters
    ----------
    hands : mapping of str to str
        Site of each hand.
    limits : CartesianLimits
    """

    def __init__(self, hands: Mapping[str, str], limits: CartesianLimits):
        self._sites, self._limits = dict(hands), limits
        self._gains = {hand: (np.zeros((6, 6)), np.zeros((6, 6))) for hand in hands}

    def follow(
        self, now: Impedance, state: State, since: float, period: float
    ) -> dict[str, HandImpedance]:
        """Impedance of every hand at a state.

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
        J = np.array([state.jacobian(site) for site in self._sites.values()])
        velocity = np.zeros(len(state.q)) if now.velocity is None else now.velocity
        springs, ways = _own(J, now.stiffness, now.reference + since * velocity - state.q)
        dampers, lags = _own(J, now.damping, velocity - state.dq)
        found = {}
        for h, (hand, site) in enumerate(self._sites.items()):
            K, D = self._limited(hand, springs[h], dampers[h], period)
            way = ways[h] / max(1.0, self._excess(K @ ways[h]))
            R, p = state.pose(site)
            target = Pose(pin.exp3(way[3:]) @ R, p + way[:3])
            found[hand] = HandImpedance(K, D, target, lags[h] + J[h] @ state.dq)
        return found

    def _limited(
        self, hand: str, K: np.ndarray, D: np.ndarray, period: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Stiffness and damping of a hand, within limits and rates."""
        limits, (K_before, D_before) = self._limits, self._gains[hand]
        K, D = _below(symmetric(K), limits.stiffness), _below(symmetric(D), limits.damping)
        K = _nearer(K_before, K, limits.stiffness_rate, period)
        D = _nearer(D_before, D, limits.damping_rate, period)
        self._gains[hand] = K, D
        return K, D

    def _excess(self, pull: np.ndarray) -> float:
        """How many times a wrench is larger than it may be."""
        force, torque = np.linalg.norm(pull[:3]), np.linalg.norm(pull[3:])
        return float(max(force / self._limits.pull[0], torque / self._limits.pull[1]))


def _own(J: np.ndarray, gains: np.ndarray, change: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gains (H, 6, 6) of each hand, and the change (H, 6) at which they make its wrench.

    Together the hands J (H, 6, n) meet ``G = (J gains^-1 J^T)^-1``, all blocks of it, and the
    wrench ``F = G J change``. Hand h alone, with the others held, has G_hh, and makes its part of
    the wrench at ``G_hh^+ F_h``. For one hand that is its own motion.
    """
    if len(J) == 1:
        return hand_stiffness(J[0], gains)[None], J @ change
    own, changes = np.zeros((len(J), 6, 6)), np.zeros((len(J), 6))
    if not gains.any():
        return own, changes
    stacked = J.reshape(-1, J.shape[-1])
    G = np.linalg.pinv(compliance(stacked, gains), rcond=1e-12, hermitian=True)
    wrench = G @ (stacked @ change)
    for h in range(len(J)):
        rows = slice(6 * h, 6 * h + 6)
        own[h] = G[rows, rows]
        changes[h] = np.linalg.pinv(own[h], rcond=1e-9, hermitian=True) @ wrench[rows]
    return own, changes


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
    return symmetric(clipped * np.outer(s, s))


def _nearer(before: np.ndarray, K: np.ndarray, rate: Pair, period: float) -> np.ndarray:
    """From one spring as far towards another as the rate allows; between two is a spring, too."""
    s, change = _roots(rate), K - before
    fastest = np.abs(np.linalg.eigvalsh(change / np.outer(s, s))).max()
    return K if fastest <= period else before + period / fastest * change
