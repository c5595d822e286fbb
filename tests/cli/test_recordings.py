"""The commands about people's own recordings: what a file holds, conversion, learning from it."""

import json

import numpy as np
import pytest

from tpsim.cli import main as cli


@pytest.fixture
def reaches(tmp_path):
    """Four reaches from anywhere to a cup, as CSV files."""
    rng, time = np.random.default_rng(0), np.linspace(0, 3, 100)
    share = (time / 3) ** 3 * (10 - 15 * time / 3 + 6 * (time / 3) ** 2)
    for k in range(4):
        start, cup = rng.uniform(-0.1, 0.1, 2), rng.uniform(0.3, 0.6, 2)
        hand = start + share[:, None] * (cup - start)
        table = np.column_stack([time, hand, 0 * time, np.tile([*cup, 0.0], (100, 1))])
        head = "time,hand_x,hand_y,hand_z,cup_x,cup_y,cup_z"
        np.savetxt(tmp_path / f"reach{k}.csv", table, delimiter=",", header=head, comments="")
    return tmp_path


def run(capsys, *words):
    code = cli.main([*map(str, words), "--json"])
    out, err = capsys.readouterr()
    return code, out, err


def test_a_file_is_described_and_converted(reaches, capsys):
    code, out, _ = run(capsys, "data", "info", reaches / "reach0.csv")
    assert code == 0
    assert json.loads(out)["poses"] == ["hand", "cup"]
    code, out, _ = run(capsys, "data", "convert", reaches / "reach0.csv", reaches / "out.csv")
    assert code == 0 and (reaches / "out.csv").is_file()


def test_learning_from_files_ends_in_a_model_and_a_picture(reaches, capsys):
    out_folder = reaches / "learned"
    code, out, err = run(capsys, "learn", reaches, "--frames", "cup", "--folder", out_folder)
    assert code == 0, err
    assert json.loads(out)["demonstrations"] == 4
    assert {"model.npz", "learned.png"} <= {path.name for path in out_folder.iterdir()}


@pytest.mark.parametrize(
    "words",
    [("data", "info", "nothing.csv"), ("learn", "nothing.csv"), ("data", "convert", "a.csv")],
)
def test_what_cannot_be_done_is_one_line(capsys, words):
    code, out, err = run(capsys, *words)
    assert code in (1, 2) and out == ""
    assert err.count("\n") == 1 and err.startswith("tpsim: ")
