"""What a report says is what was put into the trials."""

import time

import numpy as np
import pyarrow
import pytest
from scipy.stats import binomtest

from tpsim.campaign import report
from tpsim.campaign.compare import compare
from tpsim.campaign.pictures import compliance, force_displacement
from tpsim.campaign.rows import Rows
from tpsim.campaign.statistics import clusters, explained, mean, paired, share, wilson
from tpsim.errors import ArgumentError, RecordingError


def trials(count, seed=0):
    """Trials of two controllers: one errs 2 more, and fails under strong late pushes."""
    rng = np.random.default_rng(seed)
    point = np.repeat(np.arange(count // 2), 2)
    force = rng.uniform(5, 30, count // 2)[point]
    onset = rng.uniform(0, 3, count // 2)[point]
    turn = rng.uniform(0, 2 * np.pi, count // 2)[point]
    worse = np.tile([False, True], count // 2)
    situation = point // 6
    error = 1 + rng.normal(0, 3, count)[situation] + 2 * worse + 0.1 * rng.normal(size=count)
    soft = 2e-3 + 1e-3 * np.cos(turn) ** 2
    stiff = np.array([1 / 3e-3, 1 / 2e-3, 1e3])
    columns = {
        "trial": np.arange(count),
        "point": point,
        "teacher": situation % 2,
        "situation": situation,
        "controller": np.where(worse, "expert", "learned"),
        "plant": np.full(count, "nominal"),
        "outcome": np.full(count, "done"),
        "success": ~(worse & (force > 23.75) & (onset > 2.25)),
        "force_N": force,
        "force_x_N": force * np.cos(turn),
        "force_y_N": force * np.sin(turn),
        "force_z_N": 0 * force,
        "onset_s": onset,
        "error_mm": error,
        "displacement_max_mm": 5.5 * force,
        "displacement_end_mm": 1e3 * soft * force,
        "digest": np.arange(count).astype("U"),
        **{f"stiffness_{a}{a}_N_m": np.full(count, stiff[i]) for i, a in enumerate("xyz")},
        **{f"stiffness_{a}_N_m": np.zeros(count) for a in ("xy", "xz", "yz")},
    }
    return pyarrow.table(columns)


@pytest.fixture(scope="module")
def rows():
    return Rows.of(trials(4800))


def test_shares_have_wilson_intervals():
    for count, total in ((0, 7), (3, 7), (7, 7), (190, 200)):
        wanted = binomtest(count, total).proportion_ci(method="wilson")
        found = wilson(np.array([count]), np.array([total]))
        assert (found[0][0], found[1][0]) == pytest.approx((wanted.low, wanted.high))
    assert share(np.array([True] * 3 + [False])).value == 0.75


def test_of_no_trial_a_share_is_unknown(recwarn):
    low, high = wilson(np.array([0]), np.array([0]))
    np.testing.assert_allclose((low[0], high[0]), (0.0, 1.0), atol=1e-15)
    assert not recwarn.list


def test_an_interval_counts_situations_not_trials():
    """Six equal trials of one situation are one; the interval covers as often as it says."""
    rng, covered = np.random.default_rng(1), 0
    for k in range(200):
        units = np.repeat(np.arange(40), 6)
        found = mean(rng.normal(size=40)[units], units, seed=k)
        covered += found.low <= 0 <= found.high
    assert 0.89 <= covered / 200 <= 0.98
    assert np.isnan(mean(np.array([1.0, 2.0]), np.zeros(2)).low)


def test_of_very_many_situations_the_interval_is_the_normal_one():
    rng = np.random.default_rng(2)
    values = rng.normal(size=20_000)
    found = mean(values, np.arange(20_000))
    half = 1.96 * values.std(ddof=1) / np.sqrt(20_000)
    assert (found.high - found.low) / 2 == pytest.approx(half, rel=1e-3)


def test_pairs_take_out_what_situations_share(rows):
    """Situations differ by 3, trials of one by 0.1: only pairs find the 2 so sharply."""
    difference, units = paired(rows, "error_mm", "controller", "expert", "learned")
    found = mean(difference, units)
    assert len(difference) == 2400
    assert found.low < 2 < found.high and found.high - found.low < 0.05


def test_what_fails_together_is_found_first(rows):
    ranked, looked = clusters(rows.conditions, rows["success"] == 0)
    first = dict(ranked[0].conditions)
    assert first.keys() == {"controller", "force_N", "onset_s"}
    assert first["controller"] == "expert" and first["force_N"].endswith("to 30")
    assert ranked[0].failed.value > 0.9 and ranked[0].lift > 20 and looked > 100
    assert clusters(rows.conditions, np.zeros(len(rows), bool)) == ([], 0)


def test_what_decides_a_figure_explains_it(rows):
    assert explained(rows["displacement_max_mm"], rows.conditions["force_N"]) > 0.9
    assert explained(rows["displacement_max_mm"], rows.conditions["onset_s"]) < 0.02
    table = {row["condition"]: row for row in report.sensitivity(rows, ["displacement_max_mm"])}
    assert table["direction"]["displacement_max_mm"] < 0.02
    assert table["controller"]["success"] > table["direction"]["success"]


def test_pictures_show_force_and_compliance(rows):
    (axis,) = force_displacement(rows, "controller").axes
    force, way = axis.lines[0].get_data()
    np.testing.assert_allclose(way, 5.5 * np.asarray(force), rtol=1e-9)
    (polar,) = compliance(rows, "controller").axes
    turn, commanded = polar.lines[2].get_data()
    np.testing.assert_allclose(commanded, 2 + np.cos(turn) ** 2, rtol=1e-9)


def test_a_hundred_thousand_trials_are_analysed_in_seconds():
    many, began = Rows.of(trials(100_000)), time.process_time()
    assert report.cells(many, ["error_mm"]) and report.pairs(many, ["error_mm"])
    assert report.sensitivity(many, ["error_mm"]) and report.clustered(many)[0]
    assert time.process_time() - began < 10


def test_the_report_is_written(undisturbed):
    answer, folder = undisturbed
    text = (folder / "report.html").read_text()
    assert "By controller and plant" in text and "Pairs" in text
    assert answer["paths"]["report"] == str(folder / "report.html")
    assert (folder / "figures.tex").read_text().count(r"\\") == 5
    assert (folder / "figures.csv").read_text().startswith("controller,plant,trials,success,gap")


def test_a_campaign_is_itself(undisturbed, tmp_path):
    _, folder = undisturbed
    found = compare(folder, folder)
    assert (found["trials"], found["identical"]) == (26, 26)
    assert all(row["gap"].startswith("0 [") for row in found["cells"])
    with pytest.raises(RecordingError, match="campaign"):
        compare(folder, tmp_path)


def test_an_unknown_figure_is_named(rows):
    with pytest.raises(ArgumentError, match="no figure 'erorr'; they have trial, point"):
        rows["erorr"]
