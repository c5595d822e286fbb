"""The stiffness that is felt: measured by small static loads, beside the commanded one."""

from collections.abc import Iterator

import numpy as np
from scipy.linalg import eigh

from tpsim.errors import SimulationError
from tpsim.robot.state import State
from tpsim.world.impedance import Controller, Drive, Impedance
from tpsim.world.simulation import Simulation
from tpsim.world.world import World

STIFF = 100.0
"""Stiffness [1/s^2] from which on a mode is measured: softer ones take too long to come to rest."""

SLOW, SETTLED = 1e-3, 3e-5
"""Speeds of the stiff modes [kg^1/2 m/s] below which the robot, and a displacement, is at rest."""

LOOK = 0.1
"""Time [s] for which the robot is to be so slow."""

PATIENCE = 10.0
"""Time [s] that it is given for it."""

HELD = 1.0
"""Time [s] for which a load acts: ten time constants of the softest mode that is measured, and
before the creep of what is soft has turned the modes."""


def identify_stiffness(
    world: World, controller: Controller, start: np.ndarray, *, way: float = 1e-3
) -> tuple[np.ndarray, np.ndarray]:
    """Measured and commanded stiffness (k, k) of the k stiff modes of a controlled robot [1/s^2].

    With the commanded stiffness K at rest and the inertia M, modes v solve K v = w M v; those with
    w above :data:`STIFF` are looked at, in coordinates in which each has unit inertia. Torques
    M v, as a person makes them by pressing on the hands, load one mode after the other, in both
    directions and for the same time; the compliance is half of the distance between the two over
    the load. What is soft may creep meanwhile: it does so under both.

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
    state, command = probe.rest()
    rest, M = simulation.q.copy(), state.mass
    values, V = stiff_modes(command, state)
    if not len(values):
        raise SimulationError(
            f"no mode is stiffer than {STIFF:g} /s^2; there is nothing to measure"
        )
    compliance = np.empty((len(values), len(values)))
    for k, value in enumerate(values):
        load = way * value * (M @ V[:, k])
        there, back = (V.T @ M @ probe.held(rest, sign * load) for sign in (1, -1))
        apart = (there - back) / (2 * way * value)
        if np.abs(apart[:, 1]).max() * way * value > SETTLED:
            raise SimulationError(f"a mode of {value:.0f} /s^2 still moved after {HELD:g} s")
        compliance[:, k] = apart[:, 0]
    return np.linalg.inv(compliance), np.diag(values)


def stiff_modes(command: Impedance, state: State) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness (k,) above :data:`STIFF` [1/s^2] and modes (n, k) of an impedance."""
    values, V = eigh(command.stiffness, state.mass)
    return values[values > STIFF], V[:, values > STIFF]


class _Probe:
    """A controlled robot that is loaded."""

    def __init__(self, simulation: Simulation, controller: Controller):
        self._simulation, self._controller = simulation, controller

    def rest(self) -> tuple[State, Impedance]:
        """Wait until the stiff modes rest."""
        seen, quiet = np.eye(self._simulation.robot.n), 0.0
        for step, (state, command) in enumerate(self._steps(PATIENCE, 0.0)):
            if step % round(LOOK / self._simulation.timestep) == 0:
                seen = stiff_modes(command, state)[1].T @ state.mass
            # Slow for a while, not at the turning point of a swing.
            still = np.abs(seen @ state.dq).max(initial=0.0) < SLOW
            quiet = quiet + self._simulation.timestep if still else 0.0
            if quiet > LOOK:
                return state, command
        raise SimulationError(f"the robot did not come to rest in {PATIENCE:g} s")

    def held(self, start: np.ndarray, load: np.ndarray) -> np.ndarray:
        """Posture and velocity (n, 2) after joint torques (n,) [Nm] have acted for a while."""
        self._simulation.reset(start)
        for _ in self._steps(HELD, load):
            pass
        return self._simulation.x.reshape(2, -1).T.copy()

    def _steps(self, seconds: float, load: np.ndarray | float) -> Iterator[tuple[State, Impedance]]:
        simulation, robot = self._simulation, self._simulation.robot
        drive, limit = Drive(robot, simulation.timestep), robot.torque_limit
        for _ in range(round(seconds / simulation.timestep)):
            state = State(robot, simulation.x, time=simulation.time)
            command = self._controller.command(state, state.time)
            if not isinstance(command, Impedance):
                raise SimulationError("the controller commands torques; stiffness is of impedances")
            yield state, command
            torque = drive.torque(command, state)
            if (np.abs(torque) > limit).any():
                raise SimulationError("a motor reached its limit under the load of the measurement")
            simulation.step(torque + load)
