"""The command campaign, from a plan to a comparison."""

import json

import pytest

from tpsim.cli.main import main

from .conftest import TOY


@pytest.fixture
def run(capsys):
    """Exit code, and what one command line answers."""

    def run(*words):
        code = main(["campaign", *map(str, words)])
        said = capsys.readouterr()
        return code, said.out, said.err

    return run


PUSHED = ("--force", "1..2", "--push-duration", "0.1", "--effort", "0.1", "--trials", "2")


def test_from_a_plan_to_a_comparison(run, tmp_path):
    code, out, _ = run(TOY, *PUSHED, "--direction", "circle", "--plan", "--json")
    plan = json.loads(out)
    assert code == 0 and plan["fields"] == {"effort": 0.1}
    assert plan["pushes"]["force"] == {"low": 1.0, "high": 2.0}
    file = tmp_path / "mine.json"
    file.write_text(out)
    code, out, _ = run(file, "--out", tmp_path / "one", "--workers", 1, "--json")
    one = json.loads(out)
    keys = {"trials", "done", "failed", "digest", "simulated_seconds_per_second", "table", "paths"}
    assert code == 0 and keys <= one.keys() and one["done"] == 2
    words = (TOY, *PUSHED, "--direction", "circle", "--out", tmp_path / "two", "--workers", 1)
    code, out, _ = run(*words, "--json")
    assert json.loads(out)["digest"] == one["digest"]
    code, out, _ = run(tmp_path / "two", "--study", TOY, "--json")
    assert json.loads(out)["performed"] == 0
    code, out, _ = run(tmp_path / "two", "--status", "--json")
    assert json.loads(out)["cells"][0]["trials"] == 2
    code, out, _ = run("compare", tmp_path / "one", tmp_path / "two", "--json")
    assert json.loads(out)["identical"] == 2


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ((TOY,), "--out DIR"),
        ((TOY, "--out", "x", "--shard", "3/2"), "--shard 3/2: give i/n"),
        ((TOY, "--out", "x", "--force", "a"), "--force a: give numbers, or a range"),
        ((TOY, "--out", "x", "--sweep", "effort"), "--sweep effort: give field=1,2,3"),
        ((TOY, "--out", "x", "--sweep", "efort=1"), "no field of the task 'efort'"),
        ((TOY, "--out", "x", "--lead", "0.1", "--undisturbed"), "give one of them"),
        ((TOY, "--out", "x", "--force", "1", "--impulse", "1"), "both force and impulse"),
        ((TOY, "--out", "x", "--lead", "0.1", "--force", "1"), "--force and --lead"),
        ((TOY, "--out", "x", "--undisturbed", "--impulse", "1"), "--impulse and --undisturbed"),
        ((TOY, "--folder", "x", "--out", "x"), "a campaign's folder is --out"),
        (("nothing.json", "--out", "x"), "there is no file nothing.json"),
    ],
)
def test_slips_are_one_line(run, tmp_path, monkeypatch, words, says):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(*words)
    assert code in (1, 2) and out == ""
    assert says in err and err.count("\n") == 1
    assert not (tmp_path / "x").exists()
