"""Nothing is overwritten, nothing half-written has a name, and what cannot be written is named."""

import multiprocessing
import os
import subprocess
import sys
from pathlib import Path

import pytest

import tpsim
from tpsim.errors import RecordingError
from tpsim.whole import (
    abandon,
    newest,
    numbered_folder,
    sweep,
    whole_file,
    whole_folder,
    whole_path,
    write_text,
)


def test_what_exists_is_never_overwritten(tmp_path):
    for make in (Path.touch, Path.mkdir, lambda path: path.symlink_to(tmp_path / "nothing")):
        path = tmp_path / f"{make}.txt".replace("/", "")
        make(path)
        with pytest.raises(RecordingError, match=r"exists.*nothing is overwritten"):
            write_text(path, "new")
    write_text(tmp_path / "a", "old")
    with pytest.raises(RecordingError, match="exists"), whole_file(tmp_path / "b") as file:
        file.write(b"mine")
        write_text(tmp_path / "b", "theirs")  # another process, meanwhile
    assert (tmp_path / "b").read_text() == "theirs"
    write_text(tmp_path / "a", "drawn anew", replace=True)
    assert (tmp_path / "a").read_text() == "drawn anew"
    assert not list(tmp_path.glob(".*"))


def test_file_systems_without_links_are_no_exception(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "link", lambda *_: (_ for _ in ()).throw(PermissionError()))
    write_text(tmp_path / "a", "one")
    with pytest.raises(RecordingError, match="exists"), whole_file(tmp_path / "b") as file:
        file.write(b"mine")
        (tmp_path / "b").write_text("theirs")
    assert [(tmp_path / name).read_text() for name in "ab"] == ["one", "theirs"]


def numbered(folder, together, made):
    together.wait()
    for _ in range(20):
        made.put(numbered_folder(folder, lambda new: (new / "pid").write_text(str(os.getpid()))))


def test_of_many_processes_each_gets_its_own_number(tmp_path):
    context = multiprocessing.get_context("fork")
    made, together = context.Queue(), context.Barrier(3)
    folder = tmp_path / "bring"
    (tmp_path / "bring-2").mkdir()  # another behaviour
    workers = [context.Process(target=numbered, args=(folder, together, made)) for _ in range(3)]
    for worker in workers:
        worker.start()
    places = {made.get(timeout=60) for _ in range(60)}
    for worker in workers:
        worker.join()
    assert len(places) == 60
    assert newest(folder).name == "bring~60"
    assert all((place / "pid").is_file() for place in places)
    assert not list(tmp_path.glob(".*"))


def test_a_folder_that_was_made_meanwhile_stays(tmp_path):
    taken = pytest.raises(RecordingError, match="exists and is not empty")
    with taken, whole_folder(tmp_path / "a") as new:
        (new / "mine").touch()
        (tmp_path / "a").mkdir()
        (tmp_path / "a" / "theirs").touch()
    assert [path.name for path in tmp_path.rglob("*")] == ["a", "theirs"]


def test_who_is_interrupted_leaves_what_was_there(tmp_path):
    """The old demonstrations were removed before the new had their name: a kill left neither."""
    folder = numbered_folder(tmp_path / "bring", lambda new: (new / "old").touch())

    def interrupted(new):
        (new / "half").touch()
        assert (folder / "old").exists()
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        numbered_folder(folder, interrupted)
    assert [path.name for path in tmp_path.rglob("*")] == ["bring", "old"]
    assert newest(folder) == folder


LEARN = """
import sys, resource
from pathlib import Path
import numpy as np
import tpsim, tpsim.data
from tpsim.errors import TpsimError
d = tpsim.Demonstration(np.linspace(0, 1, 5000), np.random.default_rng(0).normal(size=(5000, 3)))
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
for name in sys.argv[1:]:
    try:
        tpsim.data.write(name, [d])
    except TpsimError as error:
        print(error)
"""


def test_a_full_disk_is_one_line_that_names_the_file(tmp_path):
    """A limit on file sizes stands for a disk that is full: both fail in the middle of writing."""
    names = ["d.npz", "d.csv", "d.mcap", "d.hdf5", "dataset"]
    done = subprocess.run(
        [sys.executable, "-c", LEARN, *names],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(Path(tpsim.__file__).parents[1])},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == len(names)
    for name, line in zip(names, lines, strict=True):
        assert f"cannot write {name}" in line, line
    assert list(tmp_path.rglob("*")) == []


def test_no_permission_no_folder_and_no_space_are_one_line(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(RecordingError, match=r"cannot write .*file/a \((Not a directory|File exi)"):
        write_text(tmp_path / "file" / "a", "x")
    long = tmp_path / ("n" * 300)
    with pytest.raises(RecordingError, match=r"cannot write .* \(File name too long\)"):
        write_text(long, "x")
    refused = pytest.raises(RecordingError, match=r"cannot write .* \(File name too long\)")
    with refused, whole_folder(long):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_an_error_of_the_disk_names_the_file_and_not_the_temporary_one(tmp_path):
    full = OSError(28, "No space left on device")
    for make, name in ((whole_file, "trial.npz"), (whole_folder, "new")):
        path = tmp_path / name
        with pytest.raises(RecordingError) as error, make(path):
            raise full
        assert f"cannot write {path} (No space" in str(error.value)
        assert list(tmp_path.iterdir()) == []


KILLED = """
import os, signal, sys
from pathlib import Path
from tpsim import whole
there = Path(sys.argv[1])
with whole.whole_file(there / "trial.npz"), whole.whole_folder(there / "new"):
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_what_killed_processes_left_is_swept_and_nothing_else(tmp_path):
    subprocess.run([sys.executable, "-c", KILLED, tmp_path])
    assert len(list(tmp_path.iterdir())) == 2
    kept = [".trial.npz", ".notes.part", f".far.elsewhere-{os.getpid()}-0.part"]
    for name in kept:
        (tmp_path / name).touch()
    with whole_path(tmp_path / "other.npz") as mine:
        mine.touch()
        sweep(tmp_path)
        assert {f.name for f in tmp_path.iterdir()} == {*kept, mine.name}


def test_who_ends_at_once_leaves_nothing_half_written(tmp_path):
    folder, file = whole_folder(tmp_path / "runs" / "one"), whole_file(tmp_path / "two.txt")
    (folder.__enter__() / "inside").write_text("half")
    file.__enter__().write(b"half")
    assert len([path for path in tmp_path.rglob(".*.part*")]) == 2
    abandon()
    assert not [path for path in tmp_path.rglob("*") if path.name != "runs"]
    for one in (folder, file):
        with pytest.raises(RecordingError):
            one.__exit__(None, None, None)
