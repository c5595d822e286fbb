"""Speeds of simulation: physics, control on top of it, environments, films."""

import tempfile
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

import mujoco
import numpy as np

from tpsim import tasks
from tpsim.bench.control import median_time
from tpsim.bench.timing import one_core
from tpsim.sim import rendering, scene
from tpsim.sim.teach import teach
from tpsim.sim.video import Clip, film
from tpsim.tasks.environment import environment

FPS = 25
"""Pictures of a film in a second."""

DURATION = 2.0
"""Time of a trial [s]; episodes of environments last a tenth of it."""

LESSONS = 2
"""Demonstrations of each behaviour: what is learned need be typical, not good."""


def run(quick: bool = False) -> dict[str, float]:
    """Median speeds on one core, in processor time, except that of films.

    Parameters
    ----------
    quick : bool
        Fewer repetitions, a shorter film.

    Returns
    -------
    dict
        For every task, simulated over processor time of ``mj_step`` alone
        (``<task>_physics_factor``) and of a recorded trial under the learned controller
        (``<task>_realtime_factor``), and steps of its environment in a second, observations and
        reward included (``<task>_environment_steps_per_s``). ``film_frame_ms``, wall time of a
        picture in a film, is missing where nothing draws.
    """
    repetitions = 1 if quick else 5
    figures, learned = {}, {}
    with one_core():
        for name in tasks.names():
            task = tasks.load(name)
            figures |= _physics(task, repetitions)
            figures |= _control(task, _models(task, learned), repetitions)
            figures |= _environment(task, repetitions)
    return figures | _film(25 if quick else 100)


def _key(task, figure: str) -> str:
    return f"{task.name}_{figure}".replace("-", "_")


def _models(task, learned: dict) -> dict:
    """A model for each behaviour, taught on the way; ``learned`` keeps them for other tasks."""
    simulation, models = task.simulation(), {}
    for behaviour in task.behaviours:
        known = simulation.xml, behaviour
        if known not in learned:
            lesson = partial(_lesson, task, behaviour)
            trials = teach(simulation, lesson, LESSONS, seed=0, sites=task.sites)
            learned[known] = task.learn(simulation, behaviour, trials, task.components)
        models[behaviour] = learned[known]
    return models


def _lesson(task, behaviour, simulation, rng):
    return task.lesson(simulation, behaviour, rng)


def _physics(task, repetitions: int) -> dict[str, float]:
    """Physics alone: from home, for a tenth of a second, before anything is hit."""
    simulation, steps = task.simulation(), 100

    def fall() -> None:
        simulation.reset(simulation.home)
        mujoco.mj_step(simulation.model, simulation.data, steps)

    seconds = median_time(fall, 20 * repetitions)
    return {_key(task, "physics_factor"): steps * simulation.timestep / seconds}


def _control(task, models, repetitions: int) -> dict[str, float]:
    simulation = task.simulation()
    situation = task.situation(simulation, 0, 0)
    perform = partial(task.perform, simulation, models, situation, duration=DURATION)
    return {_key(task, "realtime_factor"): DURATION / median_time(perform, repetitions)}


def _environment(task, repetitions: int) -> dict[str, float]:
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
    time = np.arange(pictures) / FPS
    clip = Clip(scene.cup_and_sugar(), time, np.tile(scene.HOME, (pictures, 1)), "", "")
    with tempfile.TemporaryDirectory() as folder:
        began = perf_counter()
        film([clip], Path(folder) / "film.mp4", fps=FPS)
        return perf_counter() - began
