"""A robot, its objects and people as an environment of dm_env, for other agents to drive.

A step of the environment is a step of :class:`~tpsim.sim.surroundings.Surroundings`, as in a
roll-out: the torques of one of our controllers, given as actions, repeat its roll-out bit for bit.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from dm_env import specs

from tpsim import rotation
from tpsim.errors import ArgumentError
from tpsim.sim.controllers.controller import Controller, FixedImpedance
from tpsim.sim.coordinates.coordinate import Coordinate
from tpsim.sim.hand import Guide
from tpsim.sim.objects import ObjectPath
from tpsim.sim.push import Push
from tpsim.sim.simulation import Simulation
from tpsim.sim.surroundings import Surroundings

with warnings.catch_warnings():
    # Looking for a renderer, dm_control warns where there is no display.
    warnings.simplefilter("ignore")
    from dm_control import mujoco
    from dm_control.mujoco import wrapper
    from dm_control.rl import control
    from dm_control.utils.rewards import tolerance

ACTIONS = ("torque", "impedance")
"""What an agent may command: joint torques, or the posture to which a spring and a damper pull."""

SLOPE = 10.0
"""Multiple of what counts as no error beyond its bound at which 0.1 of the reward is left."""

Errors = Mapping[str, tuple[float, float]]
"""Errors of this moment by name, each with the size up to which it counts as none."""


@dataclass(frozen=True)
class Episode:
    """Where an episode begins.

    Parameters
    ----------
    start : (n,)
        Start posture [rad].
    objects : tuple of ObjectPath
        Where movable objects are.
    controller : callable, optional
        Makes our own controller for it.
    """

    start: np.ndarray
    objects: tuple[ObjectPath, ...] = ()
    controller: Callable[[], Controller] | None = None


class Physics(mujoco.Physics):
    """dm_control's view of a simulation: the same model and state, stepped in our way.

    Parameters
    ----------
    simulation : Simulation
    tick : callable
        Advances it by one time step.
    """

    def __init__(self, simulation: Simulation, tick: Callable[[], None]):
        self._tick = tick
        super().__init__(wrapper.MjData(simulation.data))

    def step(self, nstep: int = 1) -> None:
        """Advance by a number of time steps."""
        for _ in range(nstep):
            self._tick()

    def after_reset(self) -> None:
        """Leave alone what :meth:`Simulation.reset` computed: more would change the last bits."""


class Movement(control.Task):
    """What an agent sees of a simulation, what it commands, and what it gets for it.

    Parameters
    ----------
    simulation : Simulation
    episodes : callable
        Gives the :class:`Episode` of a number, counted from 0.
    coordinates : sequence of Coordinate
        Candidate frames that the agent sees.
    errors : callable
        Gives the ``Errors`` at the robot's last update.
    sites : mapping
        Sites that the agent sees, by name.
    action : str
        One of ``ACTIONS``.
    stiffness : float
        Of every joint under impedance, as acceleration [1/s^2]; critically damped.
    people : sequence of Push or Guide
        Who pushes and leads the robot in every episode.
    """

    def __init__(
        self,
        simulation: Simulation,
        episodes: Callable[[int], Episode],
        *,
        coordinates: Sequence[Coordinate],
        errors: Callable[[], Errors],
        sites: Mapping[str, str],
        action: str = "torque",
        stiffness: float = 100.0,
        people: Sequence[Push | Guide] = (),
    ):
        if action not in ACTIONS:
            raise ArgumentError(f"action is {action!r}; choose one of {', '.join(ACTIONS)}")
        self.simulation, self._robot = simulation, simulation.robot
        self._episodes, self._count, self._episode = episodes, 0, None
        self._errors, self._people, self._action = errors, people, action
        self._impedance = FixedImpedance(self._robot, simulation.home, stiffness)
        self._sites = {name: self._robot.site(site) for name, site in sites.items()}
        self._views = {c.name: c.bind(self._robot) for c in coordinates}
        self._begin(Episode(simulation.home))

    def _begin(self, episode: Episode) -> None:
        self._surroundings = Surroundings(self.simulation, self._people, episode.objects)
        self._surroundings.reset(episode.start)
        self._surroundings.sense()
        self._command = self._impedance.posture = np.array(episode.start, float)
        self._quaternions = np.zeros((len(self._sites), 4))

    def initialize_episode(self, physics) -> None:
        """Begin the next episode."""
        self._episode = self._episodes(self._count)
        self._count += 1
        self._begin(self._episode)

    def controller(self) -> Controller:
        """Our own controller for this episode: its ``torque()`` is the action to take now.

        Raises
        ------
        ArgumentError
            If no episode has begun, or no models were given to make the controller of.
        """
        if self._episode is None or self._episode.controller is None:
            raise ArgumentError(
                "there is no controller of our own here; give the environment the learned models "
                "and call reset() first"
            )
        controller = self._episode.controller()
        # Making a controller may have looked at other postures.
        self._surroundings.sense()
        return controller

    def action_spec(self, physics) -> specs.BoundedArray:
        """Joint torques [Nm] within the motors' limits, or postures [rad] within the joints'."""
        robot = self._robot
        limits = {
            "torque": (-robot.torque_limit, robot.torque_limit),
            "impedance": (robot.lower, robot.upper),
        }
        return specs.BoundedArray((robot.n,), float, *limits[self._action], name=self._action)

    def before_step(self, action, physics) -> None:
        """Take the action (n,); what is beyond the limits of motors or joints is cut off."""
        action = np.array(action, float)
        if action.shape != (self._robot.n,) or not np.isfinite(action).all():
            raise ArgumentError(
                f"an action of shape {action.shape} was given; "
                f"give {self._robot.n} finite numbers, one for each joint"
            )
        if self._action == "impedance":
            robot = self._robot
            self._impedance.posture = np.minimum(np.maximum(action, robot.lower), robot.upper)
        self._command = action

    def tick(self) -> None:
        """Advance by one time step under the last action."""
        wanted = self._command if self._action == "torque" else self._impedance.torque()
        self._surroundings.advance(self._surroundings.act(wanted))
        self._surroundings.sense()

    def get_observation(self, physics) -> dict[str, np.ndarray]:
        """What the agent sees now.

        ``q``, ``dq`` (n,), ``<site>_position`` (3,) and ``<site>_quaternion`` (4,), the same of
        objects, and ``frames/<name>`` (d,), ``jacobians/<name>`` (d, n): each candidate frame as
        the y and J of Table 3.
        """
        robot = self._robot
        seen = {"q": robot.q.copy(), "dq": robot.dq.copy()}
        poses = [robot.placement(site) for site in self._sites.values()]
        turned = rotation.to_quaternion(np.array([R for R, _ in poses]))
        # Quaternions keep their sign, as in recordings.
        flipped = np.einsum("si,si->s", turned, self._quaternions) < 0
        self._quaternions = np.where(flipped[:, None], -turned, turned)
        for name, (_, p), quaternion in zip(self._sites, poses, self._quaternions, strict=True):
            seen[f"{name}_position"], seen[f"{name}_quaternion"] = p.copy(), quaternion.copy()
        for name, (p, quaternion) in self.simulation.objects.items():
            seen[f"{name}_position"], seen[f"{name}_quaternion"] = p.copy(), quaternion.copy()
        for name, evaluate in self._views.items():
            y, J = evaluate()
            seen[f"frames/{name}"], seen[f"jacobians/{name}"] = y.copy(), J.copy()
        return seen

    def get_reward(self, physics) -> float:
        """Product over all errors, each 1 within its bound and falling to 0 beyond: in [0, 1]."""
        return float(np.prod([_share(*error) for error in self._errors().values()]))

    def get_termination(self, physics) -> float | None:
        """End the episode where the state became wild."""
        return 0.0 if self._surroundings.diverged else None


def _share(error, bound):
    return tolerance(error, (0.0, bound), margin=SLOPE * bound, sigmoid="long_tail")


class Environment(control.Environment):
    """A movement as an environment of dm_env.

    Parameters
    ----------
    movement : Movement
        ``environment.task`` from then on.
    duration : float
        Of an episode [s].
    control_timestep : float, optional
        Time between two actions [s], a multiple of the simulation's time step, which it is by
        default. Under impedance the spring is computed at every time step all the same.
    """

    def __init__(self, movement: Movement, duration: float, control_timestep: float | None = None):
        h = movement.simulation.timestep
        period = h if control_timestep is None else control_timestep
        for name, value in (("duration", duration), ("control_timestep", period)):
            if not (np.isfinite(value) and value > 0):
                raise ArgumentError(f"{name} is {value} s; give a positive number")
        super().__init__(
            Physics(movement.simulation, movement.tick),
            movement,
            # Half a step less: the number of steps must not hang on the last bit of a quotient.
            time_limit=(max(1, round(duration / period)) - 0.5) * period,
            control_timestep=period,
            legacy_step=False,
        )

    def reward_spec(self) -> specs.BoundedArray:
        """Describe the reward: a number in [0, 1]."""
        return specs.BoundedArray((), float, 0.0, 1.0, name="reward")
