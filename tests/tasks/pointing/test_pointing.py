"""Pointing, taught by a hand and performed where it was never shown (Fig. 10)."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim.errors import SimulationError
from tpsim.pose import Pose
from tpsim.robot.objects import Objects
from tpsim.robot.views.observe import observe
from tpsim.study.record import Records
from tpsim.study.study import Lab, Plan
from tpsim.task.task import draw_situation
from tpsim.task.verbs import learn, perform, teach
from tpsim.tasks.pointing import study
from tpsim.tasks.pointing.task import Pointing
from tpsim.tasks.pointing.teacher import PHASES, PointingTeacher
from tpsim.world.object_path import ObjectPath
from tpsim.world.reach import satisfy
from tpsim.world.teaching import demonstrate


@pytest.fixture(scope="module")
def taught():
    """The planar arm, taught six times, and its model."""
    task = Pointing()
    trials = teach(task, seed=0)
    return task, learn(task, trials), trials


def angle(task, trial, name):
    """Angle (T,) [deg] between the axis that points and the way to an object."""
    bearing = [task.pointer.bearing(name)]
    (seen,) = observe(task.stage.robot, bearing, trial["q"], trial.objects)
    return np.degrees(np.linalg.norm(seen, axis=1))


def test_the_bearing_is_the_angle_to_the_object_in_the_recording(taught):
    """The one definition of the angle, beside arrays that know nothing of it."""
    task, _, trials = taught
    trial = trials["pointing"][0]
    for name in PHASES:
        axis = trial.pose("tip").rotation[:, :2, 0]
        way = (trial[f"{name}_position"] - trial["tip_position"])[:, :2]
        cosine = np.einsum("ti,ti->t", axis, way) / np.linalg.norm(way, axis=1)
        expected = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        np.testing.assert_allclose(angle(task, trial, name), expected, atol=1e-4)


def test_the_teacher_points_at_the_objects_and_comes_back(taught):
    task, _, trials = taught
    for trial in trials["pointing"]:
        for name, (begin, end) in PHASES.items():
            inside = (trial.time > begin + 0.2) & (trial.time < end - 0.2)
            assert angle(task, trial, name)[inside].max() < 3.0
        assert np.abs(trial["q"][-1] - task.stage.robot.home).max() < 0.1


def test_each_object_matters_in_its_own_phase_alone(taught):
    """What the covariance says once the time is known: no number of it was set by hand."""
    task, models, _ = taught
    model = models["pointing"]
    frames = dict(zip(task.pointer.views, model.frames, strict=True))
    times = model.frames[0].mean[:, 0]
    for own, other in (("first", "second"), ("second", "first")):
        deviation = {}
        for name, (begin, end) in PHASES.items():
            k = int(np.argmin(np.abs(times - (begin + end) / 2)))
            gaussian = frames[f"direction to {own}"][k]
            deviation[name] = gaussian.condition([times[k]], [0]).covariance[0, 0] ** 0.5
        assert deviation[own] < np.radians(1.5)
        assert deviation[other] > 10 * deviation[own]


def test_unseen_objects_at_rest_moving_jumping_and_a_pushed_arm(taught):
    task, models, trials = taught
    pointing = study.study(task)
    lab = Lab(pointing, models, trials)
    (conditions,) = pointing.conditions(lab, Plan(seed=7, situations=1, pushes=1))
    records = Records(task, models)
    for condition in conditions:
        people = condition.people
        records.add(condition, perform(task, models, condition.situation, people=people))
    figures = {m.name: m.figure(records) for m in pointing.all_measures}
    results = [
        m.result(figures[m.name]) for m in pointing.all_measures if figures[m.name] is not None
    ]
    assert all(record.trial.outcome == "done" for record in records)
    assert len(results) >= 8 and all(result.passed is not False for result in results), figures
    assert figures["angle_deg"] <= 1.5 and figures["angle_pushed_deg"] <= 4.0
    largest = max(
        angle(task, record.trial, name)[
            (record.trial.time >= start) & (record.trial.time < end)
        ].max()
        for record in records.select(("unpushed", "moving"))
        for name, (start, end) in PHASES.items()
    )
    assert figures["angle_deg"] == pytest.approx(largest)
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
    task, models, _ = taught
    robot = task.stage.robot
    situation = draw_situation(task, 0, 0)
    first, second = situation.objects
    wild = path(first.first.position, robot.at_home.pose("tip").position)
    situation = replace(situation, objects=(wild, second))
    trial = perform(task, models, situation, duration=4.5)
    assert trial.outcome == "done"
    assert all(np.isfinite(array).all() for array in trial.arrays.values())
    assert np.abs(trial["dq"]).max() < 2 * robot.velocity_limit.max()
    assert (trial["q"] > robot.lower - 0.05).all() and (trial["q"] < robot.upper + 0.05).all()
    if signal:
        assert trial[signal].any()


def test_the_same_situation_repeats_bit_for_bit(taught):
    task, models, _ = taught
    situation = draw_situation(task, 1, 0)
    one, other = (perform(task, models, situation, duration=0.5) for _ in range(2))
    for name in one.arrays:
        np.testing.assert_array_equal(one[name], other[name])


def test_effort_is_a_field_that_makes_the_arm_softer(taught):
    task, models, _ = taught
    situation = draw_situation(task, 1, 0)
    stiffness = [
        perform(replace(task, effort=effort), models, situation, duration=0.1)["stiffness"][0]
        for effort in (100.0, 400.0)  # so soft that the loop does not set the limit
    ]
    # Stiffness is the root of precision over effort, Eq. (34).
    np.testing.assert_allclose(stiffness[0], 2 * stiffness[1], rtol=1e-6)


def test_goals_are_the_views_that_are_controlled():
    task = Pointing()
    goals = task.goals()
    assert set(goals) == {*PHASES, "rest"}
    for name in PHASES:
        assert goals[name].view == task.pointer.views[f"direction to {name}"]
        assert (goals[name].since, goals[name].until) == PHASES[name]
    assert np.abs(goals["rest"].view(task.stage.robot.at_home).value).max() == 0


def test_the_same_code_teaches_the_gripper_of_baxter():
    task = Pointing(robot="baxter")
    assert task.name == "pointing"
    lesson = task.shown_by(task.stage, np.random.default_rng(0))
    short = replace(lesson, duration=PHASES["first"][1])
    trial = demonstrate(task.stage, short, task.sites())
    assert trial.outcome == "done"
    held = (trial.time > 2.2) & (trial.time < 3.8)
    assert angle(task, trial, "first")[held].max() < 4.0


@pytest.mark.parametrize("robot", ["planar3", "jaco"])
def test_objects_move_as_far_as_the_arm_is_long_and_where_it_can_point(robot):
    changed = study.pointing.with_task(robot=robot)
    task, pointer = changed.task, changed.task.pointer
    (found,) = study.conditions(Lab(changed, {}), Plan(seed=1, situations=4, pushes=0))
    ways = {"moving": study.SPEED, "jump": study.JUMP}
    arm = task.stage.robot
    for condition in found:
        for path in condition.situation.objects:
            if condition.label in ways:
                begin, end = np.array(path.positions)[[0, -1]]
                time = path.times[-1] - path.times[0] if condition.label == "moving" else 1.0
                assert np.linalg.norm(end - begin) / time == pytest.approx(
                    ways[condition.label] * pointer.size
                )
            for place in path.positions:
                views = pointer.bearing(path.name), pointer.posture()
                there = Objects.of({path.name: Pose(np.eye(3), np.array(place))})
                q = satisfy(arm, views, arm.home, there)
                assert (q - arm.lower > 0.1).all() and (arm.upper - q > 0.1).all()


def test_an_arm_that_can_point_at_nothing_is_told_so_in_a_line(monkeypatch):
    monkeypatch.setattr(PointingTeacher, "can_aim", lambda *_: False)
    with pytest.raises(SimulationError, match="cannot point at objects on the table before it"):
        draw_situation(Pointing(), 0, 0)
