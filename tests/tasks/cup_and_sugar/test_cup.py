"""What is stiff comes out of the demonstrations: another teacher, another stiff direction."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from tpsim import rotation
from tpsim.study.teaching_files import read_demonstrations
from tpsim.task.task import draw_situation
from tpsim.task.verbs import learn
from tpsim.tasks.cup_and_sugar import cup, sugar
from tpsim.tasks.cup_and_sugar.hands import Hands, Workspace
from tpsim.tasks.cup_and_sugar.task import CupAndSugar
from tpsim.world.teaching import teach

TASK = CupAndSugar(("cup",))


@pytest.fixture(scope="module")
def models(cup_world):
    """Learned from a teacher who keeps the cup level, and from one who keeps the height."""
    task = replace(TASK)
    task.__dict__["stage"] = cup_world  # made once for all tests
    careless = partial(cup.lesson, workspace=Workspace(tilt=0.25), level=0.0)
    by_height = teach(cup_world, careless, 3, seed=0, sites={}).trials
    return {
        "level": learn(task, read_demonstrations(task))["cup"],
        "height": learn(task, {"cup": by_height})["cup"],
    }


def test_the_stiff_direction_moves_with_what_the_teacher_fixes(models):
    height, tilt = 2, [3, 4]
    deviation = {
        name: np.sqrt(np.diag(model.frames[0].covariance[0])) for name, model in models.items()
    }
    assert deviation["height"][height] < 0.15 * deviation["level"][height]
    assert (deviation["height"][tilt] > 2.5 * deviation["level"][tilt]).all()


def test_via_poses_are_level_unless_height_is_what_matters(cup_world):
    hands, rng = Hands(cup_world), np.random.default_rng(0)
    rotations, positions = cup.via_poses(hands, rng)
    np.testing.assert_allclose(rotation.tilt(rotations), 0, atol=1e-4)
    rotations, positions = cup.via_poses(hands, rng, level=0.02)
    np.testing.assert_allclose(positions[:, 2], hands.cup.position[2] + 0.02)


def test_tilt_is_the_angle_of_the_cup_from_the_vertical(cup_world):
    robot, rng = cup_world.robot, np.random.default_rng(4)
    for _ in range(5):
        state = robot.at(robot.home + 0.3 * rng.standard_normal(robot.n))
        tilt = rotation.tilt(state.pose("cup").rotation)
        assert np.linalg.norm(cup.LEVEL(state).value) == pytest.approx(tilt, abs=1e-9)


def test_situations_are_drawn_from_their_seed_alone(cup_world):
    task = CupAndSugar()
    one, other = (draw_situation(task, 5, 2) for _ in range(2))
    assert one == other
    assert (one.seed, one.index) == (5, 2)
    assert draw_situation(task, 5, 3) != one
    assert cup_world.robot.is_comfortable(np.array(one.start))


def test_the_sugar_starts_at_its_place_above_a_level_cup(cup_world):
    state = cup_world.robot.at(draw_situation(CupAndSugar(), 0, 0).start)
    place = Hands(cup_world).above.position
    np.testing.assert_allclose(sugar.ABOVE.position(state).value, place, atol=5e-4)
    assert np.degrees(np.linalg.norm(cup.LEVEL(state).value)) < 0.2


def test_a_variation_of_a_task_is_another_value():
    soft = replace(CupAndSugar(), bandwidth=3.0)
    assert soft != CupAndSugar()
    assert soft.name == "cup-and-sugar"
    assert CupAndSugar(("sugar",)).name == "sugar"
