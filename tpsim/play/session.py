"""A session: one world into which people reach while time passes, whoever shows it.

Commands take effect between two time steps. Whoever drives the clock and whoever gives commands
hold ``lock`` meanwhile; nothing here knows of browsers.
"""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace
from threading import RLock
from typing import Literal

import numpy as np

from tpsim.controllers.renewed import FixedImpedance
from tpsim.errors import ArgumentError
from tpsim.play.beside import SameForce, SameObjects, forget_hands, stopped
from tpsim.play.hands import Hands, Pull, body_name
from tpsim.play.objects import LedObjects
from tpsim.play.recording import Recorded, until
from tpsim.study.condition import Condition
from tpsim.study.study import Study
from tpsim.task.task import Models, Others, Task, draw_situation
from tpsim.world.impedance import Controller
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.drag import Quaternion
from tpsim.world.rollout import Rollout
from tpsim.world.weightless import Weightless
from tpsim.world.world import World

Mode = Literal["teach", "perform"]

HOLD = "hold"
"""Controller where nothing was learned yet: it holds the start posture."""

HOLDING = 200.0
"""Gain [1/s^2] with which it does."""

LONGEST = 120.0
"""Time [s] after which a recording ends by itself: it is kept in memory."""

INSIDE = 1e-3
"""Distance [rad] to the joint limits from which a roll-out begins, at least."""


class Session:
    """One world, its clock, and what people do in it.

    Parameters
    ----------
    study : Study
    models : mapping of str to TPGMM, optional
        What was learned; without it the robot can be taught, and holds still.
    seed : int
        Of the situations.

    Attributes
    ----------
    lock : RLock
        Held by whoever gives commands or lets time pass.
    mode : str
        ``"teach"`` or ``"perform"``.
    controller : str
        Which of the study's controllers performs.
    behaviour : str
    going : Rollout
        What goes on.
    speed : float
        Simulated over real time; 0 where it is paused.
    ended : Recorded, optional
        A recording that ended by itself, for whoever keeps it.
    message : str
        The last thing that happened by itself, such as that the robot diverged.
    """

    def __init__(self, study: Study, models: Models | None = None, seed: int = 0):
        self.study, self.models, self.seed, self.index = study, models, seed, 0
        self.lock, self.speed, self.message = RLock(), 1.0, ""
        self.world: World = study.task.stage
        self._simulation = self.world.simulation(visible=True)
        self._beside = self.world.simulation(visible=True)
        self.mode: Mode = "perform"
        self.others: Others = "held"
        self.controller = "learned" if models is not None else HOLD
        self.compared = ""
        self.situation = draw_situation(self.task, self.seed, self.index)
        self.recorded: Recorded | None = None
        self.ended: Recorded | None = None
        self.armed, self.behaviour = False, ""
        self.beside: Rollout | None = None
        self._begin_performance()

    @property
    def task(self) -> Task:
        """The task with its fields as they are set."""
        return self.study.task

    @property
    def recording(self) -> bool:
        """Whether samples are kept now."""
        return self.going.recorded

    @property
    def time(self) -> float:
        """Time [s] since this roll-out began."""
        return self.going.steps * self.world.timestep

    def advance(self, steps: int) -> int:
        """Let time pass; how many steps did, fewer where the robot diverged or all was recorded."""
        for done in range(steps):
            if (why := stopped(self.going)) is not None:
                self._stop_there(why)
                return done
            if self.beside and (why := stopped(self.beside)) is not None:
                self.beside, self.message = None, f"'{self.compared}' ended: {why}"
            if self.recording and self.time >= LONGEST:
                self.message = f"The recording ended after {LONGEST:g} s."
                self.ended = self.stop()
                return done
        if not self.recording:
            self.hands.forget()
        if self.beside is not None:
            forget_hands(self.beside)
        return steps

    @property
    def controllers(self) -> tuple[str, ...]:
        """Controllers that can perform now, by name."""
        names = tuple(self.study.all_controllers)
        learned = self.models is not None
        return names if learned else (HOLD, *(name for name in names if name != "learned"))

    def perform(self, controller: str | None = None) -> None:
        """Perform the task from its start with one of the controllers."""
        if controller is not None:
            self.controller = self._known(controller)
        self.mode, self.armed = "perform", False
        self._begin_performance()

    def reset(self) -> None:
        """Begin the situation again, with all where it was at first."""
        self.armed = False
        if self.mode == "teach":
            self._begin(Weightless(self.world.robot), self.situation.start, self.situation.objects)
        else:
            self._begin_performance()

    def next_situation(self, step: int = 1) -> None:
        """Go to another situation that was never taught."""
        self.index = max(0, self.index + step)
        self.situation = draw_situation(self.task, self.seed, self.index)
        self.reset()

    def compare(self, controller: str) -> None:
        """Let another controller perform beside it, pushed with the same forces; "" for none."""
        self.compared = self._known(controller) if controller else ""
        if self.mode == "perform":
            self._begin_performance()

    def set_fields(self, **fields: object) -> None:
        """Change fields of the task, such as its effort, while it is performed."""
        if self.recording:
            raise ArgumentError("stop the recording before you change how the robot behaves")
        task = replace(self.task, **fields).in_world(self.world)  # type: ignore[type-var]
        self.study = replace(self.study, task=task)
        if self.mode == "perform":
            self.going.controller = self._make(self.controller)

    def set_models(self, models: Models) -> None:
        """Perform what was learned now."""
        first, self.models = self.models is None, models
        if first or self.mode == "teach":
            self.controller = "learned"
        self.perform()

    def teach(self) -> None:
        """Make the arms weightless where they are, so that they can be led."""
        self.mode, self.armed = "teach", False
        self._begin_teaching()

    def start_demonstration(self, behaviour: str) -> None:
        """Show a behaviour from the moment on in which a hand takes hold."""
        if behaviour not in self.task.behaviours():
            raise ArgumentError(f"no behaviour '{behaviour}': {', '.join(self.task.behaviours())}")
        if self.mode != "teach":
            self.teach()
        self.hands.all_let_go()
        self.behaviour, self.armed, self.recorded = behaviour, True, None

    def record(self) -> None:
        """Record the performance from its start on."""
        if self.controller == HOLD:
            raise ArgumentError("nothing was learned yet: teach it, learn, and then record")
        self.mode, self.armed, self.recorded = "perform", False, None
        self._begin_performance(recorded=True)

    def stop(self) -> Recorded:
        """End the recording or the demonstration, which lasts until the last hand lets go."""
        if self.armed and not self.recording:
            self.armed = False
            raise ArgumentError("nothing was shown yet: take hold of a hand and lead it")
        if not self.recording:
            raise ArgumentError("nothing is being recorded; start a recording first")
        start, drags = tuple(self._start.tolist()), self.hands.values()
        situation = replace(self.situation, start=start, objects=self.led.paths())
        showed = self.mode == "teach"
        name, controller = ("shown", "") if showed else ("played", self.controller)
        seconds = max((drag.until for drag in drags if showed), default=self.time)
        found = Condition(name, situation, controller, drag=drags, duration=seconds)
        behaviour = self.behaviour if showed else ""
        self.recorded = Recorded(until(self.going.trial(), seconds), found, behaviour)
        self.armed = self.going.recorded = False
        return self.recorded

    def grab(
        self, who: Hashable, body: int | str, where: np.ndarray, turned: Quaternion | None = None
    ) -> None:
        """Take hold of a body (its number) or site at a point of the world, or of an object."""
        name = body if isinstance(body, str) else body_name(self.world.model, body)
        if name in self._simulation.objects:
            self.led.take(who, name, where)
            return
        if self.armed and not self.recording:
            self._begin_teaching(recorded=True)
        if any(pull.drag.body == name for other, pull in self.pulls.items() if other != who):
            self.message = f"Two people pull '{name}' now: their forces add."
        leads = self.mode == "teach"
        self.hands.grab(who, name, where, leads=leads, others=self.others, turned=turned)
        if self.beside is not None:
            drag = self.hands.pulling[who].drag
            self.beside.episode.people.append(SameForce(drag, self.beside))

    def move(self, who: Hashable, where: np.ndarray, turned: Quaternion | None = None) -> None:
        """Pull, or lead the object, somewhere else; of no use to who holds nothing."""
        if not self.led.move(who, where, turned):
            self.hands.want(who, where, turned)

    def let_go(self, who: Hashable) -> None:
        """Let go; of no use to who holds nothing."""
        self.led.let_go(who)
        self.hands.let_go(who)

    @property
    def pulls(self) -> Mapping[Hashable, Pull]:
        """Hands that pull now."""
        return self.hands.pulling

    def _known(self, controller: str) -> str:
        if controller not in self.controllers:
            raise ArgumentError(f"no controller '{controller}': {', '.join(self.controllers)}")
        return controller

    def _make(self, name: str) -> Controller:
        if name == HOLD:
            return FixedImpedance(np.array(self.situation.start), HOLDING)
        return self.study.all_controllers[name](self.world, self.models or {}, self.situation)

    def _begin_performance(self, recorded: bool = False) -> None:
        start, objects = self.situation.start, self.situation.objects
        self._begin(self._make(self.controller), start, objects, recorded)
        if self.compared:
            self.beside = Rollout(self._beside, self._make(self.compared), start, recorded=False)
            self.beside.episode.objects = SameObjects(self.led, self._beside)

    def _begin_teaching(self, recorded: bool = False) -> None:
        self._begin_here(lambda q: Weightless(self.world.robot, posture=q), recorded)

    def _stop_there(self, why: str) -> None:
        """Begin anew if the robot cannot be held, else hold still where the arms are."""
        if self.going.diverged:
            self.message = f"{why.capitalize()}: it starts anew."
            self.reset()
        else:
            self.ended = self.stop() if self.recording and self.going.steps else None
            self.message = f"The arms hold still: {why}"
            self._begin_here(lambda q: FixedImpedance(q, HOLDING))

    def _begin_here(self, make: Callable[[np.ndarray], Controller], recorded: bool = False) -> None:
        robot = self.world.robot
        q = np.clip(self._simulation.q, robot.lower + INSIDE, robot.upper - INSIDE)
        self._begin(make(q), q, self.led.resting(), recorded)

    def _begin(
        self,
        controller: Controller,
        start: Sequence[float] | np.ndarray,
        objects: Sequence[ObjectPath],
        recorded: bool = False,
    ) -> None:
        self._start, self.beside = np.array(start, float), None
        self.going = Rollout(
            self._simulation,
            controller,
            start,
            sites=self.task.sites(),
            objects=objects,
            recorded=recorded,
        )
        self.led = LedObjects(objects, self._simulation)
        self.going.episode.objects = self.led
        self.hands = Hands(self.going)
