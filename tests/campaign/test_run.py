"""Serial, pool, threads, shards, again and again: the same trials, bit for bit."""

import resource
import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.dataset
import pyarrow.parquet
import pytest

from tpsim.campaign.campaign import Sweep
from tpsim.campaign.design import blocks
from tpsim.campaign.folder import load_folder
from tpsim.campaign.people import Leads, Pushes
from tpsim.campaign.progress import ProgressPage
from tpsim.campaign.replay import replay
from tpsim.campaign.run import campaign
from tpsim.errors import ArgumentError, RecordingError
from tpsim.study.files.trial_file import load_trial
from tpsim.study.reference import load_study


@pytest.fixture
def begun(undisturbed, tmp_path):
    """A folder in which everything is taught and nothing performed."""
    folder = tmp_path / "begun"
    folder.mkdir()
    for name in ("campaign.json", "lessons"):
        source = undisturbed[1] / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, folder / name)
    return folder


def rows(folder):
    return pyarrow.parquet.read_table(folder / "table.parquet").to_pylist()


def test_it_answers_with_what_is_done(undisturbed, described):
    answer, folder = undisturbed
    assert (answer["trials"], answer["done"], answer["failed"]) == (26, 26, 0)
    assert answer["table"] == str(folder / "table.parquet")
    assert answer["simulated_seconds_per_second"] > 0
    assert [row["trial"] for row in rows(folder)] == list(range(26))
    assert blocks(described) == 2


def test_a_row_is_what_its_trial_is(undisturbed):
    _, folder = undisturbed
    row = rows(folder)[5]
    trial = load_trial(load_folder(folder).trial(5))
    assert (row["controller"], row["plant"], row["force_N"]) == ("still", "nominal", 2.0)
    wrench = trial["push_wrench"]
    assert row["force_y_N"] == pytest.approx(wrench[:, 1].max())
    assert row["simulated_s"] == pytest.approx(0.4)
    # Up to the push, the trial is its twin.
    assert row["displacement_max_mm"] > 0 and row["gap"] > 0 and row["twin_gap"] > 0


def test_twice_the_force_on_a_spring_moves_it_twice_as_far(undisturbed):
    """Force over displacement is stiffness, and pairs differ in force alone."""
    found = [r for r in rows(undisturbed[1]) if r["controller"] == "still"]
    one, two = (next(r for r in found if r["force_N"] == force) for force in (1.0, 2.0))
    assert two["displacement_max_mm"] == pytest.approx(2 * one["displacement_max_mm"], rel=0.05)


def test_threads_and_shards_give_the_same_bits(undisturbed, described, begun):
    answer, folder = undisturbed
    half = campaign(described, begun, shard=(1, 2))
    assert (half["done"], half["performed"]) == (2, 2) and half["digest"] != answer["digest"]
    assert half["table"].endswith("table")
    rest = campaign(described, begun, shard=(2, 2), workers=2, executor=ThreadPoolExecutor)
    assert (rest["done"], rest["performed"]) == (26, 24)
    assert rest["digest"] == answer["digest"]
    assert rows(begun) == rows(folder)
    again = campaign(described, begun)
    assert (again["performed"], again["digest"]) == (0, answer["digest"])


def test_the_table_is_read_while_it_runs(undisturbed, described, begun):
    campaign(described, begun, shard=(1, 2))
    there = pyarrow.dataset.dataset(begun / "table").to_table()
    assert there.num_rows == 2


def test_a_page_tells_how_far_it_is_and_leads_to_the_report(described, begun):
    half = campaign(described, begun, shard=(1, 2))
    page = Path(half["paths"]["progress"]).read_text()
    assert 'http-equiv="refresh" content="5"' in page and "0 of 26 trials" in page
    ProgressPage(load_folder(begun), load_study(described.study))
    page = (begun / "progress.html").read_text()
    assert "2 of 26 trials" in page and "<td>nominal</td>" in page
    whole = campaign(described, begun)
    assert "progress" not in whole["paths"]
    assert "url=report.html" in (begun / "progress.html").read_text()


def test_another_campaign_is_refused_and_nothing_touched(described, undisturbed, begun):
    other = replace(described, seed=1)
    before = sorted(begun.rglob("*"))
    with pytest.raises(RecordingError, match=r"another campaign .seed is 0, not 1"):
        campaign(other, begun)
    assert sorted(begun.rglob("*")) == before
    with pytest.raises(RecordingError, match="is no campaign's folder"):
        campaign(described, begun / "lessons")


def test_other_versions_are_refused(described, begun):
    text = (begun / "campaign.json").read_text()
    (begun / "campaign.json").write_text(text.replace('"mujoco": "3', '"mujoco": "2'))
    with pytest.raises(RecordingError, match=r"other versions \(mujoco 2\S+ then"):
        campaign(described, begun)


def test_models_that_were_changed_are_refused(described, begun):
    model = begun / "lessons" / "000000" / "model-bring.npz"
    content = bytearray(model.read_bytes())
    content[200] ^= 1
    model.write_bytes(content)
    with pytest.raises(RecordingError, match=r"model-bring\.npz .* changed after the run"):
        campaign(described, begun)


def test_rows_of_another_campaign_are_refused(described, undisturbed, begun, tmp_path):
    strange = replace(described, trials=2, seed=1)
    campaign(strange, tmp_path / "strange")
    table = begun / "table" / "0000"
    table.mkdir(parents=True)
    shutil.copy(tmp_path / "strange/table/0000/block-000000.parquet", table)
    with pytest.raises(RecordingError, match="has another campaign than this"):
        campaign(described, begun)


def test_what_fails_is_a_row_and_is_done_again_when_asked(described, begun, tmp_path):
    study = load_study(described.study)

    def failing(world, models, situation):
        raise ZeroDivisionError("a user's slip")

    broken = replace(study, controllers={"still": failing})
    answer = campaign(described, begun, study=broken)
    assert (answer["done"], answer["failed"]) == (13, 13)
    failed = [row for row in rows(begun) if row["outcome"] == "failed"]
    assert {row["reason"] for row in failed} == {"ZeroDivisionError: a user's slip"}
    assert campaign(described, begun)["failed"] == 13
    mended = campaign(described, begun, retry=True)
    assert (mended["failed"], mended["performed"]) == (0, 26)


def test_a_full_disk_is_one_line_and_it_goes_on_after_space_is_made(described, undisturbed, begun):
    """A limit on file sizes stands for a disk that is full: both fail in the middle of writing."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, before[1]))
    try:
        with pytest.raises(RecordingError, match=r"cannot write .*; make space") as error:
            campaign(described, begun)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert "\n" not in str(error.value)
    assert not list(begun.rglob(".*.part*")) and not list(begun.rglob("block-*"))
    assert campaign(described, begun)["digest"] == undisturbed[0]["digest"]


def test_signals_are_a_table(undisturbed, described):
    folder = load_folder(undisturbed[1])
    table = pyarrow.parquet.read_table(folder.signals(1))
    trial = load_trial(folder.trial(25))
    own = table.filter(pyarrow.compute.field("trial") == 25)
    np.testing.assert_array_equal(own["q_1"].to_numpy(), trial["q"][:, 1].astype(np.float32))


def test_trials_come_out_again(undisturbed, described):
    folder, study = load_folder(undisturbed[1]), load_study(described.study)
    found = replay(folder, (0, 7, 25), study)
    assert (found["repeats"], found["trials"], found["identical"]) == (True, 3, 3)
    with pytest.raises(ArgumentError, match=r"name it yourself if you trust it: --study"):
        replay(folder)


def test_leads_and_sweeps_and_undisturbed_trials(described, tmp_path):
    led = replace(
        described,
        trials=4,
        controllers=("learned",),
        plants=("nominal",),
        pushes=None,
        leads=Leads(travel=(0.01,), duration=(0.1,), rest=0.05),
        sweeps={"effort": Sweep((0.05, 0.5), learn=False), "demonstrations": Sweep((2, 3))},
        keep="figures",
    )
    answer = campaign(led, tmp_path / "led")
    assert answer["failed"] == 0
    found = rows(tmp_path / "led")
    assert [row["task.effort"] for row in found] == [0.05, 0.5, 0.05, 0.5]
    assert [row["task.demonstrations"] for row in found] == [2, 2, 3, 3]
    # The stiffer hand is led by more force; both go where they are led.
    assert all(row["displacement_end_mm"] > 3 for row in found)
    assert found[0]["force_mean_N"] > found[1]["force_mean_N"]
    still = replace(led, leads=None, sweeps={}, trials=1)
    assert campaign(still, tmp_path / "still")["done"] == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"controllers": ("stil",)}, "no controller 'stil'; there are learned, still, nearby"),
        ({"sweeps": {"efort": Sweep((1.0,))}}, "no field of the task 'efort'; there are effort"),
        ({"fields": {"efort": 1.0}}, "no field of the task 'efort'"),
        ({"success": ("gap",)}, "no measure with a limit 'gap'"),
        ({"pushes": Pushes(duration=(0.5,))}, r"until 0\.5 s, and a trial 0\.4 s"),
    ],
)
def test_what_the_study_has_not_is_said_before_anything_is_written(
    described, tmp_path, change, words
):
    with pytest.raises(ArgumentError, match=words):
        campaign(replace(described, **change), tmp_path / "new")
    assert not (tmp_path / "new").exists()
