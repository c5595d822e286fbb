"""A learned task as a policy: torques, or Cartesian impedances, from what a robot senses."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import Positive, border, read
from tpsim.checks import path, shown
from tpsim.deploy import folder as files
from tpsim.deploy.cartesian import CartesianLimits, HandFilter, HandImpedance
from tpsim.deploy.sensed import Seen, objects_in, sensed
from tpsim.errors import ArgumentError, RecordingError
from tpsim.robot.objects import NONE, Objects
from tpsim.robot.robot import Robot
from tpsim.robot.state import State
from tpsim.robot.views.view import View
from tpsim.world.impedance import Controller, Drive, Impedance
from tpsim.world.tank import Energies, Tank
from tpsim.world.threads import one_thread

if TYPE_CHECKING:
    from tpsim.task.task import Models, Situation, Task
    from tpsim.world.world import World


class Policy:
    """What was learned of a task, ready to drive a robot.

    On the robot's computer it needs numpy, scipy, pinocchio, msgspec and threadpoolctl, and no
    simulator. Call
    :meth:`command` or :meth:`cartesian` once every :attr:`period`.

    Parameters
    ----------
    task : Task
    models : mapping of str to TPGMM
        Of :func:`tpsim.lab.learn`.
    situation : Situation, optional
        For tasks whose controller depends on the situation in more than its start posture: the
        policy is then for this one alone.

    Attributes
    ----------
    name : str
        Of the task.
    robot : Robot
    period : float
        Time [s] between two calls.
    objects : tuple of str
        Objects whose poses the policy needs.

    Raises
    ------
    ArgumentError
        If the task's controller is not one of tpsim's, or depends on the situation.
    """

    @one_thread()
    def __init__(self, task: "Task", models: "Models", situation: "Situation | None" = None):
        from tpsim.deploy.making import recipe_for
        from tpsim.task.task import Models, Situation, Task

        read("task", task, Task)
        models = read("models", models, Models)
        read("situation", situation, Situation | None)

        world = task.stage
        recipe = recipe_for(task, models, situation)
        self._begin(files.Content(task.name, world.timestep, recipe), world.robot)
        self._world: World | None = world

    @classmethod
    @one_thread()
    @border
    def load(
        cls,
        folder: str | Path,
        *,
        period: Positive | None = None,
        limits: CartesianLimits | None = None,
        tank: Tank | None = None,
        views: Sequence[type[View]] = (),
    ) -> "Policy":
        """Read a policy that :meth:`save` or ``tpsim export`` wrote.

        Parameters
        ----------
        folder : path
        period : float, optional
            Time [s] between two calls on this robot; that of the simulation, 1 ms, by default.
        limits : CartesianLimits, optional
            Of Cartesian gains.
        tank : Tank, optional
            What torques of impedances may put into the robot; the robot's own by default.
        views : sequence of type
            Classes of your own views, if the task has any.

        Raises
        ------
        RecordingError
            If the folder is missing or damaged; one line names file and field.
        ArgumentError
            If the period is not positive.
        """
        content, robot = files.read(path("folder", folder), views)
        policy = object.__new__(cls)
        policy._world = None
        policy._begin(content, robot, period, limits, tank)
        return policy

    def save(self, folder: str | Path) -> Path:
        """Write the policy to a new folder, whole or not at all.

        Raises
        ------
        RecordingError
            If the folder exists, or this policy was read from another: copy that one.
        """
        if self._world is None:
            raise RecordingError("this policy was read from a folder; copy the folder instead")
        return files.write(path("folder", folder), self._content, self.robot, self._world)

    def _begin(
        self,
        content: "files.Content",
        robot: Robot,
        period: float | None = None,
        limits: CartesianLimits | None = None,
        tank: Tank | None = None,
    ) -> None:
        self._content, self.name, self.robot = content, content.task, robot
        self.period = content.period if period is None else float(period)
        self.limits = CartesianLimits() if limits is None else limits
        self._tank = tank
        self.objects = tuple(dict.fromkeys(objects_in(content.recipe)))
        self.reset()

    def reset(self) -> None:
        """Begin anew: the next call is the start, and its posture the start posture."""
        self._controller: Controller | None = None
        self._drive = Drive(self.robot, self.period, self._tank)
        self._hands = HandFilter(self.robot.hands, self.limits)
        self._state: State | None = None
        self._now: Impedance | np.ndarray | None = None
        self._filtered: float | None = None
        self._since = 0.0

    @property
    def energies(self) -> Energies:
        """What torques have put in, and what is left in the tank [J]."""
        return self._drive.energies

    @one_thread()
    def command(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        objects: Objects | Mapping[str, Seen] = NONE,
        time: float = 0.0,
    ) -> np.ndarray:
        """Joint torques (n,) [Nm], gravity included, within the motors' limits.

        Parameters
        ----------
        q, dq : (n,)
            Joint angles [rad] and velocities [rad/s].
        objects : mapping of str to Pose, or to (position, quaternion[, velocity])
            At least those that :attr:`objects` names; see :data:`tpsim.deploy.sensed.Seen`.
        time : float
            Since the start [s].

        Raises
        ------
        ArgumentError
            Wrong shapes, what is not finite, a missing object, or time that runs backwards.
        RecordingError
            If the policy was damaged so that its torque is not finite.
        """
        state, now = self._follow(q, dq, objects, time)
        wanted, limit = self._drive.torque(now, state), self.robot.torque_limit
        if not np.isfinite(wanted).all():
            raise RecordingError(
                f"the policy has no finite torque at q = {shown(q)}, dq = {shown(dq)}: they "
                "are beyond all measure, or its masses or its model are damaged"
            )
        return np.minimum(np.maximum(wanted, -limit), limit)

    @one_thread()
    def cartesian(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        objects: Objects | Mapping[str, Seen] = NONE,
        time: float = 0.0,
    ) -> dict[str, HandImpedance]:
        """Stiffness, damping and target of every hand, for a Cartesian impedance controller.

        That controller compensates gravity, Coriolis and friction itself. Arguments and errors
        are those of :meth:`command`.
        """
        state, now = self._follow(q, dq, objects, time)
        if not isinstance(now, Impedance):
            raise ArgumentError("this policy commands torques: it has no impedance")
        gone = self.period if self._filtered is None else state.time - self._filtered
        self._filtered = state.time
        return self._hands.follow(now, state, state.time - self._since, gone)

    def _follow(
        self, q: ArrayLike, dq: ArrayLike, objects: Objects | Mapping[str, Seen], time: float
    ) -> tuple[State, Impedance | np.ndarray]:
        """State and command; asked twice at one time, the controller is asked once."""
        state = sensed(self.robot, q, dq, objects, time, self.objects)
        last = self._state
        if last is not None and state.time < last.time:
            raise ArgumentError(
                f"time {state.time} s is before the last call's {last.time} s; call reset() first"
            )
        if self._now is None or last is None or state.time > last.time:
            if self._controller is None:
                start = state.q.copy()
                self._controller = self._content.recipe.controller(self.robot, start)
            now = self._controller.command(state, state.time)
            if now is not self._now:
                self._since = state.time
            self._state, self._now = state, now
        return state, self._now
