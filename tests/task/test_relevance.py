"""Free movement is learned from all that moved; what several things make up is exchanged."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim import Gaussian
from tpsim.learning.tp_gmm import TPGMM
from tpsim.task.relevance import LEAST, independent_joints, with_relevance
from tpsim.tasks.cup_and_sugar import sugar
from tpsim.world.trial import Trial


@pytest.fixture(scope="module")
def robot(cup_world):
    return cup_world.robot


def wandering(robot, deviation, seed, steps=600):
    """Joints that wander independently of each other."""
    rng = np.random.default_rng(seed)
    q = robot.home + deviation * rng.standard_normal((steps, robot.n))
    return Trial({"time": 0.01 * np.arange(steps), "q": q})


def learned(robot, views, trials):
    models = {"b": model_of(robot, views, trials)}
    return with_relevance(robot, models, {"b": views}, {"b": trials})["b"]


def model_of(robot, views, trials):
    from tpsim.robot.views.observe import observe

    seen = observe(robot, list(views.values()), np.concatenate([t["q"] for t in trials]))
    frames = [Gaussian(x.mean(0)[None], np.cov(x.T)[None]) for x in seen]
    return TPGMM(np.ones(1), tuple(frames))


VIEWS = {name: sugar.VIEWS[name] for name in ("cup in base", "sugar in base", "sugar from cup")}


def test_arms_are_independent_of_each_other(robot):
    left, right = independent_joints(robot)
    assert [robot.joints[i] for i in left] == [j for j in robot.joints if j.startswith("left")]
    assert [robot.joints[i] for i in right] == [j for j in robot.joints if j.startswith("right")]


def test_where_everything_wanders_nothing_matters(robot):
    """Hands that wander apart vary, seen from each other, as exchanged ones do."""
    model = learned(robot, VIEWS, [wandering(robot, 0.1, seed) for seed in range(4)])
    assert not np.concatenate([one.matters[0] for one in model.relevance]).any()
    relative = model.relevance[2]
    np.testing.assert_allclose(relative.ratio[0, :3], 1.0, atol=0.25)
    for precision in model.precisions:
        np.testing.assert_array_equal(precision, 0)


def test_of_demonstrations_that_are_all_alike_nothing_is_irrelevant(robot):
    trials = [wandering(robot, 1e-4, seed) for seed in range(4)]
    model = learned(robot, VIEWS, trials)
    assert all(one.matters.all() for one in model.relevance)
    assert model.relevance[0].free[0, 0] == pytest.approx(LEAST["position"] ** 2)


def test_models_with_inputs_are_left_alone(robot):
    timed = TPGMM(np.ones(1), (Gaussian(np.zeros((1, 7)), np.eye(7)[None]),))
    views = {"cup in base": sugar.VIEWS["cup in base"]}
    found = with_relevance(robot, {"b": timed}, {"b": views}, {"b": [wandering(robot, 0.1, 0)]})
    assert found["b"] is timed


def test_relevance_is_kept_in_files(robot, tmp_path):
    model = learned(robot, VIEWS, [wandering(robot, 0.1, seed) for seed in range(2)])
    read = TPGMM.load(model.save(tmp_path / "model.npz"))
    for one, other in zip(model.precisions, read.precisions, strict=True):
        np.testing.assert_array_equal(one, other)
    assert replace(read, relevance=()).precisions[0][0, 0, 0] > 0
