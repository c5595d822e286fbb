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
from tpsim.world.simulation import Simulation
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
        ``"contact"`` where something touched, ``"unseen: ..."`` where objects never appeared
        to the robot, else ``"done"``.

    Raises
    ------
    ArgumentError, SimulationError
        A duration that is not positive, a start posture or an object that does not fit.
    """
    going = Rollout(
        world.simulation(plant),
        controller,
        start,
        sites=sites,
        people=people,
        objects=objects,
        plant=plant,
        tank=tank,
    )
    return going.run(max(1, round(duration / world.timestep))).trial()


class Rollout:
    """A roll-out as it goes, one time step after another: it may be stopped, forked, gone on with.

    Parameters
    ----------
    simulation : Simulation
    controller : Controller
    start, sites, people, objects, plant, tank
        As for :func:`rollout`.
    recorded : bool
        Whether samples are kept for :meth:`trial`.

    Attributes
    ----------
    episode : Episode
        Whose people may come and go meanwhile.
    steps : int
        Time steps so far.
    state : State
        What the robot sensed last.
    command : Impedance, ndarray or None
        The last one.
    """

    def __init__(
        self,
        simulation: Simulation,
        controller: Controller,
        start: Sequence[float] | np.ndarray,
        *,
        sites: Mapping[str, str] | None = None,
        people: Sequence[Person] = (),
        objects: Sequence[ObjectPath] = (),
        plant: Plant = NOMINAL,
        tank: Tank | None = None,
        recorded: bool = True,
    ):
        begin, robot = finite_array("start", start), simulation.robot
        self.controller, self.recorded = controller, recorded
        self.episode = episode = Episode(simulation, people, objects, plant)
        self._hold = episode.control_steps
        self._stride = max(1, round(RECORD_PERIOD / simulation.timestep))
        self.drive = Drive(robot, simulation.timestep * self._hold, tank)
        self._log = Log(episode, robot.hands if sites is None else sites)
        episode.reset(begin)
        self.steps, self._outcome = 0, "done"
        self.state = robot.at(begin)
        self.command: Impedance | np.ndarray | None = None
        self._wanted = np.zeros(robot.n)
        self._watched: tuple[Person, ...] = ()

    def step(self) -> bool:
        """Let one time step pass; False, and nothing passes, where the robot diverged."""
        if self._outcome == "diverged":
            return False
        episode = self.episode
        self.state = state = episode.sense()
        if self.steps % self._hold == 0:
            self.command = self.controller.command(state, state.time)
            self._wanted = self.drive.torque(self.command, state)
        torque = episode.act(self._wanted)
        if not episode.sound:
            self._outcome = "diverged"
            return False
        if self.steps % self._stride == 0:
            if episode.diverged:
                self._outcome = "diverged"
                return False
            if self.recorded:
                assert self.command is not None
                self._log.add(torque, self.command, self.drive.energies)
        episode.advance(torque)
        self.steps += 1
        return True

    @property
    def diverged(self) -> bool:
        """Whether the robot became faster than any robot."""
        return self._outcome == "diverged"

    def run(self, until: int) -> "Rollout":
        """Go on until so many time steps have passed, or the robot diverged."""
        while self.steps < until and self.step():
            pass
        return self

    def watch(self, people: Sequence[Person]) -> None:
        """Record where people who do nothing yet would act, for forks in which they do."""
        self._watched = tuple(people)
        self._log.watch([person.bind(self.episode.simulation) for person in people])

    def fork(self, which: int) -> "Rollout":
        """The same roll-out, in which a person who was watched acts from now on.

        Bit for bit what it would be if the person had been there from the start and done nothing,
        as long as controllers hold all that they know in themselves.

        Parameters
        ----------
        which : int
            Of the people who are watched.
        """
        other, simulation = copy.copy(self), self.episode.simulation
        # What never changes is shared.
        shared = {id(part): part for part in (simulation.robot, simulation.model)}
        other.controller, other.drive, other.command = copy.deepcopy(
            (self.controller, self.drive, self.command), shared
        )
        other.episode = self.episode.copy()
        person = self._watched[which].bind(other.episode.simulation)
        other.episode.people.append(person)
        other._log = self._log.fork(other.episode, which, person)
        return other

    def trial(self) -> Trial:
        """What was recorded up to now.

        Raises
        ------
        ArgumentError
            If the controller asked for torques that are not finite from the start.
        """
        if not self._log:
            raise ArgumentError(
                "the controller asked for torques that are not finite from the start: "
                f"{self._wanted}"
            )
        outcome, episode = self._outcome, self.episode
        if episode.contacts and outcome == "done":
            outcome = "contact"
        if episode.unseen and outcome == "done":
            outcome = f"unseen: {', '.join(episode.unseen)}"
        return Trial(self._log.arrays(), outcome, self._log.channels, touched=episode.touched)
