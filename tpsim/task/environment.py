"""A task as an environment of dm_env, for other people's agents."""

import warnings
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import SeedNumber, border
from tpsim.task.performance import Options, OwnController, Performance
from tpsim.task.task import Task

with warnings.catch_warnings():
    # Looking for a renderer, dm_control warns where there is no display.
    warnings.simplefilter("ignore")
    try:
        from dm_control import mujoco
        from dm_control.mujoco import wrapper
        from dm_control.rl import control
        from dm_env import specs
    except ModuleNotFoundError as error:
        raise ImportError(
            f"environments of dm_env need {error.name}, which is not installed: pip install "
            "'tpsim[dm]' (its labmaze has no wheels for Python 3.13 and later); Gymnasium's do not"
        ) from None


class Physics(mujoco.Physics):
    """dm_control's view of a performance: the same model and state, stepped in our way.

    Parameters
    ----------
    performance : Performance
    """

    def __init__(self, performance: Performance):
        self._performance = performance
        super().__init__(wrapper.MjData(performance.simulation.data))

    def step(self, nstep: int = 1) -> None:
        """Advance by a number of time steps."""
        for _ in range(nstep):
            self._performance.tick()

    def after_reset(self) -> None:
        """Leave alone what the reset computed: more would change the last bits."""


class Movement(control.Task):
    """A performance in the words of dm_control; episode i is situation i of a seed.

    Parameters
    ----------
    performance : Performance
    seed : int
    """

    def __init__(self, performance: Performance, seed: int):
        self.performance, self._seed, self._count = performance, seed, 0

    def initialize_episode(self, physics: Physics) -> None:
        """Begin the next episode."""
        self.performance.begin(self._seed, self._count)
        self._count += 1

    def controller(self) -> OwnController:
        """The task's own controller for this episode: ``torque()`` is the action to take now."""
        return self.performance.controller()

    def action_spec(self, physics: Physics) -> specs.BoundedArray:
        """Joint torques [Nm] within the motors' limits, or postures [rad] within the joints'."""
        low, high = self.performance.limits
        return specs.BoundedArray(low.shape, float, low, high, name=self.performance.action)

    def before_step(self, action: ArrayLike, physics: Physics) -> None:
        """Take the action (n,); what is beyond the limits is cut off."""
        self.performance.act(action)

    def get_observation(self, physics: Physics) -> dict[str, np.ndarray]:
        """What the agent sees: see :meth:`tpsim.task.performance.Performance.observation`."""
        return self.performance.observation()

    def get_reward(self, physics: Physics) -> float:
        """How well the task is done at this moment, in [0, 1]."""
        return self.performance.reward()

    def get_termination(self, physics: Physics) -> float | None:
        """End the episode where the state became wild."""
        return 0.0 if self.performance.diverged else None


class Environment(control.Environment):
    """A task as an environment of dm_env; ``environment.task`` is its :class:`Movement`.

    Parameters
    ----------
    movement : Movement
    """

    @border
    def __init__(self, movement: Movement):
        performance = movement.performance
        super().__init__(
            Physics(performance),
            movement,
            # Half a step less: the number of steps must not hang on the last bit of a quotient.
            time_limit=(performance.actions - 0.5) * performance.period,
            control_timestep=performance.period,
            legacy_step=False,
        )

    def reward_spec(self) -> specs.BoundedArray:
        """Describe the reward: a number in [0, 1]."""
        return specs.BoundedArray((), float, 0.0, 1.0, name="reward")


@border
def environment(task: Task, *, seed: SeedNumber = 0, **options: Unpack[Options]) -> Environment:
    """Make a task an environment of dm_env (``dm_control.rl.control.Environment``).

    Episode i is situation i of the seed. The agent sees joints, sites, objects and the task's
    views; its reward says how well the task's goals are met at this moment.

    Parameters
    ----------
    task : Task
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
        Time between two actions [s], a multiple of the time step of the physics; the plant's
        control period by default. Under impedance the spring follows at that period all the same.
    stiffness : float
        Of every joint under impedance, as acceleration [1/s^2]; critically damped.
    people : sequence of Push or Guide
        Who pushes and leads the robot in every episode.
    plant : Plant
        How the simulated robot differs from the controller's model.

    Raises
    ------
    ArgumentError, SimulationError
        If there is no such action, a number is not positive, or a view does not fit the world.

    Examples
    --------
    An agent that holds a cup upright where it found it, while a person pushes:

    >>> import numpy as np
    >>> from tpsim import lab
    >>> from tpsim.tasks.cup_and_sugar.task import CupAndSugar
    >>>
    >>> push = lab.Push("left_gripper", force=(0.0, 20.0, 0.0), start=0.1, duration=0.3)
    >>> cup = lab.environment(CupAndSugar(("cup",)), action="impedance", people=[push],
    ...                       duration=0.5, control_timestep=0.02)
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
    return Environment(Movement(Performance(task, **options), seed))
