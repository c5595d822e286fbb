"""Environments of dm_env: the steps of roll-outs, dm_env's own conformance, what is refused."""

import doctest
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dm_control")  # not for every Python
from absl.testing import absltest
from dm_env import test_utils

from tpsim.errors import ArgumentError, SimulationError
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import TPGMM
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import R
from tpsim.robot.objects import Objects
from tpsim.robot.views.sites import Site
from tpsim.study.reference import load_study
from tpsim.task import environment as module
from tpsim.task.environment import environment
from tpsim.task.task import Behaviour, Goal, Task, draw_situation
from tpsim.task.verbs import perform
from tpsim.tasks import STUDIES
from tpsim.tasks.cup_and_sugar.task import CupAndSugar
from tpsim.tasks.pointing.task import Pointing
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.push import Push
from tpsim.world.plant import Plant

TIMED = {"serve", "pointing", "transfer"}
"""Tasks whose frames observe time too."""

POINTING = Pointing()


def task_of(name: str) -> Task:
    return load_study(name, STUDIES).task


def some_models(task):
    """Models that were not taught: K = 2 Gaussians of random means in every frame."""
    world, rng = task.stage, np.random.default_rng(0)
    simulation = world.simulation()
    objects = Objects(simulation.objects, simulation.data.mocap_pos, simulation.data.mocap_quat)
    state = world.robot.at(world.robot.home, objects=objects)
    models = {}
    for name, behaviour in task.behaviours().items():
        frames = []
        for view in behaviour.views.values():
            y, space = view(state).value, view.manifold(world.robot)
            mean = space.exp(y, 0.05 * rng.standard_normal((2, space.dim)))
            if task.name in TIMED:
                mean, space = np.column_stack([[0.5, 4.0], mean]), R(1, "inputs") * space
            covariance = 0.01 * np.array([np.eye(space.dim)] * 2)
            curved = mean.shape[1] > space.dim
            frames.append(
                RiemannianGaussian(space, mean, covariance)
                if curved
                else Gaussian(mean, covariance)
            )
        models[name] = TPGMM(np.full(2, 0.5), tuple(frames))
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


def ours(world, step):
    """The task's own controller as an agent."""
    controller, limit = world.task.controller(), world.action_spec().maximum
    return lambda: np.clip(controller.torque(), -limit, limit)


@pytest.mark.parametrize("name", STUDIES)
def test_our_controller_drives_an_environment_as_it_drives_a_rollout(name):
    task = task_of(name)
    models = some_models(task)
    trial = perform(task, models, draw_situation(task, 3, 0), duration=0.3)
    world = environment(task, models=models, seed=3, duration=0.3)
    q, rewards = driven(world, ours)
    assert len(q) == 300 and np.ptp(q, axis=0).max() > 1e-3
    np.testing.assert_array_equal(q[::10], trial["q"])
    assert ((rewards >= 0) & (rewards <= 1)).all()


def test_pushes_and_moving_objects_are_those_of_a_rollout():
    class Moving(Pointing):
        def situation(self, world, rng):
            found = super().situation(world, rng)
            place = np.array(found.objects[0].positions[0])
            path = ObjectPath("first", (place, place + np.array([0.1, 0.0, 0.0])), (0.0, 0.2))
            return replace(found, objects=(path, found.objects[1]))

    task = Moving()
    models = some_models(task)
    push = Push("tip", (4.0, -3.0, 0.0), start=0.05, duration=0.2)
    situation = draw_situation(task, 0, 0)
    trial = perform(task, models, situation, people=[push], duration=0.3)
    world = environment(task, models=models, people=[push], duration=0.3)
    seen = []

    def watching(world, step):
        agent = ours(world, step)

        def act():
            seen.append(world.task.get_observation(world.physics)["first_position"])
            return agent()

        return act

    q, _ = driven(world, watching)
    np.testing.assert_array_equal(q[::10], trial["q"])
    np.testing.assert_array_equal(seen[::10], trial["first_position"])
    np.testing.assert_allclose(seen[-1], situation.objects[0].positions[1])


def test_a_plant_with_encoders_latency_and_payload_is_that_of_a_rollout():
    task, models = POINTING, some_models(POINTING)
    plant = Plant(mass=0.05, latency=0.002, encoder_bits=14, seed=1)
    trial = perform(task, models, draw_situation(task, 0, 0), duration=0.2, plant=plant)
    world = environment(task, models=models, duration=0.2, plant=plant)
    true = []

    def watching(world, step):
        agent = ours(world, step)

        def act():
            true.append(world.task.performance.simulation.q.copy())
            return agent()

        return act

    q, _ = driven(world, watching)
    np.testing.assert_array_equal(true[::10], trial["q"])
    # The agent sees what the encoders say.
    assert 0 < np.abs(q - true).max() < 2 * np.pi / 2**14


@pytest.mark.parametrize("name", STUDIES)
def test_an_agent_sees_joints_sites_objects_and_views(name):
    task = task_of(name)
    world = environment(task, duration=0.1)
    seen = world.reset().observation
    performance = world.task.performance
    robot, simulation = performance.robot, performance.simulation
    np.testing.assert_array_equal(seen["q"], simulation.q)
    for key, site in task.sites().items():
        xpos = simulation.data.site(site).xpos
        np.testing.assert_allclose(seen[f"{key}_position"], xpos, atol=1e-9)
    for key, row in simulation.objects.items():
        np.testing.assert_array_equal(seen[f"{key}_position"], simulation.data.mocap_pos[row])
    views = {n: v for b in task.behaviours().values() for n, v in b.views.items()}
    state = robot.at(seen["q"], objects=performance.state.objects)
    for name, view in views.items():
        np.testing.assert_array_equal(seen[f"frames/{name}"], view(state).value)
        np.testing.assert_array_equal(seen[f"jacobians/{name}"], view(state).jacobian)


def test_reward_is_full_where_the_task_is_done_and_falls_with_the_error():
    world = environment(CupAndSugar(), duration=0.2)
    _, rewards = driven(world, lambda world, step: lambda: np.zeros(14))
    assert rewards[0] > 0.99
    assert (np.diff(rewards[100:]) < 0).all() and rewards[-1] < 0.2


def test_a_goal_leaves_a_tenth_of_the_reward_ten_bounds_beyond_it_and_counts_in_its_time_alone():
    height = 0.2

    class Standing(Pointing):
        def goals(self):
            beside = self.stage.robot.at_home.pose("tip").position[:1] + height
            view = Site("tip").position[:1].minus(beside)
            return {"still": Goal(view, height / 11, since=0.05)}

        def situation(self, world, rng):
            return replace(super().situation(world, rng), start=world.robot.home)

    world = environment(Standing(), action="impedance", stiffness=1e4, duration=0.1)
    home = POINTING.stage.robot.home
    _, rewards = driven(world, lambda world, step: lambda: home)
    np.testing.assert_array_equal(rewards[:48], 1.0)
    np.testing.assert_allclose(rewards[51:], 0.1, atol=1e-6)


def test_an_impedance_pulls_the_posture_to_its_target():
    world = environment(POINTING, action="impedance", duration=2.0, control_timestep=0.05)
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
        world = environment(POINTING, seed=seed, duration=0.1)
        return np.array([world.reset().observation["q"] for _ in range(3)])

    first = starts(5)
    assert np.unique(first, axis=0).shape == (3, 3)
    np.testing.assert_array_equal(starts(5), first)
    assert (starts(6) != first).any()


def test_a_wild_state_ends_the_episode():
    world = environment(POINTING, duration=1.0)
    world.reset()
    world.task.performance.simulation.data.qvel[:] = 100.0
    step = world.step(np.zeros(3))
    assert step.last() and step.discount == 0.0 and step.reward == 0.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"action": "voltage"}, "give 'torque' or 'impedance'"),
        ({"duration": 0.0}, "duration is 0.0"),
        ({"control_timestep": np.nan}, "control_timestep is nan"),
        ({"control_timestep": 0.0015}, "give a multiple of the time step"),
        ({"stiffness": -1.0}, "stiffness is -1.0"),
    ],
)
def test_what_is_wrong_is_said(arguments, words):
    with pytest.raises(ArgumentError, match=words):
        environment(POINTING, **arguments)


def test_a_view_of_a_site_that_is_not_there_is_said_at_once():
    class Wrong(Pointing):
        def behaviours(self):
            (taught,) = super().behaviours().values()
            return {"wrong": Behaviour({"nose": Site("nose").pose}, taught.teacher)}

    with pytest.raises(SimulationError, match="no site 'nose' on the robot, only"):
        environment(Wrong())


def test_a_goal_without_room_is_refused():
    with pytest.raises(ArgumentError, match=r"within is 0\.0"):
        Goal(Site("tip").position, 0.0)


@pytest.mark.parametrize("action", [[0.0, 1.0], [0.0, np.nan, 0.0], 1.0])
def test_a_bad_action_is_refused(action):
    world = environment(POINTING, duration=0.1)
    world.reset()
    with pytest.raises(ArgumentError, match=r"give 3 finite numbers|row 1 of 3"):
        world.step(action)


def test_there_is_no_controller_without_models():
    world = environment(POINTING, duration=0.1)
    world.reset()
    with pytest.raises(ArgumentError, match="give the environment the learned models"):
        world.task.controller()


def test_the_example_works():
    assert doctest.testmod(module).failed == 0
    assert doctest.testmod(module).attempted > 5


class Conforms(test_utils.EnvironmentTestMixin):
    """dm_env's own test, with episodes that end."""

    task: Task
    action: str

    def make_object_under_test(self):
        return environment(self.task, action=self.action, duration=0.015)


class TestPointingTorque(Conforms, absltest.TestCase):
    task, action = POINTING, "torque"


class TestPointingImpedance(Conforms, absltest.TestCase):
    task, action = POINTING, "impedance"


class TestCupAndSugarTorque(Conforms, absltest.TestCase):
    task, action = CupAndSugar(), "torque"
