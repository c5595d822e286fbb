"""Speeds of simulation: physics, control on top of it, environments, films."""

import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

import mujoco
import numpy as np

from tpsim.bench.timing import processor_time
from tpsim.film import rendering
from tpsim.film.clip import Clip
from tpsim.film.video import film
from tpsim.robot.state import State
from tpsim.study.reference import load_study
from tpsim.task.environment import environment
from tpsim.task.task import Models, Task, controller_of, draw_situation
from tpsim.task.verbs import Taught, learn, perform, teach
from tpsim.tasks import STUDIES
from tpsim.world.impedance import Impedance
from tpsim.world.rollout import Rollout
from tpsim.world.tank import UNLIMITED, Ledger
from tpsim.world.threads import one_thread

FPS = 25
"""Pictures of a film in a second."""

DURATION = 2.0
"""Time of a trial [s]; episodes of environments last a tenth of it."""

_TURN = 200
"""Steps of a trial that are timed at once."""

LESSONS = 2
"""Demonstrations of each behaviour: what is learned need be typical, not good."""


def run(quick: bool = False, names: Sequence[str] = tuple(STUDIES)) -> dict[str, float]:
    """Median speeds on one core, in processor time, except that of films.

    Parameters
    ----------
    quick : bool
        Fewer repetitions, a shorter film.
    names : sequence of str
        Built-in tasks; all by default.

    Returns
    -------
    dict
        For every task, simulated over processor time of ``mj_step`` alone
        (``<task>_physics_factor``) and of a recorded trial under the learned controller
        (``<task>_realtime_factor``), and steps of its environment in a second, observations and
        reward included (``<task>_environment_steps_per_s``); and by how much a trial's steps take
        longer with the energy tank than without (``<task>_tank_percent``). ``film_frame_ms``, wall
        time of a picture in a film, is missing where nothing draws.
    """
    repetitions = 1 if quick else 5
    figures: dict[str, float] = {}
    taught: dict[str, Taught] = {}
    with one_thread():
        for name in names:
            task = load_study(name, STUDIES).task
            figures |= _physics(task, repetitions)
            models = _models(task, taught)
            figures |= _control(task, models, repetitions)
            figures |= _tank(task, models, repetitions)
            figures |= _environment(task, repetitions)
    return figures | _film(25 if quick else 100)


def _key(task: Task, figure: str) -> str:
    return f"{task.name}_{figure}".replace("-", "_")


def _models(task: Task, taught: dict[str, Taught]) -> Models:
    """A model for each behaviour, taught on the way; ``taught`` keeps lessons for other tasks."""
    shown = taught.setdefault(task.stage.xml, {})
    missing = [name for name in task.behaviours() if name not in shown]
    taught[task.stage.xml] = shown = {**shown, **teach(task, LESSONS, behaviours=missing)}
    return learn(task, shown)


def _physics(task: Task, repetitions: int) -> dict[str, float]:
    """Physics alone: from home, for a tenth of a second, before anything is hit."""
    simulation, steps = task.stage.simulation(), 100

    def fall() -> None:
        simulation.reset(simulation.robot.home)
        mujoco.mj_step(simulation.model, simulation.data, steps)

    seconds = processor_time(fall, 20 * repetitions)
    return {_key(task, "physics_factor"): steps * simulation.timestep / seconds}


def _control(task: Task, models: Models, repetitions: int) -> dict[str, float]:
    situation = draw_situation(task, 0, 0)
    trial = partial(perform, task, models, situation, duration=DURATION)
    return {_key(task, "realtime_factor"): DURATION / processor_time(trial, repetitions)}


class _NoTank(Ledger):
    """Lets all torques pass and keeps no books."""

    def short(self, command: Impedance, state: State) -> bool:
        """Return False: nothing is owed."""
        return False

    def enter(
        self,
        torque: np.ndarray,
        guard: np.ndarray | None,
        command: Impedance,
        state: State,
        age: int,
        short: bool,
    ) -> np.ndarray:
        """Return the torque as it is."""
        return torque if guard is None else torque + guard


def _tank(task: Task, models: Models, repetitions: int) -> dict[str, float]:
    """The same trial with and without a tank, some steps of one and of the other in turn.

    Of every turn the fastest of all repetitions counts: what else the machine does only adds.
    """
    turns = np.array([_turns(task, models) for _ in range(repetitions)])
    with_tank, without = turns.min(0).sum(1)
    return {_key(task, "tank_percent"): 100 * float(with_tank / without - 1)}


def _turns(task: Task, models: Models) -> list[list[float]]:
    """Processor times [s] of the turns of a trial with a tank, and of one without."""
    situation = draw_situation(task, 0, 0)
    both = [
        Rollout(
            task.stage.simulation(),
            controller_of(task, models, situation),
            situation.start,
            sites=task.sites(),
            objects=situation.objects,
        )
        for _ in range(2)
    ]
    h = both[1].drive.period
    both[1].drive.ledger = _NoTank(task.stage.robot, h, UNLIMITED)
    times: list[list[float]] = [[], []]
    for until in range(_TURN, round(DURATION / h), _TURN):
        for rollout, spent in zip(both, times, strict=True):
            began = process_time()
            rollout.run(until)
            spent.append(process_time() - began)
    return times


def _environment(task: Task, repetitions: int) -> dict[str, float]:
    world, times = environment(task, duration=DURATION / 10), []
    hold = np.zeros(world.action_spec().shape)
    for _ in range(repetitions):
        world.reset()
        began = process_time()
        while not world.step(hold).last():
            pass
        times.append(process_time() - began)
    steps = round(DURATION / 10 / world.control_timestep())
    return {_key(task, "environment_steps_per_s"): steps / median(times)}


def _film(pictures: int) -> dict[str, float]:
    if rendering.backend() is None:
        return {}
    # What a longer film costs more: workers take their time to start.
    return {"film_frame_ms": 1e3 * (_filming(pictures) - _filming(1)) / (pictures - 1)}


def _filming(pictures: int) -> float:
    """Seconds for a film of cup and sugar with some pictures more than the shortest one."""
    world = load_study("cup-and-sugar", STUDIES).task.stage
    clip = Clip(world, np.arange(pictures) / FPS, np.tile(world.robot.home, (pictures, 1)))
    with tempfile.TemporaryDirectory() as folder:
        began = perf_counter()
        film([clip], Path(folder) / "film.mp4", fps=FPS)
        return perf_counter() - began
