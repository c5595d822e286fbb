"""One trial as it goes: clock, objects, sensors, motors, people, physics, step by step."""

import copy
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from tpsim.errors import SimulationError
from tpsim.robot.objects import Objects
from tpsim.robot.state import State
from tpsim.world.object_path import MovingObjects, ObjectPath
from tpsim.world.perception import Camera
from tpsim.world.plant import NOMINAL, Delay, Plant, Sensors
from tpsim.world.simulation import Simulation

DIVERGED_SPEED = 30.0
"""Joint speed [rad/s] beyond which a robot is given up as diverged."""


class BoundPerson(Protocol):
    """A person in one simulation."""

    name: str
    wrench: np.ndarray

    @property
    def point(self) -> np.ndarray:
        """Where the wrench acts (3,) [m]."""
        ...

    def act(self, step: int, state: State) -> None:
        """Apply the wrench of a time step."""
        ...


class Person(Protocol):
    """Who pushes or leads the robot: a value that is bound to each simulation anew."""

    def bind(self, simulation: Simulation) -> BoundPerson:
        """Look up the names in one simulation."""
        ...


class Moves(Protocol):
    """What moves the objects of one simulation."""

    now: Objects

    def act(self, step: int) -> None:
        """Move the objects to their poses at a time step."""
        ...


class Episode:
    """What a controller drives its robot in, one time step after another.

    A step is :meth:`sense`, :meth:`act`, :meth:`advance`, in this order: whoever decides about
    the torque meanwhile, the same torques give the same movement, bit for bit.

    Parameters
    ----------
    simulation : Simulation
    people : sequence of Person
        Who pushes and leads the robot.
    objects : sequence of ObjectPath
        Where movable objects are; those without a path stay where the scene has them.
    plant : Plant
        Sensors, latency and how objects are seen.

    Attributes
    ----------
    people : list of BoundPerson
        More may come while it goes.
    objects : MovingObjects
        What moves the objects; who leads them by hand puts something else of this kind there.
    truth : State
        Where the robot is, which people feel and recordings keep; sensors may say otherwise.
    saturated, contacts : int
        Time steps so far in which a motor was at its limit, and in which something touched.
    touched : str
        The first two bodies that touched, such as ``"upper_arm and table"``.
    sound : bool
        Whether all torques that were wanted so far are finite.
    """

    def __init__(
        self,
        simulation: Simulation,
        people: Sequence[Person] = (),
        objects: Sequence[ObjectPath] = (),
        plant: Plant = NOMINAL,
    ):
        self.simulation, self._plant = simulation, plant
        self._limit = simulation.robot.torque_limit
        self.people = [person.bind(simulation) for person in people]
        self.objects: Moves = MovingObjects(objects, simulation)
        period = plant.control_period
        self.control_steps = 1 if period is None else max(1, round(period / simulation.timestep))

    def copy(self) -> "Episode":
        """The same trial at the same moment, with a simulation of its own and nobody in it."""
        other, simulation = copy.copy(self), self.simulation.copy()
        other.simulation, other.people = simulation, []
        if not isinstance(self.objects, MovingObjects):
            raise SimulationError("objects that somebody moves by hand are in one trial only")
        other.objects = self.objects.moved_to(simulation)
        own = self._sensors, self._delay, self._camera
        other._sensors, other._delay, other._camera = copy.deepcopy(own)
        return other

    def reset(self, start: np.ndarray) -> None:
        """Put the robot at rest at a start posture (n,) [rad], and the clock at zero."""
        simulation = self.simulation
        simulation.reset(start)
        self._step = self.saturated = self.contacts = 0
        self.touched, self.sound = "", True
        exact = self._plant.encoder_bits is None
        self._sensors = None if exact else Sensors(self._plant, simulation.timestep)
        perception, first = self._plant.perception, self.objects.now
        rows = simulation.objects
        self._camera = None if perception is None else Camera(perception, rows, first)
        held = simulation.robot.gravity_torque(start)
        late = self._plant.latency > 0
        self._delay = Delay(self._plant, simulation.timestep, held) if late else None

    def sense(self) -> State:
        """Move the objects to where they are now; return what the robot senses."""
        simulation = self.simulation
        self.objects.act(self._step)
        if self._step == 0:
            simulation.begin()
        x, seen, time = simulation.x, simulation.see(self.objects.now), simulation.data.time
        self.truth = State(simulation.robot, x, seen, time)
        if self._sensors is None and self._camera is None:
            return self.truth
        if self._camera is not None:
            seen = self._camera.look(time, seen)
        measured = x if self._sensors is None else self._sensors.measure(x)
        return State(simulation.robot, measured, seen, time)

    @property
    def unseen(self) -> tuple[str, ...]:
        """Objects that the robot did not see up to now."""
        return () if self._camera is None else self._camera.unseen

    @property
    def objects_seen(self) -> dict[str, int]:
        """Row of each object and thing among those that a state knows of."""
        simulation = self.simulation
        return {name: k for k, name in enumerate((*simulation.objects, *simulation.grasps.things))}

    @property
    def diverged(self) -> bool:
        """Whether the robot is faster than any robot, or the simulation lost its state."""
        simulation = self.simulation
        # MuJoCo starts over where the state is lost: its clock then disagrees with ours.
        lost = simulation.time < (self._step - 1) * simulation.timestep
        return bool(lost or not np.abs(self.truth.dq).max() < DIVERGED_SPEED)

    def act(self, wanted: np.ndarray) -> np.ndarray:
        """Let people act; torque (n,) [Nm] that the motors give when (n,) is wanted."""
        if self.people:
            self.simulation.clear_wrenches()
            for person in self.people:
                person.act(self._step, self.truth)
        if self._delay is not None:
            wanted = self._delay.pass_on(wanted)
        # Not a number is not within the limit either.
        if np.count_nonzero(np.abs(wanted) <= self._limit) == len(wanted):
            return wanted
        self.sound = self.sound and bool(np.isfinite(wanted).all())
        self.saturated += 1
        return np.minimum(np.maximum(wanted, -self._limit), self._limit)

    def advance(self, torque: np.ndarray) -> None:
        """Let one time step pass with joint torques (n,) [Nm] within the motors' limits."""
        self.simulation.step(torque)
        if self.simulation.touches:
            self.contacts += 1
            self.touched = self.touched or self.simulation.touching
        self._step += 1
