"""Coordinates of hands that follow moving objects in the plane, one beneath the other.

They are the candidate frames of tasks with priorities (Section 7, Fig. 11): each hand seen from
its object, Eq. (41), and each hand seen from its object through the nullspace of the other,
Eq. (44), in both orders. Which of them is precise is for the demonstrations to say.

Bound to a robot, they also tell how the view moves: ``dy = K dq - v`` while the objects move.
"""

from dataclasses import dataclass
from math import hypot

import numpy as np
from scipy.linalg.lapack import dposv

from tpsim.sim.coordinates.coordinate import Coordinate

DAMPING = 0.01
"""Singular value of a hand's Jacobian below which its nullspace grows [m/rad]."""

BEND = 0.3
"""Curvature of a hand's way as its arm stretches [m/rad^2]: the length of one link."""

FAST = 2.0
"""Speed [m/s] above which an object has jumped and is not chased."""

Motion = tuple[np.ndarray, np.ndarray]
"""K (d, n) and v (d,): how fast a view changes with the joints, and with the objects."""


@dataclass(frozen=True)
class Following(Coordinate):
    """Place of a site in the frame of a moving object, Eq. (41): d = 2, in the horizontal plane.

    Parameters
    ----------
    site : str
    target : str
        A movable object; its quaternion turns about the vertical.
    """

    site: str
    target: str

    labels = ("along [m]", "across [m]")

    def bind(self, robot):
        """Return a function that gives y (2,) and J (2, n) of the robot's last update."""
        return _Following(robot, self)


@dataclass(frozen=True)
class FollowingBeneath(Coordinate):
    """What one hand may still do for its object while another one follows its own, Eq. (44): d = 2.

    The secondary Jacobian is that of the nullspace, ``J~ N``: ``N (J~ N)^+`` is the best that the
    second hand can do. With ``N J~^+`` as printed, half a movement of the shared trunk is projected
    away and the rest leads astray (1.2 to 1.8 times the least distance on the planar body). Of the
    error e, ``y = P e`` is the part that can still be removed,

        P = G (G + BEND |e| I)^-1,    G = J~ N J~^T,

    a Newton step: a nearly stretched arm reaches only ``|J|^2 / BEND`` farther, however far the
    object is. Near its object the whole error counts.

    Parameters
    ----------
    first, second : Following
        The hand that has priority, and the one that is observed.
    """

    first: Following
    second: Following

    labels = Following.labels

    def bind(self, robot):
        """Return a function that gives y (2,) and J (2, n) of the robot's last update."""
        return _Beneath(robot, self)


@dataclass(frozen=True)
class PostureBeneathHands(Coordinate):
    """Posture of joints in the nullspace of all hands, Eq. (42): d = number of joints.

    ``q = N q + J^+ J q`` for every q, so the posture itself is its local coordinate. It adds
    ``N W N`` in joint space: how the arms are bent where the hands do not care.

    Parameters
    ----------
    joints : tuple of str
    first : tuple of Following
        The hands that have priority.
    """

    joints: tuple[str, ...]
    first: tuple[Following, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return tuple(f"{joint} [rad]" for joint in self.joints)

    def bind(self, robot):
        """Return a function that gives y (d,) and J (d, n) of the robot's last update."""
        return _Posture(robot, self)


class _Following:
    def __init__(self, robot, coordinate):
        self._robot, self._site = robot, robot.site(coordinate.site)
        self._p, self._quaternion = robot.objects[coordinate.target]
        self._was, self._drift = None, np.zeros(2)

    def _frame(self):
        """Axes (2, 2), in the rows, and origin (2,) of the object."""
        w, _, _, z = self._quaternion.tolist()
        cosine, sine = w * w - z * z, 2 * w * z
        return np.array([[cosine, sine], [-sine, cosine]]), self._p[:2].copy()

    def __call__(self):
        robot = self._robot
        self._now = axes, origin = self._frame()
        self._y = axes @ (robot.placement(self._site)[1][:2] - origin)
        self._J = axes @ robot.jacobian(self._site)[:2]
        return self._y, self._J

    def motion(self, dt: float) -> Motion:
        """K (2, n) and v (2,) for the time dt [s] to come, as long as since it was last asked."""
        (axes, origin), was = self._now, self._was
        self._was, drift = self._now, np.zeros(2)
        if was is not None and dt > 0:
            way = self._y + axes @ (origin - was[1] - was[0].T @ self._y)
            if hypot(*way.tolist()) < FAST * dt:
                drift = way / dt
        # Speed in the middle of the time to come, a whole period after the one just seen.
        ahead, self._drift = 2 * drift - self._drift, drift
        return self._J, ahead


class _Beneath:
    def __init__(self, robot, coordinate):
        self._robot, self._first = robot, robot.site(coordinate.first.site)
        self._second, self._all = coordinate.second.bind(robot), np.eye(2)

    def __call__(self):
        # A nullspace is the same from all axes: the first object need not be looked at.
        (e, J_second), J = self._second(), self._robot.jacobian(self._first)[:2]
        beneath = J_second - J_second @ J.T @ _inverse(J @ J.T, DAMPING**2) @ J
        s = DAMPING**2 + BEND * hypot(*e.tolist())
        self._free = self._all - s * _inverse(beneath @ beneath.T, s)
        return self._free @ e, beneath

    def motion(self, dt: float) -> Motion:
        """K (2, n) and v (2,) for the time dt [s] to come, as long as since it was last asked."""
        K, v = self._second.motion(dt)
        return self._free @ K, self._free @ v


class _Posture:
    def __init__(self, robot, coordinate):
        self._robot = robot
        self._first = [robot.site(hand.site) for hand in coordinate.first]
        self._index = [robot.joints.index(joint) for joint in coordinate.joints]
        self._damping = DAMPING**2 * np.eye(2 * len(self._first))
        self._rows, self._rest = np.eye(robot.n)[self._index], np.zeros(len(self._index))

    def __call__(self):
        J = np.concatenate([self._robot.jacobian(site)[:2] for site in self._first])
        lift = dposv(J @ J.T + self._damping, J)[1]
        self._N = self._rows - J[:, self._index].T @ lift
        return self._robot.q[self._index], self._N

    def motion(self, dt: float) -> Motion:
        """K (d, n) and v (d,): a posture rests."""
        return self._N, self._rest


def _inverse(G, s):
    """Inverse (2, 2) of G + s I, G symmetric; in plain numbers: LAPACK costs ten times as much."""
    (a, b), (_, c) = G.tolist()
    a, c = a + s, c + s
    determinant = a * c - b * b
    return np.array([[c, -b], [-b, a]]) / determinant
