"""The whole comparison, small: rows for failures, resuming, the same with several workers."""

import csv
import json

import numpy as np
import pytest

from tpsim import Demonstration, Frame
from tpsim.cli.main import main
from tpsim.errors import ArgumentError, RecordingError
from tpsim.examples import u_demonstrations
from tpsim.section8 import METHODS, compare, compare_left_out
from tpsim.section8.left_out import leave_one_out
from tpsim.section8.plan import Plan
from tpsim.section8.run import run
from tpsim.section8.trial import Trial

SMALL = Plan(("transfer", "missing frame"), (2, 4), (0, 1), (1.0, 4.0), situations=3, samples=20)


def raises(demonstrations):
    raise RuntimeError("no idea how")


def forgets(demonstrations):
    return lambda frames: np.zeros((3, 2))


def lost(demonstrations):
    return lambda frames: np.full((20, 2), np.nan)


METHODS_HERE = {
    "TP-LWR": METHODS["TP-LWR"],
    "GPR": METHODS["GPR"],
    "raises": raises,
    "forgets": forgets,
    "lost": lost,
}


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    folder = tmp_path_factory.mktemp("compare")
    return compare(METHODS_HERE, SMALL, folder=folder), folder


def test_a_failure_is_a_row_with_its_reason(compared):
    methods = compared[0]["methods"]
    assert list(methods) == list(METHODS_HERE)
    assert methods["raises"]["reason"] == "no idea how"
    assert "asks for (20, 2)" in methods["forgets"]["reason"]
    assert "NaN" in methods["lost"]["reason"]
    assert "reason" not in methods["TP-LWR"]
    assert methods["TP-LWR"]["rms"] > 0
    assert methods["TP-LWR"]["rank"] < methods["raises"]["rank"]
    assert methods["TP-LWR"]["wins"] + methods["GPR"]["wins"] == pytest.approx(1)


def test_everything_is_written(compared):
    result, folder = compared
    rows = list(csv.DictReader((folder / "comparison.csv").open()))
    assert len(rows) == 2 * 2 * 2 * len(METHODS_HERE) * 7
    first = next(r for r in rows if r["method"] == "TP-LWR" and r["figure"] == "rms")
    assert float(first["low"]) <= float(first["value"]) <= float(first["high"])
    assert json.loads((folder / "comparison.json").read_text())["methods"]["raises"]["rms"] is None
    latex = (folder / "comparison.tex").read_text()
    assert latex.count(r"\\") == 1 + len(METHODS_HERE)
    page = (folder / "report.html").read_text()
    assert "needs every frame" in page
    assert "no idea how" in page
    for picture in result["paths"]["pictures"]:
        assert picture.read_bytes().startswith(b"\x89PNG")


def test_goes_on_where_it_was_cut_off(compared):
    folder = compared[1]
    cells = sorted((folder / "cells").iterdir())
    assert len(cells) == len(SMALL.cells())
    kept = Trial.load(cells[2], _key_of(cells[2]))
    cells[0].unlink()
    cells[1].unlink()
    done = []

    def perform(plan, methods, cell):
        done.append(cell)
        return kept

    run(SMALL, METHODS_HERE, folder, performed_by=perform)
    assert len(done) == 2
    for wrong in (cells[2].read_bytes(), cells[1].read_bytes()[:100]):
        cells[1].write_bytes(wrong)
        with pytest.raises(RecordingError, match=f"{cells[1].name}.*delete it"):
            run(SMALL, METHODS_HERE, folder, performed_by=perform)
    cells[1].unlink()
    run(SMALL, METHODS_HERE, folder, performed_by=perform)
    assert len(done) == 3
    run(SMALL, {**METHODS_HERE, "TP-LWR": METHODS["TP-GP"]}, folder, performed_by=perform)
    assert len(done) == 3 + len(SMALL.cells())
    assert len(list((folder / "cells").iterdir())) == 2 * len(SMALL.cells())


def _key_of(path):
    return str(np.load(path)["key"])


def test_workers_change_nothing(tmp_path):
    plan = Plan(("transfer",), (2,), (0, 1), (1.0,), situations=2, samples=20)
    methods = {"TP-LWR": METHODS["TP-LWR"], "closure": lambda taught: lambda frames: taught[0].data}
    alone = run(plan, methods, tmp_path / "1")
    together = run(plan, methods, tmp_path / "2", workers=2)
    for cell, trial in alone.items():
        np.testing.assert_array_equal(trial.figures, together[cell].figures)


def test_seeds_are_other_teachers(tmp_path):
    plan = Plan(("transfer",), (2,), (0,), (1.0,), situations=2, samples=20)
    methods = {"TP-LWR": METHODS["TP-LWR"]}
    values = [
        compare(methods, plan, seed=seed, folder=tmp_path / str(seed))["methods"]["TP-LWR"]["rms"]
        for seed in (0, 1)
    ]
    assert values[0] != values[1]


def test_left_out_demonstrations_are_predicted(tmp_path):
    taught = [d.resampled(n) for d, n in zip(u_demonstrations(3), (20, 25, 30), strict=True)]
    methods = {"mean": lambda some: lambda frames: np.mean([d.data for d in some], 0)}
    result = compare_left_out(taught, methods | {"raises": raises}, folder=tmp_path)
    data = [d.resampled(25).data for d in taught]
    squares = [((data[m] - (data[m - 1] + data[m - 2]) / 2) ** 2).sum(1).mean() for m in range(3)]
    assert result["methods"]["mean"]["rms"] == pytest.approx(np.sqrt(np.mean(squares)), rel=1e-2)
    assert result["methods"]["raises"]["reason"] == "no idea how"
    assert (tmp_path / "report.html").is_file()


@pytest.mark.parametrize("D", [1, 3])
def test_any_dimension_is_compared(D, tmp_path):
    """On a line and in space, with a frame that is given at every step."""
    rng, taught = np.random.default_rng(0), []
    for _ in range(3):
        start, goal = rng.normal(size=(2, D))
        progress = np.linspace(0, 1, 20)[:, None] ** 2
        frames = [
            Frame(np.eye(D), start),
            Frame(np.tile(np.eye(D), (20, 1, 1)), np.tile(goal, (20, 1))),
        ]
        taught.append(
            Demonstration(2 * progress[:, 0] ** 0.5, start + progress * (goal - start), frames)
        )
    methods = {name: METHODS[name] for name in ("TP-GMM", "TP-GMR", "TP-LWR", "DMP")}
    result = compare_left_out(taught, methods, folder=tmp_path)
    for name in ("TP-GMM", "TP-GMR", "DMP"):
        assert "reason" not in result["methods"][name]
        assert result["methods"][name]["end"] < (0.5 if name == "DMP" else 0.2)


def test_bad_demonstrations_are_refused():
    taught = u_demonstrations(2, 20)
    with pytest.raises(ArgumentError, match="at least 2"):
        leave_one_out(taught[:1])
    bare = Demonstration([0, 1], np.zeros((2, 2)))
    with pytest.raises(ArgumentError, match=r"no frames.*--frames"):
        leave_one_out([bare, bare])
    with pytest.raises(ArgumentError, match="same frames: demonstration 2 has 0 of 2; leave"):
        leave_one_out([taught[0], bare])
    third = Demonstration(
        taught[1].time, taught[1].data, [*taught[1].frames, Frame(np.eye(2), [0, 0])]
    )
    with pytest.raises(ArgumentError, match="same frames"):
        leave_one_out([taught[0], third])


@pytest.mark.parametrize(
    ("plan", "words"),
    [
        (Plan(families=("transfers",)), "transfers"),
        (Plan(counts=()), "nothing in it"),
        (Plan(counts=(0,)), "counts"),
    ],
)
def test_bad_plans(plan, words, tmp_path):
    with pytest.raises(ArgumentError, match=words):
        compare(METHODS_HERE, plan, folder=tmp_path)
    with pytest.raises(ArgumentError, match="no method"):
        compare({}, SMALL, folder=tmp_path)


@pytest.mark.parametrize(
    "options",
    [["--workers", "0"], ["--seed", "-1"], ["--method", "no.py:f"], ["--data", "no-such-file"]],
)
def test_the_command_refuses_bad_options(options, capsys):
    assert main(["compare", *options]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_the_command_prints_a_line_for_every_method(tmp_path, monkeypatch, capsys):
    plan = Plan(("transfer",), (2,), (0,), (1.0,), situations=2, samples=20)
    monkeypatch.setattr("tpsim.section8.plan.QUICK", plan)
    monkeypatch.setattr(
        "tpsim.section8.methods.with_methods_from", lambda specifications: METHODS_HERE
    )
    words = ["compare", "--quick", "--workers", "1", "--folder", str(tmp_path)]
    assert main(words) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[2 : 2 + len(METHODS_HERE)]] == list(METHODS_HERE)
    assert main([*words, "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert {"methods", "paths"} <= set(result)
    assert {"rms", "end", "train_ms", "adapt_us"} <= set(result["methods"]["TP-LWR"])


def test_the_command_reads_demonstrations_of_ones_own(tmp_path, monkeypatch, capsys):
    """Whatever reads them: here a stand-in for tpsim.data."""
    monkeypatch.setattr("tpsim.data.read", lambda path: u_demonstrations(3, 20))
    monkeypatch.setattr(
        "tpsim.section8.methods.with_methods_from", lambda specifications: METHODS_HERE
    )
    words = ["compare", "--data", str(tmp_path), "--folder", str(tmp_path / "out"), "--json"]
    assert main(words) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["demonstrations"] == 3
    assert result["methods"]["TP-LWR"]["rms"] > 0


def test_objects_in_a_table_are_frames(tmp_path, monkeypatch, capsys):
    """The same comparison from CSV, the objects named, as from the demonstrations themselves."""
    taught = u_demonstrations(3, 20)
    table = tmp_path / "data"
    table.mkdir()
    for m, d in enumerate(taught):
        poses = [[*f.b, np.arctan2(f.A[1, 0], f.A[0, 0])] for f in d.frames]
        held = np.tile(np.ravel(poses), (len(d), 1))
        heads = [
            "time",
            "x",
            "y",
            *(f"{o}_{c}" for o in ("cup", "box") for c in ("x", "y", "angle")),
        ]
        rows = np.column_stack([d.time, d.data, held])
        np.savetxt(table / f"{m}.csv", rows, delimiter=",", header=",".join(heads), comments="")
    monkeypatch.setattr(
        "tpsim.section8.methods.with_methods_from", lambda specifications: METHODS_HERE
    )
    words = ["compare", "--data", str(table), "--folder", str(tmp_path / "out"), "--json"]
    assert main([*words, "--frames", "cup", "box"]) == 0
    found = json.loads(capsys.readouterr().out)["methods"]["TP-LWR"]["rms"]
    straight = leave_one_out(taught, {"TP-LWR": METHODS["TP-LWR"]})
    assert found == pytest.approx(np.sqrt(np.mean([t.figures[0, 0, 0] ** 2 for t in straight])))
    assert main(words) == 2
    assert "--frames" in capsys.readouterr().err
    assert main(["compare", "--frames", "cup"]) == 2
    assert "--data; give both" in capsys.readouterr().err
