"""Environments of Gymnasium: its own check, the steps of dm_env, vectors, ids, what is refused."""

import doctest
import pickle
import warnings

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env  # noqa: E402

import tpsim.task.gymnasium as module  # noqa: E402
import tpsim.tasks.gymnasium as registration  # noqa: E402
from tpsim.errors import ArgumentError  # noqa: E402
from tpsim.task.gymnasium import gym_environment  # noqa: E402
from tpsim.tasks import STUDIES  # noqa: E402
from tpsim.tasks.pointing.task import Pointing  # noqa: E402

POINTING = Pointing()
SHORT = {"duration": 0.1, "control_timestep": 0.02}


@pytest.mark.parametrize("action", ["torque", "impedance"])
@pytest.mark.parametrize("name", ["Pointing", "CupAndSugar"])
def test_gymnasium_accepts_it(name, action):
    env = gymnasium.make(f"tpsim/{name}-v0", action=action, **SHORT)
    with warnings.catch_warnings():
        # It would rather have actions without units, and bounded observations.
        warnings.simplefilter("ignore", UserWarning)
        check_env(env.unwrapped, skip_render_check=True)


def test_every_built_in_task_has_an_id():
    assert set(registration.IDS.values()) == set(STUDIES)
    assert {"tpsim/CupAndSugar-v0", "tpsim/Pointing-v0"} <= set(gymnasium.registry)


def test_an_episode_is_that_of_dm_env_bit_for_bit():
    pytest.importorskip("dm_control")  # not for every Python
    from tpsim.task.environment import environment

    rng = np.random.default_rng(0)
    actions = rng.uniform(-1, 1, (5, 3))
    theirs, env = environment(POINTING, seed=4, **SHORT), gym_environment(POINTING, **SHORT)
    step, (seen, about) = theirs.reset(), env.reset(seed=4)
    assert about == {"seed": 4, "situation": 0}
    for action in actions:
        step, found = theirs.step(action), env.step(action)
        seen, reward, terminated, truncated, _ = found
        assert reward == step.reward and truncated == step.last() and not terminated
        for name, value in step.observation.items():
            np.testing.assert_array_equal(seen[name], value)
    assert truncated


def test_a_seed_begins_its_situations_anew_and_without_one_they_go_on():
    env = gym_environment(POINTING, **SHORT)
    first = [env.reset(seed=7)[0]["q"], env.reset()[0]["q"]]
    again = [env.reset(seed=7)[0]["q"], env.reset()[0]["q"]]
    np.testing.assert_array_equal(first, again)
    assert (first[0] != first[1]).any()
    starts = [gym_environment(POINTING, seed=s, **SHORT).reset()[0]["q"] for s in (7, 7, None)]
    np.testing.assert_array_equal(starts[0], first[0])
    np.testing.assert_array_equal(starts[1], first[0])
    assert (starts[2] != first[0]).any()


def test_a_wild_state_terminates():
    env = gym_environment(POINTING, **SHORT)
    env.reset(seed=0)
    env.performance.simulation.data.qvel[:] = 1000.0
    _, reward, terminated, truncated, _ = env.step(np.zeros(3))
    assert terminated and not truncated and reward == 0.0


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_vectors_step_every_environment_on_its_own(mode):
    vector = gymnasium.make_vec("tpsim/Pointing-v0", num_envs=2, vectorization_mode=mode, **SHORT)
    try:
        seen, _ = vector.reset(seed=7)
        assert seen["q"].shape == (2, 3) and seen["jacobians/posture"].shape == (2, 2, 3)
        for k in range(2):
            alone = gym_environment(POINTING, **SHORT).reset(seed=7 + k)[0]
            np.testing.assert_array_equal(seen["q"][k], alone["q"])
        for _ in range(5):
            seen, rewards, ended, truncated, _ = vector.step(np.zeros((2, 3)))
        assert truncated.all() and not ended.any() and rewards.shape == (2,)
    finally:
        vector.close()


def test_a_task_of_ones_own_goes_into_a_vector():
    make = [lambda: gym_environment(Pointing(effort=0.1), **SHORT)] * 2
    vector = gymnasium.vector.SyncVectorEnv(make)
    seen, _ = vector.reset(seed=0)
    flat = gymnasium.wrappers.FlattenObservation(gym_environment(POINTING, **SHORT))
    assert flat.reset(seed=0)[0].shape == flat.observation_space.shape
    assert sum(value[0].size for value in seen.values()) == flat.observation_space.shape[0]


def test_a_joint_without_limits_may_be_sent_a_turn_away(planar_task):
    low, high = gym_environment(planar_task, action="impedance", **SHORT).performance.limits
    home = planar_task.stage.robot.home
    np.testing.assert_allclose([home - low, high - home], 2 * np.pi)


def test_images_are_drawn_where_something_draws(monkeypatch):
    from tpsim.film.rendering import backend

    if backend() is None:
        pytest.skip("nothing draws here")
    import subprocess
    import sys

    program = (
        "from tpsim.task.gymnasium import gym_environment\n"
        "from tpsim.tasks.pointing.task import Pointing\n"
        "env = gym_environment(Pointing(), render_mode='rgb_array')\n"
        "env.reset(seed=0); image = env.render(); env.close()\n"
        "assert image.shape == (480, 640, 3) and image.std() > 5, image.std()\n"
    )
    monkeypatch.setenv("MUJOCO_GL", backend())
    subprocess.run([sys.executable, "-c", program], check=True, timeout=120)


def test_what_is_wrong_is_said():
    with pytest.raises(ArgumentError, match="render_mode is 'human'; choose one of"):
        gym_environment(POINTING, render_mode="human")
    with pytest.raises(ArgumentError, match="give 3 finite numbers"):
        env = gym_environment(POINTING, **SHORT)
        env.reset()
        env.step(np.zeros(2))


def test_a_task_travels_to_other_processes():
    POINTING.stage  # noqa: B018
    assert pickle.loads(pickle.dumps(POINTING)) == POINTING


@pytest.mark.parametrize("example", [module, registration])
def test_the_examples_work(example):
    found = doctest.testmod(example)
    assert found.failed == 0 and found.attempted > 3
