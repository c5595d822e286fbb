"""From recorded demonstrations to figures: the whole walk, small."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest

from tpsim import TPGMM, paths, tasks
from tpsim.errors import RecordingError, SimulationError
from tpsim.experiment import campaign, conditions
from tpsim.experiment.conditions import Condition, Lead
from tpsim.experiment.recording import load_run
from tpsim.experiment.replay import replay
from tpsim.experiment.studies import study
from tpsim.sim.push import Push
from tpsim.tasks.task import Situation


@pytest.fixture(scope="module")
def pushed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run") / "push"
    result = campaign.push(
        "cup-and-sugar",
        situation=3,
        force=(0.0, 0.0, -20.0),
        start=1.5,
        duration=1.5,
        body="left_gripper",
        seed=11,
        folder=folder,
    )
    return result, folder


def test_a_push_yields_and_the_task_is_kept(pushed):
    figures = pushed[0]["figures"]
    assert figures["tilt_max_deg"] <= 5
    assert figures["tilt_rms_deg"] <= 2.5
    assert figures["offset_max_mm"] <= 15
    assert figures["offset_rms_mm"] <= 8
    assert figures["displacement_mean_mm"] >= 40
    assert figures["saturated_percent"] < 1
    assert figures["diverged"] == figures["contacts"] == 0
    assert json.dumps(pushed[0])


def test_the_hand_comes_back_after_the_push(pushed):
    twin, trial = load_run(pushed[1]).trials()
    assert np.linalg.norm(trial["cup_position"][-1] - twin["cup_position"][-1]) < 0.01


def test_a_run_repeats_from_its_own_folder_alone_bit_for_bit(pushed):
    answer = replay(load_run(pushed[1]))
    assert answer["identical"] == answer["trials"] == 2
    assert answer["largest_difference"] == 0


def test_conditions_survive_being_written_down():
    condition = Condition(
        "pushed",
        Situation(1, 2, (0.1, 1 / 3), {"a": [1]}),
        "stiff",
        Push("torso", (1.0, 2.0, 1 / 7)),
        Lead("left_gripper", (0.1, 0.2, 0.3), (0.0, 0.15, 0.0)),
        3.5,
    )
    about = json.loads(json.dumps({"condition": asdict(condition)}))
    assert Condition.from_about(about) == condition


def test_the_pool_gives_the_same_bits_as_one_process(pushed):
    folder = pushed[1]
    run = load_run(folder)
    models = {b: TPGMM.load(folder / f"model-{b}.npz") for b in ("cup", "sugar")}
    trial = next(run.trials())
    short = [replace(Condition.from_about(trial.about), duration=0.3) for _ in range(2)]
    runs = [
        list(conditions.perform(short, "cup-and-sugar", run.scene, models, workers))
        for workers in (1, 2)
    ]
    for one, other in zip(*runs, strict=True):
        for name, signal in one.arrays.items():
            assert np.array_equal(signal, other[name]), name


def test_the_sugar_follows_a_led_hand(pushed):
    folder = pushed[1]
    models = {b: TPGMM.load(folder / f"model-{b}.npz") for b in ("cup", "sugar")}
    found, twin = study("cup-and-sugar"), next(load_run(folder).trials())
    task = tasks.load("cup-and-sugar")
    rest = Condition.from_about(twin.about).situation
    rest = replace(rest, start=tuple(twin["q"][-1].tolist()))
    origin = tuple(twin["left_hand_position"][-1].tolist())
    lead = Lead("left_gripper", origin, (0.0, 0.15, 0.0), start=0.2, duration=2.0, rest=0.3)
    condition = Condition("led", rest, lead=lead, duration=2.5)
    trial = condition.perform(task, task.simulation(), models)
    figures = found.figures([(condition, trial)], models)
    assert figures["lead_offset_max_mm"] <= 20
    assert figures["lead_force_mean_N"] <= 20
    moved = np.linalg.norm(trial["left_hand_position"] - origin, axis=1).max()
    assert 0.12 < moved < 0.16


def test_learn_tells_what_the_teacher_cared_about(tmp_path):
    result = campaign.learn("cup-and-sugar", components=1, folder=tmp_path)
    cup = result["deviations"]["cup"]["cup in base"]
    assert max(cup["about x [rad]"], cup["about y [rad]"]) < 0.05 < cup["about z [rad]"]
    above = result["deviations"]["sugar"]["sugar from cup"]
    assert max(above["x [m]"], above["y [m]"], above["z [m]"]) < 0.005
    assert all((tmp_path / f"model-{name}.npz").is_file() for name in ("cup", "sugar"))


def test_several_components_are_learned_and_performed(tmp_path):
    result = campaign.learn("sugar", components=3, folder=tmp_path)
    models = {"sugar": TPGMM.load(tmp_path / "model-sugar.npz")}
    assert models["sugar"].components == result["components"] == 3
    assert (np.diff(models["sugar"].history) >= -1e-9).all()
    task = tasks.load("sugar")
    simulation = task.simulation()
    condition = Condition("unpushed", task.situation(simulation, 0, 0), duration=1.5)
    trial = condition.perform(task, simulation, models)
    figures = study("sugar").figures([(condition, trial)], models)
    assert trial.outcome == "done"
    assert figures["offset_max_mm"] < 20


def test_missing_demonstrations_say_how_to_record_some(monkeypatch, tmp_path):
    monkeypatch.setattr(paths, "demonstrations", lambda name: tmp_path / name)
    with pytest.raises(RecordingError, match="tpsim teach cup"):
        campaign.learn("cup", components=1)


def test_a_push_at_nothing_leaves_no_folder(tmp_path):
    with pytest.raises(SimulationError, match="no body or site 'knee'"):
        campaign.push(
            "cup",
            situation=0,
            force=(1.0, 0, 0),
            start=1.0,
            duration=1.0,
            body="knee",
            seed=0,
            folder=tmp_path / "new",
        )
    assert not (tmp_path / "new").exists()
