"""What is taken for clear at the border, and how everything else is refused."""

import datetime

import numpy as np
import pytest

from tpsim import (
    GMM,
    Demonstration,
    Frame,
    Gaussian,
    Motion,
    PlanarChain,
    TpsimError,
    attractor_path,
    checks,
    fit_gmm,
    fit_gp,
    fit_hmm,
    fit_hsmm,
    fit_promp,
    fit_tp_gmm,
    fit_trajectory_distribution,
    gmr,
    impedance,
    integrator,
    lqt,
    lwr,
    match_moments,
    projection,
    spring_damper,
    trajectory,
)
from tpsim.errors import ArgumentError

T = np.linspace(0, 1, 20)
D = np.random.default_rng(0).normal(size=(20, 2))
FRAME = Frame(np.eye(2), np.zeros(2))


class Table:
    """Behaves as a DataFrame does: an array inside, iterating gives the names of columns."""

    def __init__(self, array, columns):
        self.array, self.columns = array, columns

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.array, dtype)

    def __iter__(self):
        return iter(self.columns)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ([1.0, np.nan], "row 1 of 2"),
        ([[1.0, 2.0], [3.0, np.inf]], "row 1 of 2, column 1"),
        (np.ma.masked_equal([1.0, 999.0], 999.0), "masked entries, the first in row 1"),
        ([np.ma.masked_equal([1.0, 999.0], 999.0)], "masked"),
        ([1 + 2j], "complex"),
        ([b"1.0"], "bytes"),
        (["1.0"], "text"),
        (np.array(["2026-01-01"], "datetime64[s]"), "dates"),
        (np.array([1], "timedelta64[ms]"), "durations"),
        (np.zeros(2, [("x", float), ("y", float)]), "named fields"),
        ([[1.0], [1.0, 2.0]], "numbers"),
        ([10**400], "too large"),
        ([None, 1.0], "row 0"),
        (np.array([1.0, "2.0"], object), "row 1"),
        (Table(np.array([[1.0, "a"]], object), ["x", "name"]), "column 'name'"),
    ],
)
def test_arrays_that_casting_would_bend_are_refused_with_their_place(value, words):
    with pytest.raises(ArgumentError, match=f"data.*{words}"):
        checks.finite_array("data", value)


@pytest.mark.parametrize(
    "value",
    [
        [1, 2],
        (True, False),
        np.float32([1.5, 2.5]),
        np.ma.array([1.0, 2.0]),
        np.array([1, 2.5], object),
    ],
)
def test_plain_numbers_of_any_type_are_taken(value):
    found = checks.finite_array("data", value)
    assert found.dtype == np.float64
    np.testing.assert_array_equal(found, np.asarray(value, float))


START = datetime.datetime(2026, 1, 1)


@pytest.mark.parametrize(
    "time",
    [
        np.datetime64("2026-01-01T00:00:00.000") + 10 * np.arange(4) * np.timedelta64(1, "ms"),
        (np.datetime64("2026-01-01") + 10_000 * np.arange(4) * np.timedelta64(1, "us")),
        10_000_000 * np.arange(4) * np.timedelta64(1, "ns"),
        [START + k * datetime.timedelta(milliseconds=10) for k in range(4)],
        [k * datetime.timedelta(milliseconds=10) for k in range(4)],
    ],
)
def test_dates_and_durations_become_seconds_by_their_unit(time):
    found = Demonstration(time, np.zeros((4, 1)) + np.arange(4)[:, None]).with_derivatives(1)
    np.testing.assert_allclose(found.time, [0, 0.01, 0.02, 0.03], atol=1e-12)
    np.testing.assert_allclose(found.data[:-1, 1], 100.0)


@pytest.mark.parametrize(
    ("time", "words"),
    [
        ([0.0, 1.0, 1.0, 2.0], "sample 2"),
        ([0.0, 1.0, 0.5], "sample 2 .0.5 s. does not come after sample 1"),
        (np.float32(1.7e9 + np.arange(3) / 30), "float32"),
        (np.array(["2026-01-01", "NaT"], "datetime64[s]"), "NaT"),
        (np.arange(3).astype("timedelta64"), "without a unit"),
        ([0.0, 1e-320], "change the unit"),
    ],
)
def test_stamps_that_do_not_increase_are_named(time, words):
    with pytest.raises(ArgumentError, match=words):
        Demonstration(time, np.zeros((len(time), 1)), name="third")


def test_an_error_names_the_demonstration():
    with pytest.raises(ArgumentError, match=r"'third'.*row 7"):
        Demonstration(T, np.where(np.arange(20) == 7, np.nan, T)[:, None], name="third")
    with pytest.raises(ArgumentError, match=r"data\[2\].*row 4"):
        fit_gmm([D, D, np.where(np.arange(20)[:, None] == 4, np.nan, D)], 2)
    with pytest.raises(ArgumentError, match="demonstration 1"):
        fit_tp_gmm([Demonstration(T, D, [FRAME]), Demonstration(T, D, [FRAME, FRAME])], 2)


def test_what_is_clear_is_accepted():
    one = Demonstration(T, D, FRAME)
    moving = Frame(np.tile(np.eye(2), (20, 1, 1)), np.zeros(2))
    assert len(one.frames) == len(Demonstration(T, D, moving).frames) == 1
    assert Demonstration(T, D, None).frames == ()
    model = fit_gmm(D, 2, rng=0)
    np.testing.assert_array_equal(
        model.gaussians.mean, fit_gmm(D, 2, rng=np.random.default_rng(0)).gaussians.mean
    )
    np.testing.assert_array_equal(model.sample(3, 4), model.sample(np.random.default_rng(3), 4))
    np.testing.assert_array_equal(gmr(model, [0.1], 0).mean, gmr(model, [0.1], (0,)).mean)
    np.testing.assert_array_equal(
        Gaussian([0.0, 1.0], np.eye(2)).condition([1.0], 0).mean, np.ones(1)
    )
    assert fit_tp_gmm(one, 2).adapt(FRAME).components == 2
    assert fit_hmm([D], 2).viterbi(D[0]).shape == (1,)
    np.testing.assert_array_equal(
        fit_gmm(Table(D, ["x", "y"]), 2).gaussians.mean, fit_gmm(D, 2).gaussians.mean
    )
    np.testing.assert_array_equal(
        fit_gmm(one, 2, start="time").priors, fit_gmm(D, 2, start="time").priors
    )


MODEL = GMM([0.5, 0.5], Gaussian([[0.0, 0.0], [1.0, 1.0]], np.eye(2)))
TP = fit_tp_gmm([Demonstration(T, D, [FRAME, FRAME])], 2)
TRACK = (np.ones((3, 4)), np.tile(np.eye(4), (3, 1, 1)))


@pytest.mark.parametrize(
    "call",
    [
        lambda: Gaussian([0, 0], [[1, 2], [2, 1]]),
        lambda: Gaussian([0, 0], np.eye(2)).sample("a"),
        lambda: Gaussian([0, 0], np.eye(2)).sample(0, 1.5),
        lambda: gmr(MODEL, [[0.1]], ridge=np.nan),
        lambda: gmr(MODEL, [[0.1]], ridge=-1.0),
        lambda: gmr(TP, [[0.1]]),
        lambda: MODEL.responsibilities(np.full((1, 2), 1e160)),
        lambda: lwr(T, D, T[:1], 0.1, ridge=-1),
        lambda: lwr(T, D, T[:1], np.nan),
        lambda: fit_hsmm([D], 2).log_likelihood(D * 1e160),
        lambda: fit_hmm([D], 2).viterbi(D[:0]),
        lambda: attractor_path(Motion.of(D, 0.1), 5.0, np.nan),
        lambda: PlanarChain([np.nan, 1.0]),
        lambda: projection.pseudoinverse(np.full((1, 2), np.inf)),
        lambda: projection.relative(np.ones((2, 3)), np.zeros(3), np.zeros(2), np.eye(2), [0] * 3),
        lambda: match_moments([-1, 2], MODEL.gaussians),
        lambda: TP.adapt([np.eye(2), np.eye(2)]),
        lambda: TP.adapt([Frame(np.tile(np.eye(2), (k, 1, 1)), [0.0, 0.0]) for k in (3, 4)]),
        lambda: lqt(*TRACK, None, 1e-3),
        lambda: lqt(*TRACK, integrator(2, 0.1), 1e-3).rollout("a"),
        lambda: impedance(np.empty((0, 0)), 1.0),
        lambda: integrator(1.5, 0.1),
        lambda: spring_damper(np.zeros((3, 1)), 1.0, 1.0, np.nan),
        lambda: fit_promp([D], 2.5),
        lambda: fit_promp([D, D], 2, ridge=np.nan),
        lambda: fit_trajectory_distribution(np.stack([D, D]), 1.0),
        lambda: fit_gp(T, D, kernel="rbf"),
        lambda: fit_gmm(D, 2, rng=-1),
        lambda: fit_gmm(D * 1e-150, 2),
        lambda: trajectory(np.zeros((3, 2)), np.tile(np.eye(2), (3, 1, 1)), 1e-300, derivatives=1),
        lambda: Demonstration(T, D, [FRAME]).resampled(np.nan),
        lambda: Demonstration(T, D, [FRAME]).with_derivatives(1.5),
    ],
)
def test_nonsense_ends_in_the_one_error(call):
    with pytest.raises(TpsimError, match=r"."):
        call()
