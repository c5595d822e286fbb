"""The gallery: names, results, and what it says where something is wrong."""

import subprocess
import sys
from pathlib import Path

import pytest

from tpsim import gallery
from tpsim.errors import ArgumentError, TpsimError
from tpsim.gallery import Bounded, within

SCRIPT = '''"""demo_one: a title
of two lines.

Look for: a line,
and where it ends.
"""
from _helper import VALUE

from tpsim.gallery import present, within


def main():
    return {"inside": within(VALUE, 0, 2, "two halves"), "above": within(VALUE, -9, 0.5, "low")}


def draw(figure):
    figure.add_subplot().plot([0, VALUE])


if __name__ == "__main__":
    present(__file__, main, draw)
'''


@pytest.fixture
def demos(tmp_path, monkeypatch):
    folder = tmp_path / "demos"
    folder.mkdir()
    monkeypatch.setattr(gallery.paths, "DEMOS", folder)
    monkeypatch.setattr(gallery, "folder", lambda: tmp_path / "pictures")
    (folder / "_helper.py").write_text("VALUE = 1.0\n")
    (folder / "demo_one.py").write_text(SCRIPT)
    yield folder
    sys.modules.pop("_helper", None)


def test_a_result_has_figures_with_bounds_and_a_picture(demos, tmp_path):
    result = gallery.run("demo_one")
    assert (result["name"], result["row"]) == ("demo_one", "a title of two lines")
    assert result["look_for"] == "a line, and where it ends."
    inside, above = result["figures"]
    assert inside == {
        "figure": "inside",
        "value": 1.0,
        "least": 0.0,
        "greatest": 2.0,
        "holds": True,
        "reason": "two halves",
    }
    assert not above["holds"]
    assert result["picture"] == str(tmp_path / "pictures" / "demo_one.png")
    assert gallery.brief(result)["out_of_bounds"] == "above"
    assert str(demos) not in sys.path


def test_all_rows_in_the_order_of_table_2(demos, tmp_path):
    for name in ("figure03", "benchmark_DS_x01", "demo_Two"):
        (demos / f"{name}.py").write_text(SCRIPT.replace("demo_one", name))
    said = []
    results = gallery.run_all(tmp_path / "all", progress=said.append)
    names = [result["name"] for result in results]
    assert names == said == ["demo_one", "demo_Two", "benchmark_DS_x01", "figure03"]
    assert sorted(path.stem for path in (tmp_path / "all").iterdir()) == sorted(names)


def test_a_script_runs_by_itself(demos):
    done = subprocess.run(
        [sys.executable, str(demos / "demo_one.py")], capture_output=True, text=True, cwd=demos
    )
    assert done.returncode == 0, done.stderr
    assert "inside  1           0 to 2\n" in done.stdout
    assert "OUTSIDE" in done.stdout
    picture = Path(done.stdout.strip().splitlines()[-1].removeprefix("picture: "))
    assert picture.name == "demo_one.png" and picture.is_file()
    picture.unlink()


@pytest.mark.parametrize(
    ("given", "near"),
    [("demo_on", "'demo_one'"), ("DEMO_ONE", "'demo_one'"), ("one", "'demo_one'"), ("x", "lists")],
)
def test_an_unknown_name_gets_the_nearest_ones(demos, given, near):
    with pytest.raises(ArgumentError, match=f"unknown demo '{given}'.*{near}"):
        gallery.run(given)


@pytest.mark.parametrize("missing", ["main", "draw"])
def test_a_script_without_its_functions_is_named(demos, missing):
    (demos / "demo_one.py").write_text(SCRIPT.replace(f"def {missing}", "def other"))
    with pytest.raises(TpsimError, match=rf"demo_one.py has no function {missing}\(\)"):
        gallery.run("demo_one")


def test_a_window_needs_a_display(demos, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "agg")
    from matplotlib import pyplot

    monkeypatch.setattr(pyplot, "get_backend", lambda: "agg")
    with pytest.raises(ArgumentError, match="--show needs a display"):
        gallery.run("demo_one", show=True)


def test_nothing_holds_a_number_that_is_none():
    assert not within(float("nan"), 0, 1, "any").holds
    assert Bounded(1.0, 1.0, 1.0, "exact").holds
