"""Folders of strangers: every damage ends in one line, or is noticed; nothing hangs or grows.

A few run with the suite; ``pytest -m torture tests/torture -s`` runs thousands.
"""

import itertools
import json
import random
import shutil
from functools import partial

import numpy as np
import pytest

import tpsim
from tpsim.data import read
from tpsim.data.commands import info
from tpsim.deploy.policy import Policy
from tpsim.pose import Pose
from tpsim.section8.run import run as run_cells
from tpsim.study.files.run import load_run
from tpsim.study.replay import replay
from tpsim.study.teaching import demonstrations_of, models_of

from ..data.conftest import FILES
from . import containers, rehash, tamper
from .judge import judge

SAMPLE = pytest.param(False, id="sample")
ALL = pytest.param(True, id="all", marks=pytest.mark.torture)
EXTENT = pytest.mark.parametrize("extent", [SAMPLE, ALL])


@pytest.fixture
def try_all(tmp_path, request):
    """Judges as many cases as are asked for, drawn from all; fails with what went wrong."""

    def try_all(original, cases, use, extent, counts, silent=False):
        cases = list(cases)
        if not extent:
            cases = [(what, change) for what, change in cases if "bomb" not in what]
        # What is damaged was whole, or all would be refused and nothing tested.
        whole = shutil.copytree(original, tmp_path / "whole" / original.name)
        assert use(whole) == "as before"
        shutil.rmtree(tmp_path / "whole")
        chosen = random.Random(0).sample(cases, min(counts[extent], len(cases)))
        ledger = judge(original, chosen, use, tmp_path / "space", silent=silent)
        print(f"\n{request.node.name}: {ledger}, of {len(cases)} that there are")
        print("\n".join(ledger.failures), flush=True)
        assert ledger.failures == []
        assert not extent or ledger.counts["refused"] > ledger.counts.total() / 4
        return ledger

    return try_all


def use_run(folder, study, said=None):
    """Replay a run, and go on from it; the same values in other words of JSON are no damage."""
    run = load_run(folder)
    found = replay(run, study)
    if not found["repeats"]:
        assert found["verdict"].count("\n") == 0 and "bit for bit" not in found["verdict"]
        return "noticed"
    models_of(study, run)
    demonstrations_of(study, run)
    same = said is not None and json.loads((folder / "run.json").read_text()) == said
    return "in other words" if same and folder.parent.name != "whole" else "as before"


@EXTENT
def test_a_damaged_run_is_noticed(try_all, a_run, another_run, toy, extent):
    """Truncated, swapped, linked, gone: never replayed as if nothing were."""
    kept = [c for c in tamper.places(a_run) if not c[0].startswith("report.html")]
    swapped = [c for c in tamper.swaps(a_run, another_run) if "report.html" not in c[0]]
    said = [
        (f"run.json: {what}", lambda f, text=text: tamper.write(f / "run.json", text))
        for what, text in tamper.in_json((a_run / "run.json").read_text(), 60, 1)
    ]
    original = json.loads((a_run / "run.json").read_text())
    use = partial(use_run, study=toy.study, said=original)
    try_all(a_run, [*kept, *swapped, *said], use, extent, (8, 400))


@EXTENT
def test_a_run_whose_checksums_were_made_right(try_all, a_run, toy, extent):
    """Only what things mean is left to be checked."""
    use = partial(use_run, study=toy.study)
    try_all(a_run, rehash.cases(a_run), use, extent, (8, 400), silent=True)


def use_model(folder, name):
    """Load a model, and write it again."""
    before = folder.parent / "again.npz"
    value = tpsim.load(folder / name)
    tpsim.load(value.save(before))
    if isinstance(value, tpsim.TPGMM):
        size = value.frames[0].mean.shape[-1]
        value.adapt([tpsim.Frame(np.eye(size), np.zeros(size))] * len(value.frames))
    return "as before"


@EXTENT
def test_damaged_models_and_demonstrations(try_all, models, tmp_path, extent):
    for file in sorted(models.iterdir())[:: 1 if extent else 5]:
        alone = tmp_path / "alone" / file.stem
        alone.mkdir(parents=True)
        (alone / file.name).write_bytes(file.read_bytes())
        inside = [*tamper.in_archive(file), *(tamper.bombs(file) if file.stem == "GMM" else ())]
        cases = [
            (f"{file.name}: {what}", lambda f, name=file.name, change=change: change(f / name))
            for what, change in inside
        ]
        use = partial(use_model, name=file.name)
        try_all(alone, [*cases, *tamper.places(alone, 4)], use, extent, (3, 40), silent=True)


def use_policy(folder):
    """Load a policy, and ask it for torques."""
    policy = Policy.load(folder)
    q = policy.robot.home
    pose = Pose(np.eye(3), np.array([0.3, 0.3, 0.0]))
    torque = policy.command(q, 0 * q, dict.fromkeys(policy.objects, pose))
    assert np.isfinite(torque).all(), "torques that are no numbers"
    return "as before"


@EXTENT
def test_a_damaged_policy(try_all, policy, extent):
    said = (policy / "policy.json").read_text()
    cases = [
        (f"policy.json: {what}", lambda f, text=text: tamper.write(f / "policy.json", text))
        for what, text in tamper.in_json(said)
    ]
    for what, change in (
        *tamper.in_archive(policy / "arrays.npz"),
        *tamper.bombs(policy / "arrays.npz"),
    ):
        cases.append((f"arrays.npz: {what}", partial(rehash.of_policy, change=change)))
    used = ("policy.json", "arrays.npz")
    cases += [case for case in tamper.places(policy) if case[0].startswith(used)]
    try_all(policy, cases, use_policy, extent, (8, 400), silent=True)


@EXTENT
def test_damaged_results_of_a_comparison(try_all, cells, extent):
    first = sorted((cells.folder / "cells").iterdir())[0]
    before = {cell: trial.figures for cell, trial in _cells(cells, cells.folder).items()}

    def use(folder):
        for cell, trial in _cells(cells, folder).items():
            assert trial.figures.shape == before[cell].shape
        return "as before"

    cases = [
        (what, lambda f, change=change: change(f / "cells" / first.name))
        for what, change in (*tamper.in_archive(first), *tamper.bombs(first))
    ]
    cases += list(tamper.places(cells.folder, 6))
    try_all(cells.folder, cases, use, extent, (5, 150), silent=True)


def _cells(cells, folder):
    return run_cells(cells.plan, cells.methods, folder)


def use_data(folder, name):
    """Look at a file, and read it."""
    path = folder / name
    info(path)
    for one in read(path):
        assert np.isfinite(one.data).all()
    return "as before"


@EXTENT
@pytest.mark.parametrize("maker", FILES, ids=lambda maker: maker.__name__)
def test_damaged_recordings_of_others(try_all, tmp_path, maker, extent):
    folder = tmp_path / "original"
    folder.mkdir()
    path = maker(folder)
    cases = itertools.chain(tamper.places(folder, 10), containers.cases(path))
    use = partial(use_data, name=path.name)
    ledger = try_all(folder, cases, use, extent, (3, 60), silent=True)
    assert not extent or ledger.counts.total() >= 12
