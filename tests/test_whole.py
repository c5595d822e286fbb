"""Files are whole or not there; what killed processes left is found by its name."""

import os
import subprocess
import sys

import pytest

from tpsim import whole


def test_an_error_of_the_disk_names_the_file(tmp_path):
    file = tmp_path / "trial.npz"
    with pytest.raises(OSError) as error, whole.whole_file(file):
        raise OSError(28, "No space left on device")
    assert error.value.filename == str(file)
    with pytest.raises(OSError) as error, whole.whole_folder(tmp_path / "new") as new:
        raise OSError(28, "No space left on device")
    assert error.value.filename == str(tmp_path / "new") and not new.exists()
    (tmp_path / "file").touch()
    with pytest.raises(OSError) as error:
        whole.write_text(tmp_path / "file" / "in", "text")
    assert ".part" not in str(error.value)
    assert [f.name for f in tmp_path.iterdir()] == ["file"]


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
    kept = [".trial.npz", ".notes.part", f".far.elsewhere-{os.getpid()}.part"]
    for name in kept:
        (tmp_path / name).touch()
    with whole.whole_path(tmp_path / "other.npz") as mine:
        mine.touch()
        whole.sweep(tmp_path)
        assert {f.name for f in tmp_path.iterdir()} == {*kept, mine.name}
