import json
import os
import signal
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import tpsim.bench
from tpsim import paths
from tpsim.cli import main as cli
from tpsim.cli.commands import COMMANDS
from tpsim.cli.summaries import SUMMARIES
from tpsim.errors import ArgumentError, RecordingError, SimulationError
from tpsim.study import running, teaching, trying
from tpsim.study.study import Plan

TOY = f"{Path(__file__).parent / 'study' / 'toy.py'}:study"


@pytest.fixture
def calls(monkeypatch):
    """Stand in for the verbs: remember how they were called, answer with what they were given."""
    seen = []

    def called(name):
        def function(study, *given, **options):
            print("chatter that must not reach stdout")
            seen.append((name, study, given, options))
            figures = {"tilt_max_deg": np.float64(1.5)}
            return {"task": study.task.name, "figures": figures, "bad": np.nan}

        return function

    for module, names in (
        (running, ["run"]),
        (teaching, ["teach", "learn"]),
        (trying, ["reproduce", "push"]),
    ):
        for name in names:
            monkeypatch.setattr(module, name, called(name))
    return seen


@pytest.fixture
def run(capsys):
    """Run a command line: exit code, standard output, standard error."""

    def run(line):
        capsys.readouterr()
        code = cli.main(line.replace("TOY", TOY).split())
        out, err = capsys.readouterr()
        return code, out, err

    return run


@pytest.mark.parametrize(
    ("line", "positional", "options"),
    [
        (
            "run TOY --seed 3 --no-video --situations 2 --pushes 1 --workers 2",
            (Plan(3, 2, 1),),
            {"video": False, "workers": 2, "folder": None, "progress": False},
        ),
        ("teach TOY --count 7", (), {"count": 7, "seed": 0, "folder": None}),
        ("learn TOY --demonstrations .", (Path("."),), {"out": None}),
        ("reproduce TOY --situation 3", (None,), {"situation": 3, "seed": 0, "folder": None}),
        (
            "push TOY --force -20 0 0.5 --start 1 --duration 0.5 --body right_elbow",
            (None,),
            {"situation": 0, "force": (-20.0, 0.0, 0.5), "start": 1.0, "duration": 0.5, "seed": 0}
            | {"body": "right_elbow", "folder": None},
        ),
    ],
)
def test_options_reach_the_verbs_and_json_is_alone_on_stdout(run, calls, line, positional, options):
    code, out, err = run(line + " --json")
    assert code == 0
    ((name, study, given, named),) = calls
    typed = f"tpsim {line} --json".replace("TOY", TOY)
    assert named.pop("command", typed) == typed
    assert (name, study.task.name, given) == (line.split()[0], "bring", positional)
    assert named == options
    assert json.loads(out) == {"task": "bring", "figures": {"tilt_max_deg": 1.5}, "bad": None}
    assert out.count("\n") == 1
    assert "chatter" in err


def test_fields_of_the_task_are_options(run, calls):
    assert run("teach TOY --effort 0.2 --count 2 --reach 0.1 0.2 --grip 3")[0] == 0
    _, study, _, options = calls[0]
    assert asdict(study.task) == {"effort": 0.2, "reach": (0.1, 0.2), "grip": 3.0}
    assert options["count"] == 2
    run("teach TOY")
    assert asdict(calls[1][1].task) == {"effort": 0.05, "reach": (0.3, 0.4), "grip": None}


def test_a_field_named_as_an_option_of_the_command_keeps_its_own_name(run, calls, tmp_path):
    (tmp_path / "mine.py").write_text(
        "from dataclasses import dataclass\nfrom tests_toy import Bring\n"
        "from tpsim.study.study import Study\n\n"
        "@dataclass(frozen=True)\nclass Seeded(Bring):\n"
        '    """Bring it.\n\n    Parameters\n    ----------\n    seed : int\n'
        '        Of ``mine``.\n    """\n\n    seed: int = 5\n\nstudy = Study(Seeded())\n'
    )
    toy = Path(TOY.rpartition(":")[0]).read_text()
    (tmp_path / "tests_toy.py").write_text(toy)
    mine = f"{tmp_path / 'mine.py'}:study"
    assert run(f"teach {mine} --seed 1 --task-seed 7")[0] == 0
    assert (calls[0][1].task.seed, calls[0][3]["seed"]) == (7, 1)
    shown = " ".join(run(f"teach {mine} --help")[1].split())
    assert "--task-seed INT" in shown and "Of mine. (default: 5)" in shown


def test_help_of_a_study_lists_the_fields_of_its_task(run, calls):
    code, out, _ = run("run cup-and-sugar --help")
    assert code == 0 and not calls
    shown = " ".join(out.replace("│", " ").split())
    assert "--friction FLOAT What a person feels who leads a hand where it is free [Ns/m]." in shown
    assert "--situations INT" in shown


def test_without_json_people_read_a_summary(run, calls):
    code, out, _ = run("learn TOY")
    assert code == 0 and calls
    assert out.splitlines()[0] == "task  bring"
    assert "  tilt max deg  1.5" in out


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("run cup-and-suga", "did you mean cup-and-sugar?"),
        ("run xyz", "'xyz'"),
        ("run cup.py:study", "cup.py"),
        ("run TOY --seed -1", "--seed -1: give a number from 0 to 4294967295"),
        ("run TOY --situations 0", "--situations 0: give a number from 1 to 1000000"),
        ("run TOY --pushes -2", "--pushes -2"),
        ("run TOY --workers 0", "--workers 0"),
        ("run TOY --efort 0.2", "unknown option '--efort'; did you mean '--effort'?"),
        ("run TOY --effort nan", "--effort is nan; give a finite number"),
        ("run TOY --situation 2", "unknown option '--situation'; did you mean '--situations'?"),
        ("run TOY --xyz", "unknown option '--xyz'; --help lists the options"),
        ("run TOY --effort soft", "--effort: could not convert string to float: 'soft'"),
        ("run TOY --effort", "'--effort'"),
        ("run TOY more", "unexpected 'more'"),
        ("run TOY --seed 1.5", "--seed"),
        ("teach TOY --count 0", "--count 0"),
        ("teach TOY --count 2.5", "2.5"),
        ("learn TOY --demonstrations nowhere", "--demonstrations nowhere: give a folder"),
        ("reproduce TOY --situation -1", "--situation -1"),
        ("push TOY --duration -2", "--duration -2.0"),
        ("push TOY --duration 0", "--duration 0.0"),
        ("push TOY --duration nan", "--duration nan"),
        ("push TOY --start -1", "--start -1.0"),
        ("push TOY --force 0 0 0", "--force 0.0 0.0 0.0: give three finite numbers"),
        ("push TOY --force inf 0 0", "--force inf 0.0 0.0"),
        ("push TOY --force 1 2", "--force"),
        ("bench speed", "speed"),
        ("demo nothing", "unknown demo 'nothing'"),
        ("fly", "unknown command 'fly'"),
        ("tech cup", "did you mean 'teach'?"),
        ("", "give a command: run, teach"),
        ("run", "TASK"),
    ],
)
def test_wrong_usage_is_named_and_nothing_happens(run, calls, line, words):
    code, out, err = run(line)
    assert (code, out, calls) == (2, "", [])
    assert words in err
    assert err.count("\n") == 1 and err.startswith("tpsim: ")


def test_a_folder_that_is_a_file_is_wrong_usage(run, calls, tmp_path):
    (tmp_path / "file").write_text("")
    code, _, err = run(f"run TOY --folder {tmp_path / 'file'}")
    assert code == 2 and "is a file" in err and not calls


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (SimulationError("the site left_hand\nis missing"), 1),
        (RecordingError("truncated"), 1),
        (PermissionError(13, "Permission denied", "/x"), 1),
        (OSError(28, "No space left on device", "trial.npz"), 1),
        (MemoryError(), 1),
        (ArgumentError("body 'nose' is unknown"), 2),
    ],
)
@pytest.mark.parametrize("as_json", ["", " --json"])
def test_errors_are_one_line_on_stderr(run, calls, monkeypatch, error, code, as_json):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(running, "run", fail)
    given, out, err = run("run TOY" + as_json)
    assert (given, out) == (code, "")
    assert err.count("\n") == 1 and err.startswith("tpsim: ")
    if isinstance(error, OSError):
        assert f"tpsim: {error.filename}: {error.strerror}\n" == err
    else:
        assert " ".join(str(error).split()) in err


def test_an_interruption_says_how_to_go_on(run, calls, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(running, "run", interrupt)
    code, out, err = run("run TOY --seed 4")
    assert (code, out) == (130, "")
    assert err.count("\n") == 1 and f"tpsim run {TOY} --seed 4" in err


@pytest.mark.parametrize(("name", "code"), [("SIGINT", 130), ("SIGTERM", 143), ("SIGHUP", 129)])
def test_a_signal_is_one_line_and_an_exit_code_of_its_own(run, calls, monkeypatch, name, code):
    number = getattr(signal, name)
    before = signal.signal(number, signal.default_int_handler)

    def study_at_work(*_, **__):
        try:
            signal.raise_signal(number)
        except BaseException as error:
            error.add_note("finished trials are kept in there")
            raise

    monkeypatch.setattr(running, "run", study_at_work)
    given, out, err = run("run TOY")
    assert signal.signal(number, before) is signal.default_int_handler
    assert (given, out) == (code, "")
    what = "interrupted" if name == "SIGINT" else f"ended by {name}"
    kept = "; finished trials are kept in there. To start again: tpsim run"
    assert err.count("\n") == 1 and err.startswith(f"tpsim: {what}{kept}")


def test_recorded_demonstrations_replay_bit_for_bit(run, tmp_path):
    folder = tmp_path / "demonstrations"
    code, _, err = run(f"teach TOY --count 2 --seed 5 --folder {folder}")
    assert code == 0
    assert "tpsim: teaching bring: attempt 1 done, 1 of 2 good" in err
    code, out, _ = run(f"replay {folder / 'bring'} --study TOY --json")
    result = json.loads(out)
    assert code == 0
    assert (result["trials"], result["identical"], result["largest_difference"]) == (2, 2, 0)
    assert run(f"teach TOY --folder {folder}")[0] == 1
    assert run(f"replay {tmp_path}")[0] == 1


def test_a_replay_that_differs_fails(run, monkeypatch):
    answer = {"verdict": "all 2 trials came out again, bit for bit", "repeats": True}
    monkeypatch.setattr("tpsim.study.files.run.load_run", lambda folder: folder)
    monkeypatch.setattr("tpsim.study.replay.replay", lambda *_, **__: answer)
    assert run("replay folder")[0] == 0
    answer |= {"repeats": False}
    code, out, _ = run("replay folder --json")
    assert code == 1 and json.loads(out) == answer


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
    look = (
        "import sys; from tpsim.cli.main import main; main(['--help']); print(sorted(sys.modules))"
    )
    shown = subprocess.run([sys.executable, "-c", look], capture_output=True, text=True)
    assert all(f"  {name} " in shown.stdout for name in COMMANDS)
    heavy = ("mujoco", "pinocchio", "matplotlib", "numpy", "scipy", "tyro")
    assert not any(f"'{module}'" in shown.stdout for module in heavy)


def test_summaries_are_the_first_lines_of_docstrings():
    found = {name: command.__doc__.splitlines()[0] for name, command in COMMANDS.items()}
    assert found == SUMMARIES


@pytest.mark.parametrize("line", ["--help", "push --help", "run cup-and-sugar --help"])
@pytest.mark.parametrize("columns", [40, 80])
def test_help_is_no_wider_than_the_terminal(run, monkeypatch, line, columns):
    monkeypatch.setenv("COLUMNS", str(columns))
    code, out, _ = run(line)
    assert code == 0 and max(map(len, out.splitlines())) <= columns


def test_completion_knows_commands_and_options(run):
    for shell in ("bash", "zsh", "fish"):
        code, out, _ = run(f"--completion {shell}")
        assert code == 0 and all(word in out for word in ("reproduce", "situations"))


@pytest.mark.parametrize(
    ("flags", "change", "code"),
    [
        ("", {}, 0),
        ("", {"missed": ["tilt"]}, 0),
        ("--strict", {"missed": ["tilt"]}, 3),
        ("--strict", {}, 0),
        ("--strict", {"missed": ["tilt"], "lost": [{"trial": 3, "reason": "signal 9"}]}, 1),
    ],
)
def test_a_missed_limit_has_a_code_where_it_is_asked_for(run, monkeypatch, flags, change, code):
    answer = {"task": "bring", "missed": [], "lost": []} | change
    monkeypatch.setattr(running, "run", lambda *_, **__: answer)
    assert run(f"run TOY {flags}")[0] == code


def test_a_renderer_that_does_not_work_is_one_line_and_no_hindrance():
    given = {**os.environ, "MUJOCO_GL": "wrong"}
    line = [sys.executable, "-m", "tpsim", "reproduce", TOY, "--demonstrations", "nowhere"]
    told = subprocess.run(line, capture_output=True, text=True, env=given).stderr
    assert told.count("\n") == 2 and "MUJOCO_GL=wrong does not work here" in told
    assert "--demonstrations nowhere" in told


def test_the_version_is_printed(run):
    code, out, err = run("--version")
    assert (code, err) == (0, "") and out.startswith("tpsim ")


def test_a_value_that_the_task_refuses_is_one_line(run, calls, tmp_path):
    (tmp_path / "strict.py").write_text(
        "from dataclasses import dataclass\nfrom tests_toy import Bring\n"
        "from tpsim.study.study import Study\n\n"
        "@dataclass(frozen=True)\nclass Strict(Bring):\n"
        "    def __post_init__(self):\n"
        "        if self.effort <= 0:\n            raise ValueError('effort must be positive')\n\n"
        "study = Study(Strict())\n"
    )
    (tmp_path / "tests_toy.py").write_text(Path(TOY.rpartition(":")[0]).read_text())
    code, out, err = run(f"run {tmp_path / 'strict.py'}:study --effort -1")
    assert (code, out, calls) == (2, "", [])
    assert err == "tpsim: task 'strict' refuses {'effort': -1.0}: effort must be positive\n"
