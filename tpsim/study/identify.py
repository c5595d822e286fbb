"""The stiffness that is felt: measured by small static pushes, beside the commanded one."""

import numpy as np
import pinocchio as pin

from tpsim.errors import SimulationError
from tpsim.sim.controllers.controller import Controller, hand_stiffness
from tpsim.sim.simulation import Simulation

SETTLED = 2e-5
"""Joint speed [rad/s] below which the robot counts as at rest."""

PATIENCE = 20.0
"""Time [s] that it is given to come to rest."""


def identify_stiffness(
    simulation: Simulation,
    controller: Controller,
    start,
    site: str,
    *,
    force: float = 2.0,
    torque: float = 0.1,
) -> tuple[np.ndarray, np.ndarray]:
    """Measured and commanded stiffness (6, 6) at a site [N/m, Nm/rad].

    Six pairs of opposite wrenches are applied one after the other, each until the robot rests;
    the compliance is the displacement over the wrench, central differences.

    Parameters
    ----------
    simulation : Simulation
    controller : Controller
    start : (n,)
        Posture [rad] from which the robot first comes to its own rest.
    site : str
    force, torque : float
        Size of the pushes [N], [Nm].

    Returns
    -------
    measured, commanded : (6, 6), (6, 6)

    Raises
    ------
    SimulationError
        If the robot does not come to rest, or rests with a saturated motor.
    """
    robot, handle = simulation.robot, simulation.robot.site(site)
    body = simulation.attachment(site)[0]
    simulation.reset(start)
    _rest(simulation, controller, body, handle, np.zeros(6))
    rest = simulation.q.copy()
    commanded = hand_stiffness(robot.jacobian(handle), controller.impedance().stiffness)
    R0 = robot.placement(handle)[0].copy()
    compliance = np.empty((6, 6))
    sizes = np.repeat([force, torque], 3)
    for k in range(6):
        pose = []
        for sign in (1, -1):
            wrench = np.zeros(6)
            wrench[k] = sign * sizes[k]
            simulation.reset(rest)
            _rest(simulation, controller, body, handle, wrench)
            R, p = robot.placement(handle)
            pose.append(np.concatenate([p, pin.log3(R @ R0.T)]))
        compliance[:, k] = (pose[0] - pose[1]) / (2 * sizes[k])
    return np.linalg.inv(compliance), commanded


def _rest(simulation, controller, body, handle, wrench):
    robot, limit = simulation.robot, simulation.robot.torque_limit
    quiet = 0
    for _ in range(round(PATIENCE / simulation.timestep)):
        robot.update(simulation.q, simulation.dq)
        torque = controller.torque()
        simulation.clear_wrenches()
        simulation.apply_wrench(body, wrench, robot.placement(handle)[1])
        # Slow for a whole while, not at the turning point of a swing.
        quiet = quiet + 1 if np.abs(robot.dq).max() < SETTLED else 0
        if quiet * simulation.timestep > 0.1:
            if (np.abs(torque) > limit).any():
                break
            return
        simulation.step(np.clip(torque, -limit, limit))
    raise SimulationError(
        f"the robot did not come to rest under {np.round(wrench, 3).tolist()} within its torque "
        f"limits in {PATIENCE:g} s; push less"
    )
