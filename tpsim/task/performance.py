"""A task that an agent performs: what it sees, what it commands, and what it gets for it.

The environments of dm_env and Gymnasium are two faces of this. A time step is a step of
:class:`~tpsim.world.episode.Episode`, as in a roll-out: the torques of one of our controllers,
given as actions, repeat its roll-out bit for bit.
"""

from collections.abc import Sequence
from typing import Literal, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import Duration, NotNegative, Number, SeedNumber, border
from tpsim.controllers.renewed import FixedImpedance
from tpsim.errors import ArgumentError
from tpsim.robot.state import State
from tpsim.robot.views.view import View
from tpsim.task.check import check
from tpsim.task.task import Goal, Models, Situation, Task, draw_situation
from tpsim.world.episode import Episode, Person
from tpsim.world.impedance import Controller, Drive
from tpsim.world.plant import NOMINAL, Plant

Action = Literal["torque", "impedance"]
"""What an agent may command: joint torques, or the posture to which a spring and a damper pull."""

SLOPE = 10.0
"""Multiple of what counts as no error beyond its bound at which 0.1 of the reward is left."""

TURN = 2 * np.pi
"""How far from home an agent may command a joint without limits [rad]."""


class Options(TypedDict, total=False):
    """What :class:`Performance` may be given beside its task, for environments to pass on."""

    models: Models | None
    action: Action
    duration: float | None
    control_timestep: float | None
    stiffness: float
    people: Sequence[Person]
    plant: Plant


class Performance:
    """One task, performed by an agent, episode by episode.

    Parameters
    ----------
    task : Task
    models, action, duration, control_timestep, stiffness, people, plant
        As :func:`tpsim.task.environment.environment` describes them.

    Attributes
    ----------
    simulation : Simulation
    state : State
        What the robot senses now.
    period : float
        Time between two actions [s].
    actions : int
        Actions in an episode.

    Raises
    ------
    ArgumentError
        If a number is not positive or there is no such action.
    SimulationError
        If a view asks for a site or an object that is not there.
    """

    @border
    def __init__(
        self,
        task: Task,
        *,
        models: Models | None = None,
        action: Action = "torque",
        duration: Duration | None = None,
        control_timestep: Duration | None = None,
        stiffness: NotNegative = 100.0,
        people: Sequence[Person] = (),
        plant: Plant = NOMINAL,
    ):
        self.task, self.action, self._models = task, action, models
        self._people, self._plant = tuple(people), plant
        self.robot, self.simulation = task.stage.robot, task.stage.simulation(plant, visible=True)
        check(task)
        self._goals, self._views = task.goals(), _frames(task)
        self._sites = task.sites()
        self._impedance = FixedImpedance(self.robot.home, stiffness)
        self._situation: Situation | None = None
        self._start(Situation(tuple(self.robot.home.tolist())))
        self._set_clock(task.duration if duration is None else duration, control_timestep)

    def _set_clock(self, duration: float, control_timestep: float | None) -> None:
        h = self.simulation.timestep
        own = h * self._episode.control_steps
        self.period = own if control_timestep is None else float(control_timestep)
        self.substeps = max(1, round(self.period / h))
        if abs(self.substeps * h - self.period) > 1e-9:
            raise ArgumentError(
                f"control_timestep is {self.period} s; give a multiple of the time step of the "
                f"physics, {h} s"
            )
        self.actions = max(1, round(duration / self.period))

    @border
    def begin(self, seed: SeedNumber, index: Number) -> None:
        """Begin an episode: situation ``index`` of a seed."""
        self._situation = draw_situation(self.task, seed, index)
        self._start(self._situation)

    def _start(self, situation: Situation) -> None:
        start = np.array(situation.start)
        self._episode = Episode(self.simulation, self._people, situation.objects, self._plant)
        self._episode.reset(start)
        self.state = self._episode.sense()
        self._drive, self._step = Drive(self.robot, self.simulation.timestep), 0
        self._command = self._wanted = np.zeros(self.robot.n)
        self._impedance.posture = start
        self._quaternions = np.zeros((len(self._sites), 4))

    @property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Least and greatest action (n,): torques [Nm] or posture [rad], by ``action``."""
        robot = self.robot
        if self.action == "torque":
            return -robot.torque_limit, robot.torque_limit.copy()
        near = robot.home - TURN, robot.home + TURN
        return (
            np.where(np.isfinite(robot.lower), robot.lower, near[0]),
            np.where(np.isfinite(robot.upper), robot.upper, near[1]),
        )

    def act(self, action: ArrayLike) -> None:
        """Take the action (n,); what is beyond the limits of motors or joints is cut off."""
        given = np.array(self.robot.posture("action", action))
        if self.action == "impedance":
            self._impedance.posture = np.clip(given, *self.limits)
        self._command = given

    def tick(self) -> None:
        """Advance by one time step under the last action."""
        if self.action == "torque":
            self._wanted = self._command
        elif self._step % self._episode.control_steps == 0:
            pull = self._impedance.command(self.state, self.state.time)
            self._wanted = self._drive.torque(pull, self.state)
        self._episode.advance(self._episode.act(self._wanted))
        self._step += 1
        self.state = self._episode.sense()

    @property
    def diverged(self) -> bool:
        """Whether the state became wild; the episode is over then."""
        return self._episode.diverged

    def observation(self) -> dict[str, np.ndarray]:
        """What the agent sees now.

        ``q``, ``dq`` (n,), ``<site>_position`` (3,) and ``<site>_quaternion`` (4,), the same of
        objects, and ``frames/<name>`` (d,), ``jacobians/<name>`` (d, n): the value and Jacobian
        of every view of the task.
        """
        state, objects = self.state, self.state.objects
        seen = {"q": state.q.copy(), "dq": state.dq.copy()}
        for k, (name, site) in enumerate(self._sites.items()):
            pose = state.pose(site)
            # Quaternions keep their sign, as in recordings.
            sign = -1.0 if pose.quaternion @ self._quaternions[k] < 0 else 1.0
            self._quaternions[k] = sign * pose.quaternion
            seen[f"{name}_position"] = pose.position.copy()
            seen[f"{name}_quaternion"] = self._quaternions[k].copy()
        for name, row in self.simulation.objects.items():
            seen[f"{name}_position"] = objects.positions[row].copy()
            seen[f"{name}_quaternion"] = objects.quaternions[row].copy()
        for name, view in self._views.items():
            found = view(state)
            seen[f"frames/{name}"] = np.array(found.value)
            seen[f"jacobians/{name}"] = np.array(found.jacobian)
        return seen

    def reward(self) -> float:
        """Product over the goals that count now, in [0, 1]; 0 where the state became wild.

        Each is 1 within its bound and falls to 0 beyond.
        """
        if self.diverged:
            return 0.0
        truth = self._episode.truth
        now = [g for g in self._goals.values() if g.since <= truth.time < g.until]
        return float(np.prod([_share(goal, truth) for goal in now]))

    def controller(self) -> "OwnController":
        """The task's own controller for this episode.

        Raises
        ------
        ArgumentError
            If no episode has begun, or no models were given to make the controller of.
        """
        if self._situation is None or self._models is None:
            raise ArgumentError(
                "there is no controller of our own here; give the environment the learned models "
                "and call reset() first"
            )
        return OwnController(
            self, self.task.controller(self.task.stage, self._models, self._situation)
        )


class OwnController:
    """A controller of tpsim as an agent.

    Parameters
    ----------
    performance : Performance
        Whose robot it drives.
    controller : Controller
    """

    def __init__(self, performance: Performance, controller: Controller):
        self._performance, self._controller = performance, controller
        self._drive = Drive(performance.robot, performance.simulation.timestep)

    def torque(self) -> np.ndarray:
        """Torque (n,) [Nm] that is the action to take now; call it once for each time step."""
        state = self._performance.state
        return self._drive.torque(self._controller.command(state, state.time), state)


def _share(goal: Goal, state: State) -> float:
    """Share of the reward that a goal leaves: 1 within its bound, 0.1 at SLOPE bounds beyond."""
    error = float(np.linalg.norm(goal.view(state).value))
    beyond = max(error - goal.within, 0.0) / (SLOPE * goal.within)
    return 1.0 / (1.0 + 9.0 * beyond**2)


def _frames(task: Task) -> dict[str, View]:
    """Views of all behaviours by name; different views of one name carry their behaviour's, too."""
    found: dict[str, View] = {}
    for behaviour, taught in task.behaviours().items():
        for name, view in taught.views.items():
            if found.setdefault(name, view) != view:
                found[f"{behaviour}/{name}"] = view
    return found
