"""The experts of the built-in tasks: what they know, and the gains that are shipped."""

import json
from pathlib import Path

import numpy as np
import pytest

import tpsim.tasks
from tpsim import rotation
from tpsim.pose import Pose
from tpsim.study.reference import load_study
from tpsim.study.tuning import SEED
from tpsim.task.task import draw_situation
from tpsim.task.verbs import perform
from tpsim.tasks import STUDIES
from tpsim.tasks.cup_and_sugar.study import cup_and_sugar
from tpsim.tasks.pointing.experts import view
from tpsim.tasks.pointing.pointers import PLANAR, planar_world
from tpsim.tasks.transfer import docks
from tpsim.tasks.transfer.experts import Way, place
from tpsim.tasks.transfer.experts import view as on_the_way
from tpsim.world.object_path import ObjectPath

CONTESTS = {name: study.contest for name in STUDIES if (study := load_study(name, STUDIES)).contest}


@pytest.mark.parametrize("name", CONTESTS)
def test_every_task_has_its_experts_beside_fixed_gains(name):
    study = load_study(name, STUDIES)
    known = {"learned", "stiff", "soft", "cartesian", "osc", "computed"}
    assert known <= set(study.all_controllers)
    variants = {f"learned, {name}" for name in study.contest.variants(study.task)}
    softer = {f"{name}, softer" for name, one in study.contest.experts.items() if one.softer}
    assert set(study.performers) - set(study.all_controllers) == variants | softer


def test_shipped_gains_are_within_their_ranges_and_say_where_they_are_from():
    in_space = load_study("pointing", STUDIES).with_task(robot="baxter").contest
    contests = [*CONTESTS.values(), in_space]
    files = {contest.gains for contest in contests}
    shipped = set(Path(tpsim.tasks.__path__[0]).glob("*/gains*.json"))
    # What is not tuned yet has the middle of its ranges, and the report says so.
    assert shipped <= files
    for contest in contests:
        if contest.gains not in shipped:
            continue
        found = json.loads(contest.gains.read_text())["experts"]
        for name, expert in contest.experts.items():
            about = found[name]
            assert about["seed"] >= SEED and about["trials"] >= 3 and "tpsim" in about["versions"]
            assert dict(expert.gains) == about["gains"]
            for gain, value in expert.gains.items():
                assert expert.ranges[gain].low * 0.99 < value < expert.ranges[gain].high * 1.01


@pytest.mark.parametrize("name", ["cartesian", "osc", "computed"])
def test_experts_of_the_cup_stay_where_the_task_is_done(name):
    task = cup_and_sugar.task
    situation = draw_situation(task, 3, 0)
    expert = cup_and_sugar.contest.experts[name]
    trial = perform(task, {}, situation, controller=expert(task.stage, {}, situation), duration=0.3)
    assert np.abs(trial["q"] - trial["q"][0]).max() < 2e-3


def test_the_expert_who_points_has_one_goal_after_another():
    robot = planar_world().robot
    spots = {"first": (-0.35, 0.606, -0.054), "second": (0.35, 0.606, -0.054)}
    places = ObjectPath.at("first", spots["first"]), ObjectPath.at("second", spots["second"])
    objects = {path.name: path.first for path in places}
    wanted = [
        (0.3, PLANAR.axis),
        (3.0, PLANAR.bearing("first")),
        (6.5, PLANAR.bearing("second")),
        (9.5, PLANAR.axis),
    ]
    for time, goal in wanted:
        state = robot.at(robot.home + 0.1, objects=objects, time=time)
        np.testing.assert_array_equal(view(PLANAR)(state).value, goal(state).value)


def test_the_expert_who_carries_passes_the_poses_that_the_teacher_does(dock_world):
    placed = docks.draw(dock_world.robot, np.random.default_rng(0))
    rotations, positions = docks.via_poses(placed, 1.0)
    times = np.linspace(docks.REST, docks.STANDARD.movement - docks.REST, 4)
    for time, R, p in zip(times, rotations, positions, strict=True):
        pose = place(placed, time)
        np.testing.assert_allclose(pose.rotation, R, atol=1e-9)
        np.testing.assert_allclose(pose.position, p, atol=1e-9)
    before, after = place(placed, 0.0), place(placed, docks.STANDARD.movement + 1.0)
    np.testing.assert_allclose(before.position, positions[0])
    np.testing.assert_allclose(after.position, positions[-1])


def test_docks_that_move_carry_the_way_along(dock_world):
    """The twist is the difference of poses over time and docks."""
    robot, h = dock_world.robot, 1e-5
    placed = docks.draw(robot, np.random.default_rng(1))
    v, w = np.array([0.1, -0.05, 0.2]), np.array([0.2, 0.1, -0.3])
    still = robot.at(robot.home, objects=placed, time=2.3)
    moving = still.objects.moving(np.tile(np.concatenate([v, w]), (2, 1)))
    state = robot.at(robot.home, objects=moving, time=still.time)
    pose, twist = Way()(state)
    soon = {name: Pose(rotation.exp(h * w) @ R, p + h * v) for name, (R, p) in placed.items()}
    there = place(soon, still.time + h)
    np.testing.assert_allclose((there.position - pose.position) / h, twist[:3], atol=1e-3)
    turned = rotation.log(there.rotation @ pose.rotation.T) / h
    np.testing.assert_allclose(turned, twist[3:], atol=1e-3)
    assert on_the_way(docks.STANDARD.movement)(state).value.shape == (6,)
