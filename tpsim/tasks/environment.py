"""Every task as an environment of dm_env, for other people's agents."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from tpsim import tasks
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim.environment import Environment, Episode, Movement
from tpsim.sim.hand import Guide
from tpsim.sim.push import Push
from tpsim.tasks.task import Task


def environment(
    name: str | Task,
    *,
    models: Mapping[str, TPGMM] | None = None,
    seed: int = 0,
    action: str = "torque",
    duration: float | None = None,
    control_timestep: float | None = None,
    stiffness: float = 100.0,
    people: Sequence[Push | Guide] = (),
) -> Environment:
    """Make a task an environment of dm_env (``dm_control.rl.control.Environment``).

    Episode i is situation i of the seed. The agent sees joints, sites, objects and the task's
    candidate frames; its reward says how well the task is done at this moment.

    Parameters
    ----------
    name : str or Task
        One of :func:`tpsim.tasks.names`, or a task of your own.
    models : mapping of str to TPGMM, optional
        A model for each behaviour, for ``environment.task.controller()``: our own controller, to
        compare with.
    seed : int
    action : str
        ``"torque"``: joint torques (n,) [Nm]. ``"impedance"``: posture (n,) [rad] to which a
        spring and a damper pull, with gravity compensated.
    duration : float, optional
        Of an episode [s]; the task's own by default.
    control_timestep : float, optional
        Time between two actions [s]; the simulation's time step by default.
    stiffness : float
        Of every joint under impedance, as acceleration [1/s^2]; critically damped.
    people : sequence of Push or Guide
        Who pushes and leads the robot in every episode.

    Raises
    ------
    ArgumentError
        If there is no such task or action, or a number is not positive.

    Examples
    --------
    An agent that holds a cup upright where it found it, while a person pushes:

    >>> import numpy as np
    >>> from tpsim.sim.push import Push
    >>> from tpsim.tasks.environment import environment
    >>>
    >>> push = Push("left_gripper", force=(0.0, 20.0, 0.0), start=0.1, duration=0.3)
    >>> cup = environment("cup", action="impedance", people=[push],
    ...                   duration=0.5, control_timestep=0.02)
    >>> class Agent:
    ...     def first(self, observation):
    ...         self.rest = observation["q"]
    ...     def act(self, observation):
    ...         return self.rest - 0.1 * observation["dq"]
    >>>
    >>> agent, rewards = Agent(), []
    >>> step = cup.reset()
    >>> agent.first(step.observation)
    >>> while not step.last():
    ...     step = cup.step(agent.act(step.observation))
    ...     rewards.append(step.reward)
    >>> print(f"{len(rewards)} steps of {cup.control_timestep()} s, reward {np.mean(rewards):.1f}")
    25 steps of 0.02 s, reward 1.0
    """
    task = name if isinstance(name, Task) else tasks.load(name)
    simulation = task.simulation()

    def episode(index: int) -> Episode:
        situation = task.situation(simulation, seed, index)
        controller = None
        if models is not None:
            controller = partial(task.controller, simulation, models, situation.start)
        return Episode(np.array(situation.start), task.objects(situation), controller)

    frames = {c: None for b in task.behaviours for c in task.coordinates(simulation, b)}
    movement = Movement(
        simulation,
        episode,
        coordinates=tuple(frames),
        errors=task.errors(simulation),
        sites=task.sites,
        action=action,
        stiffness=stiffness,
        people=people,
    )
    return Environment(movement, task.duration if duration is None else duration, control_timestep)
