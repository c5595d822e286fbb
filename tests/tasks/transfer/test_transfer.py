"""Carrying between two docks, taught by a hand, performed where the docks never were."""

from dataclasses import asdict, replace

import numpy as np
import pytest

from tpsim import rotation, tasks
from tpsim.errors import ArgumentError
from tpsim.experiment.studies import study as study_of
from tpsim.experiment.studies.transfer import end, path_rms
from tpsim.sim.objects import ObjectPath
from tpsim.sim.teach import teach
from tpsim.tasks import docks

TAUGHT = 6

JUMP, AWAY = np.array([0.03, 0.08, 0.06]), np.array([0.5, 0.0, 0.1])


@pytest.fixture(scope="module")
def taught():
    """The arm, taught half as often as in a whole run, and its model."""
    task = tasks.load("transfer")
    simulation = task.simulation()
    trials = teach(
        simulation,
        lambda simulation, rng: task.lesson(simulation, "transfer", rng),
        TAUGHT,
        seed=0,
        sites=task.sites,
    )
    model = task.learn(simulation, "transfer", trials, task.components)
    return task, simulation, {"transfer": model}, trials


def elsewhere(situation, positions, times):
    """The situation with the second dock on a path."""
    first, second = (ObjectPath(**path) for path in situation.details["objects"])
    path = ObjectPath("end", positions, times, second.quaternions * len(times))
    return replace(situation, details={"objects": [asdict(first), asdict(path)]})


def test_far_situations_are_twice_as_far_as_taught_ones_from_each_other():
    rng = np.random.default_rng(0)

    def displacement(far):
        placed = docks.draw(rng, far)
        parts = []
        for name, (position, heading) in docks.HOME.items():
            R, p = placed[name]
            turn = rotation.log(R @ rotation.exp([0, 0, -heading]))
            parts += [*((p - position) / docks.RANGE[:3]), *(turn / docks.RANGE[3:])]
        return np.array(parts)

    one, other, far = (
        np.array([displacement(kind) for _ in range(500)]) for kind in (False, False, True)
    )
    assert np.abs(one).max() <= 1 + 1e-9
    apart = np.mean(np.sum((one - other) ** 2, axis=1)) ** 0.5
    away = np.mean(np.sum((far - other) ** 2, axis=1)) ** 0.5
    assert away == pytest.approx(2 * apart, rel=0.05)


def test_each_dock_is_precise_where_the_hand_is_in_it(taught):
    """What the covariance says once the time is known: no number of it was set by hand."""
    _, _, models, _ = taught
    model = models["transfer"]
    order = np.argsort(model.frames[0].mean[:, 0])
    deviations = []
    for frame in (0, 2):
        gaussians = [model.frames[frame][k] for k in order[[0, -1]]]
        rest = [g.condition(g.mean[:1], [0]).covariance for g in gaussians]
        deviations.append([np.sqrt(np.trace(covariance)) for covariance in rest])
    (start_first, start_last), (end_first, end_last) = deviations
    assert start_first < 0.01 and end_last < 0.01
    assert start_last > 10 * start_first and end_first > 10 * end_last


def test_unseen_docks_near_and_far_moved_and_a_pushed_arm(taught):
    task, simulation, models, _ = taught
    study = study_of("transfer")
    (conditions,) = study.phases(simulation, models, 7, 1, 1)
    records = [(c, c.perform(task, simulation, models)) for c in conditions]
    assert {c.label for c, _ in records} == {"unpushed", "moved", "far", "pushed"}
    figures = study.figures(records, models)
    for name in ("end", "end_pushed", "end_moved", "end_far"):
        assert figures[f"{name}_mm"] < 5.0
        assert figures[f"{name}_deg"] < 3.0
    assert figures["path_rms_mm"] < 30.0
    assert figures["path_pushed_rms_mm"] < 30.0
    assert not any(figures[name] for name in ("saturated_steps", "diverged", "contacts"))
    pushed = next(t for c, t in records if c.label == "pushed")
    still = next(t for c, t in records if c.label == "unpushed" and c.controller == "learned")
    apart = np.linalg.norm(pushed["left_hand_position"] - still["left_hand_position"], axis=1)
    assert 0.005 < apart.max() < 0.1
    assert study.sections(records, models)
    assert {clip.title for clip in study.clips(simulation, models, records, {})} == {"Reproduction"}


def test_a_dock_that_jumps_while_the_hand_is_in_it_is_found_again(taught):
    task, simulation, models, _ = taught
    situation = task.situation(simulation, 8, 0)
    home = np.array(situation.details["objects"][1]["positions"][0])
    jump = elsewhere(situation, (home, home, home + JUMP), (0.0, 6.2, 6.2))
    trial = task.perform(simulation, models, jump)
    assert trial.outcome == "done"
    assert end(trial)[0] < 5.0


def test_a_dock_out_of_reach_is_said_and_the_arm_stays_bounded(taught):
    task, simulation, models, _ = taught
    situation = task.situation(simulation, 8, 1)
    home = np.array(situation.details["objects"][1]["positions"][0])
    away = elsewhere(situation, (home, home + AWAY), (2.0, 5.0))
    trial = task.perform(simulation, models, away)
    assert trial.outcome == "unreachable"
    assert trial["beyond_limits"].any() or trial["saturated_steps"][-1]
    assert np.abs(trial["dq"]).max() < 10.0
    assert all(np.isfinite(array).all() for array in trial.arrays.values())


def test_the_teacher_shows_the_same_way_again_and_others_are_refused(taught):
    task, simulation, models, _ = taught
    situation = task.situation(simulation, 8, 0)
    first, again = (
        task.perform(simulation, models, situation, controller="teacher") for _ in range(2)
    )
    assert first.outcome == "done"
    assert end(first)[0] < 10.0
    assert path_rms(first, again) == 0.0
    with pytest.raises(ArgumentError, match="no controller 'stiff'"):
        task.perform(simulation, models, situation, controller="stiff")
