"""The teacher of pointing: leads an arm to point at one object, at another, and back to rest."""

from dataclasses import dataclass, replace

import numpy as np

from tpsim.errors import SimulationError
from tpsim.pose import Pose
from tpsim.robot.objects import Objects
from tpsim.tasks.pointing.pointers import Pointer
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.care import Care
from tpsim.world.people.demonstrator import HUMAN, Demonstrator, TeacherName
from tpsim.world.people.guide import Guide
from tpsim.world.people.posture_script import hand_path, through
from tpsim.world.people.script import Variation
from tpsim.world.reach import satisfy
from tpsim.world.teaching import Lesson
from tpsim.world.world import World

SCHEDULE = (0.0, 0.5, 2.0, 4.0, 5.5, 7.5, 9.0, 10.0)
"""When the teacher leaves rest, reaches and leaves each object, is at rest again, and ends [s]."""

PHASES = {"first": (2.0, 4.0), "second": (5.5, 7.5)}
"""When the teacher points at each object [s]."""

APPROACH = 1.5
"""How long the teacher takes to turn to an object [s]."""

AIMING = {
    "firm": Demonstrator(
        variation=Variation(drift=0.0012, tremor=0.0004, angular_drift=0.006, angular_tremor=0.002)
    ),
    "human": HUMAN,
}
"""Who looks closely where the arm points; firm hands are as steady all the while."""

SETTLING = 0.5
"""Time [s] over which the teacher begins to see to where the arm points, and ceases to."""


@dataclass(frozen=True)
class PointingTeacher:
    """Draws lessons, and places of objects that the arm can be made to point at.

    Parameters
    ----------
    pointer : Pointer
    restless, bent : float
        Standard deviations of the posture that the teacher prefers at rest and while pointing
        [rad].
    hurry : float
        Standard deviation of the teacher's timing [s].
    teacher : str
        Whose hands lead the arm.
    """

    pointer: Pointer
    restless: float
    bent: float
    hurry: float
    teacher: TeacherName = "firm"

    def __call__(self, world: World, rng: np.random.Generator) -> Lesson:
        """Draw objects, and how a person leads the arm to point at them in turn."""
        robot, h = world.robot, world.timestep
        objects = self.objects(world, rng)
        start, end = (self.rest(world, rng) for _ in range(2))
        first, second = (self.aim(world, path, rng) for path in objects)
        times = np.array(SCHEDULE)
        times[1:-1] += self.hurry * rng.standard_normal(len(times) - 2)
        postures = through(times, [start, start, first, first, second, second, end, end], h)
        care, who = self._care(times, h * np.arange(1, len(postures) + 1)), AIMING[self.teacher]
        (sight,) = who.sights(rng)
        guides = tuple(
            Guide(
                f"{site}_guide",
                site,
                who.grip if turns else replace(who.grip, angular_stiffness=0, angular_damping=0),
                hand_path(robot, site, postures, h, rng, who.variation, care if turns else None),
                # One looks at what points, not at the elbow.
                sight=sight if turns else None,
                care=care,
            )
            for site, turns in self.pointer.grips.items()
        )
        taught = robot.index(self.pointer.joints)
        held = tuple(joint for i, joint in enumerate(robot.joints) if i not in taught)
        return Lesson(start, guides, SCHEDULE[-1], held, objects)

    def _care(self, times: np.ndarray, clock: np.ndarray) -> Care:
        """Where the arm points matters while it points, not on the way."""
        (since, until), (again, end) = times[2:4], times[4:6]
        knots = [since - SETTLING, since, until, until + SETTLING]
        knots += [again - SETTLING, again, end, end + SETTLING]
        matters = np.interp(clock, knots, [0, 1, 1, 0, 0, 1, 1, 0])[:, None]
        seen_to = self.pointer.seen_to
        return Care(matters * np.array(seen_to.position), matters * np.array(seen_to.rotation))

    def objects(self, world: World, rng: np.random.Generator) -> tuple[ObjectPath, ...]:
        """Objects at rest, well apart as seen from the resting arm."""
        origin = world.robot.at_home.pose(self.pointer.axis.site).position
        placed = self.pointer.objects(rng, origin)
        return tuple(ObjectPath.at(name, position) for name, position in placed.items())

    def rest(self, world: World, rng: np.random.Generator) -> np.ndarray:
        """Posture (n,) in which the arm rests, as the teacher happens to leave it."""
        return self._near_home(world, rng, self.restless)

    def aim(self, world: World, path: ObjectPath, rng: np.random.Generator) -> np.ndarray:
        """Posture (n,) that points at an object at rest, bent as the teacher likes it.

        Raises
        ------
        SimulationError
            If the arm cannot point there.
        """
        return self._aimed(world, path.name, path.first, self._near_home(world, rng, self.bent))

    def can_aim(self, world: World, path: ObjectPath, rng: np.random.Generator) -> bool:
        """Whether the arm points off its limits, bent as at home and as the teacher likes it."""
        try:
            return self.can_follow(world, path) and world.robot.is_comfortable(
                self.aim(world, path, rng)
            )
        except SimulationError:
            return False

    def can_follow(self, world: World, path: ObjectPath) -> bool:
        """Whether the arm, bent as at home, points off its limits at all places of a path."""
        robot, places = world.robot, np.unique(path.positions, axis=0)
        try:
            return all(
                robot.is_comfortable(self._aimed(world, path.name, Pose(np.eye(3), p), robot.home))
                for p in places
            )
        except SimulationError:
            return False

    def _aimed(self, world: World, name: str, place: Pose, bent: np.ndarray) -> np.ndarray:
        """Posture (n,) that points at an object called ``name``, its redundancy as it is bent."""
        origin = bent[world.robot.index(self.pointer.joints)]
        views = self.pointer.bearing(name), self.pointer.posture(origin)
        return satisfy(world.robot, views, bent, Objects.of({name: place}))

    def _near_home(self, world: World, rng: np.random.Generator, deviation: float) -> np.ndarray:
        robot = world.robot
        posture: np.ndarray = deviation * rng.standard_normal(robot.n)
        untaught = np.setdiff1d(np.arange(robot.n), robot.index(self.pointer.joints))
        posture[untaught] = 0.0
        return robot.home + posture
