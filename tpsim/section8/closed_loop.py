"""What methods retrieve, carried out on simulated arms that are pushed: the loop is closed."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path as FilePath

import numpy as np
from numpy.typing import NDArray

from tpsim.controllers.finite_horizon import FiniteHorizon
from tpsim.controllers.seen_poses import POSE
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.rotation import to_quaternion
from tpsim.section8.arms import ARMS, Arm, ArmSituation
from tpsim.section8.fingerprint import fingerprint, mathematics
from tpsim.section8.measures import Figure
from tpsim.section8.method import Method, Path
from tpsim.section8.plan import Cell, Plan
from tpsim.section8.results import Results
from tpsim.section8.run import drawn, run
from tpsim.section8.trial import Trial, perform
from tpsim.tasks.transfer.study import apart
from tpsim.world.rollout import rollout
from tpsim.world.threads import one_thread
from tpsim.world.trial import Trial as Recording

STEADY = 0.01
"""Standard deviation [m] of a movement without a distribution."""

SURE = 0.001
"""Standard deviation [m] that is added to every distribution: no arm is as sure as some methods."""

POSTURE = 0.3
"""The same of the joints, where the hand leaves them free [rad]."""

PERIOD = 0.016
"""Time for which an impedance lasts [s]."""

REST = 1.0
"""Time [s] for which an arm holds the end."""

FIGURES: dict[str, Figure] = {
    "rms": Figure("hand's path from the teacher's, rms", "mm"),
    "end": Figure("end error", "mm"),
    "end_pushed": Figure("end error after a push", "mm"),
    "tracking": Figure("hand from the retrieved path, rms", "mm"),
    "yield": Figure("farthest that a push moves the hand", "mm", None),
    "saturated": Figure("time steps with a motor at its limit", "%"),
    "diverged": Figure("trials that diverged", ""),
}
"""Figures of :func:`measure_on`, in the order of tables."""

PLANS: dict[str, Plan] = {
    "planar arm": Plan(("planar arm",), (4,), (0, 1, 2), (1.0, 4.0), situations=2),
    "Baxter": Plan(("Baxter",), (4,), (0, 1), (1.0, 2.0), situations=2, samples=150),
}
"""How much is carried out on each arm."""

QUICK: dict[str, Plan] = {
    "planar arm": Plan(("planar arm",), (4,), (0, 1), (4.0,), situations=1, samples=60)
}
"""A taste of it."""


def run_closed_loop(
    methods: Mapping[str, Method],
    folder: FilePath,
    plans: Mapping[str, Plan] = PLANS,
    workers: int = 1,
    progress: bool = False,
) -> dict[str, Results]:
    """Carry out every plan's cells that the folder does not hold yet, and read the others.

    Parameters
    ----------
    methods
        By name.
    folder
        Where the results of the cells are.
    plans
        By name of the arm.
    workers, progress
        As for :func:`tpsim.section8.run.run`.
    """
    rooms = ("robot", "world", "controllers")
    code = fingerprint([methods, list(map(type, ARMS.values())), measure_on, mathematics(rooms)])
    return {
        name: Results(
            plan,
            run(plan, methods, folder, workers, progress, perform_on, code, tuple(FIGURES)),
            FIGURES,
        )
        for name, plan in plans.items()
    }


@one_thread()
def perform_on(plan: Plan, methods: Mapping[str, Method], cell: Cell) -> Trial:
    """Teach, learn, retrieve, and carry out: one arm, number of demonstrations and teacher."""
    name, *_ = cell
    measured = partial(measure_on, ARMS[name])
    return perform(methods, *drawn(ARMS, plan, cell), measured, tuple(FIGURES))


def measure_on(arm: Arm, path: Path, situation: ArmSituation) -> dict[str, float]:
    """Carry out a retrieved movement twice, once while somebody pushes, and measure the hand.

    Parameters
    ----------
    arm : Arm
    path : Gaussian (T, d) or array (T, d)
        In the unit of the data, at the times of the teacher's movement.
    situation : ArmSituation

    Returns
    -------
    dict
        By the names of :data:`FIGURES`; all but ``diverged`` are NaN where the arm did.

    Raises
    ------
    ArgumentError
        A path of another shape than the teacher's, or NaN in it.
    """
    movement = on_the_arm(arm, path, situation)
    truth = arm.place.to_common(situation.truth.data)
    trials = [_carried(arm, movement, situation, people) for people in ((), (situation.push,))]
    if any(trial.outcome == "diverged" for trial in trials):
        return dict.fromkeys(FIGURES, np.nan) | {"diverged": 1.0}
    plain, pushed = (trial["hand_position"] for trial in trials)
    shown = _at(trials[0].time, situation.truth.time, truth)
    wanted = _at(trials[0].time, situation.truth.time, movement.mean)
    steps = sum(round(trial.time[-1] / arm.world.timestep) for trial in trials)
    saturated = sum(int(trial["saturated_steps"][-1]) for trial in trials)
    return {
        "rms": 1e3 * apart(plain, shown),
        "end": 1e3 * float(np.linalg.norm(plain[-1] - truth[-1])),
        "end_pushed": 1e3 * float(np.linalg.norm(pushed[-1] - truth[-1])),
        "tracking": 1e3 * float(np.sqrt(((plain - wanted) ** 2).sum(1).mean())),
        "yield": 1e3 * float(np.linalg.norm(pushed - plain, axis=1).max()),
        "saturated": 100.0 * saturated / steps,
        "diverged": 0.0,
    }


def on_the_arm(arm: Arm, path: Path, situation: ArmSituation) -> Gaussian:
    """Retrieved movement in the arm's world: mean (T, 3), covariance (T, 3, 3) [m]."""
    x = path.mean if isinstance(path, Gaussian) else np.asarray(path, float)
    if x.shape != situation.truth.data.shape:
        raise ArgumentError(
            f"retrieved {x.shape}; the situation asks for {situation.truth.data.shape}"
        )
    if not np.isfinite(x).all():
        raise ArgumentError("retrieved NaN or infinite positions")
    A, floor = arm.place.A, SURE**2 * np.eye(3)
    if isinstance(path, Gaussian):
        covariance = A @ path.covariance @ A.T + floor
    else:
        covariance = np.tile(STEADY**2 * np.eye(3), (len(x), 1, 1))
    return Gaussian(arm.place.to_common(x), covariance)


def follower(arm: Arm, movement: Gaussian, situation: ArmSituation) -> FiniteHorizon:
    """LQT of a movement of the hand, as impedance; the orientation of the start is held.

    The same controller, effort and time step for all methods; only the movement differs.
    """
    robot, last = arm.world.robot, situation.objects[-1]
    R, p = last.first
    start = np.array(situation.start)
    turned = R.T @ robot.at(start).pose(arm.site).rotation
    steps = len(movement.mean)
    covariance = np.zeros((steps, 6, 6))
    covariance[:, :3, :3] = R.T @ movement.covariance @ R
    covariance[:, 3:, 3:] = np.eye(3) * arm.held**2
    mean = np.hstack([(movement.mean - p) @ R, np.tile(to_quaternion(turned), (steps, 1))])
    posture = np.tile(start[robot.index(arm.joints)], (steps, 1))
    return FiniteHorizon(
        robot,
        (last.name,),
        [RiemannianGaussian(POSE, mean, covariance)],
        Gaussian(posture, POSTURE**2 * np.eye(len(arm.joints))),
        joints=arm.joints,
        site=arm.site,
        dt=float(situation.truth.time[1]),
        effort=arm.effort,
        period=PERIOD,
    )


def _carried(arm: Arm, movement: Gaussian, situation: ArmSituation, people: tuple) -> Recording:
    return rollout(
        arm.world,
        follower(arm, movement, situation),
        situation.start,
        float(situation.truth.time[-1]) + REST,
        sites={"hand": arm.site},
        people=people,
        objects=situation.objects,
    )


def _at(times: NDArray, known: NDArray, path: NDArray) -> NDArray:
    """A path (T, 3) at other times, whose end lasts."""
    return np.column_stack([np.interp(times, known, column) for column in path.T])
