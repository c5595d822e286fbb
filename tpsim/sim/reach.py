"""Inverse kinematics by mink: the postures in which a person would start and pass."""

from collections.abc import Mapping

import mink
import numpy as np

from tpsim.errors import SimulationError
from tpsim.sim.simulation import Simulation


def reach(
    simulation: Simulation,
    targets: Mapping[str, tuple[np.ndarray, np.ndarray]],
    *,
    start=None,
    posture=None,
    margin: float = 0.05,
    tolerance: tuple[float, float] = (2e-4, 1e-3),
    iterations: int = 400,
) -> np.ndarray:
    """Joint angles (n,) at which sites have given poses, near a preferred posture.

    Parameters
    ----------
    simulation : Simulation
    targets : mapping
        Site name to (rotation (3, 3), position (3,)).
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
    model, robot = simulation.model, simulation.robot
    posture = simulation.home if posture is None else np.asarray(posture, float)
    full = model.qpos0.copy()
    full[robot.qpos] = simulation.home if start is None else start
    configuration = mink.Configuration(model, full)
    tasks = []
    for site, (R, p) in targets.items():
        simulation.robot.site(site)
        task = mink.FrameTask(site, "site", 1.0, orientation_cost=0.5, lm_damping=1e-4)
        task.set_target(mink.SE3.from_rotation_and_translation(mink.SO3.from_matrix(R), p))
        tasks.append(task)
    prefer = mink.PostureTask(model, cost=0.02)
    preferred = model.qpos0.copy()
    preferred[robot.qpos] = posture
    prefer.set_target(preferred)
    limits = [mink.ConfigurationLimit(model, min_distance_from_limits=margin)]
    for i in range(iterations):
        # The preferred posture shapes the way there and lets go at the end.
        prefer.set_cost(0.02 * 0.97**i)
        velocity = mink.solve_ik(configuration, [*tasks, prefer], 0.05, "daqp", 1e-6, limits=limits)
        configuration.integrate_inplace(velocity, 0.05)
        errors = [task.compute_error(configuration) for task in tasks]
        position = max(np.linalg.norm(error[:3]) for error in errors)
        angle = max(np.linalg.norm(error[3:]) for error in errors)
        if i > 100 and position < tolerance[0] and angle < tolerance[1]:
            return configuration.q[robot.qpos].copy()
    raise SimulationError(
        f"poses of {sorted(targets)} cannot be reached: {1e3 * position:.1f} mm and "
        f"{np.degrees(angle):.1f} deg are left; choose them nearer to the arms' workspace"
    )
