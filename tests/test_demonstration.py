"""Demonstrations: own data in, views of the frames out, archives, other times."""

from pathlib import Path

import numpy as np
import pytest

from tpsim import Demonstration, Frame, fit_tp_gmm
from tpsim.errors import ArgumentError, RecordingError
from tpsim.examples import letters, u_demonstrations, u_frames

REFERENCE = np.load(Path(__file__).parent / "reference" / "affine.npz")


def rotations(angles):
    c, s = np.cos(angles), np.sin(angles)
    return np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2)


@pytest.fixture
def moving():
    rng, time = np.random.default_rng(0), np.linspace(1.0, 3.0, 41)
    frames = (
        Frame(2.0 * np.eye(2), [1.0, 0.0]),
        Frame(rotations(time), np.column_stack([time, time**2])),
        Frame([[1.0], [0.0]], [0.0, 0.0]),
    )
    return Demonstration(time, np.cumsum(rng.normal(size=(41, 2)), 0), frames, name="moving")


def test_own_data_in_five_lines():
    rng = np.random.default_rng(0)
    arrays = [(np.linspace(0, 1, T), rng.normal(size=(T, 2))) for T in (30, 50)]
    frames = [Frame(np.eye(2), np.zeros(2)), Frame(np.diag([2.0, -1.0]), np.ones(2))]
    demonstrations = [Demonstration(time, data, frames) for time, data in arrays]
    model = fit_tp_gmm(demonstrations, components=2)
    assert model.adapt(frames).gaussians.mean.shape == (2, 2)


def test_observations_default_to_what_the_frames_see(moving):
    assert [o.shape for o in moving.observations] == [(41, 2), (41, 2), (41, 1)]
    for frame, seen in zip(moving.frames, moving.observations, strict=True):
        np.testing.assert_array_equal(seen, frame.to_local(moving.data))


def test_archive_returns_the_same_bits(moving, tmp_path):
    path = moving.save(tmp_path / "new" / "demonstration.npz")
    again = Demonstration.load(path)
    assert again.name == "moving"
    for name in ("time", "data"):
        np.testing.assert_array_equal(getattr(again, name), getattr(moving, name))
    for one, other in zip(again.frames, moving.frames, strict=True):
        np.testing.assert_array_equal(one.A, other.A)
        np.testing.assert_array_equal(one.b, other.b)
    for one, other in zip(again.observations, moving.observations, strict=True):
        np.testing.assert_array_equal(one, other)
    assert [p.name for p in path.parent.iterdir()] == ["demonstration.npz"]


def test_archives_hold_no_pickles(moving, tmp_path):
    path = moving.save(tmp_path / "demonstration.npz")
    with np.load(path, allow_pickle=False) as archive:
        assert all(archive[name].dtype != object for name in archive.files)


@pytest.mark.parametrize("content", [None, b"", b"not an archive", "half", "other", "pickle"])
def test_bad_archives_are_refused(moving, tmp_path, content):
    path = tmp_path / "demonstration.npz"
    if content == "half":
        whole = moving.save(path).read_bytes()
        path.write_bytes(whole[: len(whole) // 2])
    elif content == "other":
        np.savez(path, time=moving.time)
    elif content == "pickle":
        np.savez(path, time=np.array([{}], dtype=object))
    elif content is not None:
        path.write_bytes(content)
    with pytest.raises(RecordingError, match="demonstration"):
        Demonstration.load(path)


def test_resampling_at_the_same_times_changes_nothing(moving):
    again = moving.resampled(41)
    np.testing.assert_allclose(again.data, moving.data, atol=1e-12)
    np.testing.assert_allclose(again.frames[1].A, moving.frames[1].A, atol=1e-12)


def test_resampling_keeps_rotations_and_ends(moving):
    finer = moving.resampled(333, smooth=True)
    A = finer.frames[1].A
    np.testing.assert_allclose(A @ A.mT, np.broadcast_to(np.eye(2), A.shape), atol=1e-12)
    np.testing.assert_allclose(A, rotations(finer.time), atol=1e-3)
    np.testing.assert_allclose(finer.data[[0, -1]], moving.data[[0, -1]], atol=1e-12)
    np.testing.assert_allclose(finer.observations[0], finer.frames[0].to_local(finer.data))


def test_smooth_resampling_follows_a_cubic():
    time = np.linspace(0, 1, 9)
    cubic = Demonstration(time, time[:, None] ** 3).resampled([0.03, 0.5], smooth=True)
    np.testing.assert_allclose(cubic.data[:, 0], [0.03**3, 0.125])


def test_time_in_front(moving):
    timed = moving.with_time()
    for view in (timed.data, *timed.observations):
        np.testing.assert_allclose(view[:, 0], moving.time - 1.0)
    np.testing.assert_allclose(timed.frames[1].to_local(timed.data), timed.observations[1])
    assert moving.with_time(np.ones((41, 2))).data.shape == (41, 4)


def test_derivatives_are_those_of_the_reference():
    dt = REFERENCE["dt"]
    for x, expected in zip(REFERENCE["X"], REFERENCE["Xd"], strict=True):
        extended = Demonstration(dt * np.arange(len(x)), x).with_derivatives(2)
        np.testing.assert_allclose(extended.data, expected, rtol=1e-9, atol=1e-9)


def test_derivatives_in_constant_frames_are_seen_by_lifted_frames():
    extended = u_demonstrations(1, samples=30)[0].with_derivatives(1)
    for frame, seen in zip(extended.frames, extended.observations, strict=True):
        np.testing.assert_allclose(frame.to_local(extended.data), seen, atol=1e-10)


@pytest.mark.parametrize(
    ("time", "data", "frames"),
    [
        ([], np.empty((0, 2)), ()),
        ([0.0, 1.0], np.zeros((3, 2)), ()),
        ([0.0, 0.0], np.zeros((2, 2)), ()),
        ([1.0, 0.0], np.zeros((2, 2)), ()),
        ([0.0, 1.0], [[0.0], [np.nan]], ()),
        ([0.0, 1.0], np.zeros((2, 2)), (Frame(np.eye(3), np.zeros(3)),)),
        ([0.0, 1.0], np.zeros((2, 2)), (Frame(np.eye(2), np.zeros((3, 2))),)),
        ([0.0, 1.0], np.zeros((2, 2)), (np.eye(2),)),
    ],
)
def test_bad_demonstrations_are_refused(time, data, frames):
    with pytest.raises(ArgumentError):
        Demonstration(time, data, frames)


@pytest.mark.parametrize(
    "use",
    [
        lambda d: d.resampled(0),
        lambda d: d.resampled([0.0]),
        lambda d: d.resampled([]),
        lambda d: d.with_time(np.ones(3)),
        lambda d: Demonstration(d.time, d.data, d.frames, d.observations[:1]),
        lambda d: Demonstration(d.time[:3], d.data[:3]).resampled(9, smooth=True),
    ],
)
def test_misuse_is_refused(moving, use):
    with pytest.raises(ArgumentError):
        use(moving)


def test_examples_leave_and_enter_along_the_open_side():
    """Every movement starts at the first object and ends at the second, along its second axis."""
    for demonstration in u_demonstrations(3, samples=100):
        first, second = demonstration.observations
        np.testing.assert_allclose(first[0], 0, atol=1e-12)
        np.testing.assert_allclose(second[-1], 0, atol=1e-12)
        for early in (first[5], second[-6]):
            assert early[1] > 0
            assert abs(early[0]) < 0.05 * early[1]


def test_examples_are_the_same_every_time_and_differ_from_each_other():
    one, other = u_demonstrations(2), u_demonstrations(2)
    np.testing.assert_array_equal(one[1].data, other[1].data)
    assert np.abs(one[0].data - one[1].data).max() > 0.1
    assert not np.allclose(letters("S")[0].data, letters("S")[1].data)
    assert len(u_frames(np.random.default_rng(0), spread=2.0)) == 2
    with pytest.raises(ArgumentError, match="letter"):
        letters("Q")
