"""The command play: what is wrong is one line, and Ctrl-C is its ordinary end."""

import os
import re
import signal
import subprocess
import sys

import pytest

from tpsim.cli.main import main
from tpsim.cli.parse import parse
from tpsim.cli.play import Play, Watch


def test_a_folder_or_plane_is_watched_and_a_task_is_played(tmp_path):
    (tmp_path / "run.json").write_text("{}")
    for words in (["plane"], [str(tmp_path)]):
        assert isinstance(parse(["play", *words]).options, Watch)
    assert isinstance(parse(["play", "pointing", "--port", "0"]).options, Play)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["plane", "--port", "70000"], "--port 70000: give a number from 0 to 65535"),
        (["nothing"], "there is no study 'nothing'"),
        (["pointing", "--seed", "-1"], "--seed -1"),
    ],
)
def test_what_is_wrong_is_one_line(words, said, capsys):
    assert main(["play", *words]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert said in lines[0]


def test_a_broken_folder_is_one_line(tmp_path, capsys):
    (tmp_path / "run.json").write_text("{}")
    assert main(["play", str(tmp_path), "--port", "0"]) == 1
    assert "run.json" in capsys.readouterr().err


def test_ctrl_c_is_the_ordinary_end():
    pytest.importorskip("viser")
    command = [sys.executable, "-m", "tpsim", "play", "plane", "--port", "0"]
    # Shells start what runs in the background deaf to SIGINT.
    deaf = signal.signal(signal.SIGINT, signal.default_int_handler)
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env={**os.environ}
    )
    signal.signal(signal.SIGINT, deaf)
    try:
        line = process.stderr.readline()
        assert re.search(r"open http://127\.0\.0\.1:\d+ in a browser", line)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 0, err
    assert "Traceback" not in err
    assert "plane" in out
