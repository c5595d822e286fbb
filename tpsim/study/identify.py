"""The stiffness that is felt: measured by small static loads, beside the commanded one."""

import numpy as np
from scipy.linalg import eigh

from tpsim.errors import SimulationError
from tpsim.robot.state import State
from tpsim.world.impedance import Controller, Drive, Impedance
from tpsim.world.simulation import Simulation
from tpsim.world.world import World

STIFF = 100.0
"""Stiffness [1/s^2] from which on a mode is measured: softer ones take too long to come to rest."""

SETTLED = 1e-5
"""Speed of the stiff modes [kg^1/2 m/s] below which they count as at rest."""

PATIENCE = 10.0
"""Time [s] that they are given to come to rest."""


def identify_stiffness(
    world: World, controller: Controller, start: np.ndarray, *, way: float = 1e-3
) -> tuple[np.ndarray, np.ndarray]:
    """Measured and commanded stiffness (k, k) of the k stiff modes of a controlled robot [1/s^2].

    With the commanded stiffness K at rest and the inertia M, modes v solve K v = w M v; those with
    w above :data:`STIFF` are looked at, in coordinates in which each has unit inertia. Torques
    M v, as a person makes them by pressing on the hands, load one mode after the other, in both
    directions, until the stiff modes rest; the compliance is the displacement over the load.

    Parameters
    ----------
    world : World
    controller : Controller
        It must command an impedance.
    start : (n,)
        Posture [rad] from which the robot first comes to its own rest.
    way : float
        Displacement [kg^1/2 m] that the loads are to make.

    Raises
    ------
    SimulationError
        If nothing is stiff, or the robot does not come to rest within its torque limits.
    """
    simulation = world.simulation()
    simulation.reset(start)
    probe = _Probe(simulation, controller)
    state, command = probe.rest(np.zeros(world.robot.n), np.eye(world.robot.n))
    rest, M = simulation.q.copy(), state.mass
    values, V = eigh(command.stiffness, M)
    values, V = values[values > STIFF], V[:, values > STIFF]
    if not len(values):
        raise SimulationError(
            f"no mode is stiffer than {STIFF:g} /s^2; there is nothing to measure"
        )
    compliance = np.empty((len(values), len(values)))
    for k, value in enumerate(values):
        found = []
        for sign in (1, -1):
            simulation.reset(rest)
            probe.rest(sign * way * value * (M @ V[:, k]), V.T @ M)
            found.append(V.T @ M @ simulation.q)
        compliance[:, k] = (found[0] - found[1]) / (2 * way * value)
    return np.linalg.inv(compliance), np.diag(values)


class _Probe:
    """A controller whose robot is loaded until it rests."""

    def __init__(self, simulation: Simulation, controller: Controller):
        self._simulation, self._controller = simulation, controller

    def rest(self, load: np.ndarray, rows: np.ndarray) -> tuple[State, Impedance]:
        """Let the robot come to rest, as ``rows`` (k, n) see it, under joint torques (n,) [Nm]."""
        simulation, robot = self._simulation, self._simulation.robot
        drive, limit, quiet = Drive(robot, simulation.timestep), robot.torque_limit, 0
        slow = SETTLED if len(rows) < robot.n else 100 * SETTLED
        for _ in range(round(PATIENCE / simulation.timestep)):
            state = State(robot, simulation.x, time=simulation.time)
            command = self._controller.command(state, state.time)
            torque = drive.torque(command, state)
            # Slow for a whole while, not at the turning point of a swing.
            quiet = quiet + 1 if np.abs(rows @ state.dq).max() < slow else 0
            if quiet * simulation.timestep > 0.1:
                if (np.abs(torque) > limit).any() or not isinstance(command, Impedance):
                    break
                return state, command
            simulation.step(np.clip(torque, -limit, limit) + load)
        raise SimulationError(
            f"the robot did not come to rest within its torque limits in {PATIENCE:g} s"
        )
