"""Torque control of a hand by the finite-horizon LQT, re-planned when objects move."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg.lapack import dposv

from tpsim import rotation
from tpsim.border import Positive, border
from tpsim.control.impedance import impedance
from tpsim.control.poses import SeenMovement, fuse_poses, track_poses
from tpsim.control.system import integrator
from tpsim.controllers.progress import ByState
from tpsim.controllers.renewed import RenewedImpedance
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.semi_markov import SemiMarkovChain
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

PERIOD = 0.008
"""Time for which an impedance lasts by default [s]."""

POSTURES = 40
"""Number of taught postures in which the cost of torque is computed, at least."""

HOLD = 400.0
"""Stiffness [1/s^2] of the joints that do not belong to the arm."""


def effort_of(robot: Robot, joints: tuple[str, ...]) -> float:
    """Cost of torque [1/(Nm)^2] with which a usual deviation is worth all that springs may pull.

    ``1 / (STRENGTH limit)^2``, the mean over the motors of some joints.
    """
    pulls = STRENGTH * robot.torque_limit[robot.index(joints)]
    return float(np.mean(pulls**-2.0))


class FiniteHorizon(RenewedImpedance):
    """A hand carried along a movement that objects see, by finite-horizon LQT (Eqs 34-38).

    The hand's pose y, six coordinates in a chart about its last orientation, is a double
    integrator ``ddy = u`` with ``u_t = k_t - K_t [y, dy]``: stiffness and damping change over time
    with the precision of the movement. Through the arm's inertia this is torque,
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
        The objects that see the movement; the chart is the last one's.
    movements : sequence of SeenMovement
        One for each, sampled at ``dt``; the end lasts.
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
    period : float
        Time for which an impedance lasts [s].
    chain : SemiMarkovChain, optional
        Of the movement's states, with durations in steps of ``dt`` that add up to it. Progress is
        then inferred from the hand: held it stands still, pushed on it hurries. By default the
        clock says how far the movement has come.

    What is known of an object's pose up to a covariance counts for less, and what was not seen at
    all for nothing: the movement then goes by the other objects. The arm holds still until one
    of them is seen.
    """

    @border
    def __init__(
        self,
        robot: Robot,
        objects: Sequence[str],
        movements: Sequence[SeenMovement],
        posture: Gaussian,
        *,
        joints: Sequence[str],
        site: str,
        dt: Positive,
        effort: Positive,
        period: Positive = PERIOD,
        chain: SemiMarkovChain | None = None,
    ):
        super().__init__(period)
        self.objects, self.movements, self.posture = tuple(objects), tuple(movements), posture
        self.joints, self.site, self.dt, self.effort = tuple(joints), site, dt, effort
        self._robot = robot
        if not joints or not movements:
            raise ArgumentError("joints and movements: give at least one of each")
        if joints[0] not in robot.joints:
            raise ArgumentError(f"joints are {joints}; the robot has {robot.joints}")
        first = robot.joints.index(joints[0])
        self._arm = slice(first, first + len(joints))
        if robot.joints[self._arm] != tuple(joints):
            raise ArgumentError(f"joints {joints} do not follow each other on the robot")
        if posture.mean.shape[1:] != (len(joints),) or len(posture.mean) != len(movements[0]):
            raise ArgumentError(
                f"posture has means of shape {posture.mean.shape}; with these joints and movements "
                f"give ({len(movements[0])}, {len(joints)})"
            )
        if chain is not None and round(float(chain.durations.mean.sum())) != len(posture.mean):
            raise ArgumentError(
                f"stays of the chain add up to {chain.durations.mean.sum():g} steps and the "
                f"movement has {len(posture.mean)}; give SemiMarkovChain.along(its states)"
            )
        self.chain = chain
        self._progress = None if chain is None else ByState(chain, dt)
        self._system = integrator(6, dt, exact=True)
        self._steps, self._tail = len(movements[0]), round(TAIL / dt)
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
        if self._seen is None:  # nothing that the movement could go by was seen yet
            mass = state.mass
            return Impedance(HOLD * mass, 2 * HOLD**0.5 * mass, self._rest)
        seen = self._view(state)
        J, M = seen.jacobian[:, arm], state.mass
        when = time if self._progress is None else self._progress.at(state, time)[0]
        step, spring = self._law(when)
        lever = J.T @ self._felt_inertia(M[arm, arm], J)
        null = M[arm, arm] - lever @ J
        swivel = null @ self._swivels[step]
        # The other joints hold still, critically damped.
        stiffness, damping = HOLD * M, 2 * HOLD**0.5 * M
        stiffness[arm, arm] = swivel - lever @ spring[:, :6] @ J
        damping[arm, arm] = null @ self._swivel_brakes[step]
        damping[arm, arm] += lever @ self._brakes[step - self._first] @ J
        y = np.append(seen.value, 1.0)
        pull = lever @ (spring @ y) + swivel @ (self.posture.mean[step] - state.q[arm])
        # Only what pulls is cut: the brakes must hold what it has set in motion.
        cut = max(1.0, np.sqrt(pull * pull @ self._weakest))
        stiffness[arm, arm] /= cut
        reference = self._rest.copy()
        # How the pull changes within a period is left out: where springs are soft, a reference that
        # moves would hold many times the energy of the movement.
        reference[arm] = state.q[arm] + np.linalg.solve(stiffness[arm, arm], pull / cut)
        return Impedance(stiffness, damping, reference)

    def _look(self, state: State, time: float) -> None:
        """Plan, if there is none or an object has moved since, or is known otherwise."""
        self._next_look = time + LOOK - 1e-9
        known = [k for k, name in enumerate(self.objects) if name in state.objects]
        poses = [state.objects[self.objects[k]].pose for k in known]
        unsure = [state.objects.covariance(self.objects[k]) for k in known]
        parts = [part.ravel() for pose in poses for part in pose]
        parts += [np.sqrt(part.diagonal()) for part in unsure if part is not None]
        seen = np.concatenate([np.array(known, float), *parts])
        before = self._seen
        moved = before is None or before.shape != seen.shape
        if known and (moved or np.abs(seen - before).max() > MOVED):
            self._seen = seen
            # Who may be held or led back needs the law of the whole movement.
            first = 0 if self.chain is not None else min(round(time / self.dt), self._steps - 1)
            self._plan(first, [self.movements[k] for k in known], poses, unsure)

    def _plan(
        self,
        first: int,
        movements: Sequence[SeenMovement],
        poses: Sequence[Pose],
        unsure: Sequence[np.ndarray | None],
    ) -> None:
        """Make the law from a step of the movement to its end, from what is seen of it."""
        rest = [movement.from_step(first) for movement in movements]
        reference = poses[-1][0] @ rest[-1].reference
        means, precisions, fused = fuse_poses(rest, poses, reference, covariances=unsure)
        self._view = SiteView(self.site, None, "pose", as_rotation(reference))
        if self._progress is not None:
            spread = np.linalg.inv(precisions.sum(0))
            self._progress.follow(self._view, Gaussian.trusted(fused, spread))
        turning = np.broadcast_to(np.eye(6), precisions.shape[1:]).copy()
        turning[:, 3:, 3:] = rotation.left_jacobian(fused[:, 3:])
        effort = turning.mT @ self._costs[first:] @ turning
        # The last law is that of a long horizon, since it is kept for ever.
        means, precisions, (effort,) = (
            np.concatenate([part, np.repeat(part[:, -1:], self._tail, axis=1)], axis=1)
            for part in (means, precisions, effort[None])
        )
        feedback = track_poses(means, precisions, self._system, effort)
        kept = slice(len(rest[0]) + 1)
        self._first, self._brakes = first, feedback.gain[kept, :, 6:]
        self._springs = np.dstack([-feedback.gain[..., :6], feedback.feedforward])[kept]

    def _law(self, time: float) -> tuple[int, np.ndarray]:
        """Step of the movement, and spring there, linear between steps."""
        since = time / self.dt - self._first
        k = min(max(int(since), 0), len(self._springs) - 2)
        share = min(max(since - k, 0.0), 1.0)
        step = min(k + self._first, self._steps - 1)
        return step, (1 - share) * self._springs[k] + share * self._springs[k + 1]
