"""Whatever is wrong with a file, one line of a TpsimError says so."""

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import TpsimError
from tpsim.data import Columns, read

FILES = ["text_csv", "tum", "euroc", "npz", "mat"]
FILES += ["rosbag1", "rosbag2", "mcap_ros2", "robomimic", "lerobot"]


def broken(sample: Path, folder: Path):
    """Copies of a recording, each damaged in another way, and what was done to it."""
    files = [sample] if sample.is_file() else [p for p in sorted(sample.rglob("*")) if p.is_file()]
    rng = np.random.default_rng(0)
    for file in files:
        content = file.read_bytes()
        damages = {f"cut at {share:.0%}": content[: int(share * len(content))] for share in CUTS}
        damages["one byte short"] = content[:-1]
        damages["words"] = b"these are words, not numbers\n" * 3
        damages["noise"] = rng.integers(0, 256, 500, np.uint8).tobytes()
        for k in range(4):
            hit = np.frombuffer(content, np.uint8).copy()
            hit[rng.integers(0, len(hit), 8)] = rng.integers(0, 256, 8)
            damages[f"eight bytes wrong, {k}"] = hit.tobytes()
        for what, damaged in damages.items():
            copy = folder / "copy" / sample.name
            shutil.rmtree(folder / "copy", ignore_errors=True)
            if sample.is_file():
                copy.parent.mkdir()
                copy.write_bytes(damaged)
            else:
                shutil.copytree(sample, copy)
                (copy / file.relative_to(sample)).write_bytes(damaged)
            yield f"{file.name} {what}", copy


CUTS = (0.0, 0.02, 0.2, 0.5, 0.8, 0.99)


@pytest.mark.parametrize("name", FILES)
def test_a_damaged_file_is_read_or_refused_in_one_line(sample, tmp_path, name):
    refused = 0
    for what, path in broken(sample(name), tmp_path):
        try:
            read(path)
        except TpsimError as error:
            refused += 1
            assert "\n" not in str(error), what
            assert str(error).startswith((str(path), "there is no file")), what
    assert refused >= 3


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_another_kind_is_refused(sample, tmp_path, name):
    path = sample(name)
    for suffix in (".npz", ".csv", ".mat", ".bag", ".mcap", ".hdf5"):
        if path.is_dir() or path.suffix == suffix or {path.suffix, suffix} <= {".csv", ".tum"}:
            continue
        other = tmp_path / f"renamed{suffix}"
        shutil.copy(path, other)
        with pytest.raises(
            TpsimError, match=r"truncated or no|no text|no numbers|empty|zero bytes"
        ):
            read(other)


def test_the_truth_is_listed(truth):
    assert list(FILES) == truth.files


@pytest.mark.parametrize(
    ("name", "package", "what"),
    [
        ("robomimic", "h5py", "HDF5 files"),
        ("lerobot", "pyarrow", "LeRobot datasets"),
        ("rosbag1", "rosbags", "ROS bags"),
        ("mcap_ros2", "mcap", "MCAP files"),
    ],
)
def test_a_missing_package_is_named_with_its_extra(sample, monkeypatch, name, package, what):
    path = sample(name)
    for module in [m for m in sys.modules if m.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(TpsimError, match=rf"{what} need .*{package}.*pip install 'tpsim\[data\]'"):
        read(path)


def test_text_is_the_same_with_and_without_arrow(sample, monkeypatch):
    (one,) = read(sample("text_csv"))
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    (other,) = read(sample("text_csv"))
    np.testing.assert_array_equal(one.data, other.data)
    np.testing.assert_array_equal(one.time, other.time)


def test_messages_that_nothing_here_decodes_are_named(tmp_path):
    writer = pytest.importorskip("mcap.writer")
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        out = writer.Writer(file)
        out.start()
        schema = out.register_schema("foxglove.PoseInFrame", "protobuf", b"")
        out.add_message(out.register_channel("/pose", "protobuf", schema), 0, b"", 0)
        out.finish()
    with pytest.raises(TpsimError, match="no messages with numbers in JSON or ROS 2, only in prot"):
        read(path)


@settings(max_examples=150, deadline=None)
@given(st.text(alphabet="01.,;-e \t\n\"'#xna[]", max_size=60))
def test_any_text_is_read_or_refused(text):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.csv"
        path.write_text(text)
        try:
            (d,) = read(path, Columns(rate=10))
            assert np.isfinite(d.data).all()
        except TpsimError as error:
            assert "\n" not in str(error)
