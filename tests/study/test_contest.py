"""Experts, how they are tuned, and how they and what was learned are compared."""

import json
from dataclasses import replace

import numpy as np
import pytest

from tpsim.controllers.renewed import FixedImpedance
from tpsim.errors import ArgumentError, RecordingError
from tpsim.robot.views.sites import Object, Site
from tpsim.study import fronts
from tpsim.study.condition import Lead
from tpsim.study.contest import Contest, Error
from tpsim.study.executor import perform_all
from tpsim.study.expert import Expert, Range, tuned
from tpsim.study.pareto import least_that_yields, pareto
from tpsim.study.record import Records
from tpsim.study.study import Lab, Plan
from tpsim.study.tuning import about, hypercube, tune
from tpsim.world.people.push import Push

GAP = Site("tip").seen_from(Object("mark")).position


def gap(record):
    return 1e3 * np.linalg.norm(record.see(GAP), axis=1)


def held(world, situation, gains):
    return FixedImpedance(np.array(situation.start), gains["joints"])


def pushes(task, situation, rng):
    force = 5 * rng.standard_normal(2)
    return [Push("tip", (*(sign * force).tolist(), 0.0), 0.05, 0.2) for sign in (1, -1)]


def lead(task, situation, rng):
    return Lead("tip", (0, 0, 0), (0.02, 0.0, 0.0), 0.1, 0.15, 0.05, stiffness=4000.0)


EXPERT = Expert({"joints": Range(20.0, 2000.0, "1/s^2")}, held)


@pytest.fixture(scope="module")
def study(toy, tmp_path_factory):
    experts = {"soft hand": replace(EXPERT, gains={"joints": 60.0}), "stiff hand": EXPERT}
    contest = Contest(
        [Error("gap", gap, "mm", 10.0, "Gap")],
        pushes,
        lead,
        experts,
        gains=tmp_path_factory.mktemp("gains") / "gains.json",
        yielding=5.0,
        situations=2,
        tuning_situations=1,
    )
    return replace(toy, controllers={}, contest=contest)


@pytest.fixture(scope="module")
def records(study, models):
    found = Records(study.task, models)
    phases = study.contest.conditions(Lab(study, models), Plan(situations=2))
    conditions = next(phases)
    while True:
        for condition, trial in zip(
            conditions, perform_all(study, models, conditions), strict=True
        ):
            found.add(condition, trial)
        try:
            conditions = phases.send(found)
        except StopIteration:
            return found


def test_a_point_is_dominated_by_those_that_are_nowhere_worse_and_somewhere_better():
    rng = np.random.default_rng(0)
    points = {str(k): rng.integers(0, 4, 3).astype(float) for k in range(40)}
    found = pareto(points)
    for name, mine in points.items():
        by = {o for o, its in points.items() if all(its <= mine) and any(its < mine)}
        assert set(found[name]) == by
    # Whoever is dominated is so by one of the front.
    front = {name for name, by in found.items() if not by}
    assert all(front & set(by) for by in found.values() if by)


def test_what_was_not_measured_is_the_worst():
    found = pareto({"one": [1.0, np.nan], "other": [1.0, 5.0], "like": [1.0, 5.0]})
    assert found == {"one": ["other", "like"], "other": [], "like": []}
    with pytest.raises(ArgumentError, match=r"\[2, 1\] costs"):
        pareto({"one": [1.0, 2.0], "other": [1.0]})


def test_of_those_that_yield_enough_the_least_error_wins():
    assert least_that_yields([3.0, 2.0, 1.0], [50.0, 40.0, 10.0], 40.0) == 1
    assert least_that_yields([3.0, 2.0, 1.0], [50.0, 40.0, 10.0], 60.0) == 0


def test_gains_are_a_latin_hypercube_on_a_logarithmic_scale():
    ranges = {"k": Range(1.0, 1000.0), "ratio": Range(0.5, 2.0)}
    sets = hypercube(ranges, 16, 3)
    assert sets == hypercube(ranges, 16, 3) != hypercube(ranges, 16, 4)
    for name, one in ranges.items():
        share = np.log([s[name] / one.low for s in sets]) / np.log(one.high / one.low)
        # One in each stratum, but for the rounding to three digits.
        np.testing.assert_allclose(np.sort(share) * 16, np.arange(16) + 0.5, atol=0.52)
    near = about({"k": 900.0, "ratio": 1.0}, ranges, 1 / 3)
    assert near["k"].high == 1000.0 and near["k"].low == pytest.approx(900 / 1000 ** (1 / 6))
    assert near["ratio"].high / near["ratio"].low == pytest.approx(4 ** (1 / 3))


def test_all_controllers_meet_the_same_pushes_and_leads(study, records):
    names = set(study.performers)
    assert {"learned", "soft hand", "stiff hand", "learned, effort 0.2"} <= names
    for label in ("contest", "contest pushed", "contest led"):
        chosen = records.select(label, None)
        assert {record.condition.controller for record in chosen} == names
    met = {
        name: [
            (r.condition.situation, r.condition.push)
            for r in records.select("contest pushed", name)
        ]
        for name in names
    }
    assert all(one == met["learned"] for one in met.values()) and len(met["learned"]) == 4


def test_figures_are_those_of_the_time_of_the_push(study, records):
    point = study.contest.standing(records).points["soft hand"]
    largest, moved = [], []
    for record in records.select("contest pushed", "soft hand"):
        pushed = np.any(record["push_wrench"], axis=1)
        largest.append(gap(record)[pushed].max())
        twin = record.beside("contest")
        way = np.linalg.norm(record["hand_position"] - twin["hand_position"], axis=1)
        moved.append(1e3 * way[pushed].max())
    assert point["gap_max_mm"] == pytest.approx(max(largest))
    assert point["gap_p95_mm"] == pytest.approx(np.percentile(largest, 95))
    assert point["displacement_mean_mm"] == pytest.approx(np.mean(moved))


def test_a_trial_that_one_controller_missed_counts_for_none(study, records):
    fewer = Records(study.task, records.models)
    dropped = records.select("contest pushed", "soft hand")[-1]
    for record in records:
        if record is not dropped:
            fewer.add(record.condition, record.trial)
    points = study.contest.standing(fewer).points
    assert {point["pushes"] for point in points.values()} == {3}


def test_the_force_is_that_of_the_same_way(study, records):
    points = study.contest.standing(records).points
    soft, stiff = (points[f"{name} hand"] for name in ("soft", "stiff"))
    assert 1.5 * soft["lead_force_mean_N"] < stiff["lead_force_mean_N"]
    assert 18 < soft["lead_way_mm"] < 22


def test_the_answer_names_who_dominates_what_was_learned(study, records):
    standing = study.contest.standing(records)
    answer = standing.answer
    assert set(answer["experts"]) == {"soft hand", "stiff hand"}
    assert answer["gap_p95_mm"] == standing.points["learned"]["gap_p95_mm"]
    costs = {
        n: (p["gap_p95_mm"], -p["displacement_mean_mm"], p["contacts"])
        for n, p in standing.points.items()
    }
    by = [n for n in pareto(costs)["learned"] if not n.startswith("learned")]
    assert answer["dominated_by"] == by
    (section,) = fronts.sections(study.contest, records)
    assert len(section.pictures) == 2 and len(section.table) == len(standing.points)


def test_a_lead_off_a_way_that_moves_by_itself(toy):
    still = Lead("tip", (0.1, 0.0, 0.0), (0.0, 0.03, 0.0), 0.1, 0.2, 0.1)
    times = np.arange(31) * 0.01
    way = np.column_stack([0.1 + 0.5 * times, 0 * times, 0 * times])
    moving = replace(still, carried=tuple(map(tuple, way.tolist())))
    simulation = toy.task.stage.simulation()
    one, other = (lead.bind(simulation)._guide.path for lead in (still, moving))
    h = simulation.timestep
    np.testing.assert_allclose(
        (other.position - one.position)[:, 0], 0.5 * h * (1 + np.arange(len(one))), atol=1e-12
    )
    np.testing.assert_allclose((other.velocity - one.velocity)[:, 0], 0.5, atol=1e-9)


def test_tuning_finds_the_least_error_that_yields_enough_and_repeats(study, toy):
    file = study.contest.gains
    answer = tune(study, trials=6)
    first = file.read_text()
    found = json.loads(first)["experts"]["stiff hand"]
    assert found["figures"]["displacement_mean_mm"] >= 5.0
    assert found["gains"] == {"joints": answer["experts"]["stiff hand"]["joints"]}
    errors, yields = (np.array([one[k] for one in found["front"]]) for k in ("error", "yield_mm"))
    # Along a front more yield costs more error.
    assert (np.diff(errors) > 0).all() and (np.diff(yields) > 0).all()
    best = found["figures"]["gap_p95_mm"] / 10.0
    assert best == pytest.approx(errors[yields >= 5.0].min())
    tune(study, trials=6, workers=2)
    assert file.read_text() == first
    again = tuned({"stiff hand": EXPERT}, file)["stiff hand"]
    assert again.gains == found["gains"]
    more = yields >= 1.25 * found["figures"]["displacement_mean_mm"]
    assert again.softer == found["front"][int(np.argmax(more))]["gains"]


def test_bad_asking_is_refused(study, toy, tmp_path):
    with pytest.raises(ArgumentError, match="no experts to tune"):
        tune(toy)
    with pytest.raises(ArgumentError, match="seed 3 is one of the comparisons'"):
        tune(study, seed=3)
    with pytest.raises(ArgumentError, match="no gain elbow in the ranges of"):
        replace(EXPERT, gains={"elbow": 1.0})
    with pytest.raises(ArgumentError, match="0 < low <= high"):
        Range(3.0, 2.0)
    file = tmp_path / "gains.json"
    assert tuned({"one": EXPERT}, file)["one"].gains == {"joints": EXPERT.ranges["joints"].middle}
    file.write_text('{"experts": {"one": 3}}')
    with pytest.raises(RecordingError, match=r"gains.json: no gains of these experts"):
        tuned({"one": EXPERT}, file)
