"""A task as an environment of Gymnasium; the built-in ones have ids, see tpsim.tasks.gymnasium."""

from typing import Any, Unpack

import mujoco
import numpy as np

from tpsim.border import SeedNumber, border
from tpsim.errors import ArgumentError, RenderingError
from tpsim.film.rendering import HINT
from tpsim.task.performance import Options, Performance
from tpsim.task.task import Task

try:
    import gymnasium
    from gymnasium import spaces
except ImportError:
    raise ImportError("Gymnasium is not installed: pip install 'tpsim[gym]'") from None

Observation = dict[str, np.ndarray]

SEEDS = 2**31
"""Seeds that a generator draws from where ``reset`` was given none."""


class TaskEnvironment(gymnasium.Env[Observation, np.ndarray]):
    """A performance in the words of Gymnasium; made by :func:`gym_environment`.

    After ``reset(seed=s)`` episode i is situation i of the seed s. An episode is truncated when
    its time is over, and terminated where the state became wild.

    Parameters
    ----------
    performance : Performance
    seed : int, optional
        Of the situations until ``reset`` is given one; random by default.
    render_mode : str, optional
        ``"rgb_array"``: ``render()`` gives an image (480, 640, 3) from the scene's camera.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}  # noqa: RUF012

    @border
    def __init__(
        self,
        performance: Performance,
        seed: SeedNumber | None = None,
        render_mode: str | None = None,
    ):
        modes = (None, *self.metadata["render_modes"])
        if render_mode not in modes:
            raise ArgumentError(f"render_mode is {render_mode!r}; choose one of {modes}")
        self.metadata = {**self.metadata, "render_fps": round(1 / performance.period)}
        self.performance, self.render_mode = performance, render_mode
        self._seed, self._count, self._taken = seed, 0, 0
        self._renderer: mujoco.Renderer | None = None
        low, high = performance.limits
        self.action_space = spaces.Box(low, high, dtype=np.float64)
        self.observation_space = spaces.Dict(  # type: ignore[assignment]
            {
                name: spaces.Box(-np.inf, np.inf, value.shape, np.float64)
                for name, value in performance.observation().items()
            }
        )

    @border
    def reset(
        self, *, seed: SeedNumber | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin the next episode; a seed begins its situations anew."""
        super().reset(seed=seed)
        if seed is not None:
            self._seed, self._count = seed, 0
        elif self._seed is None:
            self._seed = int(self.np_random.integers(SEEDS))
        self.performance.begin(self._seed, self._count)
        about = {"seed": self._seed, "situation": self._count}
        self._count, self._taken = self._count + 1, 0
        return self.performance.observation(), about

    def step(self, action: np.ndarray) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Take the action (n,); what is beyond the limits is cut off."""
        performance = self.performance
        performance.act(action)
        for _ in range(performance.substeps):
            performance.tick()
        self._taken += 1
        over = self._taken >= performance.actions
        wild = performance.diverged
        return performance.observation(), performance.reward(), wild, over and not wild, {}

    def render(self) -> np.ndarray | None:  # type: ignore[override]
        """Image (480, 640, 3) from the scene's camera, under ``render_mode="rgb_array"``.

        Raises
        ------
        RenderingError
            If nothing draws here.
        """
        if self.render_mode is None:
            return None
        simulation = self.performance.simulation
        if self._renderer is None:
            try:
                self._renderer = mujoco.Renderer(simulation.model, 480, 640)
            except Exception as error:
                raise RenderingError(f"{HINT} ({error})") from None
        cameras = [simulation.model.camera(k).name for k in range(simulation.model.ncam)]
        self._renderer.update_scene(simulation.data, "hero" if "hero" in cameras else -1)
        image: np.ndarray = self._renderer.render()
        return image

    def close(self) -> None:
        """Give the renderer back."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None


@border
def gym_environment(
    task: Task,
    *,
    seed: SeedNumber | None = None,
    render_mode: str | None = None,
    **options: Unpack[Options],
) -> TaskEnvironment:
    """Make a task an environment of Gymnasium.

    Parameters
    ----------
    task : Task
    seed : int, optional
        Of the situations until ``reset(seed=...)`` is given one; random by default.
    render_mode : str, optional
        ``"rgb_array"`` for images.
    models, action, duration, control_timestep, stiffness, people, plant
        As :func:`tpsim.task.environment.environment` takes them.

    Raises
    ------
    ArgumentError, SimulationError
        If there is no such action or render mode, a number is not positive, or a view does not
        fit the world.

    Examples
    --------
    >>> from tpsim.task.gymnasium import gym_environment
    >>> from tpsim.tasks.cup_and_sugar.task import CupAndSugar
    >>> env = gym_environment(CupAndSugar(("cup",)), action="impedance", control_timestep=0.02)
    >>> observation, about = env.reset(seed=3)
    >>> observation, reward, terminated, truncated, info = env.step(observation["q"])
    >>> print(f"{reward:.1f}", terminated, truncated)
    1.0 False False
    """
    return TaskEnvironment(Performance(task, **options), seed, render_mode)
