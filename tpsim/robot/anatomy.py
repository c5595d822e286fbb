"""Shoulders, elbows, length, strength and weight of arms, found from their mechanism."""

import numpy as np
import pinocchio as pin
from scipy.linalg.lapack import dposv

from tpsim.robot.robot import Robot
from tpsim.robot.state import State

_POSTURES = 40


def anchors(robot: Robot, site: str) -> np.ndarray:
    """Where the joints of a hand's arm turn (k, 3) at home, the first one first [m]."""
    model = robot.mechanism.model
    data = model.createData()
    pin.forwardKinematics(model, data, robot.home)
    return np.array([data.oMi[int(i) + 1].translation for i in robot.chain(site)])


def shoulder(robot: Robot, site: str) -> np.ndarray:
    """Where the arm of a hand begins (3,): the first joint that other joints do not share [m]."""
    chain = robot.chain(site)
    others = [i for s in robot.hands.values() if s != site for i in robot.chain(s)]
    own = [k for k, i in enumerate(chain) if i not in others]
    point: np.ndarray = anchors(robot, site)[own[0] if own else 0]
    return point


def length(robot: Robot, site: str) -> float:
    """Length [m] of an arm along its joints, from the first one to the hand."""
    points = np.vstack([anchors(robot, site), robot.at_home.pose(site).position])
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def elbow(robot: Robot, site: str) -> str:
    """Joint of an arm that changes most how far the hand is from the shoulder."""
    chain, rng = robot.chain(site), np.random.default_rng(0)
    low, high = (np.clip(limit, -np.pi, np.pi) for limit in (robot.lower, robot.upper))
    rates = np.zeros(len(chain))
    for q in rng.uniform(low, high, (_POSTURES, robot.n)):
        state = robot.at(q)
        way = state.pose(site).position - shoulder(robot, site)
        rates += np.abs(way @ state.jacobian(site)[:3, chain]) / np.linalg.norm(way)
    return robot.joints[chain[int(rates.argmax())]]


def strength(robot: Robot, site: str, q: np.ndarray) -> float:
    """Force [N] that the motors hold at a hand at q (n,) whatever its direction, beside gravity.

    The least over the directions of ``(limit - |gravity|)_i / |J_i|``, with J_i (3,) how joint i
    moves the hand.
    """
    state = robot.at(q)
    lever = np.linalg.norm(state.jacobian(site)[:3], axis=0)
    spare = robot.torque_limit - np.abs(state.gravity)
    held = np.divide(spare, lever, out=np.full(robot.n, np.inf), where=lever > 1e-9)
    return float(held.min())


def mobility(M: np.ndarray, J: np.ndarray) -> np.ndarray:
    """Acceleration (6, 6) of a hand by a wrench, J M^-1 J^T, for J (6, m) and M (m, m)."""
    found: np.ndarray = J @ dposv(M, J.T)[1]
    return found


def felt(state: State, site: str) -> tuple[float, float]:
    """Mass [kg] and inertia [kg m^2] that a person feels who moves, or turns, a site.

    Means over the principal directions in which it moves at all; zero where there is none.
    """
    moved, means = mobility(state.mass, state.jacobian(site)), []
    for rows in (slice(3), slice(3, 6)):
        values = np.linalg.eigvalsh(moved[rows, rows])
        moves = values[values > 1e-9 * max(values[-1], 1e-9)]
        means.append(float(np.mean(1 / moves)) if len(moves) else 0.0)
    return means[0], means[1]
