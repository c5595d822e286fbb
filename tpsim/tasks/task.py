"""What a task is: a scene, how it is taught, what is learned, how it is performed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from tpsim.control import projection
from tpsim.demonstration import Demonstration
from tpsim.errors import SimulationError
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.sim.controllers.controller import Controller
from tpsim.sim.coordinates.coordinate import Coordinate
from tpsim.sim.hand import Guide
from tpsim.sim.objects import ObjectPath
from tpsim.sim.push import Push
from tpsim.sim.robot import Robot
from tpsim.sim.rollout import rollout
from tpsim.sim.simulation import Simulation
from tpsim.sim.teach import Lesson
from tpsim.sim.trial import Trial

ATTEMPTS = 100
"""Situations drawn before a task gives up finding one that the robot can be put in."""


@dataclass(frozen=True)
class Situation:
    """One situation in which a task is performed: everything that was drawn for it.

    Parameters
    ----------
    seed, index : int
        Situation ``index`` draws from ``SeedSequence(seed, spawn_key=(index,))``.
    start : (n,) tuple
        Start posture [rad].
    details : dict
        What else the task drew, as plain JSON values.
    """

    seed: int
    index: int
    start: tuple[float, ...]
    details: dict = field(default_factory=dict)


class Task:
    """A task on one scene; each subclass is one file of :mod:`tpsim.tasks`.

    Attributes
    ----------
    name : str
    behaviours : tuple of str
        What is taught, each apart from the others; one model is learned of each.
    sites : dict
        Sites that recordings keep, by name.
    duration : float
        Of a performance [s].
    hand : str
        Body or site that people push if they do not say where.
    demonstrations, components : int
        How often a whole run teaches each behaviour, and the Gaussians that it learns of it.
    """

    name: str
    behaviours: tuple[str, ...]
    sites: Mapping[str, str]
    duration: float
    hand: str = "left_hand"
    demonstrations: int = 6
    components: int = 1

    def simulation(self, xml: str | None = None) -> Simulation:
        """The task's scene, or the recorded scene ``xml`` of a run folder."""
        raise NotImplementedError

    def lesson(self, simulation: Simulation, behaviour: str, rng) -> Lesson:
        """Draw one demonstration of a behaviour."""
        raise NotImplementedError

    def coordinates(self, simulation: Simulation, behaviour: str) -> tuple[Coordinate, ...]:
        """Candidate frames of a behaviour that are coordinates of the robot; none by default."""
        return ()

    def draw(self, simulation: Simulation, rng) -> tuple[np.ndarray, dict]:
        """Draw a start posture (n,) and the details of a situation; may be unreachable."""
        raise NotImplementedError

    def perform(
        self,
        simulation: Simulation,
        models: Mapping[str, TPGMM],
        situation: Situation,
        *,
        controller: str = "learned",
        people: Sequence[Push | Guide] = (),
        duration: float | None = None,
    ) -> Trial:
        """Perform the task once."""
        return rollout(
            simulation,
            self.controller(simulation, models, situation.start, controller),
            situation.start,
            self.duration if duration is None else duration,
            sites=self.sites,
            people=people,
            objects=self.objects(situation),
        )

    def controller(
        self, simulation: Simulation, models: Mapping[str, TPGMM], start, kind: str = "learned"
    ) -> Controller:
        """What drives the robot from a start posture (n,): learned, or of a kind to compare."""
        raise NotImplementedError

    def objects(self, situation: Situation) -> tuple[ObjectPath, ...]:
        """Where movable objects are in a situation: as its details say."""
        return tuple(ObjectPath(**path) for path in situation.details.get("objects", ()))

    def errors(self, simulation: Simulation) -> Callable[[], dict[str, tuple[float, float]]]:
        """Return a function that measures how well the task is done at the robot's last update.

        It gives each error that counts now by name, with the size up to which it is none: what
        an environment rewards. By default nothing counts.
        """
        return dict

    def learn(
        self, simulation: Simulation, behaviour: str, trials: Sequence[Trial], components: int
    ) -> TPGMM:
        """Fit the TP-GMM of one behaviour to its demonstrations (Appendix A)."""
        seen = [
            demonstration(simulation.robot, trial, self.coordinates(simulation, behaviour))
            for trial in trials
        ]
        return fit_tp_gmm(seen, components)

    def situation(self, simulation: Simulation, seed: int, index: int, **kind) -> Situation:
        """Situation ``index`` of a seed: drawn until the robot can be put in it freely.

        ``kind`` is handed to :meth:`draw`, where a task draws several kinds of situations.

        Raises
        ------
        SimulationError
            If no reachable, contact-free start posture is found.
        """
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1, index)))
        for _ in range(ATTEMPTS):
            try:
                start, details = self.draw(simulation, rng, **kind)
                simulation.reset(start)
            except SimulationError:
                continue
            if simulation.data.ncon == 0 and self.is_comfortable(simulation, start):
                return Situation(seed, index, tuple(start.tolist()), details)
        raise SimulationError(
            f"task '{self.name}' found no start posture that the robot can reach without contact "
            f"in {ATTEMPTS} draws; give its workspace less range"
        )

    def is_comfortable(self, simulation: Simulation, start) -> bool:
        """Whether a start posture keeps 0.15 rad from joint limits and has torque to spare."""
        robot = simulation.robot
        margin = np.minimum(start - robot.lower, robot.upper - start).min()
        load = np.abs(robot.gravity_torque(start)) / robot.torque_limit
        return margin > 0.15 and load.max() < 0.8


def demonstration(robot: Robot, trial: Trial, coordinates: Sequence[Coordinate], name=""):
    """One taught trial as it is seen from every candidate frame.

    Parameters
    ----------
    robot : Robot
    trial : Trial
        From kinesthetic teaching; ``q (T, n)`` counts, and where the objects were.
    coordinates : sequence of Coordinate
        The P candidate frames.
    name : str

    Returns
    -------
    Demonstration
        ``data`` is q (T, n), ``observations`` holds y_j(q), (T, d_j) each, and ``frames`` the
        moving projections of Table 3 that map them back to joint space.
    """
    q = trial["q"]
    objects = {
        name: (trial[f"{name}_position"], trial[f"{name}_quaternion"]) for name in robot.objects
    }
    observations, frames = [], []
    for coordinate in coordinates:
        y, J = coordinate.observe(robot, q, objects)
        observations.append(y)
        frames.append(projection.absolute(J, q, y))
    return Demonstration(trial["time"], q, frames, observations, name)
