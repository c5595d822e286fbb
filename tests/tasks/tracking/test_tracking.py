"""Two hands with one trunk follow two objects, with the priorities that were taught (Fig. 11)."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim.controllers.optimal import bandwidth_for
from tpsim.errors import ArgumentError
from tpsim.robot.views.observe import observe
from tpsim.study.record import Records
from tpsim.study.study import Lab, Plan
from tpsim.task.task import draw_situation
from tpsim.task.verbs import learn, perform, teach
from tpsim.tasks.tracking import study
from tpsim.tasks.tracking.body import SIDES, TEACHINGS, Body
from tpsim.tasks.tracking.outcome import Outcome
from tpsim.tasks.tracking.task import HANDS, Tracking, behaviour
from tpsim.world.object_path import ObjectPath

LEFT, RIGHT_BENEATH_LEFT, LEFT_BENEATH_RIGHT, RIGHT, _ = range(5)


@pytest.fixture(scope="module")
def taught():
    """The task, two demonstrations of each teaching and a model of each."""
    task = Tracking()
    trials = teach(task, 2, seed=0)
    return task, learn(task, trials), trials


def follow(task, models, situation, teaching, **fields):
    """Perform one of the teachings."""
    controller = task.follow(teaching, task.stage, models, situation)
    return perform(task, models, situation, controller=controller, **fields)


def distances(task, trial):
    """Distance (T,) [m] of each hand from its object."""
    seen = observe(task.stage.robot, list(HANDS.values()), trial["q"], trial.objects)
    return dict(zip(SIDES, np.linalg.norm(seen, axis=-1), strict=True))


def deviations(model):
    return [float(np.sqrt(gaussian.covariance[0, 0, 0])) for gaussian in model.frames]


def test_the_view_of_a_hand_is_its_distance_in_the_recording(taught):
    """The one definition of the distance, beside arrays that know nothing of it."""
    task, _, trials = taught
    trial = trials[behaviour("left")][0]
    for side, away in distances(task, trial).items():
        way = trial[f"{side}_position"] - trial[f"{side}_object_position"]
        np.testing.assert_allclose(away, np.linalg.norm(way[:, :2], axis=1), atol=1e-12)


@pytest.mark.parametrize("teaching", TEACHINGS)
def test_the_teacher_leads_both_hands_as_well_as_the_body_allows(taught, teaching):
    task, _, trials = taught
    body = Body.of(task.stage.robot)
    for trial in trials[behaviour(teaching)]:
        points = [trial[f"{side}_object_position"][:, :2] for side in SIDES]
        angle, apart = body.lean(*points, teaching)
        assert 0.15 < apart.mean() < 0.6
        for away, point in zip(distances(task, trial).values(), points, strict=True):
            assert np.abs(away - body.missing(angle, point)).max() < 0.04


def test_precision_says_which_hand_was_preferred(taught):
    """No number of it was set by hand: the frames are the same for all three teachings."""
    _, models, _ = taught
    left, right, compromise = (deviations(models[behaviour(one)]) for one in TEACHINGS)
    assert left[LEFT] < 0.006 < 0.02 < left[RIGHT]
    assert right[RIGHT] < 0.006 < 0.02 < right[LEFT]
    assert min(compromise[LEFT], compromise[RIGHT]) > 0.012
    assert compromise[LEFT] == pytest.approx(compromise[RIGHT], rel=0.3)
    for one in (left, right, compromise):
        assert max(one[RIGHT_BENEATH_LEFT], one[LEFT_BENEATH_RIGHT]) < 0.006


def test_unseen_paths_are_followed_with_the_priority_that_was_taught(taught):
    task, models, trials = taught
    tracking = study.study(task)
    lab = Lab(tracking, models, trials)
    (conditions,) = tracking.conditions(lab, Plan(seed=7, situations=1, pushes=3))
    records = Records(task, models)
    for condition in conditions:
        make, situation = tracking.all_controllers[condition.controller], condition.situation
        controller = make(task.stage, models, situation)
        people = condition.people
        trial = perform(task, models, situation, controller=controller, people=people)
        records.add(condition, trial)
    figures = {m.name: m.figure(records) for m in tracking.measures}
    results = [m.result(figures[m.name]) for m in tracking.measures if figures[m.name] is not None]
    assert all(record.trial.outcome == "done" for record in records)
    assert len(results) >= 12 and all(result.passed is not False for result in results), figures
    assert max(figures["rms_mm"], figures["rms_pushed_mm"]) <= 10.0
    assert max(figures["priority_rms_mm"], figures["priority_rms_pushed_mm"]) <= 15.0
    assert max(figures["other_distance_ratio"], figures["other_distance_ratio_pushed"]) <= 1.1
    assert max(figures["compromise_ratio"], figures["compromise_ratio_pushed"]) <= 0.15


def test_several_components_are_performed_too(taught):
    task, _, trials = taught
    task = replace(task, components=2)
    models = learn(task, trials)
    assert all(model.components == 2 for model in models.values())
    trial = perform(task, models, draw_situation(task, 7, 0), duration=2.5)
    assert trial.outcome == "done"
    assert max(away.max() for away in distances(task, trial).values()) < 0.02


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
    task, models, _ = taught
    robot, situation = task.stage.robot, draw_situation(task, 0, 0)
    left, right = (np.array(one.positions[0]) for one in situation.objects)
    moved = path(left), ObjectPath.at("right_object", right)
    situation = replace(situation, objects=moved)
    for teaching in task.taught:
        trial = follow(task, models, situation, teaching, duration=2.0)
        assert trial.outcome == "done"
        assert all(np.isfinite(array).all() for array in trial.arrays.values())
        assert (np.abs(trial["dq"]) < 1.2 * robot.velocity_limit).all()
        assert (trial["q"] > robot.lower - 0.05).all() and (trial["q"] < robot.upper + 0.05).all()
        assert trial["beyond_limits"].any() == beyond


def test_the_same_situation_repeats_bit_for_bit(taught):
    task, models, _ = taught
    situation = draw_situation(task, 1, 0)
    one, other = (perform(task, models, situation, duration=0.5) for _ in range(2))
    for name in one.arrays:
        np.testing.assert_array_equal(one[name], other[name])


def test_the_first_behaviour_is_the_task_and_one_alone_has_its_name(taught):
    task, models, _ = taught
    assert task.name == "tracking"
    assert [replace(task, taught=(one,)).name for one in TEACHINGS] == list(task.behaviours())
    situation = draw_situation(task, 1, 0)
    own = perform(task, models, situation, duration=0.1)
    first = follow(task, models, situation, "left", duration=0.1)
    np.testing.assert_array_equal(own["torque"], first["torque"])


def test_controllers_of_the_study_follow_the_fields_of_its_task(taught):
    task, models, _ = taught
    situation = draw_situation(task, 1, 0)
    stiffness = []
    for effort in (100.0, 400.0):  # so soft that the loop does not set the limit
        soft = study.study(task).with_task(effort=effort)
        make = soft.all_controllers[behaviour("right")]
        controller = make(task.stage, models, situation)
        trial = perform(soft.task, models, situation, controller=controller, duration=0.05)
        stiffness.append(trial["stiffness"][0])
    # Stiffness is the root of precision over effort, Eq. (34).
    np.testing.assert_allclose(stiffness[0], 2 * stiffness[1], rtol=1e-6)


class Overheard:
    """A controller whose commands are kept, beside the states."""

    def __init__(self, controller):
        self.controller, self.heard = controller, []

    def command(self, state, time):
        """What the controller commands."""
        self.heard.append((state, self.controller.command(state, time)))
        return self.heard[-1][1]


def test_no_direction_is_faster_than_the_loop_bears(taught):
    """Natural frequencies are the roots of the eigenvalues of M^-1 K."""
    task, models, _ = taught
    situation, tops = draw_situation(task, 1, 0), []
    for effort in (1.0, 1e-3):
        told = Overheard(replace(task, effort=effort).controller(task.stage, models, situation))
        perform(task, models, situation, controller=told, duration=0.05)
        state, command = told.heard[0]
        values = np.linalg.eigvals(np.linalg.solve(state.mass, command.stiffness)).real
        tops.append(np.sqrt(values.max()) / (2 * np.pi))
    assert tops[0] == pytest.approx(bandwidth_for(), rel=0.01)
    assert tops[1] <= 1.001 * bandwidth_for()


def test_a_teaching_that_was_not_taught_is_refused(taught):
    task, models, _ = taught
    left = {behaviour("left"): models[behaviour("left")]}
    with pytest.raises(ArgumentError, match="tracking-right"):
        task.follow("right", task.stage, left, draw_situation(task, 1, 0))


def test_outcomes_compare_with_the_least_distances():
    """Hands where the body can bring them at most are at a ratio of one."""
    body = Body(0.35, 0.3)
    angle = np.linspace(-0.8, 0.6, 50)[:, None]
    left = 0.85 * np.hstack([-np.sin(angle), np.cos(angle)])
    points = {"left": left, "right": np.broadcast_to([0.85, 0.0], left.shape)}
    lean, apart = body.lean(*points.values(), "left")
    assert 0 < apart.mean() < 1
    reached = {
        side: np.linalg.norm(body.led(lean, point, 0.0, 1e-6) - point, axis=1)
        for side, point in points.items()
    }
    outcome = Outcome.of(reached, points, body, "left")
    assert outcome.apart["left"] < 1e-5 and max(outcome.together.values()) < 1e-5
    assert outcome.ratio["right"] == pytest.approx(1.0, abs=1e-4)
    assert np.isnan(outcome.ratio["left"])
