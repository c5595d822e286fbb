import numpy as np
import pytest

from tpsim import KMP, Gaussian, SquaredExponential, fit_gp
from tpsim.errors import ArgumentError

TIMES = np.linspace(0.0, 1.0, 21)


def a_path(noise=1e-2):
    mean = np.column_stack([np.sin(3 * TIMES), TIMES**2])
    return Gaussian(mean, np.tile(noise * np.eye(2), (len(TIMES), 1, 1)))


def test_equal_noise_is_a_gaussian_process():
    """With Sigma = s I the mean is that of a Gaussian process of unit variance and noise s."""
    kmp = KMP(TIMES, a_path(0.04), length=0.2)
    process = fit_gp(TIMES, a_path().mean, SquaredExponential(1.0, 0.2, 0.04))
    queries = np.linspace(0, 1, 33)
    ours, theirs = kmp(queries), process(queries)
    np.testing.assert_allclose(ours.mean, theirs.mean, atol=1e-9)
    np.testing.assert_allclose(ours.covariance, len(TIMES) * theirs.covariance, atol=1e-8)


def test_goes_through_a_desired_point_and_elsewhere_stays():
    kmp = KMP(TIMES, a_path(), length=0.1)
    bent = kmp.through(0.5, [0.0, 1.0], 1e-8 * np.eye(2))
    at = bent([0.5])
    np.testing.assert_allclose(at.mean[0], [0, 1], atol=1e-3)
    assert np.trace(at.covariance[0]) < 1e-3 * np.trace(kmp([0.5]).covariance[0])
    np.testing.assert_allclose(bent([0.0]).mean, kmp([0.0]).mean, atol=1e-3)
    assert len(bent.inputs) == len(TIMES)
    assert len(kmp.through(2.0, [0, 0], np.eye(2)).inputs) == len(TIMES) + 1


def test_less_certain_points_count_less():
    precise = KMP(TIMES, a_path(1e-4), length=0.3)
    path = a_path(1e-4)
    covariance = path.covariance.copy()
    covariance[10] *= 1e6
    mean = path.mean.copy()
    mean[10] += 5.0
    doubtful = KMP(TIMES, Gaussian(mean, covariance), length=0.3)
    np.testing.assert_allclose(doubtful(TIMES).mean, precise(TIMES).mean, atol=0.05)


def test_follows_a_shift_of_the_origin():
    kmp = KMP(TIMES, a_path(), length=0.1)
    path = a_path()
    moved = KMP(TIMES, Gaussian(path.mean + 100.0, path.covariance), length=0.1)
    np.testing.assert_allclose(moved(TIMES).mean, kmp(TIMES).mean + 100.0, atol=1e-8)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: KMP(TIMES[:5], a_path(), 0.1), r"\(N,\)"),
        (lambda: KMP(TIMES, a_path(), 0.0), "length is 0.0"),
        (lambda: KMP(TIMES, a_path(), 0.1).through(0.5, [0.0], np.eye(1)), "point has shape"),
        (lambda: KMP(TIMES, a_path(), 0.1)([np.nan]), "NaN"),
    ],
)
def test_bad_arguments(call, words):
    with pytest.raises(ArgumentError, match=words):
        call()
