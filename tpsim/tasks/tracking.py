"""Tracking two moving objects with two hands that share a trunk (Section 7, Fig. 11).

At times the objects are too far apart. A teacher leads the hands through three behaviours, each
taught apart: the left object counts more, the right one does, or both alike. The candidate frames
are each hand seen from its object, Eq. (41), and each hand in the nullspace of the other,
Eq. (44): how precise the demonstrations are in these four decides in reproduction who has priority.
A fifth frame, the arms' posture in the nullspace of both hands (Eq. 42), bends what is left.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from tpsim import rotation
from tpsim.errors import ArgumentError
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.sim import scene
from tpsim.sim.controllers.controller import Behaviour
from tpsim.sim.controllers.pursuit import Pursuit
from tpsim.sim.coordinates.coordinate import Coordinate
from tpsim.sim.coordinates.following import Following, FollowingBeneath, PostureBeneathHands
from tpsim.sim.hand import Guide, Hand, Path
from tpsim.sim.objects import ObjectPath
from tpsim.sim.script import Variation, minimum_jerk, wandering
from tpsim.sim.simulation import Simulation
from tpsim.sim.teach import Lesson
from tpsim.sim.trial import Trial
from tpsim.tasks.leaning import TEACHINGS, Body
from tpsim.tasks.task import Situation, Task, demonstration

SIDES = ("left", "right")
"""The hands; the left object is the one farther to the left."""

SITES = {side: f"{side}_hand" for side in SIDES}
"""Sites that recordings keep, by the name they have there."""

ARMS = ("left_shoulder", "left_elbow", "right_shoulder", "right_elbow")
"""Joints that are not the trunk's."""

VIAS = 5
"""Moments between which the objects move: together, apart, together, apart, together."""

SECONDS = 15.0
"""How long the objects move [s]."""

HEADING = 0.8
"""Where the middle between the objects may be, about straight ahead, to both sides [rad]."""

NEAR, FAR = (0.55, 0.75), (0.72, 0.88)
"""Distances of objects from the trunk's foot when they are together and when they are apart [m]."""

TOGETHER, APART = (0.3, 0.7), (0.3, 0.6)
"""Angle between objects that are together, as a share of what both can be reached with, and how
much more it is than that when they are apart [rad]."""

FLOOR = -0.054
"""Height of the objects [m]."""

PERIOD = 0.05
"""Time between two points of an object's path [s]."""

SHORT, SMOOTH = 0.003, 0.003
"""How much of an arm's length the teacher keeps it from being stretched, and how softly [m]."""

FADE = 0.5
"""Time [s] over which a teacher's hand begins to wander."""

EFFORT = 0.0007
"""Cost of acceleration [s^4/(kg m^2)]: the one number that sets how soft the robot is."""

REACHED = 0.01
"""Distance [m] up to which a hand is at its object."""


BEHAVIOURS = tuple(f"tracking-{teaching}" for teaching in TEACHINGS)
"""What is taught; each is also a task by itself."""


class Tracking(Task):
    """Follow two objects with two hands, as a behaviour was taught.

    The behaviour's name is the kind of controller; ``"learned"`` is the first one.

    Parameters
    ----------
    name : str
    behaviours : tuple of str
        Out of ``BEHAVIOURS``. They are performed apart, not together.
    """

    sites, duration = SITES, SECONDS

    def __init__(self, name: str, behaviours: tuple[str, ...]):
        self.name, self.behaviours = name, behaviours

    def simulation(self, xml: str | None = None) -> Simulation:
        """The trunk with two arms, and two objects."""
        return Simulation(scene.planar5() if xml is None else xml)

    def coordinates(self, simulation: Simulation, behaviour: str) -> tuple[Coordinate, ...]:
        """Both hands from their objects, each beneath the other, and the posture beneath both."""
        left, right = (
            Following(f"{side} hand", f"{side}_hand", f"{side}_object") for side in SIDES
        )
        return (
            left,
            FollowingBeneath("right beneath left", left, right),
            FollowingBeneath("left beneath right", right, left),
            right,
            PostureBeneathHands("posture", ARMS, (left, right)),
        )

    def lesson(self, simulation: Simulation, behaviour: str, rng) -> Lesson:
        """Draw paths of the objects, and how a person leads both hands after them."""
        body, h = Body.of(simulation), simulation.timestep
        points = _points(self._vias(body, rng), h * np.arange(round(SECONDS / h)))
        angle, _ = body.lean(*points, teaching(behaviour))
        guides = tuple(
            _guide(side, body.led(angle, point, SHORT, SMOOTH), h, rng)
            for side, point in zip(SIDES, points, strict=True)
        )
        start = body.posture(angle[0], *(point[0] for point in points))
        return Lesson(start, guides, SECONDS, objects=_paths(points[:, :: round(PERIOD / h)]))

    def _vias(self, body, rng):
        """Heading [rad], angle between the objects [rad], distances of both [m]: (VIAS, 4)."""
        vias = np.empty((VIAS, 4))
        vias[:, 0] = np.pi / 2 + rng.uniform(-HEADING, HEADING, VIAS)
        for k, via in enumerate(vias):
            via[2:] = rng.uniform(*(FAR if k % 2 else NEAR), 2)
            both = body.half_width(via[2:]).sum()
            via[1] = both + rng.uniform(*APART) if k % 2 else both * rng.uniform(*TOGETHER)
        return vias

    def learn(
        self, simulation: Simulation, behaviour: str, trials: Sequence[Trial], components: int
    ) -> TPGMM:
        """Fit a TP-GMM with one precision for each frame, alike in all directions.

        A few demonstrations show how much an error matters, not that it matters more along the
        few directions in which the objects happened to be out of reach.
        """
        coordinates = self.coordinates(simulation, behaviour)
        seen = [demonstration(simulation.robot, trial, coordinates) for trial in trials]
        return fit_tp_gmm(seen, components, covariance="spherical")

    def draw(self, simulation: Simulation, rng) -> tuple[np.ndarray, dict]:
        """Draw paths of the objects; the hands start at them."""
        body = Body.of(simulation)
        vias = self._vias(body, rng)
        points = _points(vias, [0.0])
        angle, _ = body.lean(*points, "compromise")
        return body.posture(angle[0], *points[:, 0]), {"vias": vias.tolist()}

    def objects(self, situation: Situation) -> tuple[ObjectPath, ...]:
        """Where the objects are: between the vias of the situation, or as it says itself."""
        if "vias" not in situation.details:
            return super().objects(situation)
        vias = np.array(situation.details["vias"])
        return _paths(_points(vias, PERIOD * np.arange(round(SECONDS / PERIOD) + 1)))

    def controller(
        self, simulation: Simulation, models: Mapping[str, TPGMM], start, kind: str = "learned"
    ) -> Pursuit:
        """Follow the objects as one of the behaviours was taught."""
        name = self.behaviours[0] if kind == "learned" else kind
        if name not in self.behaviours:
            raise ArgumentError(
                f"tracking has no controller '{kind}'; use 'learned' or one of its behaviours "
                f"{', '.join(self.behaviours)}"
            )
        behaviour = Behaviour(name, self.coordinates(simulation, name), models[name])
        return Pursuit(simulation, [behaviour], effort=EFFORT)

    def errors(self, simulation: Simulation):
        """Distance [m] of each hand from its object."""
        left, _, _, right, _ = self.coordinates(simulation, self.behaviours[0])
        views = {view.name: view.bind(simulation.robot) for view in (left, right)}
        return lambda: {
            name: (float(np.linalg.norm(view()[0])), REACHED) for name, view in views.items()
        }


def teaching(behaviour: str) -> str:
    """Which of ``TEACHINGS`` a behaviour is."""
    return behaviour.removeprefix("tracking-")


def _points(vias, times) -> np.ndarray:
    """Places of both objects (2, T, 2) [m] at times (T,), minimum jerk through the vias."""
    heading, between, *distances = minimum_jerk(np.linspace(0, SECONDS, VIAS), vias)(times).T
    bearings = heading + between / 2, heading - between / 2
    return np.array(
        [
            np.stack([r * np.cos(bearing), r * np.sin(bearing)], axis=-1)
            for bearing, r in zip(bearings, distances, strict=True)
        ]
    )


def _paths(points) -> tuple[ObjectPath, ...]:
    """Paths of both objects through points (2, V, 2), turned as on a carousel about the trunk."""
    paths = []
    for side, place in zip(SIDES, points, strict=True):
        turn = np.zeros((len(place), 3))
        turn[:, 2] = np.unwrap(np.arctan2(place[:, 1], place[:, 0]))
        quaternions = rotation.continuous(rotation.to_quaternion(rotation.exp(turn)))
        positions = np.column_stack([place, np.full(len(place), FLOOR)])
        times = PERIOD * np.arange(len(place))
        paths.append(ObjectPath(f"{side}_object", positions, times, quaternions))
    return tuple(paths)


def _guide(side, points, timestep, rng) -> Guide:
    """A person's hand that leads one of the robot's along points (T, 2) [m]."""
    steps = len(points)
    strayed, _ = wandering(steps, timestep, rng, Variation())
    fade = np.minimum(timestep / FADE * np.arange(steps), 1.0)[:, None]
    positions, velocities = np.zeros((2, steps, 3))
    positions[:, :2] = points + fade * strayed[:, :2]
    velocities[:, :2] = np.gradient(points, timestep, axis=0)
    path = Path(
        positions,
        np.broadcast_to(np.eye(3), (steps, 3, 3)),
        velocities,
        np.zeros((steps, 3)),
    )
    hand = Hand(angular_stiffness=0.0, angular_damping=0.0)
    return Guide(f"{side}_guide", f"{side}_hand", hand, path)


def task(name: str) -> Tracking:
    """The task called ``tracking``, or by one of its behaviours."""
    return Tracking(name, BEHAVIOURS if name == "tracking" else (name,))
