"""Trials are measured where they are performed, and read when they are asked for."""

import os
import signal
from dataclasses import replace

import numpy as np
import pytest

from tpsim.study import running
from tpsim.study.condition import Condition
from tpsim.study.executor import perform_condition
from tpsim.study.files.run import load_run, open_run
from tpsim.study.measure import Measure
from tpsim.study.record import Records
from tpsim.study.recording import record_all
from tpsim.study.study import Plan
from tpsim.task.task import draw_situation


def moved(record):
    """How far the arm is from where it is under the first label, which is another trial."""
    other = record.beside("unpushed")
    return None if other is None else np.abs(record["q"] - other["q"]).max(1)[:5]


def test_figures_of_stored_trials_are_those_of_trials_in_memory(toy, models, tmp_path):
    beside = Measure("moved", moved, label="pushed", controller=None, reduce=np.max)
    short = replace(beside, of=lambda record: float(moved(record).max()))
    measures = [*toy.measures, short, replace(toy.measures[0], name="rest", window=(0.3, 0.4))]
    study = replace(toy, measures=measures)
    first, second = (draw_situation(toy.task, 0, i) for i in range(2))
    conditions = [
        Condition("unpushed", first),
        Condition("pushed", first),
        Condition("unpushed", second, "still"),
    ]
    run = open_run(tmp_path / "run", study=study, command="", configuration={}, seed=0)
    records = Records(study.task, models)
    record_all(run, study, records, conditions)
    whole = Records(
        study.task, models, [(c, perform_condition(study, models, c)) for c in conditions]
    )
    for stored, kept in zip(records, whole, strict=True):
        assert set(stored.numbers) == {"gap", "rest"}  # what looks beside waits
        assert stored.trial.outcome == kept.trial.outcome
        assert dict(stored.trial.about) == dict(kept.trial.about)
        for name, array in kept.trial.arrays.items():
            assert stored[name].tobytes() == array.tobytes()
        with pytest.raises(KeyError):
            stored.trial.arrays["nothing"]
    for measure in measures:
        assert measure.figure(records) == measure.figure(whole) is not None
    files = [run.path(i) for i in range(3)]
    assert list(run.files()) == files
    # Nothing is kept of the signals: with its file a trial is gone.
    files[0].unlink()
    with pytest.raises(FileNotFoundError):
        records[0]["q"]


def deadly(world, models, situation):
    """Ends the worker in which it is made."""
    if os.environ["TPSIM_DRIVER"] != str(os.getpid()):
        os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError("this was made in the driver")


def test_a_trial_that_ends_its_worker_twice_is_a_row_and_the_rest_finishes(
    toy, tmp_path, monkeypatch
):
    monkeypatch.setenv("TPSIM_DRIVER", str(os.getpid()))

    def conditions(lab, plan):
        situations = [draw_situation(lab.task, plan.seed, i) for i in range(4)]
        yield [Condition("unpushed", s, "deadly" if s.index == 1 else "still") for s in situations]

    study = replace(toy, controllers={**toy.controllers, "deadly": deadly}, conditions=conditions)
    study = replace(study, measures=[replace(toy.measures[0], controller="still")])
    answer = running.run(study, Plan(), tmp_path / "run", workers=2, video=False)
    (row,) = answer["lost"]
    assert (row["trial"], row["controller"], row["situation"]) == (1, "deadly", 1)
    assert "signal 9" in row["reason"] and "\n" not in row["reason"]
    assert answer["trials"] == 3
    run = load_run(tmp_path / "run")
    assert [file.name for file in run.files()] == [f"trial-00000{i}.npz" for i in (0, 2, 3)]
    assert run.file.whole is None
    report = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert "Trials that are missing" in report and "signal 9" in report
