"""From a user's files to a model, without writing Python."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tpsim import TPGMM, Demonstration, Frame, TpsimError
from tpsim.data import Columns, read
from tpsim.data.choice import Choice, retrieve
from tpsim.data.commands import convert, info, learn
from tpsim.data.lesson import prepared


@pytest.fixture(scope="module")
def reaching(tmp_path_factory):
    """Four reaches for a turned box, in millimetres and milliseconds, still at both ends."""
    folder = tmp_path_factory.mktemp("reaching")
    rng = np.random.default_rng(0)
    names = "time [ms],x [mm],y [mm],z [mm],box_x [mm],box_y [mm],box_z [mm],box_qw,box_qx,box_qy,"
    for n in range(4):
        T = 150 + 40 * n
        time = np.sort(rng.uniform(0, 3, T))
        way = np.clip((time - 0.5) / 2, 0, 1)[:, None]
        way = 10 * way**3 - 15 * way**4 + 6 * way**5
        box = np.array([0.5, 0.1, 0.1]) + 0.2 * rng.normal(size=3)
        turn = Rotation.from_euler("z", rng.normal())
        start = 0.1 * rng.normal(size=3)
        aside = turn.apply([-0.2, 0, 0]) * (way * (1 - way))
        path = start + (box - start) * way + aside
        pose = np.tile([*(1e3 * box), *turn.as_quat(scalar_first=True)], (T, 1))
        table = np.hstack([1e3 * time[:, None], 1e3 * path, pose])
        header = names + "box_qz"
        np.savetxt(folder / f"{n}.csv", table, delimiter=",", header=header, comments="")
    return folder


def test_info_says_what_read_would_make(reaching):
    about = info(reaching / "0.csv")
    assert about["movement"] == ["x [m]", "y [m]", "z [m]"]
    assert about["poses"] == ["(without a name)", "box"]
    assert about["columns"]["x"]["unit"] == "mm"
    (timing,) = about["demonstrations"]
    assert timing["samples"] == 150
    assert timing["duration"] == pytest.approx(3, abs=0.1)
    assert not timing["even"]
    assert about["problem"] is None
    json.dumps(about)


def test_info_says_why_a_file_cannot_be_read_as_it_stands(tmp_path):
    np.save(tmp_path / "a.npy", np.zeros((5, 3)))
    about = info(tmp_path / "a.npy")
    assert "Columns(rate=...)" in about["problem"]
    assert about["columns"]["array"]["width"] == 3
    with pytest.raises(TpsimError, match="no file"):
        info(tmp_path / "b.npy")


def test_info_names_columns_that_have_no_usual_names(sample):
    names = info(sample("lerobot"))["movement"]
    assert names == [f"observation.state[{i}]" for i in range(3)]
    names = info(sample("rosbag2"))["movement"]
    assert names == [f"/joint_states/j{i}/position [rad]" for i in (1, 2, 3)]


def test_convert(reaching, tmp_path):
    columns = Columns(frames=["box"])
    out = convert(reaching, tmp_path / "all.csv", columns)
    assert out["demonstrations"] == 4
    for one, other in zip(read(out["paths"]["written"][0]), read(reaching, columns), strict=True):
        np.testing.assert_array_equal(one.data, other.data)
        np.testing.assert_array_equal(one.frames[0].A, other.frames[0].A)


def test_learn_walks_from_files_to_a_model(reaching, tmp_path):
    out = learn(reaching, ["start", "box"], tmp_path / "out", samples=50)
    assert out["demonstrations"] == 4
    assert out["frames"] == ["start", "box"]
    assert out["error"]["position [m]"] < 0.03
    assert out["left_out_error"]["position [m]"] < 0.1
    assert json.loads((tmp_path / "out/summary.json").read_text()) == out
    model = TPGMM.load(out["paths"]["model"])
    assert model.components == out["components"]
    assert model.dims == (4, 4)  # time and position
    retrieved = read(out["paths"]["retrieved"])
    for path in retrieved:
        np.testing.assert_allclose(path.data, retrieve(model, path).mean, atol=1e-9)
        np.testing.assert_allclose(path.data[-1], path.frames[1].b, atol=0.03)
    png = (tmp_path / "out/learned.png").read_bytes()
    assert png.startswith(b"\x89PNG")
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [
        "learned.png", "model.npz", "retrieved.csv", "summary.json"
    ]  # fmt: skip


def test_learn_is_the_same_in_other_units(reaching, tmp_path):
    """Metres and seconds, or millimetres and milliseconds: the same model."""
    for path in sorted(reaching.glob("*.csv")):
        table = np.loadtxt(path, delimiter=",", skiprows=1)
        table[:, 0] = 1.7e9 + table[:, 0] / 1e3
        table[:, 1:7] /= 1e3
        names = "time,x,y,z,box_x,box_y,box_z,box_qw,box_qx,box_qy,box_qz"
        np.savetxt(tmp_path / path.name, table, "%.17g", ",", header=names, comments="")
    options = {"samples": 30, "components": 3}
    one = learn(reaching, ["box"], tmp_path / "one", **options)
    other = learn(sorted(tmp_path.glob("*.csv")), ["box"], tmp_path / "other", **options)
    assert other["error"]["position [m]"] == pytest.approx(one["error"]["position [m]"], rel=1e-3)


def test_learn_takes_the_ends_of_a_movement_where_no_frame_is_named(sample, tmp_path):
    out = learn(sample("robomimic"), out=tmp_path / "out", samples=20, components=2)
    assert out["frames"] == ["start", "end"]
    assert set(out["error"]) == {"position [m]", "orientation [deg]"}
    assert out["left_out_error"] == {}


def test_learn_takes_the_frames_that_a_file_holds(sample, tmp_path):
    out = learn(sample("mat"), out=tmp_path / "out", samples=20, components=2)
    assert out["frames"] == ["frame 0", "frame 1"]


def test_all_frames_moved_alike_move_the_movement_alike(reaching):
    movements = prepared(
        read(reaching, Columns(frames=["start", "box"])), samples=20, trim=True, align=True
    )
    model = Choice(2, "full").fit(movements)
    R, p = Rotation.from_rotvec([0.3, -1.0, 0.5]).as_matrix(), np.array([1.0, 2.0, -3.0])
    frames = [Frame(R @ frame.A, R @ frame.b + p) for frame in movements[0].frames]
    moved = Demonstration(movements[0].time, movements[0].data, frames)
    path, expected = retrieve(model, moved), retrieve(model, movements[0]).affine(R, p)
    np.testing.assert_allclose(path.mean, expected.mean, atol=1e-9)
    np.testing.assert_allclose(path.covariance, expected.covariance, atol=1e-9)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"samples": 3}, "samples is 3"),
        ({"frames": ["cup"]}, "no pose is called 'cup'"),
        ({"components": 0}, "components"),
    ],
)
def test_what_cannot_be_learned(reaching, tmp_path, options, words):
    with pytest.raises(TpsimError, match=words):
        learn(reaching, out=tmp_path / "out", **options)
    assert not list(tmp_path.iterdir())
