"""What is retrieved, carried out on an arm: the map to its world, figures, failures, files."""

import csv
import json

import numpy as np
import pytest

from tpsim import Gaussian
from tpsim.cli.main import main
from tpsim.errors import ArgumentError
from tpsim.section8 import METHODS, closed_loop, compare
from tpsim.section8.arms import ARMS, SCALE
from tpsim.section8.closed_loop import FIGURES, STEADY, SURE, measure_on, on_the_arm
from tpsim.section8.plan import Plan
from tpsim.section8.results import Results
from tpsim.section8.tables import closed_loop_table
from tpsim.section8.trial import Trial

ARM = ARMS["planar arm"]
SMALL = {"planar arm": Plan(("planar arm",), (2,), (0,), (1.0, 4.0), situations=1, samples=40)}


def raises(demonstrations):
    raise RuntimeError("no idea how")


def lost(demonstrations):
    return lambda frames: np.full((40, 2), np.nan)


@pytest.fixture(scope="module")
def situation():
    return ARM.situations(1, 1.0, 60, 0)[0]


def test_movements_are_laid_into_the_arms_world(situation):
    rng, steps = np.random.default_rng(0), 60
    root = rng.normal(size=(steps, 2, 2))
    path = Gaussian(situation.truth.data, root @ root.mT + np.eye(2))
    there = on_the_arm(ARM, path, situation)
    np.testing.assert_allclose(there.mean[:, :2], SCALE * path.mean + ARM.middle)
    inside = SCALE**2 * path.covariance + SURE**2 * np.eye(2)
    np.testing.assert_allclose(there.covariance[:, :2, :2], inside)
    plain = on_the_arm(ARM, path.mean, situation)
    np.testing.assert_array_equal(plain.covariance[3], STEADY**2 * np.eye(3))
    for bad, words in ((path.mean[:5], "asks for"), (np.nan * path.mean, "NaN")):
        with pytest.raises(ArgumentError, match=words):
            on_the_arm(ARM, bad, situation)


@pytest.mark.parametrize("name", ARMS)
def test_an_arm_is_the_joints_that_move_its_hand(name):
    arm, robot = ARMS[name], ARMS[name].world.robot
    columns = zip(robot.joints, robot.at_home.jacobian(arm.site).T, strict=True)
    assert {joint for joint, column in columns if column.any()} == set(arm.joints)


def test_the_arm_starts_where_the_teacher_does(situation):
    hand = ARM.world.robot.at(situation.start).pose(ARM.site).position
    np.testing.assert_allclose(hand, ARM.place.to_common(situation.truth.data[0]), atol=1e-6)


def test_the_teachers_own_movement_is_followed_and_a_push_gives_way(situation):
    figures = measure_on(ARM, situation.truth.data, situation)
    assert figures["rms"] <= figures["tracking"] + 0.5  # nearest points, as far apart as samples
    assert figures["tracking"] < 3.0 and figures["end"] < 0.5 and figures["end_pushed"] < 0.5
    assert 1.0 < figures["yield"] < 50.0
    assert figures["diverged"] == 0


def test_what_is_uncertain_is_softer(situation):
    """Stiffness is the root of precision over effort: a push moves the hand farther."""
    x, ones = situation.truth.data, np.tile(np.eye(2), (60, 1, 1))
    sure, unsure = (
        measure_on(ARM, Gaussian(x, (deviation / SCALE) ** 2 * ones), situation)["yield"]
        for deviation in (0.01, 0.1)
    )
    assert unsure > 3 * sure


def test_refusals_and_divergences_are_counted():
    figures = np.zeros((2, 2, len(FIGURES)))
    figures[0, 1] = np.nan  # refused
    figures[1, 0, :-1], figures[1, 0, -1] = np.nan, 1.0  # diverged
    trial = Trial(("a", "b"), figures, *np.zeros((3, 2)), ("no idea how", ""))
    results = Results(SMALL["planar arm"], {("planar arm", 2, 0): trial}, FIGURES)
    counted = [(row["refused"], row["diverged"]) for row in closed_loop_table(results)]
    assert counted == [("1", "0"), ("0", "1")]


def test_it_stands_beside_the_open_loop_and_goes_on_where_it_was_cut_off(tmp_path, monkeypatch):
    methods = {"TP-GMR diagonal": METHODS["TP-GMR diagonal"], "raises": raises, "lost": lost}
    plan = Plan(("transfer",), (2,), (0,), (1.0,), situations=2, samples=20)
    result = compare(methods, plan, folder=tmp_path, arms=SMALL)
    figures = result["closed_loop"]["planar arm"]
    assert 0 < figures["TP-GMR diagonal"]["rms"] < 100
    assert figures["raises"]["reason"] == "no idea how"
    assert "NaN" in figures["lost"]["reason"]
    rows = list(csv.DictReader((tmp_path / "comparison.csv").open()))
    arm = [row for row in rows if row["family"] == "planar arm"]
    assert len(arm) == 2 * len(methods) * len(FIGURES)
    assert "planar arm" in json.loads((tmp_path / "comparison.json").read_text())["closed_loop"]
    assert (tmp_path / "comparison.tex").read_text().count(r"\begin{tabular}") == 2
    assert "Closed loop: planar arm" in (tmp_path / "report.html").read_text()
    assert (tmp_path / "closed-loop.png").is_file()
    monkeypatch.setattr(closed_loop, "perform_on", None)
    again = compare(methods, plan, folder=tmp_path, arms=SMALL)
    assert again["closed_loop"]["planar arm"]["TP-GMR diagonal"] == figures["TP-GMR diagonal"]


def test_other_peoples_data_has_no_teacher_to_ask(tmp_path, capsys):
    assert main(["compare", "--data", str(tmp_path), "--closed-loop"]) == 2
    assert "--closed-loop needs a teacher" in capsys.readouterr().err
