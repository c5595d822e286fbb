"""The page on your own recordings: its Python runs, its tables name what there is."""

import re
from pathlib import Path

import numpy as np
import pytest

import tpsim.data
from tpsim.data import reading

PAGE = (Path(__file__).parents[2] / "docs" / "your-recordings.md").read_text()


def test_the_python_of_the_page_runs(tmp_path, monkeypatch):
    for package in ("h5py", "mcap", "pyarrow"):
        pytest.importorskip(package)
    rng = np.random.default_rng(0)
    (tmp_path / "reach").mkdir()
    for n in range(3):
        time = np.linspace(0, 2, 150)
        way = np.outer(3 * (time / 2) ** 2 - 2 * (time / 2) ** 3, rng.normal(size=3))
        box = np.tile(way[-1], (150, 1))
        table = np.column_stack([time, way + 0.001 * rng.normal(size=way.shape), box])
        names = "time,x,y,z,box_x,box_y,box_z"
        np.savetxt(tmp_path / f"reach/{n}.csv", table, delimiter=",", header=names, comments="")
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for code in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(code, names)
    assert names["model"].components == 5
    assert {p.name for p in (tmp_path / "out").iterdir()} == {
        "reach.csv", "reach.mcap", "reach.hdf5", "reach"
    }  # fmt: skip


def test_functions_that_the_page_names_are_public():
    named = set(re.findall(r"^\| `(\w+)\(", PAGE, re.MULTILINE))
    assert named == {"trimmed", "resampled", "smoothed", "segmented", "aligned"}
    assert all(hasattr(tpsim.data, name) for name in named)


def test_endings_that_the_page_names_are_read():
    table = PAGE[PAGE.index("## Nine formats") : PAGE.index("## What the file")]
    endings = {e for cell in re.findall(r"`(\.[^`]*)`", table) for e in cell.split()}
    assert {e for e in endings if re.fullmatch(r"\.\w+", e)} <= set(reading._SUFFIXES)
