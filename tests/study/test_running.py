"""From demonstrations to figures: the whole walk, small, of a user's study and of cup and sugar."""

import json
from dataclasses import replace

import numpy as np
import pytest

from tpsim import TPGMM, paths
from tpsim.errors import ArgumentError, RecordingError, SimulationError
from tpsim.robot.views.sites import Site
from tpsim.study import figures, running, teaching, trying
from tpsim.study.condition import Condition, Lead
from tpsim.study.executor import perform_condition
from tpsim.study.files.run import load_run
from tpsim.study.measure import Measure
from tpsim.study.metrics import push_interval
from tpsim.study.record import Records
from tpsim.study.study import Plan
from tpsim.task.task import Goal, Situation, draw_situation
from tpsim.task.verbs import learn, perform, show_all
from tpsim.tasks.cup_and_sugar.study import cup, cup_and_sugar, sugar


def restless(lab):
    """A probe whose robot does not do what it needs."""
    raise SimulationError("it did not come to rest")


@pytest.fixture(scope="module")
def toy_run(toy, tmp_path_factory):
    """A whole run of a user's study, without a film."""
    folder = tmp_path_factory.mktemp("campaign") / "run"
    study = replace(
        toy,
        measures=[*toy.measures, Measure("strength", unit="N", limit=1.0, title="Strength")],
        probes={"strength": lambda lab: 2.0, "restless": restless},
    )
    return running.run(study, Plan(3, 1, 2), folder, video=False, command="tpsim run"), folder


@pytest.fixture(scope="module")
def pushed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run") / "push"
    result = trying.push(
        cup_and_sugar,
        situation=3,
        force=(0.0, 0.0, -20.0),
        start=1.5,
        duration=1.5,
        body="left_gripper",
        seed=11,
        folder=folder,
    )
    return result, folder


def test_a_run_answers_with_figures_limits_and_paths(toy_run):
    answer, folder = toy_run
    keys = [
        "task",
        "seed",
        "trials",
        "refused_demonstrations",
        "refusals",
        "figures",
        "missed",
        "lost",
        "wall_seconds",
        "paths",
    ]
    assert list(answer) == keys
    assert (answer["task"], answer["seed"], answer["trials"]) == ("bring", 3, 9)
    assert set(answer["figures"]) == {"gap", "strength", "restless", "realtime_factor"}
    assert answer["figures"]["strength"] == 2.0
    assert answer["figures"]["restless"] is None
    assert answer["figures"]["realtime_factor"] > 0
    assert answer["missed"] == ["Strength"]
    assert answer["paths"] == {
        "run": str(folder),
        "report": str(folder / "report.html"),
        "film": None,
    }
    assert json.dumps(answer)


def test_a_run_leaves_a_whole_folder_that_states_plan_and_fields(toy_run):
    run = load_run(toy_run[1])
    assert run.file.whole.trials == 9 and set(run.models) == {"bring"}
    assert run.file.configuration["plan"] == {"seed": 3, "situations": 1, "pushes": 2}
    assert run.file.task.fields["effort"] == 0.05
    taught = load_run(toy_run[1] / "demonstrations" / "bring")
    assert taught.file.whole.trials == 3


def test_the_largest_gap_is_that_of_the_recorded_trials(toy_run, toy):
    """The figure again, from the files: distance of tip and mark in trials under "learned"."""
    run = load_run(toy_run[1])
    gaps = [
        np.linalg.norm(trial["hand_position"] - trial["mark_position"], axis=1).max()
        for trial in run.trials()
        if trial.about["condition"]["controller"] == "learned"
    ]
    assert len(gaps) == 3
    assert toy_run[0]["figures"]["gap"] == pytest.approx(1e3 * max(gaps), rel=1e-9)


def test_the_report_of_a_plain_study_shows_every_series(toy_run):
    page = (toy_run[1] / "report.html").read_text()
    for words in (
        "Bring the tip to the mark.",
        "Controllers beside each other",
        "<h2>gap</h2>",
        "What was learned",
        "No film was asked for.",
        "1 limits kept",
    ):
        assert words in page, words
    assert page.count("<svg") == 2


def test_what_never_comes_is_infinite_and_missed(toy, tmp_path):
    never = Measure("recovery", of=lambda record: np.inf, unit="s", limit=1.0)
    answer = running.run(
        replace(toy, measures=[never]), Plan(0, 1, 1), tmp_path / "new", video=False
    )
    assert answer["figures"]["recovery"] == np.inf and answer["missed"] == ["recovery"]


def test_a_measure_of_nothing_is_refused_before_anything_runs(toy, tmp_path):
    lost = replace(toy, measures=[Measure("luck")])
    with pytest.raises(ArgumentError, match=r"'luck' has neither of nor whole.*no probe"):
        running.run(lost, Plan(0, 1, 1), tmp_path / "new")
    assert not (tmp_path / "new").exists()
    twice = replace(toy, measures=[toy.measures[0], toy.measures[0]])
    with pytest.raises(ArgumentError, match="two measures are called 'gap'"):
        running.run(twice, Plan(0, 1, 1), tmp_path / "new")


def test_taught_demonstrations_are_learned_from_their_folder(toy, tmp_path, capsys):
    answer = teaching.teach(toy, 2, seed=1, folder=tmp_path / "shown")
    assert answer["attempts"] == {"bring": 2}
    assert "teaching bring: attempt 2 done, 2 of 2 good" in capsys.readouterr().err
    learned = teaching.learn(toy, tmp_path / "shown", tmp_path / "models")
    assert learned["demonstrations"] == {"bring": 2}
    taught = teaching.demonstrations_of(toy, tmp_path / "shown")
    fresh = learn(toy.task, taught)["bring"]
    stored = TPGMM.load(tmp_path / "models" / "model-bring.npz")
    for one, other in zip(fresh.frames, stored.frames, strict=True):
        np.testing.assert_array_equal(one.mean, other.mean)
    spread = learned["deviations"]["bring"]["posture"]
    assert list(spread) == ["shoulder [rad]", "elbow [rad]"]
    variances = fresh.frames[1].covariance[0].diagonal()
    np.testing.assert_allclose(list(spread.values()), np.sqrt(variances))
    with pytest.raises(RecordingError, match="exists and is not empty; give a new folder"):
        teaching.teach(toy, 2, folder=tmp_path / "shown")


def test_side_by_side_teaching_gives_the_same_bits(toy):
    task = replace(toy.task)
    shown = task.behaviours()["bring"]
    trials = show_all(task, 3, 4)["bring"].trials
    ways = [np.linalg.norm(trial["hand_position"], axis=1).max() for trial in trials]
    goal = Goal(Site("tip").position, float(np.median(ways)))  # which one of three misses
    both = {"one": shown, "two": replace(shown, goals={"near": goal})}
    object.__setattr__(task, "behaviours", lambda: both)
    study = replace(toy, task=task)
    alone, beside = (teaching.taught_all(study, 3, 4, workers) for workers in (1, 2))
    assert list(alone) == list(beside) == ["one", "two"]
    assert alone["two"].refusals["near"] >= 1
    for name, found in alone.items():
        assert found.refusals == beside[name].refusals
        for one, other in zip(found.trials, beside[name].trials, strict=True):
            assert one.about == other.about
            np.testing.assert_array_equal(one["q"], other["q"])


def test_a_push_yields_and_the_task_is_kept(pushed):
    found = pushed[0]["figures"]
    assert found["tilt_max_deg"] <= 5
    assert found["tilt_rms_deg"] <= 2.5
    assert found["offset_max_mm"] <= 15
    assert found["offset_rms_mm"] <= 8
    assert found["displacement_mean_mm"] >= 40
    assert found["saturated_percent"] < 1
    assert found["diverged"] == found["contacts"] == 0
    assert json.dumps(pushed[0])


def test_the_hand_stays_where_the_push_left_it(pushed):
    twin, trial = load_run(pushed[1]).trials()
    place = trial["cup_position"]
    assert np.linalg.norm(place[-1] - twin["cup_position"][-1]) > 0.1
    after = place[trial.time > push_interval(trial)[1] + 0.3]
    assert np.linalg.norm(after - after[0], axis=1).max() < 0.02


def test_the_sugar_follows_a_led_hand(pushed):
    run = load_run(pushed[1])
    models, twin, task = run.models, next(run.trials()), cup_and_sugar.task
    rest = Situation(tuple(twin["q"][-1].tolist()))
    origin = tuple(twin["left_hand_position"][-1].tolist())
    lead = Lead("left_gripper", origin, (0.0, 0.15, 0.0), start=0.2, duration=2.0, rest=0.3)
    condition = Condition("led", rest, lead=(lead,), duration=2.5)
    trial = perform_condition(cup_and_sugar, models, condition)
    records = Records(task, models, [(condition, trial)])
    found = figures.of_trials(cup_and_sugar, records)
    assert found["lead_offset_max_mm"] <= 20
    assert found["lead_force_mean_N"] <= 20
    moved = np.linalg.norm(trial["left_hand_position"] - origin, axis=1).max()
    assert 0.12 < moved < 0.16


def test_learn_tells_what_the_teacher_cared_about(tmp_path):
    result = teaching.learn(cup_and_sugar, out=tmp_path)
    cup = result["deviations"]["cup"]["cup in base"]
    assert max(cup["about x [rad]"], cup["about y [rad]"]) < 0.05 < cup["about z [rad]"]
    above = result["deviations"]["sugar"]["sugar from cup"]
    assert max(above["x [m]"], above["y [m]"], above["z [m]"]) < 0.005
    assert all((tmp_path / f"model-{name}.npz").is_file() for name in ("cup", "sugar"))


def test_several_components_are_learned_and_performed(tmp_path):
    study = sugar.with_task(components=3)
    result = teaching.learn(study, out=tmp_path)
    models = {"sugar": TPGMM.load(tmp_path / "model-sugar.npz")}
    assert models["sugar"].components == result["components"] == 3
    assert (np.diff(models["sugar"].history) >= -1e-9).all()
    condition = Condition("unpushed", draw_situation(study.task, 0, 0), duration=1.5)
    trial = perform(study.task, models, condition.situation, duration=1.5)
    records = Records(study.task, models, [(condition, trial)])
    assert trial.outcome == "done"
    assert figures.of_trials(study, records)["offset_max_mm"] < 20


def test_missing_demonstrations_say_how_to_record_some(monkeypatch, tmp_path):
    monkeypatch.setattr(paths, "demonstrations", lambda name: tmp_path / name)
    with pytest.raises(RecordingError, match="record some with tpsim teach"):
        teaching.learn(cup)


def test_demonstrations_of_another_robot_are_refused(toy, tmp_path):
    teaching.teach(toy, 1, folder=tmp_path)
    (tmp_path / "bring").rename(tmp_path / "cup")
    with pytest.raises(RecordingError, match="shows a robot with joints shoulder, elbow"):
        teaching.learn(cup, tmp_path)


def test_a_push_at_nothing_leaves_no_folder(tmp_path):
    with pytest.raises(SimulationError, match="no body or site 'knee'"):
        trying.push(
            cup, force=(1.0, 0, 0), start=1.0, duration=1.0, body="knee", folder=tmp_path / "new"
        )
    assert not (tmp_path / "new").exists()
