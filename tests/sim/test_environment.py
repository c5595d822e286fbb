"""Environments of dm_env: the steps of roll-outs, dm_env's own conformance, what is refused."""

import doctest
from dataclasses import replace

import numpy as np
import pytest
from absl.testing import absltest
from dm_env import test_utils

from tpsim import tasks
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim.objects import ObjectPath
from tpsim.sim.push import Push
from tpsim.tasks import environment as module
from tpsim.tasks.environment import environment

TIMED = {"pointing", "pointing-baxter", "transfer"}
"""Tasks whose frames observe time too."""


def some_models(task):
    """Models that were not taught: K = 2 Gaussians of random means in every frame."""
    simulation, rng = task.simulation(), np.random.default_rng(0)
    simulation.robot.update(simulation.home, 0 * simulation.home)
    models = {}
    for behaviour in task.behaviours:
        frames = []
        for coordinate in task.coordinates(simulation, behaviour):
            y, _ = coordinate.bind(simulation.robot)()
            mean = y + 0.05 * rng.standard_normal((2, y.size))
            if task.name in TIMED:
                mean = np.column_stack([[0.5, 4.0], mean])
            frames.append(Gaussian(mean, 0.01 * np.array([np.eye(mean.shape[1])] * 2)))
        models[behaviour] = TPGMM(np.full(2, 0.5), tuple(frames))
    return models


def driven(world, action):
    """Rewards of an episode and q before every step."""
    step, q, rewards = world.reset(), [], []
    agent = action(world, step)
    while not step.last():
        q.append(step.observation["q"])
        step = world.step(agent())
        rewards.append(step.reward)
    return np.array(q), np.array(rewards)


@pytest.mark.parametrize("name", tasks.names())
def test_our_controller_drives_an_environment_as_it_drives_a_rollout(name):
    task = tasks.load(name)
    models, simulation = some_models(task), task.simulation()
    situation = task.situation(simulation, 3, 0)
    trial = task.perform(simulation, models, situation, duration=0.3)
    world = environment(name, models=models, seed=3, duration=0.3)
    limit = world.action_spec().maximum

    def ours(world, step):
        controller = world.task.controller()
        return lambda: np.clip(controller.torque(), -limit, limit)

    q, rewards = driven(world, ours)
    assert len(q) == 300 and np.ptp(q, axis=0).max() > 1e-3
    np.testing.assert_array_equal(q[::10], trial["q"])
    assert ((rewards >= 0) & (rewards <= 1)).all()


def test_pushes_and_moving_objects_are_those_of_a_rollout():
    task = tasks.load("pointing")
    models, simulation = some_models(task), task.simulation()
    push = Push("tip", (4.0, -3.0, 0.0), start=0.05, duration=0.2)
    situation = task.situation(simulation, 0, 0)
    first = ObjectPath(**situation.details["objects"][0])
    (at,) = first.positions
    away = tuple(np.add(at, [0.1, 0.0, 0.0]))
    moving = replace(first, positions=(at, away), times=(0.0, 0.2), quaternions=None)
    task.objects = lambda _: (moving,)
    trial = task.perform(simulation, models, situation, people=[push], duration=0.3)
    world = environment(task, models=models, people=[push], duration=0.3)
    seen = []

    def ours(world, step):
        controller = world.task.controller()

        def act():
            seen.append(world.task.get_observation(world.physics)["first_position"])
            return controller.torque()

        return act

    q, _ = driven(world, ours)
    np.testing.assert_array_equal(q[::10], trial["q"])
    np.testing.assert_array_equal(seen[::10], trial["first_position"])
    np.testing.assert_allclose(seen[-1], away)


@pytest.mark.parametrize("name", tasks.names())
def test_an_agent_sees_joints_sites_objects_and_frames(name):
    world = environment(name, duration=0.1)
    seen = world.reset().observation
    task, simulation = world.task, world.task.simulation
    robot, data = simulation.robot, simulation.data
    np.testing.assert_array_equal(seen["q"], simulation.q)
    for key, site in tasks.load(name).sites.items():
        np.testing.assert_allclose(seen[f"{key}_position"], data.site(site).xpos, atol=1e-9)
    for key, (position, _) in simulation.objects.items():
        np.testing.assert_array_equal(seen[f"{key}_position"], position)
    # Each frame's y follows its Jacobian.
    step = 1e-6 * np.random.default_rng(0).standard_normal(robot.n)
    robot.update(simulation.q + step, simulation.dq)
    moved = task.get_observation(world.physics)
    frames = [key for key in seen if key.startswith("frames/")]
    assert frames
    for key in frames:
        J = seen[key.replace("frames", "jacobians")]
        change = moved[key] - seen[key]
        # The nullspaces of Eqs (42)-(44) turn with q; their Jacobians leave that out.
        if "posture" not in key and "beneath" not in key:
            np.testing.assert_allclose(change, J @ step, atol=1e-10)


def test_reward_is_full_where_the_task_is_done_and_falls_with_the_error():
    world = environment("cup-and-sugar", duration=0.2)
    _, rewards = driven(world, lambda world, step: lambda: np.zeros(14))
    assert rewards[0] > 0.99
    assert (np.diff(rewards[100:]) < 0).all() and rewards[-1] < 0.2


def test_an_impedance_pulls_the_posture_to_its_target():
    world = environment("pointing", action="impedance", duration=2.0, control_timestep=0.05)
    target = None

    def towards(world, step):
        nonlocal target
        target = step.observation["q"] + [0.1, -0.2, 0.1]
        return lambda: target

    q, _ = driven(world, towards)
    assert len(q) == 40
    np.testing.assert_allclose(q[-1], target, atol=1e-3)


def test_every_episode_is_another_situation_and_a_seed_repeats_them():
    def starts(seed):
        world = environment("pointing", seed=seed, duration=0.1)
        return np.array([world.reset().observation["q"] for _ in range(3)])

    first = starts(5)
    assert np.unique(first, axis=0).shape == (3, 3)
    np.testing.assert_array_equal(starts(5), first)
    assert (starts(6) != first).any()


def test_a_wild_state_ends_the_episode():
    world = environment("pointing", duration=1.0)
    world.reset()
    world.task.simulation.data.qvel[:] = 100.0
    step = world.step(np.zeros(3))
    assert step.last() and step.discount == 0.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"name": "tea"}, "no task 'tea'"),
        ({"action": "voltage"}, "choose one of torque, impedance"),
        ({"duration": 0.0}, "duration is 0.0"),
        ({"control_timestep": np.nan}, "control_timestep is nan"),
        ({"stiffness": -1.0}, "stiffness is -1.0"),
    ],
)
def test_what_is_wrong_is_said(arguments, words):
    with pytest.raises(ArgumentError, match=words):
        environment(**{"name": "pointing", **arguments})


@pytest.mark.parametrize("action", [[0.0, 1.0], [0.0, np.nan, 0.0], 1.0])
def test_a_bad_action_is_refused(action):
    world = environment("pointing", duration=0.1)
    world.reset()
    with pytest.raises(ArgumentError, match="give 3 finite numbers"):
        world.step(action)


def test_there_is_no_controller_without_models():
    world = environment("pointing", duration=0.1)
    world.reset()
    with pytest.raises(ArgumentError, match="give the environment the learned models"):
        world.task.controller()


def test_the_example_works():
    assert doctest.testmod(module).failed == 0
    assert doctest.testmod(module).attempted > 5


class Conforms(test_utils.EnvironmentTestMixin):
    """dm_env's own test, with episodes that end."""

    name: str
    action: str

    def make_object_under_test(self):
        return environment(self.name, action=self.action, duration=0.015)


def _conformance():
    for name in tasks.names():
        for action in ("torque", "impedance"):
            title = f"Test{name.title()}{action.title()}".replace("-", "")
            about = {"name": name, "action": action}
            yield title, type(title, (Conforms, absltest.TestCase), about)


globals().update(_conformance())
