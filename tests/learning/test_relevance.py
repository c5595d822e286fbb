"""Frame relevance: which frame decides, when, and which never does."""

import numpy as np
import pytest

from tpsim import Demonstration, Frame, Gaussian, fit_tp_gmm
from tpsim.errors import ArgumentError
from tpsim.learning import relevance
from tpsim.learning.relevance import frame_relevance, frame_report, frame_shares
from tpsim.learning.tp_gmm import TPGMM


def rotation(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


@pytest.fixture(scope="module")
def demonstrations():
    """From a start to a goal; the third frame has nothing to do with it."""
    rng = np.random.default_rng(0)
    found = []
    for _ in range(12):
        start, goal, elsewhere = rng.normal([[0, 0], [9, 0], [4, 4]], 2.0)
        s = np.linspace(0, 1, 60)[:, None]
        data = start + (goal - start) * (3 * s**2 - 2 * s**3) + 0.05 * rng.normal(size=(60, 2))
        angles = rng.uniform(-np.pi, np.pi, size=3)
        frames = [
            Frame(rotation(a), b)
            for a, b in zip((0, 0, angles[2]), (start, goal, elsewhere), strict=True)
        ]
        found.append(Demonstration(np.linspace(0, 2, 60), data, frames))
    return found


@pytest.fixture(scope="module")
def model(demonstrations):
    return fit_tp_gmm(demonstrations, 5, start="time")


def test_each_frame_matters_where_the_movement_depends_on_it(model, demonstrations):
    share = frame_relevance(model, demonstrations[0])
    np.testing.assert_allclose(share.sum(1), 1.0, rtol=1e-9)
    assert share[0, 0] > 0.8
    assert share[-1, 1] > 0.8
    assert share[:, 2].max() < share[:, :2].min(1).max()


def test_report_names_the_frame_that_never_matters(model, demonstrations):
    report = frame_report(model, demonstrations)
    assert report.never == (2,)
    assert report.peak_progress[0] < 0.3
    assert report.peak_progress[1] > 0.7
    assert report.tested.all()
    assert (report.chance[:2] < 0.01).all()
    assert str(report).splitlines()[3].endswith("never matters")
    np.testing.assert_allclose(report.mean.sum(), 1.0)


def test_a_frame_without_meaning_is_rarely_found_to_matter():
    """Under the null the chance is uniform: about one frame in ten is below 0.1."""
    rng = np.random.default_rng(1)
    chances = []
    for _ in range(60):
        found = []
        for _ in range(6):
            data = rng.normal(size=(12, 2)) + rng.normal(size=2)
            frame = Frame(rotation(rng.uniform(0, 6)), rng.normal(size=2))
            found.append(Demonstration(np.arange(12.0), data, [frame]))
        exchanges = np.array([np.arange(6), *(rng.permutation(6) for _ in range(60))])
        chances.append(relevance._chance(found, 0, 3, exchanges))
    assert 1 <= (np.array(chances) < 0.1).sum() <= 14
    assert abs(np.mean(chances) - 0.5) < 0.15


def test_frames_that_cannot_be_exchanged_are_judged_by_their_share(demonstrations, model):
    few = frame_report(model, demonstrations[:3])
    assert not few.tested.any()
    assert "untested" in str(few)
    fixed = [
        Demonstration(d.time, d.data, [*d.frames[:2], Frame(np.eye(2), np.zeros(2))])
        for d in demonstrations
    ]
    report = frame_report(fit_tp_gmm(fixed, 5, start="time"), fixed)
    np.testing.assert_array_equal(report.tested, [True, True, False])
    assert report.chance[2] == 1.0


def test_shares_do_not_depend_on_the_common_coordinates(model, demonstrations):
    frames = demonstrations[0].frames
    T = rotation(0.7) @ np.diag([3.0, 0.2])
    moved = [Frame(T @ frame.A, T @ frame.b + 1.0) for frame in frames]
    np.testing.assert_allclose(frame_shares(model, moved), frame_shares(model, frames), rtol=1e-9)


def test_shares_by_hand_also_of_frames_that_see_one_direction():
    wide = Gaussian(np.zeros((1, 2)), np.diag([1.0, 4.0])[None])
    narrow = Gaussian(np.zeros((1, 1)), np.array([[[1.0]]]))
    model = TPGMM([1.0], [wide, narrow])
    frames = [Frame(np.eye(2), np.zeros(2)), Frame([[1.0], [0.0]], np.zeros(2))]
    # Direction x: 1 and 1. Direction y: the first frame alone.
    np.testing.assert_allclose(frame_shares(model, frames), [[0.75, 0.25]])
    np.testing.assert_allclose(frame_shares(model, frames, dims=[0]), [[0.5, 0.5]])


def test_moving_frames_have_shares_at_every_step(model, demonstrations):
    moving = [Frame(np.broadcast_to(f.A, (60, 2, 2)), f.b) for f in demonstrations[0].frames]
    still = demonstrations[0]
    moved = Demonstration(still.time, still.data, moving)
    assert frame_shares(model, moving).shape == (60, 5, 3)
    ours, theirs = frame_relevance(model, moved), frame_relevance(model, still)
    np.testing.assert_allclose(ours, theirs, atol=1e-12)


def test_time_that_all_frames_share_can_be_left_out(demonstrations):
    timed = [demonstration.with_time() for demonstration in demonstrations]
    report = frame_report(fit_tp_gmm(timed, 5, start="time"), timed, dims=[1, 2])
    assert report.never == (2,)


def test_bad_arguments_are_refused(model, demonstrations):
    frames = demonstrations[0].frames
    plain = Demonstration(demonstrations[0].time, demonstrations[0].data)
    for call in (
        lambda: frame_shares(model, frames[:2]),
        lambda: frame_shares(model, [Frame(np.eye(3), np.zeros(3))] * 3),
        lambda: frame_relevance(model, plain),
        lambda: frame_report(model, []),
        lambda: frame_report(model, demonstrations, draws=0),
        lambda: frame_report(model, demonstrations, significance=1.0),
    ):
        with pytest.raises(ArgumentError):
            call()
