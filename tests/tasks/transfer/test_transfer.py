"""Carrying between two docks, taught by a hand, performed where the docks never were."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim import rotation
from tpsim.learning.gmm import GMM
from tpsim.pose import Pose
from tpsim.retrieval.gmr import gmr
from tpsim.study.executor import perform_condition
from tpsim.study.record import Records
from tpsim.study.study import Lab, Plan
from tpsim.task.task import draw_situation
from tpsim.task.verbs import learn, perform, teach
from tpsim.tasks.transfer import docks
from tpsim.tasks.transfer.study import ENDED, MEASURES, TO_THE_END, path_rms, study
from tpsim.tasks.transfer.task import Transfer
from tpsim.tasks.transfer.teacher import lesson_between
from tpsim.world.object_path import ObjectPath
from tpsim.world.perception import Perception
from tpsim.world.plant import Plant
from tpsim.world.rehearsal import hindrance

TAUGHT = 6

LABELS = {"unpushed", "taught", "moved", "far", "seen", "hidden", "pushed", TO_THE_END}

JUMP, AWAY = np.array([0.0, 0.0, -0.05]), np.array([0.5, 0.0, 0.1])


@pytest.fixture(scope="module")
def lab():
    """The arm, taught half as often as in a whole run, and its model."""
    task = Transfer()
    taught = teach(task, TAUGHT)
    return Lab(study(task), learn(task, taught), taught)


def measured(lab, pairs):
    """Figures of pairs of condition and trial."""
    records = Records(lab.task, lab.models, pairs)
    return {m.name: m.figure(records) for m in MEASURES}, records


def elsewhere(situation, positions, times):
    """The situation with the second dock on a path."""
    first, second = situation.objects
    path = ObjectPath("end", positions, times, second.quaternions * len(times))
    return replace(situation, objects=(first, path))


def test_far_situations_are_twice_as_far_as_taught_ones_from_each_other():
    rng, robot = np.random.default_rng(0), Transfer().stage.robot

    def displacement(far):
        placed = docks.draw(robot, rng, far)
        parts = []
        for name, (R_home, p_home) in docks.home(robot).items():
            R, p = placed[name]
            turn = rotation.log(R @ R_home.T)
            parts += [*((p - p_home) / docks.RANGE[:3]), *(turn / docks.RANGE[3:])]
        return np.array(parts)

    one, other, far = (
        np.array([displacement(kind) for _ in range(500)]) for kind in (False, False, True)
    )
    assert np.abs(one).max() <= 1 + 1e-9
    apart = np.mean(np.sum((one - other) ** 2, axis=1)) ** 0.5
    away = np.mean(np.sum((far - other) ** 2, axis=1)) ** 0.5
    assert away == pytest.approx(2 * apart, rel=0.05)


def test_a_way_through_a_wall_is_seen_where_every_posture_is_looked_at():
    stage = Transfer().stage
    behind = {
        "start": Pose(rotation.exp([0.036, -0.07, 2.957]), np.array([0.624, 0.49, 0.13])),
        "end": Pose(rotation.exp([0.24, -0.273, -3.103]), np.array([0.56, 0.148, 0.168])),
    }
    start = docks.start_posture(stage, behind, np.random.default_rng(0))
    led = lesson_between(stage, behind, start, np.random.default_rng(1), pace=1.5)
    assert hindrance(stage, led) == ""
    assert hindrance(stage, led, stride=1) == "sugar and end touch"


def test_each_dock_is_precise_where_the_hand_is_in_it(lab):
    """What the covariance says once the time is known: no number of it was set by hand."""
    model = lab.models["transfer"]
    order = np.argsort(model.frames[0].mean[:, 0])
    deviations = []
    for frame in (0, 2):
        gaussians = [model.frames[frame][k] for k in order[[0, -1]]]
        rest = [g.condition(g.mean[:1], [0]).covariance for g in gaussians]
        deviations.append([np.sqrt(np.trace(covariance)) for covariance in rest])
    (start_first, start_last), (end_first, end_last) = deviations
    assert start_first < 0.01 and end_last < 0.01
    assert start_last > 10 * start_first and end_first > 10 * end_last


def test_what_a_dock_saw_is_believed_along_its_own_axes_alone(lab):
    """By chance a few turns keep still in some oblique direction, and a product believes that."""
    controller = lab.task.controller(lab.world, lab.models, draw_situation(lab.task, 0, 0))
    model, times = lab.models["transfer"], [0.0, lab.task.layout.movement]
    for k, movement in enumerate(controller.movements):
        for frame, part in ((2 * k, slice(0, 3)), (2 * k + 1, slice(3, 6))):
            raw = gmr(GMM(model.priors, model.frames[frame]), times).covariance[-1]
            ours = movement.covariance[-1][part, part]
            np.testing.assert_allclose(ours, np.diag(np.diag(raw)), rtol=1e-9)
            assert np.linalg.eigvalsh(ours)[0] > 1.05 * np.linalg.eigvalsh(raw)[0]


def test_unseen_docks_near_and_far_moved_and_a_pushed_arm(lab):
    (conditions,) = lab.study.conditions(lab, Plan(seed=7, situations=1, pushes=3))
    held = [c for c in conditions if c.controller != "learned"]
    assert {(c.label, c.controller) for c in held} == {
        (label, by) for label in ("unpushed", "held") for by in ("by state", "by clock")
    }
    conditions = [c for c in conditions if c not in held and c.label != "far pushed"]
    pairs = [(c, perform_condition(lab.study, lab.models, c)) for c in conditions]
    assert {c.label for c, _ in pairs} == LABELS
    figures, records = measured(lab, pairs)
    (last,) = (c.push[0] for c in conditions if c.label == TO_THE_END)
    assert last.start + last.duration == pytest.approx(lab.task.duration)
    assert last.start < lab.task.duration - ENDED
    errors = "end", "end_pushed", "end_while_pushed", "end_moved", "end_far", "end_seen"
    for name in (*errors, "end_hidden"):
        assert figures[f"{name}_mm"] < 5.0
        assert figures[f"{name}_deg"] < 3.0
    assert figures["seen_ratio"] < 3.0  # one situation; the mean of many is in the docs
    assert figures["unseen"] == 0
    (hidden,) = records.select("hidden")
    # While the second dock is hidden, the arm is softer about it.
    stiffness = [
        np.trace(one["left_hand_stiffness"], axis1=1, axis2=2)[435]
        for one in (hidden, *records.select("unpushed"))
    ]
    assert stiffness[0] < 0.9 * stiffness[1]
    assert figures["path_rms_mm"] < 30.0
    assert figures["path_pushed_rms_mm"] < 30.0
    assert not any(figures[name] for name in ("saturated_steps", "diverged", "contacts"))
    # A renewal puts no more into springs than it takes for the way: the tank never acts.
    assert figures["energy_injected_max_J"] < 5.0
    (pushed,), (still,) = records.select("pushed"), records.select("unpushed")
    apart = np.linalg.norm(pushed["left_hand_position"] - still["left_hand_position"], axis=1)
    assert 0.005 < apart.max() < 0.1
    assert lab.study.sections(records)
    shown = lab.study.clips(replace(lab, taught={}), records)
    assert {clip.title for clip in shown} == {"Reproduction"}


def test_a_dock_that_jumps_while_the_hand_is_in_it_is_found_again(lab):
    situation = draw_situation(lab.task, 8, 0)
    home = np.array(situation.objects[1].positions[0])
    jump = elsewhere(situation, (home, home, home + JUMP), (0.0, 6.2, 6.2))
    trial = perform(lab.task, lab.models, jump)
    assert trial.outcome == "done"
    assert np.linalg.norm(trial["end_position"][-1] - trial["left_hand_position"][-1]) < 5e-3


def test_a_dock_out_of_reach_is_said_and_the_arm_stays_bounded(lab):
    situation = draw_situation(lab.task, 8, 1)
    home = np.array(situation.objects[1].positions[0])
    away = elsewhere(situation, (home, home + AWAY), (2.0, 5.0))
    trial = perform(lab.task, lab.models, away)
    assert trial.outcome == "unreachable"
    assert trial["beyond_limits"].any() or trial["saturated_steps"][-1]
    assert np.abs(trial["dq"]).max() < 10.0
    assert all(np.isfinite(array).all() for array in trial.arrays.values())


def test_a_dock_that_never_appears_is_said_and_the_arm_stays_bounded(lab):
    situation = draw_situation(lab.task, 8, 0)
    for hidden in (["end"], ["start", "end"]):
        camera = Perception(occluded=tuple((name, -10.0, 100.0) for name in hidden))
        trial = perform(
            lab.task, lab.models, situation, plant=Plant(perception=camera), duration=3.0
        )
        assert trial.outcome == f"unseen: {', '.join(hidden)}"
        assert np.abs(trial["dq"]).max() < 3.0
        assert not trial["saturated_steps"][-1]
    # Without any dock to go by, the hand holds still.
    moved = trial["left_hand_position"] - trial["left_hand_position"][0]
    assert np.abs(moved).max() < 1e-3


def test_the_teacher_shows_the_same_way_again(lab):
    (conditions,) = lab.study.conditions(lab, Plan(seed=8, situations=1, pushes=0))
    taught = next(c for c in conditions if c.label == "taught")
    first, again = (perform_condition(lab.study, lab.models, taught) for _ in range(2))
    assert first.outcome == "done"
    unpushed = next(c for c in conditions if c.label == "unpushed")
    _, records = measured(lab, [(unpushed, first), (taught, again)])
    assert path_rms(records[0]) == 0.0
    assert np.linalg.norm(first["end_position"][-1] - first["left_hand_position"][-1]) < 0.01
