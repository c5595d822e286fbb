"""Torque control of a hand by the finite-horizon LQT, re-planned when objects move."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg.lapack import dposv

from tpsim.border import Count, Positive, border
from tpsim.control.impedance import impedance
from tpsim.control.system import integrator
from tpsim.control.unrolled import Unrolled, tracked
from tpsim.controllers.renewed import RenewedImpedance
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.product_on import placed
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import S3, R
from tpsim.manifold.product import fused
from tpsim.pose import Pose
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.robot.views.sites import SiteView, as_rotation
from tpsim.world.impedance import Impedance

LOOK = 0.1
"""Time [s] between two looks at the objects; a plan is made where one has moved."""

MOVED = 1e-5
"""Change of an object's position [m] or rotation matrix that counts as motion."""

TAIL = 0.6
"""Time [s] for which a plan goes on beyond the movement's end, which then lasts."""

STRENGTH = 0.3
"""Share of the motors' torque that springs do not exceed, as after a jump of an object."""

SINGULAR = 0.05
"""Mobility [1/kg], [1/(kg m^2)] below which the arm counts as unable to move its hand."""

PERIOD = 8
"""Time steps for which an impedance lasts by default."""

POSTURES = 40
"""Number of taught postures in which the cost of torque is computed, at least."""

HOLD = 400.0
"""Stiffness [1/s^2] of the joints that do not belong to the arm."""


POSE = R(3) * S3
"""Where the hand's pose lives."""


class FiniteHorizon(RenewedImpedance):
    """A hand carried along a movement that objects see, by finite-horizon LQT (Eqs 34-38).

    The hand's pose lives on its manifold, ``R(3) * S3``; the product of what the objects saw is
    unrolled onto a plane (:mod:`tpsim.control.unrolled`), where the pose y is a double integrator
    ``ddy = u`` with ``u_t = k_t - K_t [y, dy]``, however far it turns: stiffness and damping change
    over time with the precision of the movement. Through the arm's inertia this is torque,
    ``tau = J^T (J M^-1 J^T)^-1 u``; what is left of the arm follows the taught posture in the
    hand's nullspace (Eq. 42) by the infinite-horizon optimum. The effort is torque, ``r |tau|^2``
    in the taught postures, so that what is light is not softer than what is heavy. The plan is
    optimal for costs, M and J as they are along the taught postures; through the arm's inertia of
    the moment its stiffness need not be symmetric, and the tank bounds what that may give
    (:mod:`tpsim.world.tank`).

    Parameters
    ----------
    robot : Robot
    objects : sequence of str
        The objects that see the movement.
    movements : sequence of RiemannianGaussian (T,) on R(3) * S3
        What each of them saw of the hand, sampled at ``dt``; the end lasts.
    posture : Gaussian (T, n)
        Of the arm's joints [rad].
    joints : tuple of str
        The arm; all other joints hold still.
    site : str
        The hand.
    dt : float
        Time step of the plan [s]. No gain is faster than it: natural frequencies stay below 1/dt.
    effort : float
        Cost r of torque [1/(Nm)^2], against the log-likelihood of the movement.
    every : int
        Time steps for which stiffness, damping and the velocity of the reference last.
    """

    @border
    def __init__(
        self,
        robot: Robot,
        objects: Sequence[str],
        movements: Sequence[RiemannianGaussian],
        posture: Gaussian,
        *,
        joints: Sequence[str],
        site: str,
        dt: Positive,
        effort: Positive,
        every: Count = PERIOD,
    ):
        super().__init__(every)
        self.objects, self.movements, self.posture = tuple(objects), tuple(movements), posture
        self.joints, self.site, self.dt, self.effort = tuple(joints), site, dt, effort
        self._robot = robot
        if not joints or not movements:
            raise ArgumentError("joints and movements: give at least one of each")
        kinds = [(str(one.manifold), one.mean.shape[:-1]) for one in movements]
        if len(objects) != len(kinds) or set(kinds) != {(str(POSE), (len(movements[0].mean),))}:
            raise ArgumentError(
                f"movements are {kinds} for objects {self.objects}; give one (T,) on {POSE} for "
                "each, all of the same length"
            )
        if joints[0] not in robot.joints:
            raise ArgumentError(f"joints are {joints}; the robot has {robot.joints}")
        first = robot.joints.index(joints[0])
        self._arm = slice(first, first + len(joints))
        if robot.joints[self._arm] != tuple(joints):
            raise ArgumentError(f"joints {joints} do not follow each other on the robot")
        steps = len(movements[0].mean)
        if posture.mean.shape != (steps, len(joints)):
            raise ArgumentError(
                f"posture has means of shape {posture.mean.shape}; with these joints and movements "
                f"give ({steps}, {len(joints)})"
            )
        self._system = integrator(6, dt, exact=True)
        self._steps, self._tail = len(movements[0].mean), round(TAIL / dt)
        # The costs of torque change slowly: one posture stands for some of its neighbours.
        some = posture[:: max(1, self._steps // POSTURES)]
        near = np.linspace(0, len(some.mean) - 1, self._steps).round().astype(int)
        mass, cost = self._torques(some.mean)
        swivels = impedance(some.precision, effort * mass @ mass)
        self._swivels, self._swivel_brakes = (gains[near] for gains in swivels)
        self._costs = effort * cost[near]
        self._weakest = (STRENGTH * robot.torque_limit[self._arm]) ** -2.0
        self._rest: np.ndarray | None = None
        self._seen: np.ndarray | None = None
        self._next_look = 0.0

    def _torques(self, postures: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Inertia (T, m, m) in postures, and |tau|^2 of the hand's acceleration there.

        The latter (T, 6, 6) is ``L J J^T L`` with L the inertia that the hand feels.
        """
        robot, arm = self._robot, self._arm
        q = np.zeros(robot.n)
        masses, costs = [], []
        for posture in postures:
            q[arm] = posture
            state = robot.at(q)
            M, J = state.mass[arm, arm], state.jacobian(self.site)[:, arm]
            inertia = self._felt_inertia(M, J)
            masses.append(M)
            costs.append(inertia @ J @ J.T @ inertia)
        return np.array(masses), np.array(costs)

    @staticmethod
    def _felt_inertia(M: np.ndarray, J: np.ndarray) -> np.ndarray:
        """Inertia (6, 6) that the hand feels, bounded where the arm is singular."""
        values, V = np.linalg.eigh(J @ dposv(M, J.T)[1])
        felt: np.ndarray = (V / np.maximum(values, SINGULAR)) @ V.T
        return felt

    def renew(self, state: State, time: float) -> Impedance:
        """Impedance of this moment in joint space: from the hand's force to torques.

        Swivelling is left to the nullspace ``M - J^T L J``, in which it moves no hand.
        """
        arm = self._arm
        if self._rest is None:
            self._rest = state.q
        if time >= self._next_look:
            self._look(state, time)
        step, spring, change = self._law(time)
        place, J = self._on_plane(step, state)
        J, M = J[:, arm], state.mass
        lever = J.T @ self._felt_inertia(M[arm, arm], J)
        null = M[arm, arm] - lever @ J
        swivel = null @ self._swivels[step]
        # The other joints hold still, critically damped.
        stiffness, damping = HOLD * M, 2 * HOLD**0.5 * M
        stiffness[arm, arm] = swivel - lever @ spring[:, :6] @ J
        damping[arm, arm] = null @ self._swivel_brakes[step]
        damping[arm, arm] += lever @ self._brakes[step - self._first] @ J
        y = np.append(place, 1.0)
        pull = lever @ (spring @ y) + swivel @ (self.posture.mean[step] - state.q[arm])
        # Only what pulls is cut: the brakes must hold what it has set in motion.
        cut = max(1.0, np.sqrt(pull * pull @ self._weakest))
        stiffness[arm, arm] /= cut
        wanted = np.stack([pull, lever @ (change @ y)], axis=1) / cut
        way, speed = np.linalg.solve(stiffness[arm, arm], wanted).T
        way -= np.linalg.solve(stiffness[arm, arm], damping[arm, arm] @ speed)
        reference, velocity = self._rest.copy(), np.zeros(state.robot.n)
        reference[arm], velocity[arm] = state.q[arm] + way, speed
        return Impedance(stiffness, damping, reference, velocity)

    def _look(self, state: State, time: float) -> None:
        """Plan, if there is none or an object has moved since."""
        self._next_look = time + LOOK - 1e-9
        objects = [state.objects[name].pose for name in self.objects]
        seen = np.concatenate([part.ravel() for pose in objects for part in pose])
        if self._seen is None or np.abs(seen - self._seen).max() > MOVED:
            self._seen = seen
            self._plan(min(round(time / self.dt), self._steps - 1), objects)

    def _plan(self, first: int, poses: Sequence[Pose]) -> None:
        """Make the law from a step of the movement to its end."""
        frames = [Frame(R, p) for R, p in poses]
        means, precisions = placed([one[first:] for one in self.movements], frames)
        way, _ = fused(POSE, means, precisions)
        # The last law is that of a long horizon, since it is kept for ever.
        way, means, precisions, costs = (
            np.concatenate([part, np.repeat(part[..., -1:, :, :], self._tail, axis=-3)], axis=-3)
            for part in (way[..., None], means[..., None], precisions, self._costs[first:])
        )
        path = Unrolled.of(POSE, way[..., 0])
        effort = path.axes.mT @ costs @ path.axes
        feedback = tracked(path, means[..., 0], precisions, self._system, effort)
        kept = slice(self._steps - first + 1)
        self._first, self._path, self._brakes = first, path, feedback.gain[kept, :, 6:]
        self._springs = np.dstack([-feedback.gain[..., :6], feedback.feedforward])[kept]
        self._slopes = np.diff(self._springs, axis=0)
        self._views: dict[int, SiteView] = {}

    def _on_plane(self, step: int, state: State) -> tuple[np.ndarray, np.ndarray]:
        """Where the hand is on the plane (6,), and its Jacobian (6, n), as seen from a step."""
        t, path = step - self._first, self._path
        if t not in self._views:
            here = Pose.of_quaternion(path.points[t, :3], path.points[t, 3:])
            self._views = {t: SiteView(self.site, None, "pose", as_rotation(here.rotation))}
        seen, back = self._views[t](state), path.axes[t].T
        away = seen.value.copy()
        away[:3] -= path.points[t, :3]
        return path.plane[t] + back @ away, back @ seen.jacobian

    def _law(self, time: float) -> tuple[int, np.ndarray, np.ndarray]:
        """Step of the movement, and spring there with its rate of change, linear between steps."""
        since = time / self.dt - self._first
        k = min(max(int(since), 0), len(self._slopes) - 1)
        share = min(max(since - k, 0.0), 1.0)
        rate = self._slopes[k] / self.dt if share < 1 else np.zeros_like(self._slopes[k])
        step = min(k + self._first, self._steps - 1)
        return step, self._springs[k] + share * self._slopes[k], rate
