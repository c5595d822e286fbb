"""Roll-outs: a controller drives the robot at 1 kHz, people push and lead it, all is recorded."""

from collections.abc import Mapping, Sequence

import numpy as np

from tpsim.border import Duration, border
from tpsim.checks import finite_array
from tpsim.errors import ArgumentError
from tpsim.world.episode import Episode, Person
from tpsim.world.impedance import Controller, Drive
from tpsim.world.log import Log
from tpsim.world.object_path import ObjectPath
from tpsim.world.plant import NOMINAL, Plant
from tpsim.world.tank import Tank
from tpsim.world.threads import one_thread
from tpsim.world.trial import Trial
from tpsim.world.world import World

RECORD_PERIOD = 0.01
"""Time [s] between samples of a recording."""


@one_thread()
@border
def rollout(
    world: World,
    controller: Controller,
    start: Sequence[float] | np.ndarray,
    duration: Duration,
    *,
    sites: Mapping[str, str] | None = None,
    people: Sequence[Person] = (),
    objects: Sequence[ObjectPath] = (),
    plant: Plant = NOMINAL,
    tank: Tank | None = None,
) -> Trial:
    """Let a controller drive the robot from rest for a while, and record it.

    Parameters
    ----------
    world : World
    controller : Controller
        A new one: controllers may remember what they did.
    start : (n,)
        Start posture [rad].
    duration : float
        Time [s].
    sites : mapping of str to str, optional
        Sites to record, by the name that the recording gives them; the hands by default.
    people : sequence of Person
        Who pushes and leads the robot meanwhile.
    objects : sequence of ObjectPath
        Where movable objects are; those without a path stay where the scene has them.
    plant : Plant
        How the simulated robot differs from the controller's model.
    tank : Tank, optional
        What impedances may put into the robot; the robot's own by default.

    Returns
    -------
    Trial
        At 100 Hz; ``outcome`` is ``"diverged"`` where the robot became faster than any robot,
        ``"contact"`` where something touched, else ``"done"``.

    Raises
    ------
    ArgumentError, SimulationError
        A duration that is not positive, a start posture or an object that does not fit.
    """
    begin = finite_array("start", start)
    steps, stride = (max(1, round(t / world.timestep)) for t in (duration, RECORD_PERIOD))
    episode = Episode(world.simulation(plant), people, objects, plant)
    drive = Drive(world.robot, world.timestep * episode.control_steps, tank)
    log = Log(episode, world.robot.hands if sites is None else sites)
    episode.reset(begin)
    outcome, hold = "done", episode.control_steps
    command, wanted = None, np.zeros(world.robot.n)
    for step in range(steps):
        state = episode.sense()
        if step % hold == 0:
            command = controller.command(state, state.time)
            wanted = drive.torque(command, state)
        torque = episode.act(wanted)
        if not np.isfinite(torque.dot(torque)):
            outcome = "diverged"
            break
        if step % stride == 0:
            if episode.diverged:
                outcome = "diverged"
                break
            assert command is not None
            log.add(torque, command, drive.energies)
        episode.advance(torque)
    if not log:
        raise ArgumentError(
            f"the controller asked for torques that are not finite from the start: {wanted}"
        )
    if episode.contacts and outcome == "done":
        outcome = "contact"
    return Trial(log.arrays(), outcome, log.channels, touched=episode.touched)
