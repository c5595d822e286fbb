"""Every format gives back the movement that was written into it."""

import numpy as np
import pytest

from tpsim import TpsimError
from tpsim.data import Columns, PoseColumns, read, recordings


def test_a_table_with_headings(sample, truth):
    (d,) = read(sample("text_csv"))
    np.testing.assert_allclose(d.time, truth.time, atol=1e-15)
    np.testing.assert_allclose(d.data, np.hstack([truth.position, truth.quaternion]), atol=1e-12)


@pytest.mark.parametrize("name", ["tum", "euroc"])
def test_trajectories_have_exact_stamps_though_unix_time_is_large(sample, truth, name):
    (d,) = read(sample(name))
    np.testing.assert_allclose(d.time, truth.time, atol=1e-9)
    np.testing.assert_allclose(d.data, np.hstack([truth.position, truth.quaternion]), atol=1e-12)


def test_arrays_by_name(sample, truth):
    (d,) = read(sample("npz"), Columns(frames=["box"]))
    np.testing.assert_allclose(d.data, np.hstack([truth.position, truth.quaternion]), atol=1e-12)
    seen = truth.box_turn.inv().apply(truth.position - truth.box)
    np.testing.assert_allclose(d.observations[0][:, :3], seen, atol=1e-12)


def test_situations_of_pbdlib(sample, truth):
    demonstrations = read(sample("mat"))
    assert len(demonstrations) == 3
    for n, d in enumerate(demonstrations):
        np.testing.assert_allclose(d.data, truth.position[:, :2] + n)
        assert np.linalg.det(d.frames[0].A) == pytest.approx(-0.1)
        x = d.data - [1.0, 2.0]
        np.testing.assert_allclose(d.observations[0], -x[:, ::-1] / np.sqrt(0.1), atol=1e-12)
        assert d.time[1] == pytest.approx(0.01)


@pytest.mark.parametrize("name", ["rosbag1", "rosbag2", "mcap_ros2"])
def test_joint_states_of_messages(sample, truth, name):
    (d,) = read(sample(name))
    np.testing.assert_allclose(d.time, truth.time, atol=2e-9)
    np.testing.assert_allclose(d.data, truth.joints, atol=1e-12)


@pytest.mark.parametrize("name", ["rosbag1", "rosbag2"])
def test_a_pose_seen_from_a_transform_in_a_tree(sample, truth, name):
    pose = {"position": "/hand/pose/position/?", "orientation": "/hand/pose/orientation/?"}
    (d,) = read(sample(name), Columns(**pose, order="xyzw", frames=["box"]))
    np.testing.assert_allclose(d.data, np.hstack([truth.position, truth.quaternion]), atol=1e-12)
    at = truth.box + truth.box_turn.apply([0.1, 0, 0])
    np.testing.assert_allclose(d.frames[0].b[:3], at, atol=1e-12)
    seen = truth.box_turn.inv() * truth.turn
    quaternion = seen.as_quat(scalar_first=True)
    cosine = np.abs(np.sum(d.observations[0][:, 3:] * quaternion, axis=1))
    np.testing.assert_allclose(cosine, 1, atol=1e-12)


def test_robomimic_in_the_order_of_numbers(sample, truth):
    two, ten = read(sample("robomimic"))
    assert (two.name, ten.name) == ("demo_2", "demo_10")
    np.testing.assert_allclose(
        two.data, np.hstack([truth.position + 2, truth.quaternion]), atol=1e-9
    )
    np.testing.assert_allclose(np.diff(two.time), 1 / 20)


def test_robosuite_without_observations_takes_time_from_the_states(sample, truth, tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "raw.hdf5"
    with h5py.File(path, "w") as file:
        file["data/demo_1/states"] = np.column_stack([truth.time, truth.joints])
    (d,) = read(path, Columns(joints=["states[1]", "states[2]"]))
    np.testing.assert_allclose(d.time, truth.time)
    np.testing.assert_allclose(d.data, truth.joints[:, :2])


def test_lerobot_episodes(sample, truth):
    first, second = read(sample("lerobot"))
    np.testing.assert_allclose(first.data, truth.joints, atol=1e-7)
    np.testing.assert_allclose(second.data, truth.joints + 1, atol=1e-7)
    np.testing.assert_array_equal(second.time, np.arange(len(truth.time)) / 50)
    (one, _) = read(sample("lerobot"), Columns(joints="observation.state.j2"))
    np.testing.assert_allclose(one.data[:, 0], truth.joints[:, 1], atol=1e-7)


def test_a_folder_of_files_is_read_in_the_order_of_names(sample, tmp_path):
    text = sample("text_csv").read_text()
    for name in ("b.csv", "a.csv"):
        (tmp_path / name).write_text(text)
    (tmp_path / "notes.md").write_text("not a recording")
    assert [d.name for d in read(tmp_path)] == ["a", "b"]
    assert len(read([tmp_path / "b.csv", tmp_path / "a.csv"])) == 2


def test_what_a_file_holds_before_it_is_described(sample):
    (recording,) = recordings(sample("rosbag2"))
    assert "/joint_states/j1/position" in set(recording.names())


@pytest.mark.parametrize("name", ["pdf", "mat"])
def test_formats_are_named(sample, name):
    with pytest.raises(TpsimError, match=r"format is 'pdf'|truncated or no MATLAB"):
        read(sample("text_csv"), format=name)


def test_poses_by_columns(sample, truth):
    box = PoseColumns("box", ("box_x", "box_y", "box_z"), "box_q?", "xyzw", moving=True)
    (d,) = read(sample("text_csv"), Columns(frames=[box, "start", "end"]))
    assert [frame.shape for frame in d.frames] == [(len(truth.time),), (), ()]
    np.testing.assert_allclose(d.observations[1][0], [0, 0, 0, 1, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(d.observations[2][-1], [0, 0, 0, 1, 0, 0, 0], atol=1e-12)
