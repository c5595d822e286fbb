"""Signals at random moments: nobody is left behind, nothing is half, lost or doubled.

A sample runs by default; ``pytest -m torture`` sends 200. What is kept or done again is compared
byte for byte with what an undisturbed command writes in one process.
"""

import os
import shutil
import signal
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="it looks into /proc")

HOW = ("SIGINT", "SIGINT again", "SIGTERM", "SIGHUP", "SIGKILL")
KILLS = int(os.environ.get("TPSIM_KILLS", "200"))
AFRESH = 5
"""One command in so many starts Python afresh; the others are forked with all imported."""

AGAIN = 8
"""After every so many signals the command is done again, undisturbed, and compared."""


@pytest.fixture(scope="session")
def lines(taught, tmp_path_factory):
    """Command lines by name; OUT is where they write."""
    toy = str(Path(__file__).parents[1] / "study" / "toy.py") + ":study"
    few = ["--situations", "3", "--pushes", "1", "--no-video"]
    pushes = ["--trials", "52", "--push-duration", "0.1", "--keep", "everything"]
    table = tmp_path_factory.mktemp("table") / "table.csv"
    rows = [f"{0.01 * i},{0.1 * i},{i % 7}" for i in range(60_000)]
    table.write_text("time,x,y\n" + "\n".join(rows) + "\n")
    given = ["--demonstrations", str(taught)]
    return {
        "run": ["run", toy, *few, "--workers", "2", "--folder", "OUT"],
        "run alone": ["run", toy, *few, "--workers", "1", "--folder", "OUT"],
        "campaign": ["campaign", toy, *pushes, "--workers", "2", "--out", "OUT"],
        "campaign alone": ["campaign", toy, *pushes, "--workers", "1", "--out", "OUT"],
        "teach": ["teach", toy, "--folder", "OUT"],
        "learn": ["learn", toy, *given, "--folder", "OUT"],
        "reproduce": ["reproduce", toy, *given, "--folder", "OUT"],
        "push": ["push", toy, *given, "--start", "0.1", "--duration", "0.1", "--folder", "OUT"],
        "data": ["data", "convert", str(table), "OUT/converted.npz"],
    }


@pytest.fixture(scope="session")
def undisturbed(lines, tmp_path_factory):
    """Contents and duration of every command, in one process and left alone; made when asked."""
    known = {}

    def of(name, torture, forks=None):
        """Contents of one in one process; duration of one that is started in the same way."""
        if (name, forks) not in known:
            folder = tmp_path_factory.mktemp("undisturbed")
            serial = lines.get(f"{name} alone", lines[name])
            began = time.monotonic()
            command = torture.Command(serial, folder, forks)
            assert command.wait() == 0, command.lines
            # With workers it takes longer: they start afresh.
            took = (time.monotonic() - began) * (2 if f"{name} alone" in lines else 1)
            known[name, forks] = torture.contents(folder / "OUT"), took
            assert known[name, forks][0]
        return known[name, forks]

    return of


def strike(torture, lines, undisturbed, name, how, rng, folder, forks=None):
    """Disturb a command once and look at what it leaves; return whether it was reached."""
    wanted, duration = undisturbed(name, torture, forks)
    out = folder / "OUT"
    shutil.rmtree(out, ignore_errors=True)
    command = torture.Command(lines[name], folder, forks)
    # Python itself needs a moment until it can listen.
    first = 0.15 if forks is None else 0.02
    # Workers are there after a while, and gone before the end: one is waited for.
    last = 0.3 if how == "worker" else 1.1
    reached = torture.disturb(command, how, rng.uniform(first, last * duration), rng)
    asked = time.monotonic()
    code = command.wait()
    took = time.monotonic() - asked
    assert command.orphans() == []
    said = command.lines
    name_of = how.split()[0]
    # In its last milliseconds, when all is done, Python listens no more.
    late = how != "worker" and code == -getattr(signal, name_of) and torture.contents(out) == wanted
    answered = late or code in (0, torture.CODES.get(name_of))
    assert answered, (name, how, code, said)
    if code:
        assert len(said) <= 3 and not any("Traceback" in line for line in said), said
        assert how != "SIGINT again" or took < 1.5, took
    kept = torture.contents(out)
    assert kept.items() <= wanted.items()
    if code == 0:
        assert kept == wanted
    hidden = [file for file in folder.rglob(".*.part*")]
    assert how in ("SIGKILL", "worker") or not hidden, hidden
    return reached and (code != 0 or how == "worker")


def again(torture, lines, undisturbed, name, folder, forks):
    """The same command, undisturbed, into the same place where it is free."""
    out = folder / "OUT"
    if name in ("run", "run alone", "reproduce", "push") and out.exists():
        # A run is never overwritten: it says so in a line, and starts in another folder.
        command = torture.Command(lines[name], folder, forks)
        assert command.wait() == 1 and len(command.lines) == 1, command.lines
        shutil.rmtree(out)
    command = torture.Command(lines[name], folder, forks)
    code = command.wait()
    if name in ("teach", "learn", "data") and code == 1:  # it was finished before the signal came
        assert "exist" in command.lines[0]
    else:
        assert code == 0, command.lines
    assert torture.contents(out) == undisturbed(name, torture, forks)[0]
    assert not list(folder.rglob(".*.part*"))


@pytest.mark.parametrize(
    ("name", "how"), [("run", "worker"), ("teach", "SIGKILL"), ("campaign", "SIGTERM")]
)
def test_a_sample(torture, lines, undisturbed, rng, tmp_path, forks, name, how):
    # A signal that comes when all is done shows nothing.
    given = torture, lines, undisturbed, name, how, rng, tmp_path, forks
    assert any(strike(*given) for _ in range(5))
    if how != "worker":
        again(torture, lines, undisturbed, name, tmp_path, forks)


@pytest.mark.torture
def test_signals_at_random_moments(torture, lines, undisturbed, rng, tmp_path, forks, capsys):
    names, reached, done = list(lines), {}, 0
    while done < KILLS:
        name = rng.choice([*names, "run", "campaign"])
        how = rng.choice([*HOW, "worker"] if f"{name} alone" in lines else HOW)
        # One in so many starts afresh: while Python imports, signals are heard as well.
        given = None if rng.random() < 1 / AFRESH else forks
        if strike(torture, lines, undisturbed, name, how, rng, tmp_path, given):
            done += 1
            key = name, how, "afresh" if given is None else "forked"
            reached[key] = reached.get(key, 0) + 1
            if done % AGAIN == 0 and how != "worker":
                again(torture, lines, undisturbed, name, tmp_path, forks)
            if done % 10 == 0:
                with capsys.disabled():
                    print(f"{done} of {KILLS}", flush=True)
    with capsys.disabled():
        print("\nsignals that reached a command, by command and signal:")
        for (name, how, start), count in sorted(reached.items()):
            print(f"  {name:<10} {how:<13} {start} {count}")


@pytest.mark.torture
def test_a_comparison_goes_on_where_it_was_ended(torture, rng, tmp_path):
    line = ["compare", "--quick", "--workers", "2", "--folder", "OUT"]
    for how in ("SIGINT", "SIGKILL", "SIGTERM", "worker"):
        command = torture.Command(line, tmp_path)
        torture.disturb(command, how, rng.uniform(3.0, 12.0), rng)
        code = command.wait()
        assert command.orphans() == []
        if how != "worker":
            assert code in (0, torture.CODES[how]) and len(command.lines) <= 3, command.lines
        cells = {file.name for file in (tmp_path / "OUT" / "cells").glob("*.npz")}
    assert code == 0 and cells
    assert not list(tmp_path.rglob(".*.part*"))
