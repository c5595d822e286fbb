"""Which way round a hand turns, and how fast, where objects claim orientations that are far apart.

From what the first object claims to what the last one does there are two ways round, by d and by
d - 2 pi d / |d|. A product of Gaussians takes the shorter one at every moment, though the hand's
own way need not be the shorter on it, joints may not be able to go there, and close to half a turn
it leaps from the one to the other. So the way round is chosen once, for the whole movement, and
gone at a speed that arms have; positions go from claim to claim, too. Joints that keep within their
limits say which way can be gone, and where the elbow is on it.
"""

import numpy as np
import pinocchio as pin

from tpsim import rotation
from tpsim.controllers.seen_poses import PARTS, POSE
from tpsim.robot.robot import Robot

EITHER = 1.0
"""Angle [rad] between claims from which on there are two ways round."""

AGREED = 1e-3
"""Distance [m] between claims below which no direction leads from the one to the other."""

SPEED = 1.5
"""How fast the hand goes over from one claim to the other [rad/s], at most."""

ROOM = 0.1
"""Distance [rad] from the joint limits that is kept in rehearsal."""

BEHIND = np.array([0.01] * 3 + [0.05] * 3)
"""How far [m], [rad] the hand may stay behind a way that the arm can follow."""

STRIDE = 4
"""Steps of the movement for each one that is looked at in joint space."""

DAMPING = 0.02
"""Singular value [m/rad] below which joints no longer follow the hand in rehearsal."""


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
    place, turn = PARTS
    d = POSE.work.log(means[0], means[-1])[:, turn]
    if np.linalg.norm(d, axis=-1).max() < EITHER:
        return [way]
    d = _continuous(d)
    # Student's t with residuals far outside of what was shown: the ratio of precisions, squared.
    known = np.square(np.trace(precisions[..., turn, turn], axis1=-2, axis2=-1))
    share = known[-1] / (known[0] + known[-1])
    positions = _from_claim_to_claim(means[..., place], precisions[..., place, place])
    found = []
    for lead in (d, _other(d)):
        ahead = np.zeros((len(way), 6))
        ahead[:, turn] = _unhurried(share, np.linalg.norm(lead, axis=-1).max(), dt)[:, None] * lead
        one = POSE.work.exp(means[0], ahead)
        one[:, :3] = positions
        found.append(one)
    return found


def _from_claim_to_claim(means: np.ndarray, precisions: np.ndarray) -> np.ndarray:
    """Positions (T, 3) among claims (P, T, 3), (P, T, 3, 3) that are far apart.

    A product settles every direction by itself: with one coordinate of this claim and another one
    of that, the hand would go where neither was ever seen, such as through a dock. Here a claim
    counts as a whole, with its precision towards the others; squared, as for orientations.
    """
    away = means - means.mean(0)
    near = np.square(AGREED)
    asked = np.vecdot(away, (precisions @ away[..., None])[..., 0])
    asked += near * np.trace(precisions, axis1=-2, axis2=-1) / 3
    worth = np.square(asked / (np.vecdot(away, away) + near))
    found: np.ndarray = (worth[..., None] * means).sum(0) / worth.sum(0)[:, None]
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
    ways: list[np.ndarray], robot: Robot, arm: slice, site: str, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The way that turns least of those that the arm can follow, or that it follows best.

    And the arm's postures (S, m) on it: far from those that were taught.
    """
    found = [rehearsed(robot, arm, site, q, way) for way in ways]
    behind = [float(np.abs(missing / BEHIND).max()) for _, missing in found]
    followed = [k for k, far in enumerate(behind) if far < 1]
    best = min(followed, key=lambda k: turned(ways[k])) if followed else int(np.argmin(behind))
    return ways[best], found[best][0]


def turned(way: np.ndarray) -> float:
    """By how much a way (T, 7) turns in all [rad]."""
    return float(np.linalg.norm(POSE.work.log(way[:-1], way[1:])[:, PARTS[1]], axis=-1).sum())


def apart(way: np.ndarray, other: np.ndarray) -> float:
    """Mean angle [rad] between two ways (T, 7)."""
    return float(np.linalg.norm(POSE.work.log(way, other)[:, PARTS[1]], axis=-1).mean())


def rehearsed(
    robot: Robot, arm: slice, site: str, q: np.ndarray, way: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Postures (S, m) of the arm on a way (T, 7) of the hand, every few steps, gone from q (n,).

    And what the hand misses there (S, 6). By damped inverse kinematics within the joint limits, the
    rest of the arm at rest: drawn to the taught posture, which turned the hand otherwise, the elbow
    went where joints lock.
    """
    q, found, missed = q.copy(), [], []
    lower, upper = robot.lower[arm] + ROOM, robot.upper[arm] - ROOM
    rotations, state = rotation.from_quaternion(way[:, 3:]), robot.at(q)

    def missing(t: int) -> np.ndarray:
        R, p = state.pose(site)
        return np.concatenate([way[t, :3] - p, pin.log3(rotations[t] @ R.T)])

    for t in [*range(0, len(way), STRIDE), len(way) - 1]:
        J = state.jacobian(site)[:, arm]
        q[arm] += _step(J, missing(t), lower - q[arm], upper - q[arm])
        state = robot.at(q)
        found.append(q[arm].copy())
        missed.append(missing(t))
    return np.array(found), np.array(missed)


def _step(J: np.ndarray, missing: np.ndarray, least: np.ndarray, most: np.ndarray) -> np.ndarray:
    """Step (m,) of joints within bounds by which a hand makes up for what it misses (6,).

    Joints that would go beyond stop there, the farthest first, and the others make up for it
    (saturation in the nullspace: Flacco, De Luca and Khatib, ICRA 2012).
    """
    step, moves = np.zeros(J.shape[1]), np.ones(J.shape[1], bool)
    while moves.any():
        A, left = J[:, moves], missing - J @ (step * ~moves)
        step[moves] = A.T @ np.linalg.solve(A @ A.T + DAMPING**2 * np.eye(6), left)
        beyond = np.maximum(step - most, least - step) * moves
        if beyond.max() <= 0:
            break
        k = int(beyond.argmax())
        step[k], moves[k] = np.clip(step[k], min(least[k], 0.0), max(most[k], 0.0)), False
    return step
