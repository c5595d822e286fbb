"""Values own what they hold: nobody changes it from outside, and it cannot be written to."""

import dataclasses

import numpy as np
import pytest

from tpsim import (
    GMM,
    PGMM,
    Demonstration,
    Frame,
    Gaussian,
    LinearSystem,
    MarkovChain,
    fit_gmm,
    fit_gp,
    fit_promp,
    gmr,
    lqr,
    lqt,
)

RNG = np.random.default_rng(0)


def arrays_of(value):
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from arrays_of(part)
    elif dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            yield from arrays_of(getattr(value, field.name))


@pytest.mark.parametrize(
    ("make", "given"),
    [
        (Frame, (np.eye(2), np.zeros(2))),
        (Gaussian, (np.zeros(2), np.eye(2))),
        (Demonstration, (np.arange(3.0), np.zeros((3, 2)), (), [np.zeros((3, 1))])),
        (lambda A, B: LinearSystem(A, B, 0.1), (np.eye(2), np.ones((2, 1)))),
        (MarkovChain, (np.array([1.0, 0.0]), np.eye(2))),
        (lambda p: GMM(p, Gaussian(np.zeros((2, 1)), np.eye(1))), (np.array([0.5, 0.5]),)),
        (PGMM, (np.ones(1), np.zeros((1, 2, 3)), np.eye(2)[None])),
    ],
)
def test_a_value_does_not_follow_the_memory_that_it_was_made_of(make, given):
    value = make(*given)
    before = [array.copy() for array in arrays_of(value)]
    for array in arrays_of(tuple(tuple(g) if isinstance(g, list) else g for g in given)):
        array += 1.0
    for array, old in zip(arrays_of(value), before, strict=True):
        np.testing.assert_array_equal(array, old)


SYSTEM = LinearSystem(np.array([[1.0, 0.1], [0.0, 1.0]]), np.array([[0.0], [0.1]]), 0.1)


@pytest.mark.parametrize(
    "value",
    [
        fit_gmm(RNG.normal(size=(30, 2)), 2),
        fit_promp([RNG.normal(size=(20, 2)) for _ in range(3)], 3),
        fit_gp(np.arange(5.0), RNG.normal(size=(5, 2))),
        gmr(fit_gmm(RNG.normal(size=(30, 2)), 2), [0.1, 0.2]),
        lqt(np.zeros((4, 2)), np.tile(np.eye(2), (4, 1, 1)), SYSTEM, 1.0),
        lqr(SYSTEM, np.eye(2), 1.0),
        Gaussian(np.zeros(2), np.eye(2)).affine(2 * np.eye(2)),
        Demonstration(np.arange(3.0), np.zeros((3, 2)), Frame(np.eye(2), np.zeros(2))).with_time(),
    ],
    ids=lambda value: type(value).__name__,
)
def test_frozen_means_frozen(value):
    found = list(arrays_of(value))
    assert found
    for array in found:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


def test_what_is_remembered_is_frozen_as_well():
    frame, gaussian = Frame(2 * np.eye(2), np.zeros(2)), Gaussian(np.zeros(2), 2 * np.eye(2))
    for remembered in (frame.inverse, gaussian.precision):
        with pytest.raises(ValueError, match="read-only"):
            remembered[0, 0] = 5.0


def test_the_trusted_path_takes_arrays_without_a_copy():
    mean, covariance = np.zeros(2), np.eye(2)
    assert np.shares_memory(Gaussian.trusted(mean, covariance).mean, mean)
    A, b = np.eye(2), np.zeros(2)
    assert np.shares_memory(Frame.trusted(A, b).A, A)
    assert not A.flags.writeable
