"""What is exported reads back, by tpsim and by the formats' own libraries."""

import json

import numpy as np
import pytest

from tpsim import Demonstration, Frame, TpsimError, rotation
from tpsim.data import Columns, read, write, write_csv, write_lerobot, write_mcap, write_robomimic


def demonstrations(count=2, T=40):
    rng = np.random.default_rng(0)
    found = []
    for n in range(count):
        time = 0.02 * np.arange(T)
        turn = rotation.to_quaternion(rotation.exp(np.outer(time, [0.1, 0.5, 1.0]) + 0.1 * n))
        data = np.hstack([rng.normal(size=(T, 3)).cumsum(0), rotation.continuous(turn)])
        moving = rotation.exp(np.outer(time, [0, 0, 1.0]))
        A = np.tile(np.eye(7), (T, 1, 1))
        A[:, :3, :3] = moving
        frames = [Frame(np.eye(7), np.arange(7.0) + n), Frame(A, rng.normal(size=(T, 7)))]
        own = [data - np.arange(7.0) - n, rng.normal(size=(T, 7))]
        found.append(Demonstration(time, data, frames, own))
    return found


def assert_same(one, other, atol=0.0):
    np.testing.assert_allclose(one.time, other.time, atol=1e-9)
    np.testing.assert_allclose(one.data, other.data, atol=atol, rtol=0)
    assert len(one.frames) == len(other.frames)
    for a, b in zip(one.frames, other.frames, strict=True):
        assert a.shape == b.shape
        np.testing.assert_allclose(a.A, b.A, atol=1e-15, rtol=0)
        np.testing.assert_allclose(a.b, b.b, atol=1e-15, rtol=0)
    for a, b in zip(one.observations, other.observations, strict=True):
        np.testing.assert_allclose(a, b, atol=max(atol, 1e-15) * 10, rtol=0)


@pytest.mark.parametrize(
    ("name", "package", "atol"),
    [
        ("many.csv", "numpy", 0.0),
        ("many.hdf5", "h5py", 0.0),
        ("many.mcap", "mcap", 0.0),
        ("dataset", "pyarrow", 2e-6),
    ],
)
def test_demonstrations_come_back_with_frames_and_observations(tmp_path, name, package, atol):
    pytest.importorskip(package)
    written = demonstrations()
    (path,) = write(tmp_path / name, written)
    again = read(path)
    assert len(again) == len(written)
    for one, other in zip(again, written, strict=True):
        assert_same(one, other, atol)
    assert [p.name for p in tmp_path.iterdir()] == [name]  # nothing half-written is left


def test_npz_one_file_each(tmp_path):
    written = demonstrations(3)
    paths = write(tmp_path / "d.npz", written)
    assert [p.name for p in paths] == ["d-000.npz", "d-001.npz", "d-002.npz"]
    for one, other in zip(read(paths), written, strict=True):
        assert_same(one, other)


def trial(T=30):
    rng = np.random.default_rng(1)
    return {
        "time": 0.01 * np.arange(T),
        "q": rng.normal(size=(T, 7)),
        "torque": rng.normal(size=(T, 7)),
        "hand_position": rng.normal(size=(T, 3)),
        "hand_quaternion": np.tile([1.0, 0, 0, 0], (T, 1)),
        "stiffness": rng.normal(size=(T, 3, 3)),
        "outcome": np.array("done"),
    }


@pytest.mark.parametrize("name", ["t.csv", "t.hdf5", "t.mcap", "t"])
def test_trials_come_back(tmp_path, name):
    pytest.importorskip("h5py")
    given = trial()
    (path,) = write(tmp_path / name, [given])
    columns = Columns(joints="observation.state") if name == "t" else Columns(joints="q")
    (d,) = read(path, columns)
    np.testing.assert_allclose(d.data, given["q"], atol=1e-6)
    np.testing.assert_allclose(d.time, given["time"], atol=1e-9)


def test_robomimic_by_its_published_schema(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = write_robomimic(tmp_path / "demo.hdf5", [trial(), trial(20)], environment="Lift")
    with h5py.File(path) as file:
        data = file["data"]
        assert data.attrs["total"] == 50
        arguments = json.loads(data.attrs["env_args"])
        assert set(arguments) == {"env_name", "env_type", "env_kwargs"}
        assert arguments["env_kwargs"]["control_freq"] == pytest.approx(100)
        for i, T in enumerate((30, 20)):
            demo = data[f"demo_{i}"]
            assert demo.attrs["num_samples"] == T
            np.testing.assert_array_equal(demo["actions"], trial(T)["torque"])
            assert {len(demo[key]) for key in ("rewards", "dones", "obs/q")} == {T}
            assert demo["dones"][-1] == 1
            assert demo["dones"][:-1].sum() == 0


def test_lerobot_by_its_published_schema(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    written = demonstrations(3)
    path = write_lerobot(tmp_path / "set", written, task="pour", robot="panda")
    info = json.loads((path / "meta/info.json").read_text())
    assert info["codebase_version"] == "v3.0"
    assert (info["fps"], info["total_episodes"], info["total_frames"]) == (50, 3, 120)
    assert info["features"]["observation.state"]["shape"] == [7]
    file = info["data_path"].format(chunk_index=0, file_index=0)
    table = parquet.read_table(path / file)
    assert set(table.column_names) == set(info["features"])
    for name, about in info["features"].items():
        kind = table.schema.field(name).type
        number = kind if about["shape"] == [1] else kind.value_type
        assert str(number) == {"float32": "float", "float64": "double"}.get(
            about["dtype"], about["dtype"]
        )
    np.testing.assert_array_equal(table["index"], np.arange(120))
    stamps = np.asarray(table["timestamp"])
    np.testing.assert_allclose(stamps, np.asarray(table["frame_index"]) / 50, atol=1e-4)
    episodes = parquet.read_table(path / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [(e["dataset_from_index"], e["dataset_to_index"]) for e in episodes] == [
        (0, 40),
        (40, 80),
        (80, 120),
    ]
    assert episodes[1]["tasks"] == ["pour"]
    low = np.min(written[1].data, axis=0)
    np.testing.assert_allclose(episodes[1]["stats/observation.state/min"], low)
    stats = json.loads((path / "meta/stats.json").read_text())
    whole = np.vstack([d.data for d in written])
    np.testing.assert_allclose(stats["observation.state"]["mean"], whole.mean(0))
    state = np.array(table["observation.state"].to_pylist())
    action = np.array(table["action"].to_pylist())
    np.testing.assert_array_equal(action[:39], state[1:40])
    tasks = parquet.read_table(path / "meta/tasks.parquet").to_pydict()
    assert tasks == {"task_index": [0], "task": ["pour"]}


def test_lerobot_wants_even_stamps_and_gets_them(tmp_path):
    pytest.importorskip("pyarrow")
    time = np.array([0, 0.1, 0.25, 0.4, 0.5])
    path = write_lerobot(tmp_path / "set", Demonstration(time, 2 * time[:, None]), fps=20)
    (d,) = read(path)
    np.testing.assert_allclose(d.time, np.arange(11) / 20)
    np.testing.assert_allclose(d.data[:, 0], 2 * d.time, atol=1e-7)


def test_mcap_shows_poses_in_space(tmp_path):
    reader = pytest.importorskip("mcap.reader")
    (written,) = demonstrations(1)
    path = write_mcap(tmp_path / "d.mcap", written)
    with path.open("rb") as file:
        mcap = reader.make_reader(file, validate_crcs=True)
        summary = mcap.get_summary()
        topics = {c.topic: summary.schemas[c.schema_id].name for c in summary.channels.values()}
        pose = "foxglove.PoseInFrame"
        prefix = "/demonstration_0"
        assert {t for t, schema in topics.items() if schema == pose} == {
            f"{prefix}/movement", f"{prefix}/frame_0", f"{prefix}/frame_1"
        }  # fmt: skip
        messages = [json.loads(m.data) for _, _, m in mcap.iter_messages([f"{prefix}/movement"])]
    assert len(messages) == len(written)
    assert messages[3]["timestamp"] == {"sec": 0, "nsec": 60_000_000}
    assert list(messages[3]["pose"]["position"].values()) == written.data[3, :3].tolist()
    assert messages[3]["pose"]["orientation"]["w"] == written.data[3, 3]
    (d,) = read(path, Columns(position=f"{prefix}/movement/pose/position/?", frames=["frame_1"]))
    np.testing.assert_allclose(d.data, written.data[:, :3])


def test_a_planar_movement_lies_on_the_ground(tmp_path):
    pytest.importorskip("mcap")
    time = np.linspace(0, 1, 5)
    turned = Frame([[0.0, -2.0], [2.0, 0.0]], [1.0, 2.0])
    written = Demonstration(time, np.column_stack([time, time**2]), [turned])
    path = write_mcap(tmp_path / "d.mcap", written)
    pose = Columns(
        position="/demonstration_0/frame_0/pose/position/?",
        orientation="/demonstration_0/frame_0/pose/orientation/?",
        order="xyzw",
    )
    (d,) = read(path, pose)
    np.testing.assert_allclose(d.data[0], [1, 2, 0, np.sqrt(0.5), 0, 0, np.sqrt(0.5)], atol=1e-12)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda p: write(p / "a.xyz", demonstrations(1)), r"ends with \.xyz"),
        (lambda p: write(p / "a.npz", [trial()]), "give demonstrations"),
        (lambda p: write_csv(p / "a.csv", []), "nothing to write"),
        (lambda p: write_csv(p / "a.csv", {"q": [1, 2]}), "no array 'time'; it has q"),
        (lambda p: write_csv(p / "a.csv", {"time": [0, 1], "q": [1]}), "q has 1 rows and time 2"),
        (lambda p: write_csv(p / "a.csv", {"time": [0, 0], "q": [1, 2]}), "strictly increasing"),
        (lambda p: write_csv(p / "a.csv", {"time": [0, 1], "q": [1, np.nan]}), "q .* in row 1"),
        (lambda p: write_csv(p / "a.csv", [trial(), *demonstrations(1)]), "other signals"),
        (lambda p: write_lerobot(p / "a", {"time": [0, 1], "x": [1, 2]}), "name the state"),
        (lambda p: write_lerobot(p / "a", trial(), fps=2.5), "fps is 2.5"),
        (lambda p: write_lerobot(p, trial()), "not empty"),
        (lambda p: write_robomimic(p / "a.h5", trial(), action="x"), "no signal x"),
    ],
)
def test_what_cannot_be_written(tmp_path, call, words):
    pytest.importorskip("pyarrow")
    pytest.importorskip("h5py")
    (tmp_path / "here").touch()
    with pytest.raises(TpsimError, match=words):
        call(tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["here"]


@pytest.mark.parametrize("name", ["d.csv", "d.hdf5", "d.mcap"])
def test_frames_that_are_not_square_come_back(tmp_path, name):
    pytest.importorskip("h5py")
    pytest.importorskip("mcap")
    rng = np.random.default_rng(0)
    frames = [Frame(rng.normal(size=(3, 2)), rng.normal(size=3)) for _ in range(2)]
    written = Demonstration(np.arange(6.0), rng.normal(size=(6, 3)), frames)
    (path,) = write(tmp_path / name, [written])
    (again,) = read(path)
    for one, other in zip(again.frames, frames, strict=True):
        np.testing.assert_array_equal(one.A, other.A)
