"""Pointing, taught by a hand and performed where it was never shown (Fig. 10)."""

from dataclasses import asdict, replace

import numpy as np
import pytest

from tpsim import tasks
from tpsim.errors import ArgumentError
from tpsim.experiment.studies import study as study_of
from tpsim.experiment.studies.pointing import angle
from tpsim.sim.objects import ObjectPath
from tpsim.sim.teach import demonstrate, teach
from tpsim.tasks.pointing import PHASES


@pytest.fixture(scope="module")
def taught():
    """The planar arm, taught six times, and its model."""
    task = tasks.load("pointing")
    simulation = task.simulation()
    trials = teach(
        simulation,
        lambda simulation, rng: task.lesson(simulation, task.name, rng),
        task.demonstrations,
        seed=0,
        sites=task.sites,
    )
    model = task.learn(simulation, task.name, trials, task.components)
    return task, simulation, {task.name: model}, trials


def test_the_teacher_points_at_the_objects_and_comes_back(taught):
    task, _, _, trials = taught
    for trial in trials:
        for name, (begin, end) in PHASES.items():
            inside = (trial["time"] > begin + 0.2) & (trial["time"] < end - 0.2)
            assert angle(trial, task.pointer, name)[inside].max() < 3.0
        assert np.abs(trial["q"][-1] - task.rest).max() < 0.1


def test_each_object_matters_in_its_own_phase_alone(taught):
    """What the covariance says once the time is known: no number of it was set by hand."""
    _, _, models, _ = taught
    (model,) = models.values()
    times = model.frames[0].mean[:, 0]
    for frame, own, other in ((2, "first", "second"), (3, "second", "first")):
        deviation = {}
        for name, (begin, end) in PHASES.items():
            k = int(np.argmin(np.abs(times - (begin + end) / 2)))
            gaussian = model.frames[frame][k]
            deviation[name] = gaussian.condition([times[k]], [0]).covariance[0, 0] ** 0.5
        assert deviation[own] < np.radians(1.5)
        assert deviation[other] > 10 * deviation[own]


def test_unseen_objects_at_rest_moving_jumping_and_a_pushed_arm(taught):
    task, simulation, models, _ = taught
    study = study_of("pointing")
    (conditions,) = study.phases(simulation, models, 7, 1, 1)
    records = [(c, c.perform(task, simulation, models)) for c in conditions]
    figures = study.figures(records, models)
    limits = {m.name: m for m in study.measures(figures)}
    assert all(trial.outcome == "done" for _, trial in records)
    assert len(limits) >= 8 and all(m.passed is not False for m in limits.values()), figures
    assert figures["angle_deg"] <= 1.5 and figures["angle_pushed_deg"] <= 4.0
    assert figures["posture_rad"] <= 0.1 and figures["jump_recovery_s"] <= 0.5


@pytest.mark.parametrize(
    ("path", "signal"),
    [
        (lambda p, tip: ObjectPath.at("first", (-0.5, -0.8, p[2])), "beyond_limits"),
        (lambda p, tip: ObjectPath("first", (p, p, 2 * tip - p), (0, 3, 3)), "beyond_limits"),
        (lambda p, tip: ObjectPath.at("first", tip), None),
        (lambda p, tip: ObjectPath.at("first", (1e3, 1e3, 0)), None),
    ],
    ids=["out of reach", "jump across the arm", "at the tip", "far away"],
)
def test_impossible_objects_leave_the_arm_bounded_and_are_recorded(taught, path, signal):
    task, simulation, models, _ = taught
    robot = simulation.robot
    situation = task.situation(simulation, 0, 0)
    first, second = (ObjectPath(**p) for p in situation.details["objects"])
    robot.update_kinematics(task.rest)
    tip = robot.placement(robot.site("tip"))[1].copy()
    wild = path(np.array(first.positions[0]), tip)
    details = {"objects": [asdict(wild), asdict(second)]}
    trial = task.perform(simulation, models, replace(situation, details=details), duration=4.5)
    assert trial.outcome == "done"
    assert all(np.isfinite(array).all() for array in trial.arrays.values())
    assert np.abs(trial["dq"]).max() < 2 * robot.velocity_limit.max()
    assert (trial["q"] > robot.lower - 0.05).all() and (trial["q"] < robot.upper + 0.05).all()
    if signal:
        assert trial[signal].any()


def test_the_same_situation_repeats_bit_for_bit(taught):
    task, simulation, models, _ = taught
    situation = task.situation(simulation, 1, 0)
    one, other = (task.perform(simulation, models, situation, duration=0.5) for _ in range(2))
    for name in one.arrays:
        np.testing.assert_array_equal(one[name], other[name])


def test_a_controller_that_is_not_there_is_refused(taught):
    task, simulation, models, _ = taught
    with pytest.raises(ArgumentError, match="stiff"):
        task.perform(simulation, models, task.situation(simulation, 1, 0), controller="stiff")


def test_the_same_code_teaches_the_gripper_of_baxter():
    task = tasks.load("pointing-baxter")
    simulation = task.simulation()
    lesson = task.lesson(simulation, task.name, np.random.default_rng(0))
    short = replace(lesson, duration=PHASES["first"][1])
    trial = demonstrate(simulation, short, task.sites)
    assert trial.outcome == "done"
    held = (trial["time"] > 2.2) & (trial["time"] < 3.8)
    assert angle(trial, task.pointer, "first")[held].max() < 4.0
