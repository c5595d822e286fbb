import json
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import tpsim.bench
from tpsim import cli, experiment, paths, tasks
from tpsim.errors import ArgumentError, RecordingError, SimulationError
from tpsim.experiment.recording import open_run
from tpsim.sim.trial import Trial

MODEL = SimpleNamespace(njnt=0, nsite=0)


def record(task, *, seed, folder, **_):
    """A campaign that records two trials drawn from the seed."""
    command, where = f"tpsim teach {task} --seed {seed}", folder / task
    run = open_run(where, command=command, configuration={}, seed=seed, scene_xml="", model=MODEL)
    rng = np.random.default_rng(seed)
    for index in range(2):
        run.save(index, Trial({"time": np.arange(9.0), "q": rng.normal(size=(9, 2))}))
    return {"task": task, "paths": {"demonstrations": [str(where)]}}


@pytest.fixture
def calls(monkeypatch):
    """Stand in for the campaign: remember how it was called, answer with what it was given."""
    seen = []

    def called(name):
        def function(task, **options):
            print("chatter that must not reach stdout")
            seen.append((name, task, options))
            return {"task": task, "figures": {"tilt_max_deg": np.float64(1.5)}, "bad": np.nan}

        return function

    campaign = SimpleNamespace(
        **{name: called(name) for name in ("run", "teach", "learn", "reproduce", "push")}
    )
    monkeypatch.setattr(experiment, "campaign", campaign, raising=False)
    monkeypatch.setitem(sys.modules, "tpsim.experiment.campaign", campaign)
    monkeypatch.setattr(tasks, "names", lambda: ("cup", "sugar", "cup-and-sugar"), raising=False)
    return seen


@pytest.fixture
def run(capsys):
    """Run a command line: exit code, standard output, standard error."""

    def run(line):
        capsys.readouterr()
        code = cli.main(line.split())
        out, err = capsys.readouterr()
        return code, out, err

    return run


@pytest.mark.parametrize(
    ("line", "options"),
    [
        (
            "run cup --seed 3 --no-video --situations 2 --pushes 1 --workers 2",
            {"seed": 3, "video": False, "situations": 2, "pushes": 1, "workers": 2, "folder": None}
            | {"progress": False},
        ),
        ("teach cup --count 7", {"count": 7, "seed": 0, "folder": None}),
        ("learn cup --components 3", {"components": 3, "folder": None}),
        ("reproduce cup --situation 3", {"situation": 3, "seed": 0, "folder": None}),
        (
            "push cup --force -20 0 0.5 --start 1 --duration 0.5 --body right_elbow",
            {"situation": 0, "force": (-20.0, 0.0, 0.5), "start": 1.0, "duration": 0.5, "seed": 0}
            | {"body": "right_elbow", "folder": None},
        ),
    ],
)
def test_options_reach_the_campaign_and_json_is_alone_on_stdout(run, calls, line, options):
    code, out, err = run(line + " --json")
    assert code == 0
    assert calls == [(line.split()[0], "cup", options)]
    assert json.loads(out) == {"task": "cup", "figures": {"tilt_max_deg": 1.5}, "bad": None}
    assert out.count("\n") == 1
    assert "chatter" in err


def test_without_json_people_read_a_summary(run, calls):
    code, out, _ = run("learn cup")
    assert code == 0 and calls
    assert out.splitlines()[0] == "task  cup"
    assert "  tilt max deg  1.5" in out


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("run cup-sugar", "unknown task 'cup-sugar'; did you mean 'cup-and-sugar'? (known: cup, "),
        ("run xyz", "unknown task 'xyz' (known: cup, cup-and-sugar, sugar)"),
        ("run cup --seed -1", "--seed -1: give zero or a greater number"),
        ("run cup --situations 0", "--situations 0: give a number greater than zero"),
        ("run cup --pushes -2", "--pushes -2"),
        ("run cup --workers 0", "--workers 0"),
        ("teach cup --count 0", "--count 0"),
        ("teach cup --count 2.5", "2.5"),
        ("learn cup --components 0", "--components 0"),
        ("reproduce cup --situation -1", "--situation -1"),
        ("push cup --duration -2", "--duration -2.0"),
        ("push cup --duration 0", "--duration 0.0"),
        ("push cup --duration nan", "--duration nan"),
        ("push cup --start -1", "--start -1.0"),
        ("push cup --force 0 0 0", "--force 0.0 0.0 0.0: give three finite numbers"),
        ("push cup --force inf 0 0", "--force inf 0.0 0.0"),
        ("push cup --force 1 2", "--force"),
        ("bench speed", "speed"),
        ("demo nothing", "unknown demo 'nothing'"),
        ("fly", "fly"),
        ("run", "TASK"),
    ],
)
def test_wrong_usage_is_named_and_nothing_happens(run, calls, line, words):
    code, out, err = run(line)
    assert (code, out, calls) == (2, "", [])
    assert words in err


def test_a_folder_that_is_a_file_is_wrong_usage(run, calls, tmp_path):
    (tmp_path / "file").write_text("")
    code, _, err = run(f"run cup --folder {tmp_path / 'file'}")
    assert code == 2 and "is a file" in err and not calls


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (SimulationError("the site left_hand\nis missing"), 1),
        (RecordingError("truncated"), 1),
        (PermissionError(13, "Permission denied", "/x"), 1),
        (ArgumentError("body 'nose' is unknown"), 2),
    ],
)
@pytest.mark.parametrize("as_json", ["", " --json"])
def test_errors_are_one_line_on_stderr(run, calls, monkeypatch, error, code, as_json):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(experiment.campaign, "run", fail)
    given, out, err = run("run cup" + as_json)
    assert (given, out) == (code, "")
    assert err.count("\n") == 1 and err.startswith("tpsim: ")
    assert " ".join(str(error).split()) in err


def test_an_interruption_says_how_to_go_on(run, calls, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(experiment.campaign, "run", interrupt)
    code, out, err = run("run cup --seed 4")
    assert (code, out) == (1, "")
    assert err.count("\n") == 1 and "tpsim run cup --seed 4" in err


def test_recorded_demonstrations_replay_bit_for_bit(run, calls, monkeypatch, tmp_path):
    monkeypatch.setattr(experiment.campaign, "teach", record)
    folder = tmp_path / "demonstrations"
    assert run(f"teach cup --seed 5 --folder {folder}")[0] == 0
    code, out, _ = run(f"replay {folder / 'cup'} --json")
    result = json.loads(out)
    assert code == 0
    assert (result["trials"], result["identical"], result["largest_difference"]) == (2, 2, 0)
    assert run(f"teach cup --folder {folder}")[0] == 1
    assert run(f"replay {tmp_path}")[0] == 1


def test_benchmarks_are_run_by_area(run, monkeypatch):
    for area in ("learning", "control", "retrieval", "simulation"):
        bench = SimpleNamespace(run=lambda quick, area=area: {f"{area}_ms": 1 + quick})
        monkeypatch.setitem(sys.modules, f"tpsim.bench.{area}", bench)
        monkeypatch.setattr(tpsim.bench, area, bench, raising=False)
    assert json.loads(run("bench control --quick --json")[1]) == {"control": {"control_ms": 2}}
    assert len(json.loads(run("bench --json")[1])) == 4
    assert "learning ms  1" in run("bench learning")[1]


def test_demos_are_listed_and_run_by_name(run, monkeypatch, tmp_path):
    monkeypatch.setattr(paths, "DEMOS", tmp_path)
    (tmp_path / "demo_one.py").write_text(
        '"""demo_one: the first.\n\nLook for: a line.\n"""\n'
        "from tpsim.gallery import within\n"
        "def main():\n    return {'x': within(1, 0, 2, 'it is one')}\n"
        "def draw(figure):\n    figure.add_subplot().plot([0, 1])\n"
    )
    assert json.loads(run("demo --json")[1]) == {"demos": ["demo_one: the first"]}
    folder = tmp_path / "pictures"
    result = json.loads(run(f"demo demo_one --json --folder {folder}")[1])
    assert (result["row"], result["look_for"]) == ("the first", "a line.")
    assert [(f["figure"], f["value"], f["holds"]) for f in result["figures"]] == [("x", 1, True)]
    assert result["picture"] == str(folder / "demo_one.png")
    code, out, _ = run(f"demo --all --json --folder {folder}")
    rows = json.loads(out)["rows"]
    assert code == 0 and [row["name"] for row in rows] == ["demo_one"]
    assert str(folder / "demo_one.png") in run(f"demo --all --folder {folder}")[1]
    assert "did you mean 'demo_one'" in run("demo one")[2]
    for slip in ("demo nothing", "demo demo_one --all", "demo --show"):
        code, out, err = run(slip)
        assert (code, out, err.count("\n")) == (2, "", 1)


def test_help_names_every_command_and_imports_nothing_heavy():
    look = "import sys; from tpsim.cli import main; main(['--help']); print(sorted(sys.modules))"
    shown = subprocess.run([sys.executable, "-c", look], capture_output=True, text=True)
    names = "run teach learn reproduce push replay compare bench demo doctor"
    assert all(f"• {name} " in shown.stdout for name in names.split())
    assert not any(f"'{heavy}'" in shown.stdout for heavy in ("mujoco", "pinocchio", "matplotlib"))
