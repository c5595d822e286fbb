"""Cleaning keeps what it should, on uneven stamps too, and frames and observations in step."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import Demonstration, Frame, TpsimError, rotation
from tpsim.data import aligned, resampled, segmented, smoothed, trimmed
from tpsim.data.motion import speed


def uneven(rng, T=200, duration=4.0):
    steps = rng.uniform(0.3, 1.7, T - 1)
    return np.concatenate([[0], np.cumsum(steps)]) * duration / steps.sum()


def seen(time, data, name=""):
    """A constant and a turning frame."""
    turning = rotation.exp(np.outer(np.sin(time), [0.1, 0.2, 1.0]))
    moving = Frame(turning, np.column_stack([time, 0 * time, time**2]))
    return Demonstration(time, data, [Frame(2 * np.eye(3), [1.0, 2, 3]), moving], name=name)


def in_step(d):
    for frame, observation in zip(d.frames, d.observations, strict=True):
        np.testing.assert_allclose(frame.to_local(d.data), observation, atol=1e-9)


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 1000), st.floats(0.05, 0.5))
def test_smoothing_leaves_cubics_alone_at_any_stamps(seed, window):
    rng = np.random.default_rng(seed)
    time = uneven(rng)
    cubic = np.vander(time, 4) @ rng.normal(size=(4, 3))
    d = Demonstration(time, cubic, [Frame(2 * np.eye(3), [1.0, 2, 3])])
    s = smoothed(d, window)
    np.testing.assert_array_equal(s.time, time)
    np.testing.assert_allclose(s.data, cubic, atol=1e-8 * np.abs(cubic).max())
    in_step(s)


def test_smoothing_takes_noise_away_and_keeps_frames_rotations():
    rng = np.random.default_rng(0)
    time = uneven(rng, 400)
    truth = np.column_stack([np.sin(time), np.cos(time), time])
    d = seen(time, truth + 0.01 * rng.normal(size=truth.shape))
    s = smoothed(d, 0.4)
    assert np.std(s.data - truth) < 0.4 * np.std(d.data - truth)
    A = s.frames[1].A
    np.testing.assert_allclose(A.mT @ A, np.tile(np.eye(3), (400, 1, 1)), atol=1e-9)
    in_step(s)


def test_smoothing_keeps_observations_that_are_not_of_the_data():
    time = np.linspace(0, 1, 50)
    own = np.column_stack([time**2])
    d = Demonstration(time, time[:, None], [Frame(np.eye(1), [0.0])], [own])
    np.testing.assert_allclose(smoothed(d, 0.2).observations[0], own, atol=1e-12)


def still_moving_still(rng, T=600):
    time = uneven(rng, T, 6.0)
    progress = np.clip((time - 1.5) / 2.5, 0, 1)
    way = 10 * progress**3 - 15 * progress**4 + 6 * progress**5
    return time, np.outer(way, [0.4, -0.3, 0.2])


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.sampled_from([1e-3, 1.0, 1e3]), st.floats(-1e3, 1e3))
def test_trimming_finds_the_same_ends_in_any_unit(seed, scale, offset):
    rng = np.random.default_rng(seed)
    time, data = still_moving_still(rng)
    data = data + 1e-4 * rng.normal(size=data.shape)
    d = seen(time, scale * data + offset)
    t = trimmed(d, margin=0.0)
    assert 1.4 < t.time[0] < 1.9
    assert 3.6 < t.time[-1] < 4.1
    in_step(t)
    assert len(t.frames[1].b) == len(t)
    wider = trimmed(d, margin=0.3)
    assert wider.time[0] == pytest.approx(t.time[0] - 0.3, abs=0.03)


def test_resampling_by_rate():
    time = np.linspace(0, 1, 11)
    d = seen(time, np.column_stack([time, time**2, -time]))
    r = resampled(d, rate=20)
    np.testing.assert_allclose(r.time, np.linspace(0, 1, 21))
    np.testing.assert_allclose(r.data[:, 0], r.time)
    assert len(resampled(d, rate=3)) == 4
    assert len(resampled(d)) == 11
    assert len(resampled(d, 5)) == 5


def test_alignment_of_different_rates_brings_bumps_together():
    def bump(time, at):
        return np.exp(-(((time - at) / 0.1) ** 2))[:, None]

    demonstrations = []
    for at, T in ((0.4, 50), (0.5, 120), (0.65, 90)):
        time = np.linspace(0, 1, T)
        demonstrations.append(Demonstration(time, bump(time, at), [Frame(np.eye(1), [0.0])]))
    warped = aligned(demonstrations, band=0.3)
    peaks = [d.time[d.data[:, 0].argmax()] for d in warped]
    assert np.ptp(peaks) < 0.03
    for d in warped:
        np.testing.assert_allclose(d.observations[0], d.data)
        np.testing.assert_array_equal(d.time, warped[0].time)


def test_segments_between_stops():
    rng = np.random.default_rng(1)
    parts = [still_moving_still(rng) for _ in range(3)]
    time = np.concatenate([t + 6.1 * i for i, (t, _) in enumerate(parts)])
    data = np.concatenate(
        [x * (1 - 2 * (i % 2)) + (i % 2) * x[-1] for i, (_, x) in enumerate(parts)]
    )
    d = seen(time, data + 1e-4 * rng.normal(size=data.shape), "long")
    segments = segmented(d)
    assert [s.name for s in segments] == ["long-0", "long-1", "long-2"]
    for i, s in enumerate(segments):
        assert s.time[0] == pytest.approx(6.1 * i + 1.65, abs=0.2)
        assert s.time[-1] == pytest.approx(6.1 * i + 3.85, abs=0.2)
        in_step(s)


def test_segments_at_changes_of_direction():
    rng = np.random.default_rng(2)
    time = uneven(rng, 900, 9.0)
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]])
    data = np.column_stack([np.interp(time, [0, 2, 5, 9], c) for c in corners.T])
    d = seen(time, data + 1e-3 * rng.normal(size=data.shape))
    for segments in (segmented(d, "changes"), segmented(d, "changes", pieces=3)):
        ends = [s.time[-1] for s in segments]
        np.testing.assert_allclose(ends, [2, 5, 9], atol=0.1)
        assert sum(len(s) for s in segments) == len(d) + 2


def test_segments_at_times():
    d = seen(np.linspace(0, 1, 11), np.zeros((11, 3)))
    assert [len(s) for s in segmented(d, [0.3, 0.7])] == [4, 5, 4]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda d: trimmed(d, still=2), "still is 2"),
        (lambda d: trimmed(d, margin=-1), "margin is -1"),
        (lambda d: trimmed(seen(d.time, 0 * d.data)), "never moves"),
        (lambda d: smoothed(d, 0), "window is 0"),
        (lambda d: smoothed(d, order=50), "order 50 needs 52 samples"),
        (lambda d: resampled(d, 5, rate=3), "both given"),
        (lambda d: resampled(d, rate=0), "rate is 0"),
        (lambda d: aligned([]), "no demonstrations"),
        (lambda d: aligned([d], band=-1), "band is -1"),
        (lambda d: segmented(d, "pauses"), "'stops' or 'changes'"),
        (lambda d: segmented(d, "changes", pieces=99), "pieces is 99"),
        (lambda d: segmented(d, pause=-1), "pause is -1"),
    ],
)
def test_arguments_out_of_range(call, words):
    time = np.linspace(0, 1, 20)
    d = seen(time, np.column_stack([time, time, time]))
    with pytest.raises(TpsimError, match=words):
        call(d)


def test_speed_on_lines_of_any_length_and_stamps():
    """Also with two samples in a window of a recording of three hours."""
    rng = np.random.default_rng(3)
    for T, window in ((5, 0.0), (100_000, 0.0), (100_000, 1.0)):
        time = 1e4 + np.cumsum(rng.uniform(0.05, 0.15, T))
        d = Demonstration(time, np.outer(time, [3.0, 4.0]))
        np.testing.assert_allclose(speed(d, window), 5, rtol=1e-4)


def test_short_movements_are_not_cut():
    time = np.arange(3.0)
    assert len(segmented(Demonstration(time, time[:, None]), "changes")) == 1
    with pytest.raises(TpsimError, match="only one sample"):
        trimmed(Demonstration([0.0], [[1.0]]))
