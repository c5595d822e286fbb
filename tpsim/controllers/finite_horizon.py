"""Torque control of a hand by the finite-horizon LQT, re-planned when objects move."""

from collections.abc import Sequence
from functools import partial

import numpy as np
import pinocchio as pin

from tpsim import rotation
from tpsim.border import Count, Duration, Positive, border
from tpsim.checks import felt
from tpsim.control.impedance import impedance
from tpsim.control.system import integrator
from tpsim.control.unrolled import Unrolled, tracked
from tpsim.controllers import torque_cost
from tpsim.controllers.progress import AheadOfState, Patience
from tpsim.controllers.renewed import RenewedImpedance
from tpsim.controllers.seen_poses import (
    POSE,
    common_pose,
    counted,
    placed_poses,
    precision_at,
)
from tpsim.controllers.way_round import apart, chosen, ways_round
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.pose import Pose
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.robot.views.view import Seen
from tpsim.world.impedance import Impedance

LOOK = 0.1
"""Time [s] between two looks at the objects; a plan is made where one has moved."""

MOVED = 1e-5
"""Change of an object's position [m] or rotation matrix that counts as motion."""

TAIL = 0.6
"""Time [s] for which a plan goes on beyond the movement's end, which then lasts."""

PERIOD = 0.008
"""Time for which an impedance lasts by default [s]."""

POSTURES = 40
"""Number of taught postures in which the cost of torque is computed, at least."""

HOLD = 400.0
"""Stiffness [1/s^2] of the joints that do not belong to the arm."""


class FiniteHorizon(RenewedImpedance):
    """A hand carried along a movement that objects see, by finite-horizon LQT (Eqs 34-38).

    The hand's pose lives on its manifold, ``R(3) * S3``. The product of what the objects saw is
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
    period : float
        Time for which an impedance lasts [s].
    chain : SemiMarkovChain, optional
        Of the movement's states, at every step or every second, ... one. Progress is then the
        hand's, not the clock's: held it stands still, pushed on it hurries.
    shown : int, optional
        From how many demonstrations the movements were learned. What an object saw in so few of
        them counts less where the others say something else than was ever shown: its claim is
        Student's t (:func:`~tpsim.controllers.seen_poses.counted`). By default it is Gaussian.

    What is known of an object's pose up to a covariance counts for less, and what was not seen at
    all for nothing: the movement then goes by the other objects. The arm holds still until one
    of them is seen.
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
        dt: Duration,
        effort: Positive,
        period: Positive = PERIOD,
        chain: SemiMarkovChain | None = None,
        shown: Count | None = None,
    ):
        super().__init__(period)
        self.objects, self.movements, self.posture = tuple(objects), tuple(movements), posture
        self.joints, self.site, self.dt, self.effort = tuple(joints), site, dt, effort
        self.shown, self.chain = shown, chain
        if not joints or not movements:
            raise ArgumentError("joints and movements: give at least one of each")
        kinds = {(str(one.manifold), one.mean.shape[:-1]) for one in movements}
        steps = len(movements[0].mean)
        if len(objects) != len(movements) or kinds != {(str(POSE), (steps,))}:
            raise ArgumentError(
                f"movements are {sorted(kinds)} for objects {self.objects}; give one (T,) on "
                f"{POSE} for each, all of the same length"
            )
        if joints[0] not in robot.joints:
            raise ArgumentError(f"joints are {joints}; the robot has {robot.joints}")
        first = robot.joints.index(joints[0])
        self._arm = slice(first, first + len(joints))
        if robot.joints[self._arm] != tuple(joints):
            raise ArgumentError(f"joints {joints} do not follow each other on the robot")
        if posture.mean.shape != (steps, len(joints)):
            raise ArgumentError(
                f"posture has means of shape {posture.mean.shape}; give ({steps}, {len(joints)})"
            )
        ticks = steps if chain is None else max(1, round(float(chain.durations.mean.sum())))
        self._ticks = slice(None, None, -(-steps // ticks))
        if len(range(steps)[self._ticks]) != ticks:
            raise ArgumentError(
                f"stays of the chain add up to {ticks} steps and the movement has {steps}; give "
                "SemiMarkovChain.along(its states), or of every second, third, ... of them"
            )
        every = dt * self._ticks.step
        self._progress = None if chain is None else AheadOfState(chain, every, 1 / dt)
        self._system = integrator(6, dt, exact=True)
        self._steps, self._tail = steps, round(TAIL / dt)
        # The costs of torque change slowly: one posture stands for some of its neighbours.
        some = posture[:: max(1, self._steps // POSTURES)]
        self._hand = robot, self._arm, site
        self._least = torque_cost.least_mobility(*self._hand, some.mean)
        mass, cost = torque_cost.inertia_and_cost(*self._hand, some.mean, self._least)
        swivels = impedance(felt("precision of posture", some.precision), effort * mass @ mass)
        self._swivels, self._swivel_brakes = map(self._spread, swivels)
        self._costs, self._elbow = effort * self._spread(cost), posture.mean
        self._weights = robot.torque_limit[self._arm] ** -2.0
        held = torque_cost.held(robot, self._arm)
        self._patience = Patience(held, torque_cost.STRENGTH, end=steps * dt)
        self._rest: np.ndarray | None = None
        self._seen: np.ndarray | None = None
        self._begun: np.ndarray | None = None
        self._next_look = 0.0

    def _spread(self, some: np.ndarray) -> np.ndarray:
        """What is known of some steps (S, ...), of all of them (T, ...)."""
        near = np.linspace(0, len(some) - 1, self._steps).round().astype(int)
        return np.asarray(some[near])

    def renew(self, state: State, time: float) -> Impedance:
        """Impedance in joint space: swivelling is left to ``M - J^T L J``, which moves no hand."""
        arm = self._arm
        if self._rest is None:
            self._rest = state.q
        if time >= self._next_look:
            self._look(state, time)
        if self._seen is None:  # nothing that the movement could go by was seen yet
            mass = state.mass
            return Impedance(HOLD * mass, 2 * HOLD**0.5 * mass, self._rest)
        place, rate = (time, 1.0) if self._progress is None else self._progress.at(state, time)
        step, spring = self._law(place)
        self._near = step - self._first
        seen = self._on_plane(state)
        J, M = seen.jacobian[:, arm], state.mass
        inertia = torque_cost.felt_inertia(M[arm, arm], J, self._least)
        lever = J.T @ inertia
        null = M[arm, arm] - lever @ J
        swivel = null @ self._swivels[step]
        # The other joints hold still, critically damped.
        stiffness, damping = HOLD * M, 2 * HOLD**0.5 * M
        stiffness[arm, arm] = swivel - lever @ spring[:, :6] @ J
        damping[arm, arm] = null @ self._swivel_brakes[step]
        damping[arm, arm] += lever @ self._brakes[self._near] @ J
        if self._progress is not None:
            lacks = self._lacks(place, seen.value, J @ state.dq[arm])
            self._progress.draw(lacks, -spring[:, :6], self._brakes[self._near], inertia)
        y = np.append(seen.value, 1.0)
        pull = lever @ (spring @ y) + swivel @ (self._elbow[step] - state.q[arm])
        # Brakes stay, and relieve springs where it goes on: nobody holds it at half its tempo.
        weights = self._weights / self._patience.strength(time, place, 2 * rate) ** 2
        brake = self._patience.going * (damping[arm, arm] @ state.dq[arm])
        share = torque_cost.share_within(pull, brake, weights)
        stiffness[arm, arm] *= share
        # It stays for the period: over soft springs, one that moves would hold too much energy.
        reference = self._rest.copy()
        reference[arm] = state.q[arm] + np.linalg.solve(stiffness[arm, arm], share * pull)
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
            self._plan(first, [self.movements[k] for k in known], poses, unsure, state)

    def _plan(
        self,
        first: int,
        movements: Sequence[RiemannianGaussian],
        poses: Sequence[Pose],
        unsure: Sequence[np.ndarray | None],
        state: State,
    ) -> None:
        """Make the law from a step of the movement to its end, from what is seen of it."""
        means, precisions = placed_poses(movements, poses, unsure)
        way = self._way(means, precisions, state)
        if self._alone and self.shown is not None:
            precisions = counted(means, precisions, way, self.shown)
            way, _ = common_pose(means, precisions, way)
        precision = precision_at(way, means, precisions)
        way, precision, costs = (part[first:] for part in (way, precision, self._costs))
        # The last law is that of a long horizon, since it is kept for ever.
        longer = np.minimum(np.arange(len(way) + self._tail), len(way) - 1)
        path, costs = Unrolled.of(POSE, way[longer]), costs[longer]
        effort = path.axes.mT @ costs @ path.axes
        # Of Gaussians that are tracked at once (Eq. 38) only the product matters.
        target = way[longer][None], precision[longer][None]
        feedback = tracked(path, *target, self._system, effort)
        self._first, self._near, self._path = first, 0, path
        self._turned = rotation.from_quaternion(path.points[:, 3:])
        self._brakes: np.ndarray = feedback.gain[: len(way) + 1, :, 6:]
        self._springs = np.dstack([-feedback.gain[..., :6], feedback.feedforward])[: len(way) + 1]
        if self._progress is not None:
            axes = path.axes[: len(way)][self._ticks]
            spread = axes.mT @ np.linalg.inv(precision[self._ticks]) @ axes
            places = Gaussian.trusted(path.plane[: len(way)][self._ticks], spread)
            self._progress.follow(self._on_plane, places)

    def _way(self, means: np.ndarray, precisions: np.ndarray, state: State) -> np.ndarray:
        """Where the hand goes (T, 7): on the way round that it began, or on the better one."""
        ways = ways_round(means, precisions, common_pose(means, precisions)[0], self.dt)
        self._alone = len(ways) == 1
        if self._alone:
            way = ways[0]
        elif self._begun is None:
            way, postures = chosen(ways, *self._hand, state.q)
            # There the arm is another one than where it was taught, and torque costs otherwise.
            cost = torque_cost.inertia_and_cost(*self._hand, postures, self._least)[1]
            self._costs, self._elbow = self.effort * self._spread(cost), self._spread(postures)
        else:
            way = min(ways, key=partial(apart, self._begun))
        self._begun = way
        return way

    def _on_plane(self, state: State) -> Seen:
        """The hand's pose on the plane (6,), as it is seen from the step of the movement."""
        (R, p), J = state.pose(self.site), state.jacobian(self.site)
        path, t = self._path, self._near
        turn, back = R @ self._turned[t].T, path.axes[t].T
        away = np.concatenate([p - path.points[t, :3], pin.log3(turn)])
        J = np.concatenate([J[:3], pin.Jlog3(turn).T @ J[3:]])
        return Seen(path.plane[t] + back @ away, back @ J, np.zeros(6))

    def _lacks(self, time: float, y: np.ndarray, dy: np.ndarray) -> np.ndarray:
        """Velocity of the movement, and what place and velocity lack of it (3, 6)."""
        at, past = self._path.plane[self._near :][:2], time / self.dt - self._near - self._first
        way = (at[-1] - at[0]) / self.dt
        return np.array([way, at[0] + past * self.dt * way - y, way - dy])

    def _law(self, time: float) -> tuple[int, np.ndarray]:
        """Step of the movement, and spring there, linear between steps."""
        since = time / self.dt - self._first
        k = min(max(int(since), 0), len(self._springs) - 2)
        share = min(max(since - k, 0.0), 1.0)
        step = min(k + self._first, self._steps - 1)
        return step, (1 - share) * self._springs[k] + share * self._springs[k + 1]
