"""Many teachers: figures of all their trials together, and for how many a limit holds."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from tpsim.errors import SimulationError
from tpsim.study import teachers
from tpsim.study.contest import Contest, Error
from tpsim.study.files.run import load_run
from tpsim.study.measure import Measure, most
from tpsim.study.running import run
from tpsim.study.study import Plan
from tpsim.study.teachers import run_teachers
from tpsim.world.people.push import Push


def reach(record):
    return 1e3 * np.linalg.norm(record["hand_position"] - record["hand_position"][0], axis=1)


REACH = Measure("reach_mm", of=reach, unit="mm", label="pushed", across=most, limit=50.0)


@pytest.fixture(scope="module")
def found(toy, tmp_path_factory):
    study = replace(toy, measures=[REACH], controllers={})
    folder = tmp_path_factory.mktemp("teachers") / "run"
    return study, run_teachers(study, Plan(4, 1, 2), 2, folder), folder


def trials(folder, seed):
    run = load_run(folder / f"teacher-{seed}")
    return [t for t in run.trials() if t.about["condition"]["label"] == "pushed"]


def test_every_teacher_has_a_run_of_its_own(found):
    _, answer, folder = found
    assert answer["teachers"] == 2 and answer["situations"] == 2
    assert [load_run(folder / f"teacher-{seed}").file.seed for seed in (4, 5)] == [4, 5]
    assert json.loads((folder / "teachers.json").read_text())["kept"] == answer["kept"]


def test_figures_are_those_of_all_trials_together(found):
    _, answer, folder = found
    numbers = [
        1e3 * np.linalg.norm(t["hand_position"] - t["hand_position"][0], axis=1).max()
        for seed in (4, 5)
        for t in trials(folder, seed)
    ]
    assert len(numbers) == 4 and min(numbers) < 50 < max(numbers)
    assert answer["figures"]["reach_mm"] == pytest.approx(np.percentile(numbers, 95))
    kept = sum(n <= 50 for n in numbers)
    row = answer["kept"]["reach_mm"]
    assert row["trials"] == 4 and row["kept"] == f"{25 * kept:.1f} %"
    # Wilson's interval for k of n.
    z, n, p = norm.ppf(0.975), 4, kept / 4
    middle = (p + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z * np.sqrt(p * (1 - p) / n + z**2 / (4 * n**2)) / (1 + z**2 / n)
    assert row["interval"] == f"{100 * (middle - half):.1f} to {100 * (middle + half):.1f} %"


def test_what_a_study_measures_itself_is_not_replaced_by_its_contest(toy, tmp_path):
    """A contest looks at some of the trials, and may define an error in another way."""
    error = Error("gap", lambda record: 7.0 + 0 * reach(record), "mm", 1.0)
    push = Push("tip", (3.0, 0.0, 0.0), 0.05, 0.1)
    contest = Contest([error], lambda task, situation, rng: [push], situations=1)
    mine = replace(REACH, name="gap_p95_mm")
    study = replace(toy, measures=[mine], controllers={}, contest=contest)
    seen = {}
    answer = run(
        study,
        Plan(4, 1, 1),
        tmp_path / "run",
        video=False,
        look=lambda lab, records, results: seen.update({r.name: r.value for r in results}),
    )
    assert answer["figures"]["gap_p95_mm"] == seen["gap_p95_mm"] != 7.0
    assert answer["figures"]["dominated_by"] == []


def test_a_teacher_who_fails_is_counted_and_does_not_end_the_others(toy, tmp_path, monkeypatch):
    whole = teachers.run

    def failing(study, plan, *others, **more):
        if plan.seed == 5:
            raise SimulationError("only 5 of 6 demonstrations were good")
        return whole(study, plan, *others, **more)

    monkeypatch.setattr(teachers, "run", failing)
    study = replace(toy, measures=[REACH], controllers={})
    answer = run_teachers(study, Plan(4, 1, 1), 3, tmp_path / "run")
    assert answer["failed"] == [{"seed": 5, "why": "only 5 of 6 demonstrations were good"}]
    assert "the teacher of seed 5 failed" in answer["missed"]
    assert answer["kept"]["reach_mm"]["worst teacher"].endswith(("(seed 4)", "(seed 6)"))
    assert "The teacher of seed 5 failed: only 5 of 6" in (tmp_path / "run/report.html").read_text()
    with pytest.raises(SimulationError, match="only 5 of 6"):
        run_teachers(study, Plan(5, 1, 1), 1, tmp_path / "other")
