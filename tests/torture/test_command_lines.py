"""Hostile command lines: one line names what is wrong, and nothing is written.

A sample runs by default; ``pytest -m torture`` tries all of them.
"""

import os
import subprocess
import sys
from itertools import chain
from pathlib import Path

import pytest

from tpsim.cli import main as cli

LONG = "x" * 300
DEEP = "d/" * 3000
INTEGERS = ["x", "1.5", "-1", "nan", "inf", "1e3", "0x10", "9" * 5000, "1 2", "日本", "-", "\udcff"]
FLOATS = ["x", "nan", "inf", "-inf", "1e999", "1,5", "½", "--5", "1" * 400 + "e"]
FOLDERS = ["file.txt", "file.txt/in", "/proc/nothing", LONG, DEEP, "/dev/null", "/dev/null/x"]
STUDIES = [
    "nowhere.py:study",
    "toy.py:nothing",
    "toy.py:",
    ":study",
    "folder.py:study",
    "file.txt:study",
    "broken.py:study",
    "leaves.py:study",
    "binary.py:study",
    "json:loads",
    "os:path",
    "no.such.module:study",
    "..:study",
    "cup-and-suga",
    "日本語",
    "\udcfe.py:study",
    LONG,
    DEEP,
    LONG + ".py:study",
    "a:b:c:d",
]
WORDS = [
    "--nothing",
    "--sed",
    "more",
    "-x",
    "--=",
    "--=3",
    "-",
    "---",
    "--json=perhaps",
    LONG,
]
SEEDED = ["run", "teach", "reproduce", "push"]
STUDIED = [*SEEDED, "learn", "export"]


def lines():
    """All hostile command lines, as lists of words."""
    for word in [
        "fly",
        "Run",
        "--run",
        "-v",
        "--",
        "日本",
        LONG,
        "\udcff",
        "run ",
        "help",
        "--json",
    ]:
        yield [word]
    for name in (*STUDIED, "replay", "data"):
        yield [name]
        yield [name, ""]
        yield [name, "   "]
    for name in STUDIED:
        yield from ([name, study] for study in STUDIES)
        yield from ([name, "toy.py:study", word] for word in WORDS)
        yield from ([name, "toy.py:study", "--folder", folder] for folder in FOLDERS)
        yield from ([name, "toy.py:study", *end] for end in (["--folder"], ["--folder", ""]))
        yield from ([name, "toy.py:study", "--effort", value] for value in FLOATS)
    for name in SEEDED:
        yield from ([name, "toy.py:study", f"--seed={value}"] for value in INTEGERS)
    for option in ("situations", "pushes", "workers"):
        values = [*INTEGERS, "0", "-7", "10000000000"]
        yield from (["run", "toy.py:study", f"--{option}={value}"] for value in values)
    for option in ("start", "duration", "force", "body"):
        for value in FLOATS if option != "body" else ["nose", "", "日本", LONG]:
            words = [value] * (3 if option == "force" else 1)
            yield ["push", "toy.py:study", "--demonstrations", "taught", f"--{option}", *words]
    for name in ("learn", "reproduce", "push", "export"):
        for folder in ("nowhere", "file.txt", "", LONG, "empty", "folder.py"):
            yield [name, "toy.py:study", "--demonstrations", folder]
    for folder in ("nowhere", "file.txt", "empty", "half", "/dev/null", LONG, DEEP, "/proc/1"):
        yield ["replay", folder]
        yield ["data", "info", folder]
        yield ["data", "convert", folder, "out.npz"]
    yield from (["data", *words.split()] for words in ("fly x", "info", "convert table.csv"))
    for out in ("out.xyz", "file.txt/out.npz", "/proc/nothing/out.npz", LONG + ".npz", ""):
        yield ["data", "convert", "table.csv", out]
    yield ["data", "info", "table.csv", "--format", "nothing"]
    yield ["data", "info", "table.csv", "out.npz"]
    yield from (
        ["learn", "table.csv", "--components", value] for value in ("0", "x", "-1", "9" * 99)
    )
    yield from (["learn", "table.csv", "--frames", value] for value in ("nose", "日本"))
    yield from (["learn", "table.csv", "--folder", folder] for folder in FOLDERS)
    for method in (
        "nowhere.py:f",
        "toy.py",
        "toy.py:nothing",
        "broken.py:f",
        ":",
        LONG,
        "leaves.py:f",
    ):
        yield ["compare", "--method", method]
    for option, value in (("seed", "-1"), ("workers", "0"), ("data", "nowhere"), ("data", "half")):
        yield ["compare", f"--{option}", value]
    yield from (["compare", "--quick", "--folder", folder] for folder in FOLDERS)
    yield from (["demo", word] for word in ("nothing", "日本", LONG, "../x", "--show"))
    yield from (["bench", word] for word in ("nothing", "日本", LONG, "--quick=5"))
    yield from (["--completion", *words] for words in ([], ["cmd"], ["bash", "zsh"], [LONG]))


ALL = list(lines())


@pytest.fixture
def place(tmp_path, monkeypatch, taught):
    """A folder with all kinds of things in it, which nobody may change."""
    toy = (Path(__file__).parents[1] / "study" / "toy.py").read_bytes()
    (tmp_path / "toy.py").write_bytes(toy)
    (tmp_path / "file.txt").write_text("words\n")
    (tmp_path / "table.csv").write_text("time,x\n0,1\n0.1,2\n0.2,4\n")
    (tmp_path / "broken.py").write_text("def study(:\n")
    (tmp_path / "leaves.py").write_text("raise SystemExit(0)\n")
    (tmp_path / "binary.py").write_bytes(b"\x00\xff\xfe")
    for folder in ("folder.py", "empty", "half"):
        (tmp_path / folder).mkdir()
    (tmp_path / "half" / "run.json").write_text('{"schema": 2')
    (tmp_path / "taught").symlink_to(taught)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    return tmp_path


def tree(folder):
    """What is there, and how large."""
    return {str(f.relative_to(folder)): f.lstat().st_size for f in folder.rglob("*")}


def refused(words, place, capsys):
    before = tree(place)
    capsys.readouterr()
    code = cli.main(words)
    out, err = capsys.readouterr()
    shown = [word[:60] for word in words]
    assert code in (1, 2), (shown, code)
    assert not out and "Traceback" not in err, (shown, err)
    assert 1 <= err.count("\n") <= 3 and err.startswith("tpsim: "), (shown, err)
    assert len(err) < 1000, (shown, len(err))
    assert tree(place) == before, shown


def test_a_sample_of_hostile_command_lines(place, capsys):
    for words in ALL[::9]:
        refused(words, place, capsys)


@pytest.mark.torture
def test_all_hostile_command_lines(place, capsys, monkeypatch):
    for number, words in enumerate(ALL):
        monkeypatch.setenv("COLUMNS", "40" if number % 2 else "120")
        refused(words, place, capsys)
    with capsys.disabled():
        print(f"\n{len(ALL)} hostile command lines refused")


@pytest.mark.torture
@pytest.mark.parametrize("locale", ["C", "POSIX"])
def test_hostile_command_lines_where_letters_are_missing(place, locale):
    plain = {"LC_ALL": locale, "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0", "COLUMNS": "40"}
    for words in chain(ALL[::60], [["run", "--help"], ["--help"], ["run", "tracking", "--help"]]):
        line = [sys.executable, "-B", "-m", "tpsim", *map(os.fsencode, words)]
        done = subprocess.run(line, capture_output=True, env={**os.environ, **plain})
        assert b"Traceback" not in done.stderr and done.stderr.count(b"\n") <= 3, words
        assert done.returncode == (0 if "--help" in words else done.returncode or 9)
        assert done.returncode in (0, 1, 2), words
