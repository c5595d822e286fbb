"""Two hands with one trunk follow two objects, with the priorities that were taught (Fig. 11)."""

from dataclasses import asdict, replace

import numpy as np
import pytest

from tpsim import tasks
from tpsim.errors import ArgumentError
from tpsim.experiment.studies import study as study_of
from tpsim.experiment.studies.tracking import Outcome, distance
from tpsim.sim.objects import ObjectPath
from tpsim.sim.teach import teach
from tpsim.tasks.leaning import Body
from tpsim.tasks.tracking import BEHAVIOURS, teaching

LEFT, RIGHT_BENEATH_LEFT, LEFT_BENEATH_RIGHT, RIGHT, _ = range(5)


@pytest.fixture(scope="module")
def taught():
    """The task, its simulation, two demonstrations of each teaching and a model of each."""
    task = tasks.load("tracking")
    simulation = task.simulation()
    trials = {
        name: teach(
            simulation,
            lambda simulation, rng, name=name: task.lesson(simulation, name, rng),
            2,
            seed=0,
            sites=task.sites,
        )
        for name in task.behaviours
    }
    models = {name: task.learn(simulation, name, seen, 1) for name, seen in trials.items()}
    return task, simulation, models, trials


def deviations(model):
    return [float(np.sqrt(gaussian.covariance[0, 0, 0])) for gaussian in model.frames]


@pytest.mark.parametrize("name", BEHAVIOURS)
def test_the_teacher_leads_both_hands_as_well_as_the_body_allows(taught, name):
    _, simulation, _, trials = taught
    body = Body.of(simulation)
    for trial in trials[name]:
        points = [trial[f"{side}_object_position"][:, :2] for side in ("left", "right")]
        angle, apart = body.lean(*points, teaching(name))
        assert 0.15 < apart.mean() < 0.6
        for side, point in zip(("left", "right"), points, strict=True):
            assert np.abs(distance(trial, side) - body.missing(angle, point)).max() < 0.04


def test_precision_says_which_hand_was_preferred(taught):
    """No number of it was set by hand: the frames are the same for all three teachings."""
    _, _, models, _ = taught
    left, right, compromise = (deviations(models[name]) for name in models)
    assert left[LEFT] < 0.006 < 0.02 < left[RIGHT]
    assert right[RIGHT] < 0.006 < 0.02 < right[LEFT]
    assert min(compromise[LEFT], compromise[RIGHT]) > 0.012
    assert compromise[LEFT] == pytest.approx(compromise[RIGHT], rel=0.3)
    for one in (left, right, compromise):
        assert max(one[RIGHT_BENEATH_LEFT], one[LEFT_BENEATH_RIGHT]) < 0.006


def test_unseen_paths_are_followed_with_the_priority_that_was_taught(taught):
    task, simulation, models, _ = taught
    study = study_of("tracking")
    (conditions,) = study.phases(simulation, models, 7, 1, 3)
    records = [(c, c.perform(task, simulation, models)) for c in conditions]
    figures = study.figures(records, models)
    measures = study.measures(figures)
    assert all(trial.outcome == "done" for _, trial in records)
    assert len(measures) >= 12 and all(m.passed is not False for m in measures), figures
    assert max(figures["rms_mm"], figures["rms_pushed_mm"]) <= 10.0
    assert max(figures["priority_rms_mm"], figures["priority_rms_pushed_mm"]) <= 15.0
    assert max(figures["other_distance_ratio"], figures["other_distance_ratio_pushed"]) <= 1.1
    assert max(figures["compromise_ratio"], figures["compromise_ratio_pushed"]) <= 0.15


def test_several_components_are_performed_too(taught):
    task, simulation, models, trials = taught
    name = task.behaviours[0]
    models = models | {name: task.learn(simulation, name, trials[name], 2)}
    trial = task.perform(simulation, models, task.situation(simulation, 7, 0), duration=2.5)
    assert models[name].components == 2 and trial.outcome == "done"
    assert max(distance(trial, side).max() for side in ("left", "right")) < 0.02


@pytest.mark.parametrize(
    ("path", "beyond"),
    [
        (lambda p: ObjectPath.at("left_object", (100.0, 50.0, 0.0)), True),
        (lambda p: ObjectPath("left_object", (p, p, -p), (0, 0.5, 0.5)), True),
        (lambda p: ObjectPath.at("left_object", (0.0, 0.0, 0.0)), True),
        (lambda p: ObjectPath.at("left_object", p), False),
    ],
    ids=["far away", "jump across the arm", "at the trunk's foot", "at rest"],
)
def test_impossible_objects_leave_the_arm_bounded_and_are_recorded(taught, path, beyond):
    task, simulation, models, _ = taught
    robot, situation = simulation.robot, task.situation(simulation, 0, 0)
    left, right = task.objects(situation)
    moved = path(np.array(left.positions[0])), ObjectPath.at("right_object", right.positions[0])
    situation = replace(situation, details={"objects": [asdict(one) for one in moved]})
    for name in task.behaviours:
        trial = task.perform(simulation, models, situation, controller=name, duration=2.0)
        assert trial.outcome == "done"
        assert all(np.isfinite(array).all() for array in trial.arrays.values())
        assert (np.abs(trial["dq"]) < 1.2 * robot.velocity_limit).all()
        assert (trial["q"] > robot.lower - 0.05).all() and (trial["q"] < robot.upper + 0.05).all()
        assert trial["beyond_limits"].any() == beyond


def test_the_same_situation_repeats_bit_for_bit(taught):
    task, simulation, models, _ = taught
    situation = task.situation(simulation, 1, 0)
    one, other = (task.perform(simulation, models, situation, duration=0.5) for _ in range(2))
    for name in one.arrays:
        np.testing.assert_array_equal(one[name], other[name])


def test_a_teaching_that_is_not_there_is_refused(taught):
    task, simulation, models, _ = taught
    with pytest.raises(ArgumentError, match="nobody"):
        task.perform(simulation, models, task.situation(simulation, 1, 0), controller="nobody")
    with pytest.raises(ArgumentError, match="nobody"):
        Body(0.35, 0.3).lean(np.ones((1, 2)), np.ones((1, 2)), "nobody")


def test_outcomes_compare_with_the_least_distances():
    """Hands where the body can bring them at most are at a ratio of one."""
    body = Body(0.35, 0.3)
    angle = np.linspace(-0.8, 0.6, 50)[:, None]
    left = 0.85 * np.hstack([-np.sin(angle), np.cos(angle)])
    right = np.broadcast_to([0.85, 0.0], left.shape)
    arrays = {}
    lean, apart = body.lean(left, right, "left")
    assert 0 < apart.mean() < 1
    for side, point in (("left", left), ("right", right)):
        arrays[f"{side}_object_position"] = np.pad(point, ((0, 0), (0, 1)))
        hand = body.led(lean, point, 0.0, 1e-6)
        arrays[f"{side}_position"] = np.pad(hand, ((0, 0), (0, 1)))
    outcome = Outcome.of(arrays, body, "left")
    assert outcome.apart["left"] < 1e-5 and max(outcome.together.values()) < 1e-5
    assert outcome.ratio["right"] == pytest.approx(1.0, abs=1e-4)
    assert np.isnan(outcome.ratio["left"])
