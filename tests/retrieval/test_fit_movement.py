"""Movements that choose for themselves: what they promise near and far, and their clock."""

import numpy as np
import pytest

from tpsim import (
    Demonstration,
    Frame,
    TPTrajectory,
    fit_movement,
    fit_tp_gmr,
    fit_tp_trajectory,
    on_one_clock,
    tp_gmr,
)
from tpsim.errors import ArgumentError
from tpsim.examples import u_demonstration, u_demonstrations, u_frames
from tpsim.retrieval.left_out import choose, left_out_error, left_out_scale

SAMPLES = 50
FITS = (fit_movement, fit_tp_gmr, fit_tp_trajectory)


@pytest.fixture(scope="module")
def taught():
    return u_demonstrations(4, SAMPLES, np.random.default_rng(5))


def far_errors(movement, spread, count=12):
    rng, errors = np.random.default_rng(9), []
    for _ in range(count):
        frames = u_frames(rng, spread)
        apart = movement(frames).mean - u_demonstration(frames, SAMPLES).data
        errors.append([np.sqrt((apart**2).sum(1).mean()), np.linalg.norm(apart[-1])])
    return np.mean(errors, axis=0)


def test_the_default_generalises(taught):
    """At four times the taught spread: a small error, at the end no larger than nearby."""
    movement = fit_movement(taught)
    near, far = far_errors(movement, 1.0), far_errors(movement, 4.0)
    assert near[0] < 0.1
    assert far[0] < 0.2
    assert far[1] < 1.5 * near[1]
    product = fit_tp_gmr(taught, 6, covariance="full", order="product")
    assert far[0] < 0.5 * far_errors(product, 4.0)[0]


def test_two_demonstrations_are_enough(taught):
    movement = fit_movement(taught[:2])
    assert isinstance(movement, TPTrajectory)
    assert far_errors(movement, 4.0)[0] < 0.3
    assert far_errors(fit_tp_gmr(taught[:2]), 4.0)[0] < 0.7


@pytest.mark.parametrize("fit", FITS)
def test_one_demonstration_is_repeated_where_it_was_shown(fit, taught):
    path = fit(taught[:1])(taught[0].frames)
    assert np.abs(path.mean - taught[0].data).max() < 0.05


def test_the_number_of_components_predicts_best_what_was_left_out(taught):
    movement = fit_tp_gmr(taught, (2, 6))
    assert movement.model.components == min(movement.errors, key=movement.errors.get) == 6
    again = left_out_error(lambda some: fit_tp_gmr(some, 2), taught)
    assert movement.errors[2] == pytest.approx(again)


def test_regression_remembered_is_regression(taught):
    movement, frames = fit_tp_gmr(taught, 5), u_frames(np.random.default_rng(1), 2.0)
    expected = tp_gmr(movement.model, frames, movement.times)
    for given in (frames, [frame.with_input() for frame in frames]):
        np.testing.assert_allclose(movement(given).mean, expected.mean, atol=1e-10)
    one = movement([frames[0], None])
    np.testing.assert_allclose(
        one.mean, tp_gmr(movement.model, [frames[0], None], movement.times).mean, atol=1e-10
    )


def test_the_tube_is_as_wide_as_what_was_left_out(taught):
    movement = fit_tp_trajectory(taught, 6)

    def unscaled(some):
        fitted = fit_tp_trajectory(some, 6)
        return TPTrajectory(fitted.model, fitted.times)

    assert movement.scale == pytest.approx(left_out_scale(unscaled, taught))
    narrow = TPTrajectory(movement.model, movement.times)(taught[0].frames)
    wide = movement(taught[0].frames)
    np.testing.assert_allclose(wide.covariance, movement.scale * narrow.covariance)


def test_choosing_takes_the_smallest_error():
    moved = [Demonstration([0, 1], [[m, 0], [m, 1]]) for m in (0.0, 1.0, 2.0)]
    fits = {
        shift: lambda some, shift=shift: (
            lambda frames: type(
                "G", (), {"mean": np.mean([d.data for d in some], axis=0) + shift}
            )()
        )
        for shift in (0.0, 5.0)
    }
    best, errors = choose(fits, moved, 5.0)
    assert best == 0.0
    assert errors[0.0] == pytest.approx(np.sqrt((1.5**2 + 0 + 1.5**2) / 3))
    assert choose(fits, moved[:2], 5.0) == (5.0, {})


def test_missing_frames_are_done_without(taught):
    frames = u_frames(np.random.default_rng(4), 1.0)
    for fit in (fit_tp_gmr, fit_tp_trajectory):
        movement = fit(taught, 6)
        alone = movement([None, frames[1]])
        assert np.linalg.norm(alone.mean[-1] - frames[1].b) < 0.05
        with pytest.raises(ArgumentError, match=r"None|observed"):
            movement([None, None])
        with pytest.raises(ArgumentError, match="1 frames"):
            movement(frames[:1])


def test_one_clock_stretches_and_samples(taught):
    slow = Demonstration(3 + 2 * taught[0].time, taught[0].data, taught[0].frames)
    short = taught[1].resampled(30)
    clocked = on_one_clock([slow, short, taught[2]])
    for demonstration in clocked:
        np.testing.assert_allclose(demonstration.time, np.linspace(0, 2, SAMPLES))
    np.testing.assert_allclose(clocked[0].data, taught[0].data, atol=1e-9)
    np.testing.assert_allclose(clocked[1].data, taught[1].data, atol=0.01)
    np.testing.assert_array_equal(clocked[2].data, taught[2].data)
    assert len(on_one_clock(taught, 20)[0]) == 20


def test_unequal_lengths_are_learned(taught):
    cut = [d.resampled(n) for d, n in zip(taught, (40, 50, 60, 70), strict=True)]
    assert len(fit_tp_gmr(cut, 6).times) == 55
    assert far_errors(fit_tp_trajectory(on_one_clock(cut, SAMPLES), 6), 1.0)[0] < 0.1


@pytest.mark.parametrize("fit", FITS)
def test_bad_demonstrations(fit, taught):
    with pytest.raises(ArgumentError, match="no demonstration"):
        fit([])
    single = Demonstration([0.0], [[0.0, 0.0]], [Frame(np.eye(2), [0, 0])] * 2)
    with pytest.raises(ArgumentError, match="at least 2 samples"):
        fit([single])
    other = Demonstration(taught[0].time, taught[0].data, taught[0].frames[:1])
    with pytest.raises(ArgumentError, match="same frames"):
        fit([taught[1], other])
    if fit is not fit_movement:
        with pytest.raises(ArgumentError, match="components is empty"):
            fit(taught, ())
