import json
import multiprocessing
import resource
import threading
from contextlib import contextmanager
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from tpsim import paths
from tpsim.errors import RecordingError
from tpsim.study import teaching
from tpsim.study.files.about import condition_of
from tpsim.study.files.checked import plain
from tpsim.study.files.inside import checksum
from tpsim.study.files.run import load_run, open_run, run_folder


def start(folder, study):
    return open_run(folder, study=study, command="tpsim run", configuration={"n": 1}, seed=3)


def test_a_run_says_how_to_repeat_it_before_it_starts(tmp_path, toy):
    run = start(tmp_path / "run", toy)
    assert sorted(p.name for p in run.folder.iterdir()) == ["assets", "run.json", "scene.xml"]
    said = json.loads((run.folder / "run.json").read_text())
    assert (said["command"], said["seed"], said["configuration"]) == ("tpsim run", 3, {"n": 1})
    assert said["task"]["fields"] == {"effort": 0.05, "reach": [0.3, 0.4], "grip": None}
    assert said["task"]["reference"].endswith("toy.py:study")
    assert said["robot"]["joints"] == ["shoulder", "elbow"]
    assert said["versions"].keys() == {"python", "tpsim", "numpy", "scipy", "mujoco", "pin", "blas"}
    assert "1 thread" in said["versions"]["blas"]
    assert said["units"]["torque"] == "Nm"
    assert said["whole"] is None
    assert load_run(run.folder) == run


def test_a_whole_run_comes_back(recorded, trials, models, conditions, toy):
    run = load_run(recorded.folder)
    assert run == recorded
    assert run.file.whole.trials == len(trials)
    for index, (trial, condition) in enumerate(zip(trials, conditions, strict=True)):
        back = run.load(index)
        assert (back.outcome, back.channels, back.about) == (
            trial.outcome,
            trial.channels,
            trial.about,
        )
        assert condition_of(back) == condition
        for name in trial.arrays:
            np.testing.assert_array_equal(back[name], trial[name])
    assert [t.about["condition"]["label"] for t in run.trials()] == [c.label for c in conditions]
    assert run.models.keys() == models.keys()
    np.testing.assert_array_equal(run.models["bring"].priors, models["bring"].priors)
    assert run.world.xml == toy.task.stage.xml
    assert run.world.robot.joints == toy.task.stage.robot.joints
    assert run.world.description == toy.task.stage.description


def test_nothing_is_overwritten(recorded, toy, trials, models):
    for write in (
        lambda: start(recorded.folder, toy),
        lambda: recorded.save(0, trials[0]),
        lambda: recorded.save_models(models),
        recorded.finish,
    ):
        before = {p: p.read_bytes() for p in recorded.folder.rglob("*") if p.is_file()}
        with pytest.raises(RecordingError):
            write()
        assert before == {p: p.read_bytes() for p in recorded.folder.rglob("*") if p.is_file()}


def test_of_many_that_open_a_folder_one_gets_it(tmp_path, toy):
    for attempt in range(5):
        won, lost, together = [], [], threading.Barrier(8)

        def open_it(folder=tmp_path / f"run{attempt}", won=won, lost=lost, together=together):
            together.wait()
            try:
                won.append(start(folder, toy))
            except RecordingError as error:
                lost.append(str(error))

        threads = [threading.Thread(target=open_it) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert (len(won), len(lost)) == (1, 7)
        assert all("not an empty folder" in line for line in lost)
        assert load_run(won[0].folder) == won[0]


def test_of_two_processes_that_open_a_folder_one_gets_it(tmp_path, toy):
    context = multiprocessing.get_context("fork")
    together, won = context.Barrier(2), context.SimpleQueue()

    def open_it():
        for attempt in range(10):
            together.wait()
            try:
                start(tmp_path / str(attempt), toy)
            except RecordingError:
                won.put(False)
            else:
                won.put(True)

    processes = [context.Process(target=open_it) for _ in range(2)]
    for process in processes:
        process.start()
    found = [won.get() for _ in range(20)]
    for process in processes:
        process.join()
    assert (found.count(True), found.count(False)) == (10, 10)
    assert all(load_run(tmp_path / str(attempt)) for attempt in range(10))


@contextmanager
def full_disk(size):
    """Files cannot grow beyond so many bytes: writing fails in the middle, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_on_a_full_disk_what_was_written_stays_and_nothing_is_half_written(tmp_path, toy, trials):
    run = start(tmp_path / "run", toy)
    run.save(0, trials[0])
    before = {p: p.read_bytes() for p in run.folder.rglob("*") if p.is_file()}
    refused = partial(pytest.raises, RecordingError)
    with full_disk(6000):
        with refused(match=r"cannot write .*trial-000001.npz \(File too large\)"):
            run.save(1, trials[1])
        with refused(match=r"cannot write .*trial-000000.npz \(File too large\)"):
            teaching.teach(toy, 1, folder=tmp_path / "taught")
        with full_disk(9), refused(match=r"cannot write .*mark.obj \(File too large\)"):
            start(tmp_path / "other", toy)
    assert before == {p: p.read_bytes() for p in run.folder.rglob("*") if p.is_file()}
    assert not (tmp_path / "other").exists()
    assert list((tmp_path / "taught").iterdir()) == []


def test_names_of_new_folders_are_never_shared(tmp_path, monkeypatch):
    monkeypatch.setattr(paths, "runs", lambda: tmp_path / "runs")
    names = [run_folder("cup", 4) for _ in range(3)]
    assert len(set(names)) == 3
    assert names[0].name.startswith("cup-") and names[0].name.endswith("-seed4")


def test_a_gap_is_no_whole_run(tmp_path, toy, trials):
    run = start(tmp_path / "run", toy)
    run.save(0, trials[0])
    run.save(2, trials[0])
    with pytest.raises(RecordingError, match="a trial between others is missing"):
        run.finish()


def test_a_task_with_a_field_that_is_no_value_is_refused_before_anything_is_written(tmp_path, toy):
    study = replace(toy, task=replace(toy.task, grip=lambda: 3))
    with pytest.raises(RecordingError, match="field 'grip' of task bring"):
        start(tmp_path / "run", study)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, r"there is no file .*run.json"),
        ('{"command": ', "run.json is no JSON"),
        ("[]", "run.json: Expected `object`"),
        ('{"schema": 1}', "schema 1, this tpsim reads 3"),
        ('{"schema": 3}', "run.json: Object missing required field `command`"),
        ("\xff", "is no text"),
    ],
)
def test_a_broken_run_file_is_refused(tmp_path, text, words):
    if text is not None:
        (tmp_path / "run.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(RecordingError, match=words):
        load_run(tmp_path)


def test_every_key_of_the_run_file_is_checked(recorded):
    file = recorded.folder / "run.json"
    whole = plain(recorded.file)
    for key in whole:
        for wrong in ([None], {"x": object}, True):
            said = {**whole, key: {"x": [True]} if isinstance(wrong, dict) else wrong}
            if key == "configuration" and isinstance(wrong, dict):
                continue
            file.write_text(json.dumps(said))
            with pytest.raises(RecordingError, match=rf"run.json.*({key}|schema)"):
                load_run(recorded.folder)
        file.write_text(json.dumps({k: v for k, v in whole.items() if k != key}))
        with pytest.raises(RecordingError, match=key):
            load_run(recorded.folder)


@pytest.mark.parametrize(
    ("name", "asked"),
    [("scene.xml", "world"), ("assets/mark.obj", "world"), ("model-bring.npz", "models")],
)
def test_what_was_changed_after_the_run_is_refused(recorded, name, asked):
    file, content = recorded.folder / name, (recorded.folder / name).read_bytes()
    file.write_bytes(content.replace(b"0", b"1", 1))
    with pytest.raises(RecordingError, match=r"changed after the run|truncated"):
        getattr(load_run(recorded.folder), asked)
    file.unlink()
    with pytest.raises(RecordingError, match=r"there is no file|changed after the run"):
        getattr(load_run(recorded.folder), asked)


@pytest.mark.parametrize("name", ["scene.xml", "assets/mark.obj", "model-bring.npz", "run.json"])
def test_links_out_of_the_folder_are_not_followed(recorded, tmp_path, name):
    file = recorded.folder / name
    file.rename(tmp_path / "elsewhere")
    file.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(RecordingError, match="leads out of its folder"):
        run = load_run(recorded.folder)
        _ = run.world, run.models


def test_a_linked_trial_is_not_followed(recorded, tmp_path):
    file = recorded.path(0)
    file.rename(tmp_path / "elsewhere.npz")
    file.symlink_to(tmp_path / "elsewhere.npz")
    for read in (lambda: recorded.load(0), lambda: list(recorded.trials())):
        with pytest.raises(RecordingError, match="leads out of its folder"):
            read()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"joints": ["shoulder", "wrist"]}, "no 'wrist' that robot.joints names"),
        ({"hands": {"hand": "palm"}}, "no 'palm' that robot.hands names"),
        ({"home": [0.0]}, "robot has 2 joints, and limits or home do not fit"),
        ({"joints": ["elbow", "elbow"]}, "do not fit"),
        ({"fixed": {"wrist": 0.0}}, "no 'wrist' that robot.fixed names"),
    ],
)
def test_a_description_of_another_robot_is_refused(recorded, changes, words):
    said = plain(recorded.file)
    said["robot"] |= changes
    (recorded.folder / "run.json").write_text(json.dumps(said))
    with pytest.raises(RecordingError, match=words):
        _ = load_run(recorded.folder).world


def test_a_scene_that_does_not_compile_is_one_line(recorded):
    file = recorded.folder / "scene.xml"
    text = file.read_text().replace('type="capsule"', 'type="blob"', 1)
    file.write_text(text)
    said = plain(recorded.file) | {"scene": checksum(text.encode())}
    (recorded.folder / "run.json").write_text(json.dumps(said))
    with pytest.raises(RecordingError, match=r"scene.xml: the scene does not compile.*'blob'") as e:
        _ = load_run(recorded.folder).world
    assert "\n" not in str(e.value)
