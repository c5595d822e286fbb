"""Roll-outs: a controller drives the robot at 1 kHz, people push and lead it, all is recorded."""

import copy
from collections.abc import Mapping, Sequence

import numpy as np

from tpsim.border import Duration, border
from tpsim.checks import finite_array
from tpsim.errors import ArgumentError
from tpsim.world.episode import Episode, Person
from tpsim.world.impedance import Controller, Drive, Impedance
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
    going = Rollout(world, controller, start, duration, sites, people, objects, plant, tank)
    return going.run().trial()


class Rollout:
    """A roll-out as it goes, which may be stopped, forked and gone on with.

    Parameters
    ----------
    world, controller, start, duration, sites, people, objects, plant, tank
        As for :func:`rollout`.
    """

    def __init__(
        self,
        world: World,
        controller: Controller,
        start: Sequence[float] | np.ndarray,
        duration: float,
        sites: Mapping[str, str] | None = None,
        people: Sequence[Person] = (),
        objects: Sequence[ObjectPath] = (),
        plant: Plant = NOMINAL,
        tank: Tank | None = None,
    ):
        begin, self._world = finite_array("start", start), world
        self._steps, self._stride = (
            max(1, round(t / world.timestep)) for t in (duration, RECORD_PERIOD)
        )
        self._episode = Episode(world.simulation(plant), people, objects, plant)
        period = world.timestep * self._episode.control_steps
        self._drive = Drive(world.robot, period, tank)
        self._log = Log(self._episode, world.robot.hands if sites is None else sites)
        self._episode.reset(begin)
        self._controller, self._outcome = controller, "done"
        self._command: Impedance | np.ndarray | None = None
        self._wanted = np.zeros(world.robot.n)
        self._step = 0
        self._watched: tuple[Person, ...] = ()

    def run(self, until: int | None = None) -> "Rollout":
        """Go on to a time step, by default to the end."""
        episode, drive, log, controller = self._episode, self._drive, self._log, self._controller
        command, wanted, hold = self._command, self._wanted, episode.control_steps
        last = self._steps if until is None else min(until, self._steps)
        for step in range(self._step, last if self._outcome == "done" else self._step):
            state = episode.sense()
            if step % hold == 0:
                command = controller.command(state, state.time)
                wanted = drive.torque(command, state)
            torque = episode.act(wanted)
            if not np.isfinite(torque.dot(torque)):
                self._outcome = "diverged"
                break
            if step % self._stride == 0:
                if episode.diverged:
                    self._outcome = "diverged"
                    break
                assert command is not None
                log.add(torque, command, drive.energies)
            episode.advance(torque)
        self._command, self._wanted, self._step = command, wanted, last
        return self

    def watch(self, people: Sequence[Person]) -> None:
        """Record where people who do nothing yet would act, for forks in which they do."""
        self._watched = tuple(people)
        self._log.watch([person.bind(self._episode.simulation) for person in people])

    def fork(self, which: int) -> "Rollout":
        """The same roll-out, in which a person who was watched acts from now on.

        Bit for bit what it would be if the person had been there from the start and done nothing,
        as long as controllers hold all that they know in themselves.

        Parameters
        ----------
        which : int
            Of the people who are watched.
        """
        other = copy.copy(self)
        # What never changes is shared.
        shared = {id(part): part for part in (self._world, self._world.robot, self._world.model)}
        other._controller, other._drive, other._command = copy.deepcopy(
            (self._controller, self._drive, self._command), shared
        )
        other._episode = self._episode.copy()
        person = self._watched[which].bind(other._episode.simulation)
        other._episode.people.append(person)
        other._log = self._log.fork(other._episode, which, person)
        return other

    def trial(self) -> Trial:
        """What was recorded."""
        episode, log, outcome = self._episode, self._log, self._outcome
        if not log:
            raise ArgumentError(
                "the controller asked for torques that are not finite from the start: "
                f"{self._wanted}"
            )
        if episode.contacts and outcome == "done":
            outcome = "contact"
        return Trial(log.arrays(), outcome, log.channels, touched=episode.touched)
