import json
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tpsim import paths
from tpsim.errors import RecordingError
from tpsim.experiment.recording import load_run, load_trial, open_run, run_folder, save_trial
from tpsim.experiment.replay import compare_runs
from tpsim.sim.trial import Trial


@pytest.fixture
def trial(rng):
    clock = np.arange(50) / 100
    arrays = {
        "time": clock,
        "q": rng.normal(size=(50, 14)),
        "stiffness": rng.normal(size=(50, 3, 3)),
    }
    return Trial(arrays, "contact", {"task": "cup", "seed": 3, "push": [0.0, 20.0, 0.0]})


@pytest.fixture
def rng():
    return np.random.default_rng(1)


@pytest.fixture
def model():
    def named(prefix):
        return lambda index: SimpleNamespace(name=f"{prefix}{index}")

    return SimpleNamespace(njnt=2, nsite=1, joint=named("joint"), site=named("site"))


def start(folder, model, **changes):
    settings = {"command": "tpsim run cup --seed 3", "configuration": {"effort": 0.01}, "seed": 3}
    return open_run(folder, **settings | changes, scene_xml="<mujoco/>", model=model)


def test_a_trial_comes_back_bit_for_bit(tmp_path, trial):
    back = load_trial(save_trial(tmp_path / "trial-000000.npz", trial))
    assert (back.outcome, back.about) == (trial.outcome, trial.about)
    assert back.arrays.keys() == trial.arrays.keys()
    for name, array in trial.arrays.items():
        assert back[name].dtype == array.dtype
        np.testing.assert_array_equal(back[name], array)


def test_the_same_trial_gives_the_same_bytes_at_any_time(tmp_path, trial, monkeypatch):
    first = save_trial(tmp_path / "a.npz", trial).read_bytes()
    monkeypatch.setattr(time, "time", lambda: 2e9)
    shuffled = Trial(dict(reversed(trial.arrays.items())), trial.outcome, trial.about)
    assert save_trial(tmp_path / "b.npz", shuffled).read_bytes() == first


def test_a_failed_write_leaves_nothing(tmp_path, trial, monkeypatch):
    def broken(file, **_):
        file.write(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savez", broken)
    with pytest.raises(KeyboardInterrupt):
        save_trial(tmp_path / "trial-000000.npz", trial)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("keep", [0, 10, 200, 0.5, 0.9, 0.999])
def test_a_truncated_file_is_refused_in_one_line(tmp_path, trial, keep):
    path = save_trial(tmp_path / "trial-000000.npz", trial)
    whole = path.read_bytes()
    path.write_bytes(whole[: keep if isinstance(keep, int) else int(keep * len(whole))])
    with pytest.raises(RecordingError, match=r"truncated.*record again") as error:
        load_trial(path)
    assert "\n" not in str(error.value)


def test_a_flipped_bit_is_noticed(tmp_path, trial):
    path = save_trial(tmp_path / "trial-000000.npz", trial)
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    with pytest.raises(RecordingError, match="truncated or no recording"):
        load_trial(path)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("q", np.full((50, 14), np.nan), "q is not finite from row 0"),
        ("q", np.zeros((49, 14)), r"q is float64 \(49, 14\); signals are numbers \(50, ...\)"),
        ("time", np.zeros(50), "time must be a growing row"),
        ("time", np.zeros(0), "time must be a growing row"),
        ("note", np.array(["x"] * 50), "note is <U1"),
    ],
)
def test_bad_signals_are_neither_written_nor_read(tmp_path, trial, name, value, words):
    bad = replace(trial, arrays=trial.arrays | {name: value})
    with pytest.raises(RecordingError, match=words):
        save_trial(tmp_path / "a.npz", bad)
    assert not list(tmp_path.iterdir())
    members = {"schema": 1, "outcome": "done", "about": "{}"} | bad.arrays
    np.savez(tmp_path / "a.npz", **members)
    with pytest.raises(RecordingError, match=words):
        load_trial(tmp_path / "a.npz")


def test_what_is_no_recording_is_refused(tmp_path):
    with pytest.raises(RecordingError, match="there is no recording"):
        load_trial(tmp_path / "nothing.npz")
    np.savez(tmp_path / "other.npz", x=np.zeros(3))
    with pytest.raises(RecordingError, match="is no recording of tpsim"):
        load_trial(tmp_path / "other.npz")
    np.savez(tmp_path / "later.npz", schema=9, outcome="done", about="{}", time=np.arange(3.0))
    with pytest.raises(RecordingError, match="has schema 9, this tpsim reads 1"):
        load_trial(tmp_path / "later.npz")
    np.savez(tmp_path / "pickle.npz", time=np.array([{}], dtype=object))
    with pytest.raises(RecordingError, match="truncated or no recording"):
        load_trial(tmp_path / "pickle.npz")


def test_a_run_says_how_to_repeat_it_before_it_starts(tmp_path, model, trial):
    run = start(tmp_path / "run", model)
    assert sorted(p.name for p in run.folder.iterdir()) == ["run.json", "scene.xml"]
    said = json.loads((run.folder / "run.json").read_text())
    assert said["command"] == "tpsim run cup --seed 3"
    assert (said["seed"], said["configuration"]) == (3, {"effort": 0.01})
    assert (said["joints"], said["sites"]) == (["joint0", "joint1"], ["site0"])
    assert said["versions"].keys() == {"python", "tpsim", "numpy", "scipy", "mujoco", "pin"}
    assert said["units"]["torque"] == "Nm"
    run.save(1, trial)
    run.save(0, trial)
    again = load_run(run.folder)
    assert again == run
    assert again.scene == "<mujoco/>"
    assert [p.name for p in again.files()] == ["trial-000000.npz", "trial-000001.npz"]
    assert [t.outcome for t in again.trials()] == ["contact", "contact"]
    assert again.load(1).about == trial.about


def test_a_run_is_never_overwritten(tmp_path, model, monkeypatch):
    start(tmp_path / "run", model)
    with pytest.raises(RecordingError, match="not an empty folder"):
        start(tmp_path / "run", model)
    monkeypatch.setattr(paths, "runs", lambda: tmp_path)
    names = []
    for _ in range(3):
        names.append(run_folder("cup", 4))
        names[-1].mkdir()
    assert len(set(names)) == 3
    assert names[0].name.startswith("cup-") and names[0].name.endswith("-seed4")


def test_a_broken_run_folder_is_refused(tmp_path, model):
    with pytest.raises(RecordingError, match="cannot read"):
        load_run(tmp_path)
    (tmp_path / "run.json").write_text('{"command": ')
    with pytest.raises(RecordingError, match="is no JSON"):
        load_run(tmp_path)
    (tmp_path / "run.json").write_text('{"schema": 0}')
    with pytest.raises(RecordingError, match="not of schema 1"):
        load_run(tmp_path)
    run = start(tmp_path / "run", model)
    (run.folder / "scene.xml").write_text("<mujoco> </mujoco>")
    with pytest.raises(RecordingError, match="was changed after the run"):
        _ = run.scene


def test_a_repetition_is_compared_bit_for_bit(tmp_path, model, trial):
    one, other = start(tmp_path / "one", model), start(tmp_path / "other", model)
    with pytest.raises(RecordingError, match="holds no trials"):
        compare_runs(one, other)
    for run in (one, other):
        run.save(0, trial)
    one.save(1, trial)
    with pytest.raises(RecordingError, match="holds 2 trials, its repetition 1"):
        compare_runs(one, other)
    moved = trial.arrays | {"q": trial["q"] + 1e-3 * (np.arange(14) == 5)}
    other.save(1, replace(trial, arrays=moved))
    result = compare_runs(one, other)
    assert (result["trials"], result["identical"]) == (2, 1)
    assert result["different"] == ["trial-000001.npz"]
    assert result["largest_difference"] == pytest.approx(1e-3)
    assert result["other_versions"] == []
