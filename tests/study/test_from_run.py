"""What a run folder holds is enough to go on from: models, demonstrations, scene and fields."""

import json
from pathlib import Path

import numpy as np
import pytest

from tpsim.cli.main import main
from tpsim.errors import ArgumentError, RecordingError
from tpsim.learning.tp_gmm import TPGMM
from tpsim.study.files.checked import plain
from tpsim.study.files.run import load_run, open_run
from tpsim.study.teaching import models_of
from tpsim.study.teaching_files import write_demonstrations
from tpsim.tasks.pointing.study import pointing

TOY = Path(__file__).parent / "toy.py"


@pytest.fixture
def run(tmp_path, toy, taught, models):
    """A run of the toy with another effort, as far as its models."""
    study = toy.with_task(effort=0.2)
    opened = open_run(tmp_path / "run", study=study, command="", configuration={}, seed=0)
    where = opened.folder / "demonstrations" / "bring"
    write_demonstrations(where, study, "bring", taught["bring"], seed=0, command="")
    opened.save_models(models)
    return opened.finish()


def tpsim(capsys, *words):
    code = main([*map(str, words), "--json"])
    said = capsys.readouterr()
    return json.loads(said.out) if code == 0 else said.err


def test_a_run_is_gone_on_from(run, tmp_path, capsys, monkeypatch):
    study, out = f"{TOY}:study", tmp_path / "out"
    answer = tpsim(capsys, "learn", study, "--from", run.folder, "--folder", out)
    assert answer["demonstrations"] == {"bring": 3}
    one, other = TPGMM.load(out / "model-bring.npz"), run.models["bring"]
    np.testing.assert_array_equal(one.frames[0].mean, other.frames[0].mean)

    def never(*_):
        raise AssertionError("its models are there: nothing is to be learned")

    monkeypatch.setattr("tpsim.study.teaching.learn_behaviours", never)
    again = tmp_path / "again"
    tpsim(capsys, "reproduce", study, "--from", run.folder, "--folder", again, "--seed", 4)
    made = load_run(again)
    assert made.file.task.fields["effort"] == 0.2  # the run's field, not the file's
    assert (made.folder / "model-bring.npz").read_bytes() == (
        run.folder / "model-bring.npz"
    ).read_bytes()
    other = tmp_path / "other"
    tpsim(capsys, "reproduce", study, "--from", run.folder, "--folder", other, "--effort", 0.3)
    assert load_run(other).file.task.fields["effort"] == 0.3


def test_a_run_that_was_changed_is_not(run, capsys):
    study = f"{TOY}:study"
    assert "give one of them" in tpsim(
        capsys, "learn", study, "--from", run.folder, "--demonstrations", run.folder
    )
    assert "no file" in tpsim(capsys, "learn", study, "--from", run.folder / "assets")
    said = plain(run.file)
    said["task"]["fields"]["effort"] = 0.4
    (run.folder / "run.json").write_text(json.dumps(said))
    assert "run.json in" in (error := tpsim(capsys, "reproduce", study, "--from", run.folder))
    assert "changed after the run" in error and error.count("\n") == 1


def test_models_are_never_added_to_a_run(run, models, capsys):
    """What issue 11 began with: the model of a run was gone, and the run no longer repeated."""
    before = {p: p.read_bytes() for p in run.folder.rglob("*") if p.is_file()}
    study = f"{TOY}:study"
    for folder in (run.folder, run.folder / "demonstrations"):
        error = tpsim(capsys, "learn", study, "--from", run.folder, "--folder", folder)
        assert "nothing is overwritten" in error
    with pytest.raises(RecordingError, match="holds models already"):
        run.save_models(models)
    assert before == {p: p.read_bytes() for p in run.folder.rglob("*") if p.is_file()}


def test_interrupted_teaching_is_not_learned_from(run, capsys):
    shown = load_run(run.folder / "demonstrations" / "bring")
    said = plain(shown.file) | {"whole": None}
    (shown.folder / "run.json").write_text(json.dumps(said))
    words = ("learn", f"{TOY}:study", "--demonstrations", run.folder / "demonstrations")
    assert "teaching was interrupted" in tpsim(capsys, *words)
    assert "bring/run.json in" in tpsim(capsys, "learn", f"{TOY}:study", "--from", run.folder)


def test_what_one_robot_learned_is_not_given_to_another(run):
    with pytest.raises(ArgumentError, match=r"taught with the joints .*elbow.* has .*joint3"):
        models_of(pointing, run)


def test_fields_of_the_wrong_kind_are_refused_before_anything_is_taught(toy):
    with pytest.raises(ArgumentError, match="bring effort is 'soft'"):
        toy.with_task(effort="soft")
    with pytest.raises(ArgumentError, match="pointing components is 0"):
        pointing.with_task(components=0)
