"""The stiffness that is felt: measured by small displacements, beside the commanded one."""

import numpy as np

from tpsim import rotation
from tpsim.errors import SimulationError
from tpsim.pose import Pose
from tpsim.robot.state import State
from tpsim.world.impedance import Controller, Drive, Impedance, hand_stiffness
from tpsim.world.people.guide import Grip
from tpsim.world.simulation import Simulation
from tpsim.world.world import World

SETTLED = 5e-4
"""Joint speed [rad/s] below which the robot counts as at rest: what still creeps then
cancels between opposite displacements."""

PATIENCE = 20.0
"""Time [s] that it is given to come to rest."""


GRIP = Grip(2000.0, 120.0, 60.0, 2.5)
"""The hand that holds the site where it was displaced: the wrench that it feels is measured."""


def identify_stiffness(
    world: World,
    controller: Controller,
    start: np.ndarray,
    site: str,
    *,
    distance: float = 1e-3,
    angle: float = 5e-3,
) -> tuple[np.ndarray, np.ndarray]:
    """Measured and commanded stiffness (6, 6) at a site [N/m, Nm/rad].

    A grip takes the site to six pairs of opposite displacements, one after the other, until the
    robot rests; the stiffness is the wrench that it then feels over the displacement, central
    differences. Where the robot is free it feels nothing.

    Parameters
    ----------
    world : World
    controller : Controller
        It must command an impedance.
    start : (n,)
        Posture [rad] from which the robot first comes to its own rest.
    site : str
    distance, angle : float
        Size of the displacements of the grip [m], [rad].

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
    state, command, _ = probe.rest(None)
    rest, pose = simulation.q.copy(), state.pose(site)
    commanded = hand_stiffness(state.jacobian(site), command.stiffness)
    moved, felt = np.empty((6, 6)), np.empty((6, 6))
    for k in range(6):
        found = []
        for sign in (1, -1):
            step = np.zeros(6)
            step[k] = sign * (distance if k < 3 else angle)
            simulation.reset(rest)
            wanted = Pose(rotation.exp(step[3:]) @ pose.rotation, pose.position + step[:3])
            state, _, wrench = probe.rest(wanted)
            R, p = state.pose(site)
            found.append((np.concatenate([p, rotation.log(R @ pose.rotation.T)]), wrench))
        moved[:, k] = found[0][0] - found[1][0]
        felt[:, k] = found[0][1] - found[1][1]
    return np.linalg.solve(moved.T, felt.T).T, commanded


class _Probe:
    """A controller whose robot is held at a site until it rests."""

    def __init__(self, simulation: Simulation, controller: Controller, site: str):
        self._simulation, self._controller, self._site = simulation, controller, site
        self._body = simulation.attachment(site)[0]

    def rest(self, wanted: Pose | None) -> tuple[State, Impedance, np.ndarray]:
        """Let the robot come to rest, held at a pose or by nobody; state, command, wrench (6,)."""
        simulation, robot, still = self._simulation, self._simulation.robot, np.zeros(6)
        drive, limit, quiet = Drive(robot, simulation.timestep), robot.torque_limit, 0
        for _ in range(round(PATIENCE / simulation.timestep)):
            state = State(robot, simulation.x, time=simulation.time)
            command = self._controller.command(state, state.time)
            torque = drive.torque(command, state)
            simulation.clear_wrenches()
            wrench, pose = still, state.pose(self._site)
            if wanted is not None:
                wrench = GRIP.wrench(pose, state.twist(self._site), wanted, still)
                simulation.apply_wrench(self._body, wrench, pose.position)
            # Slow for a whole while, not at the turning point of a swing.
            quiet = quiet + 1 if np.abs(state.dq).max() < SETTLED else 0
            if quiet * simulation.timestep > 0.3:
                if (np.abs(torque) > limit).any() or not isinstance(command, Impedance):
                    break
                return state, command, wrench.copy()
            simulation.step(np.clip(torque, -limit, limit))
        raise SimulationError(
            f"the robot did not come to rest at {self._site} within its torque limits in "
            f"{PATIENCE:g} s; displace it less"
        )
