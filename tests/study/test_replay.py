import json
from dataclasses import replace

import numpy as np
import pytest

from tpsim.errors import ArgumentError, RecordingError, TpsimError
from tpsim.learning.tp_gmm import TPGMM
from tpsim.study.files.checked import plain
from tpsim.study.files.run import load_run, open_run
from tpsim.study.files.trial_file import load_trial, save_trial
from tpsim.study.replay import replay

WHOLE = {
    "verdict": "all 4 trials came out again, bit for bit",
    "repeats": True,
    "trials": 4,
    "identical": 4,
    "whole": True,
    "missing": [],
    "changed": [],
    "different": [],
    "largest_difference": 0.0,
    "other_versions": [],
}


def tamper(run, index, change):
    """Write a trial again, changed."""
    path = run.path(index)
    trial = change(load_trial(path))
    path.unlink()
    save_trial(path, trial)


def test_a_run_repeats_from_its_folder_alone(recorded, toy, monkeypatch):
    # The study's own world, fields and models do not count.
    def none(self):
        raise AssertionError("the world is in the folder")

    other = replace(toy, task=replace(toy.task, effort=1.0))
    monkeypatch.setattr(type(toy.task), "world", none)
    assert replay(load_run(recorded.folder), other) == WHOLE


def test_demonstrations_are_shown_again(tmp_path, toy, taught):
    run = open_run(tmp_path / "bring", study=toy, command="", configuration={}, seed=0)
    for index, trial in enumerate(taught["bring"]):
        run.save(index, trial)
    result = replay(run.finish(), toy)
    assert (result["repeats"], result["trials"], result["identical"]) == (True, 3, 3)
    tamper(run, 1, lambda trial: trial.with_about(attempt=7))
    result = replay(load_run(run.folder), toy)
    assert result["different"] == ["trial-000001.npz"]
    tamper(run, 1, lambda trial: trial.with_about(behaviour="sing"))
    with pytest.raises(RecordingError, match="behaviour is 'sing'; the task has bring"):
        replay(load_run(run.folder), toy)


def test_a_difference_is_measured_and_named(recorded, toy):
    def moved(trial):
        return replace(trial, arrays={**trial.arrays, "q": trial["q"] + 1e-3 * np.eye(40, 2)})

    tamper(recorded, 1, moved)
    tamper(recorded, 2, lambda trial: trial.with_about("contact"))
    result = replay(recorded, toy)
    assert (result["repeats"], result["identical"]) == (False, 2)
    assert result["changed"] == result["different"]
    assert result["verdict"].startswith("2 of 4 trials differ; trial-000001.npz, trial-000002.npz")
    assert result["different"] == ["trial-000001.npz", "trial-000002.npz"]
    assert result["largest_difference"] == pytest.approx(1e-3)


def test_what_is_missing_is_said(recorded, toy):
    recorded.path(3).unlink()
    recorded.path(1).unlink()
    result = replay(recorded, toy)
    assert result["missing"] == ["trial-000001.npz", "trial-000003.npz"]
    assert (result["trials"], result["identical"], result["whole"]) == (2, 2, True)
    assert not result["repeats"] and "2 files are missing" in result["verdict"]


def test_a_changed_seed_and_a_swapped_trial_are_noticed(recorded, toy, trials):
    """What says of itself that it is whole is compared with what it was, not only performed."""
    said = plain(recorded.file)
    (recorded.folder / "run.json").write_text(json.dumps({**said, "command": "other"}))
    result = replay(load_run(recorded.folder), toy)
    assert (result["repeats"], result["changed"]) == (False, ["run.json"])
    (recorded.folder / "run.json").write_text(json.dumps({**said, "seed": 1}))
    with pytest.raises(RecordingError, match=r"trial-000000.npz is of another seed than the 1 of"):
        replay(load_run(recorded.folder), toy)
    (recorded.folder / "run.json").write_text(json.dumps(said))
    tamper(recorded, 1, lambda _: trials[0])  # repeats, but is not what was there
    result = replay(load_run(recorded.folder), toy)
    assert (result["repeats"], result["different"]) == (False, [])
    assert result["verdict"] == "trial-000001.npz changed after the run"
    with pytest.raises(RecordingError, match=r"trial-000001.npz in .*: changed after the run"):
        load_run(recorded.folder).check()


def test_an_interrupted_run_is_not_whole(recorded, toy):
    said = plain(replace(recorded.file, whole=None))
    (recorded.folder / "run.json").write_text(json.dumps(said))
    result = replay(load_run(recorded.folder), toy)
    assert (result["repeats"], result["whole"], result["identical"]) == (False, False, 4)
    assert result["verdict"] == "the run was interrupted before its end"
    for file in recorded.files():
        file.unlink()
    with pytest.raises(RecordingError, match="holds no trials"):
        replay(recorded, toy)


def test_code_that_a_folder_names_is_not_run(recorded, tmp_path):
    trap = tmp_path / "trap.py"
    trap.write_text(f"open({str(tmp_path / 'sprung')!r}, 'w')\n")
    for reference in (f"{trap}:study", "trap:study", "os:system", "tpsim.tasks/../trap:study", ""):
        said = plain(recorded.file)
        said["task"]["reference"] = reference
        (recorded.folder / "run.json").write_text(json.dumps(said))
        with pytest.raises(ArgumentError, match="name it yourself"):
            replay(load_run(recorded.folder))
    assert not (tmp_path / "sprung").exists()


def test_another_task_and_models_that_do_not_fit_are_refused(recorded, toy, models):
    said = plain(recorded.file)
    for field, wrong in (("effort", "soft"), ("reach", [0.1]), ("grip", [])):
        fields = {**said["task"]["fields"], field: wrong}
        text = json.dumps({**said, "task": {**said["task"], "fields": fields}})
        (recorded.folder / "run.json").write_text(text)
        with pytest.raises(RecordingError, match=rf"run.json: task.fields: .*`\$\.{field}`"):
            replay(load_run(recorded.folder), toy)
    (recorded.folder / "run.json").write_text(json.dumps({**said, "whole": None}))
    (recorded.folder / "model-bring.npz").unlink()
    with pytest.raises(RecordingError, match="has no model of bring"):
        replay(load_run(recorded.folder), toy)
    less = TPGMM(models["bring"].priors, models["bring"].frames[:1])
    less.save(recorded.folder / "model-bring.npz")
    with pytest.raises((RecordingError, ArgumentError)):
        replay(load_run(recorded.folder), toy)


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (("condition", "duration"), 1e9, "condition: duration is 1000000000.0 s"),
        (("condition", "plant", "latency"), 1e7, "plant.latency is"),
        (("condition", "lead", 0, "rest"), 1e7, r"lead\[0\].rest is"),
        (("condition", "lead", 0, "duration"), -1.0, "lead duration is -1.0"),
        (("condition", "situation", "objects", 0, "times"), [1e9], r"objects\[0\].times is"),
        (("condition", "situation", "seed"), -1, "situation.seed is -1"),
        (("condition", "situation", "start"), [0.1], "start posture|do not belong"),
        (("condition", "controller"), "mine", "no controller 'mine'"),
        (("condition", "label"), 3, r"about: Expected `str`, got `int` - at `\$.condition.label`"),
        (("task", "fields", "effort"), 2.0, "about.task is not that of run.json"),
    ],
)
def test_a_trial_that_asks_for_too_much_is_refused(recorded, toy, path, value, words):
    def change(trial):
        about = json.loads(json.dumps(dict(trial.about)))
        *above, last = path
        inner = about
        for key in above:
            inner = inner[key]
        inner[last] = value
        return replace(trial, about=about)

    tamper(recorded, 2, change)
    with pytest.raises(TpsimError, match=words) as error:
        replay(load_run(recorded.folder), toy)
    assert "\n" not in str(error.value)
