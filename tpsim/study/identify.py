"""The stiffness that is felt: measured by small static pushes, beside the commanded one."""

import numpy as np

from tpsim import rotation
from tpsim.errors import SimulationError
from tpsim.robot.state import State
from tpsim.world.impedance import Controller, Drive, Impedance, hand_stiffness
from tpsim.world.simulation import Simulation
from tpsim.world.world import World

SETTLED = 2e-5
"""Joint speed [rad/s] below which the robot counts as at rest."""

PATIENCE = 20.0
"""Time [s] that it is given to come to rest."""


def identify_stiffness(
    world: World,
    controller: Controller,
    start: np.ndarray,
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
    world : World
    controller : Controller
        It must command an impedance.
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
    simulation = world.simulation()
    probe = _Probe(simulation, controller, site)
    simulation.reset(start)
    state, command = probe.rest(np.zeros(6))
    rest = simulation.q.copy()
    commanded = hand_stiffness(state.jacobian(site), command.stiffness)
    R0 = state.pose(site).rotation
    compliance = np.empty((6, 6))
    sizes = np.repeat([force, torque], 3)
    for k in range(6):
        pose = []
        for sign in (1, -1):
            wrench = np.zeros(6)
            wrench[k] = sign * sizes[k]
            simulation.reset(rest)
            R, p = probe.rest(wrench)[0].pose(site)
            pose.append(np.concatenate([p, rotation.log(R @ R0.T)]))
        compliance[:, k] = (pose[0] - pose[1]) / (2 * sizes[k])
    return np.linalg.inv(compliance), commanded


class _Probe:
    """A controller that is pushed at a site until it rests."""

    def __init__(self, simulation: Simulation, controller: Controller, site: str):
        self._simulation, self._controller, self._site = simulation, controller, site
        self._body = simulation.attachment(site)[0]

    def rest(self, wrench: np.ndarray) -> tuple[State, Impedance]:
        """Let the robot come to rest under a wrench (6,)."""
        simulation, robot = self._simulation, self._simulation.robot
        drive, limit, quiet = Drive(robot, simulation.timestep), robot.torque_limit, 0
        for _ in range(round(PATIENCE / simulation.timestep)):
            state = State(robot, simulation.x, time=simulation.time)
            command = self._controller.command(state, state.time)
            torque = drive.torque(command, state)
            simulation.clear_wrenches()
            simulation.apply_wrench(self._body, wrench, state.pose(self._site).position)
            # Slow for a whole while, not at the turning point of a swing.
            quiet = quiet + 1 if np.abs(state.dq).max() < SETTLED else 0
            if quiet * simulation.timestep > 0.1:
                if (np.abs(torque) > limit).any() or not isinstance(command, Impedance):
                    break
                return state, command
            simulation.step(np.clip(torque, -limit, limit))
        raise SimulationError(
            f"the robot did not come to rest under {np.round(wrench, 3).tolist()} within its "
            f"torque limits in {PATIENCE:g} s; push less"
        )
