"""Pointing at two objects in turn, and back to rest (Section 7, Fig. 10).

The frames are candidate projections of Table 3: the arm's posture in the nullspace of its
direction (Eq. 42), its direction in the robot's frame (Eq. 40), and its direction towards each
object, which may move (Eq. 41); all are functions of time (Eq. 20). The same code teaches,
learns and performs it on the planar arm of three links (``pointing``) and, in space, with the
gripper of Baxter's left arm (``pointing-baxter``).
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.subspace import MFA
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.sim.controllers.controller import Behaviour
from tpsim.sim.controllers.timed_intervention import TimedIntervention
from tpsim.sim.coordinates.coordinate import Coordinate
from tpsim.sim.coordinates.direction import Direction, DirectionTo, PostureBeneath
from tpsim.sim.hand import Guide, Hand
from tpsim.sim.objects import MovingObjects, ObjectPath
from tpsim.sim.posture_script import hand_path, posture_at, through
from tpsim.sim.script import Variation
from tpsim.sim.simulation import Simulation
from tpsim.sim.teach import Lesson
from tpsim.sim.trial import Trial
from tpsim.tasks.pointers import BAXTER, OBJECTS, PLANAR, Pointer
from tpsim.tasks.task import Task, demonstration

SCHEDULE = (0.0, 0.5, 2.0, 4.0, 5.5, 7.5, 9.0, 10.0)
"""When the teacher leaves rest, reaches and leaves each object, is at rest again, and ends [s]."""

PHASES = {"first": (2.0, 4.0), "second": (5.5, 7.5)}
"""When the teacher points at each object [s]."""

POINTED, RESTED = float(np.radians(1.5)), 0.1
"""Angles [rad] up to which the arm points at an object, and up to which it is at rest."""

APPROACH = 1.5
"""How long the teacher takes to turn to an object [s]."""

HURRY = 0.05
"""Standard deviation of the teacher's timing [s]."""

RESTLESS, BENT = 0.02, 0.06
"""Standard deviations of the posture that the teacher prefers at rest and while pointing [rad]."""

STEADY = Variation(drift=0.0012, tremor=0.0004, angular_drift=0.006, angular_tremor=0.002)
"""How the hand of a person strays who looks closely where the arm points."""

STRUCTURE = MFA(1)
"""Of the covariances: time moves everything, what remains is each dimension's own. Six
demonstrations are too few to say how five joints depend on each other (Section 4.2)."""

EFFORT = 0.05
"""Cost of acceleration [s^4/(kg m^2)]: the one number that sets how soft the robot is."""

HOLD, FREE = 0.1, 10.0
"""Standard deviations [rad] with which joints that were not taught hold their start, and with
which the others do, which says nothing."""


class Pointing(Task):
    """Point at two objects in turn.

    Parameters
    ----------
    name : str
    pointer : Pointer
        The arm that points.

    Attributes
    ----------
    rest : (n,)
        The teacher's rest posture [rad].
    """

    duration = SCHEDULE[-1]
    components = 6

    def __init__(self, name: str, pointer: Pointer):
        self.name, self.behaviours = name, (name,)
        self.pointer, self.sites, self.hand = pointer, pointer.sites, pointer.site
        self.rest = np.array(pointer.rest)

    def simulation(self, xml: str | None = None) -> Simulation:
        """The robot and its two objects."""
        return Simulation(self.pointer.scene() if xml is None else xml)

    def coordinates(self, simulation: Simulation, behaviour: str) -> tuple[Coordinate, ...]:
        """Posture beneath the direction, direction in the base, directions to the objects."""
        return (
            self._posture(simulation, self.rest),
            self._direction(simulation),
            *(self._towards(name) for name in OBJECTS),
        )

    def _direction(self, simulation):
        robot, pointer = simulation.robot, self.pointer
        robot.update_kinematics(self.rest)
        R, _ = robot.placement(robot.site(pointer.site))
        return Direction("direction in base", pointer.site, pointer.axes, tuple(R.ravel().tolist()))

    def _towards(self, name):
        return DirectionTo(f"direction to {name}", self.pointer.site, name, self.pointer.axes)

    def _posture(self, simulation, q):
        joints, robot = self.pointer.joints, simulation.robot
        origin = tuple(float(q[robot.joints.index(joint)]) for joint in joints)
        return PostureBeneath(
            "posture", joints, self._direction(simulation), self.pointer.free, origin
        )

    def lesson(self, simulation: Simulation, behaviour: str, rng) -> Lesson:
        """Draw objects, and how a person leads the arm to point at them in turn."""
        robot, h = simulation.robot, simulation.timestep
        objects = self._objects(simulation, rng)
        start, end = (self._near_rest(simulation, rng, RESTLESS) for _ in range(2))
        first, second = (self._aim(simulation, path, rng) for path in objects)
        times = np.array(SCHEDULE)
        times[1:-1] += HURRY * rng.standard_normal(len(times) - 2)
        postures = through(times, [start, start, first, first, second, second, end, end], h)
        guides = tuple(
            Guide(
                f"{site}_guide",
                site,
                Hand() if turns else Hand(angular_stiffness=0.0, angular_damping=0.0),
                hand_path(robot, site, postures, h, rng, STEADY),
            )
            for site, turns in self.pointer.grips
        )
        held = tuple(joint for joint in robot.joints if joint not in self.pointer.joints)
        return Lesson(start, guides, self.duration, held, objects)

    def _near_rest(self, simulation, rng, deviation):
        taught = np.isin(simulation.robot.joints, self.pointer.joints)
        return self.rest + deviation * taught * rng.standard_normal(self.rest.size)

    def _objects(self, simulation, rng):
        robot = simulation.robot
        robot.update_kinematics(self.rest)
        _, p = robot.placement(robot.site(self.pointer.site))
        placed = self.pointer.objects(rng, p.copy())
        return tuple(ObjectPath.at(name, position) for name, position in placed.items())

    def _aim(self, simulation, path: ObjectPath, rng):
        """Posture (n,) that points at an object at rest, bent as the teacher likes it."""
        preferred = self._near_rest(simulation, rng, BENT)
        MovingObjects([path], simulation).act(0)
        coordinates = self._towards(path.name), self._posture(simulation, preferred)
        return posture_at(simulation.robot, coordinates, preferred)

    def learn(
        self, simulation: Simulation, behaviour: str, trials: Sequence[Trial], components: int
    ) -> TPGMM:
        """Fit a TP-GMM over time and all frames to the demonstrations."""
        coordinates = self.coordinates(simulation, behaviour)
        views = [demonstration(simulation.robot, trial, coordinates) for trial in trials]
        timed = [view.with_time() for view in views]
        return fit_tp_gmm(timed, components, covariance=STRUCTURE, start="time")

    def draw(self, simulation: Simulation, rng) -> tuple[np.ndarray, dict]:
        """Draw a start near rest, and objects that the teacher could point at."""
        start, objects = self._near_rest(simulation, rng, RESTLESS), self._objects(simulation, rng)
        for path in objects:
            if not self.is_comfortable(simulation, self._aim(simulation, path, rng)):
                return self.draw(simulation, rng)
        return start, {"objects": [asdict(path) for path in objects]}

    def controller(
        self, simulation: Simulation, models: Mapping[str, TPGMM], start, kind: str = "learned"
    ) -> TimedIntervention:
        """Point at the objects, wherever they move; joints that were not taught hold ``start``."""
        if kind != "learned":
            raise ArgumentError(f"pointing has no controller '{kind}'; use 'learned'")
        taught = np.isin(simulation.robot.joints, self.pointer.joints)
        prior = Gaussian(np.array(start), np.diag(np.where(taught, FREE, HOLD) ** 2))
        (name,) = self.behaviours
        behaviour = Behaviour(name, self.coordinates(simulation, name), models[name])
        return TimedIntervention(
            simulation, behaviour, effort=EFFORT, until=SCHEDULE[-1], prior=prior
        )

    def errors(self, simulation: Simulation):
        """Angle [rad] to the object that it is time to point at; in the end, to rest."""
        robot = simulation.robot
        seen = {name: self._towards(name).bind(robot) for name in OBJECTS}
        taught = np.isin(robot.joints, self.pointer.joints)

        def evaluate():
            for name, (begin, end) in PHASES.items():
                if begin <= simulation.time < end:
                    return {name: (float(np.linalg.norm(seen[name]()[0])), POINTED)}
            if simulation.time >= SCHEDULE[-2]:
                return {"rest": (float(np.abs(robot.q - self.rest)[taught].max()), RESTED)}
            return {}

        return evaluate


def task(name: str) -> Pointing:
    """The task called ``pointing`` or ``pointing-baxter``."""
    return Pointing(name, BAXTER if name.endswith("baxter") else PLANAR)
