"""Inverse kinematics: postures that bring sites to poses, by mink, and that satisfy views."""

from collections.abc import Mapping, Sequence
from typing import Annotated

import mink
import numpy as np

from tpsim.border import NotNegative, Positive, Range, border
from tpsim.errors import ArgumentError, SimulationError
from tpsim.pose import Pose
from tpsim.robot.home import put
from tpsim.robot.objects import NONE, Objects
from tpsim.robot.robot import Robot
from tpsim.robot.views.view import View

NEARLY = 1e-5
"""Value [m], [rad] of a view that counts as zero where steps towards it have become short."""


@border
def reach(
    robot: Robot,
    targets: Mapping[str, Pose],
    *,
    start: np.ndarray | None = None,
    posture: np.ndarray | None = None,
    margin: NotNegative = 0.05,
    tolerance: tuple[Positive, Positive] = (2e-4, 1e-3),
    iterations: Annotated[int, Range(least=1, most=1e5)] = 400,
) -> np.ndarray:
    """Joint angles (n,) at which sites have given poses, near a preferred posture.

    Parameters
    ----------
    robot : Robot
    targets : mapping of str to Pose
        Where sites are to be.
    start, posture : (n,), optional
        Where the search starts and the posture it prefers; home by default.
    margin : float
        Distance kept from the joint limits [rad].
    tolerance : (float, float)
        Error allowed in position [m] and orientation [rad].
    iterations : int
        At most.

    Raises
    ------
    SimulationError
        If the poses cannot be reached.
    """
    model = robot.model
    posture = robot.home if posture is None else robot.posture("posture", posture)
    start = robot.home if start is None else robot.posture("start", start)
    if not targets:
        raise ArgumentError("targets is empty; give the pose of at least one site")
    targets = {site: pose.checked(f"targets[{site!r}]") for site, pose in targets.items()}
    full = model.qpos0.copy()
    put(model, full, robot.description.fixed)
    full[robot.simulated.qpos] = start
    configuration = mink.Configuration(model, full)
    tasks = []
    for site, (R, p) in targets.items():
        robot.at_home.pose(site)
        task = mink.FrameTask(site, "site", 1.0, orientation_cost=0.5, lm_damping=1e-4)
        task.set_target(mink.SE3.from_rotation_and_translation(mink.SO3.from_matrix(R), p))
        tasks.append(task)
    prefer = mink.PostureTask(model, cost=0.02)
    preferred = full.copy()
    preferred[robot.simulated.qpos] = posture
    prefer.set_target(preferred)
    limits = [mink.ConfigurationLimit(model, min_distance_from_limits=margin)]
    for i in range(iterations):
        # The preferred posture shapes the way there and lets go at the end.
        prefer.set_cost(0.02 * 0.97**i)
        try:
            velocity = mink.solve_ik(
                configuration, [*tasks, prefer], 0.05, "daqp", 1e-6, limits=limits
            )
        except mink.MinkError as error:
            raise SimulationError(
                f"no step towards the targets keeps a margin of {margin:g} from the limits: {error}"
            ) from None
        configuration.integrate_inplace(velocity, 0.05)
        errors = [task.compute_error(configuration) for task in tasks]
        position = max(float(np.linalg.norm(error[:3])) for error in errors)
        angle = max(float(np.linalg.norm(error[3:])) for error in errors)
        if i > 100 and position < tolerance[0] and angle < tolerance[1]:
            found: np.ndarray = configuration.q[robot.simulated.qpos].copy()
            return found
    raise SimulationError(
        f"poses of {sorted(targets)} cannot be reached: {1e3 * position:.1f} mm and "
        f"{np.degrees(angle):.1f} deg are left; choose them nearer to the arms' workspace"
    )


@border
def satisfy(
    robot: Robot, views: Sequence[View], start: np.ndarray, objects: Objects = NONE
) -> np.ndarray:
    """Posture (n,) at which all views are zero, by Gauss-Newton from a start (n,).

    Raises
    ------
    SimulationError
        If there is none within the joint limits.
    """
    q = robot.posture("start", start)
    if not views:
        raise ArgumentError("views is empty; give at least one")
    for _ in range(50):
        seen = [view(state) for state in [robot.at(q, objects=objects)] for view in views]
        y = np.concatenate([s.value for s in seen])
        if np.abs(y).max() < 1e-6:
            return q
        step = np.linalg.lstsq(np.concatenate([s.jacobian for s in seen]), -y, rcond=1e-6)[0]
        if not (longest := float(np.abs(step).max())):
            break
        q = np.clip(q + step * min(1.0, 0.5 / longest), robot.lower, robot.upper)
    worst = int(np.argmax(np.abs(y)))
    if abs(y[worst]) < NEARLY:
        return q
    names = [f"{type(v).__name__} '{label}'" for v in views for label in v.labels(robot)]
    raise SimulationError(
        "no posture within the joint limits makes all views zero: "
        f"{y[worst]:.3g} of {names[worst]} is left"
    )
