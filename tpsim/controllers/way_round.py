"""Which way round a hand turns, and how fast, where objects claim orientations that are far apart.

From what the first object claims to what the last one does there are two ways round, by d and by
d - 2 pi d / |d|. A product of Gaussians takes the shorter one at every moment, though the hand's
own way need not be the shorter on it, joints may not be able to go there, and close to half a turn
it leaps from the one to the other. So the way round is chosen once, for the whole movement, and
gone at a speed that arms have.
"""

import numpy as np
import pinocchio as pin

from tpsim import rotation
from tpsim.controllers.seen_poses import PARTS, POSE
from tpsim.robot.robot import Robot

EITHER = 1.0
"""Angle [rad] between claims from which on there are two ways round."""

SPEED = 1.5
"""How fast the hand goes over from one claim to the other [rad/s], at most."""

ROOM = 0.1
"""Distance [rad] from the joint limits that a way is to leave."""

STRIDE = 4
"""Steps of the movement for each one that is looked at in joint space."""

DAMPING = 0.02
"""Singular value [m/rad] below which joints no longer follow the hand in rehearsal."""

EASE = 0.1
"""Share of the way to the taught posture that the rest of the arm goes with every step."""


def ways_round(
    means: np.ndarray, precisions: np.ndarray, way: np.ndarray, dt: float
) -> list[np.ndarray]:
    """Ways (T, 7) of the hand: the product of claims as it is, or both ways round.

    Parameters
    ----------
    means, precisions : (P, T, 7), (P, T, 6, 6)
        Claims of P objects over the whole movement.
    way : (T, 7)
        Means of their product.
    dt : float
        Time step [s].
    """
    turn = PARTS[1]
    d = POSE.work.log(means[0], means[-1])[:, turn]
    if np.linalg.norm(d, axis=-1).max() < EITHER:
        return [way]
    d = _continuous(d)
    # Student's t with residuals far outside of what was shown: the ratio of precisions, squared.
    known = np.square(np.trace(precisions[..., turn, turn], axis1=-2, axis2=-1))
    share = known[-1] / (known[0] + known[-1])
    found = []
    for lead in (d, _other(d)):
        ahead = np.zeros((len(way), 6))
        ahead[:, turn] = _unhurried(share, np.linalg.norm(lead, axis=-1).max(), dt)[:, None] * lead
        one = POSE.work.exp(means[0], ahead)
        one[:, :3] = way[:, :3]
        found.append(one)
    return found


def _other(d: np.ndarray) -> np.ndarray:
    """Rotation vectors (..., 3) to the same places, the other way round."""
    angle = np.maximum(np.linalg.norm(d, axis=-1, keepdims=True), 1e-9)
    return d - 2 * np.pi * d / angle


def _continuous(d: np.ndarray) -> np.ndarray:
    """Rotation vectors (T, 3) of which none goes the other way round than the one before."""
    found, others = d.copy(), _other(d)
    for t in range(1, len(d)):
        away = [np.linalg.norm(one[t] - found[t - 1]) for one in (d, others)]
        found[t] = (d, others)[int(np.argmin(away))][t]
    return found


def _unhurried(share: np.ndarray, angle: float, dt: float) -> np.ndarray:
    """Share (T,) of the turn that is made, smoothed until it is slow enough."""
    for steps in range(1, len(share), 6):
        kernel = np.hanning(steps + 2)[1:-1]
        padded = np.pad(share, (steps // 2, steps - 1 - steps // 2), "edge")
        smooth = np.convolve(padded, kernel / kernel.sum(), "valid")
        if angle * np.abs(np.diff(smooth)).max() <= SPEED * dt:
            break
    return smooth


def chosen(
    ways: list[np.ndarray], robot: Robot, arm: slice, site: str, q: np.ndarray, posture: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The way that turns least of those that joints leave room for, or leaves most room.

    And the arm's postures (S, m) on it: far from those that were taught.
    """
    found = [rehearsed(robot, arm, site, q, posture, way) for way in ways]
    lower, upper = robot.lower[arm], robot.upper[arm]
    rooms = [float(np.minimum(one - lower, upper - one).min()) for one in found]
    free = [k for k, left in enumerate(rooms) if left > ROOM]
    best = min(free, key=lambda k: turned(ways[k])) if free else int(np.argmax(rooms))
    return ways[best], found[best]


def turned(way: np.ndarray) -> float:
    """By how much a way (T, 7) turns in all [rad]."""
    return float(np.linalg.norm(POSE.work.log(way[:-1], way[1:])[:, PARTS[1]], axis=-1).sum())


def apart(way: np.ndarray, other: np.ndarray) -> float:
    """Mean angle [rad] between two ways (T, 7)."""
    return float(np.linalg.norm(POSE.work.log(way, other)[:, PARTS[1]], axis=-1).mean())


def rehearsed(
    robot: Robot, arm: slice, site: str, q: np.ndarray, posture: np.ndarray, way: np.ndarray
) -> np.ndarray:
    """Postures (S, m) of the arm on a way (T, 7) of the hand, every few steps, gone from q (n,).

    By damped inverse kinematics, the rest of the arm towards the taught posture (T, m).
    """
    q, found = q.copy(), []
    rotations = rotation.from_quaternion(way[:, 3:])
    for t in [*range(0, len(way), STRIDE), len(way) - 1]:
        state = robot.at(q)
        (R, p), J = state.pose(site), state.jacobian(site)[:, arm]
        missing = np.concatenate([way[t, :3] - p, pin.log3(rotations[t] @ R.T)])
        felt = np.linalg.solve(J @ J.T + DAMPING**2 * np.eye(6), np.c_[missing, J])
        free = EASE * (posture[t] - q[arm])
        q[arm] += J.T @ (felt[:, 0] - felt[:, 1:] @ free) + free
        found.append(q[arm].copy())
    return np.array(found)
