"""Time counts: derivatives, phases and models by the stamps, not by the number of the row."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import (
    Demonstration,
    Frame,
    Motion,
    TpsimError,
    align,
    fit_hmm,
    fit_hsmm,
    fit_promp,
    fit_tp_gmm,
    fit_tp_promp,
    fit_tp_trajectory_distribution,
    fit_trajectory_distribution,
    gmr,
    timeline,
)
from tpsim.errors import DataWarning
from tpsim.timeline import around

EVEN = np.linspace(0, 2, 201)
LOSSY = EVEN[np.unique(np.r_[0:20, 20:201:6, 200])]
FRAME = [Frame(np.eye(2), np.zeros(2))]


def movement(t):
    return np.column_stack([t, np.sin(t)])


def shown(times, frames=FRAME):
    return [Demonstration(t, movement(t) + 0.01 * k, frames) for k, t in enumerate(times)]


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 3), st.integers(0, 10**6), st.floats(-1e5, 1e5))
def test_derivatives_are_exact_for_polynomials_however_the_stamps_lie(n, seed, start):
    """The n-th divided difference of a polynomial of degree n is its n-th derivative."""
    rng = np.random.default_rng(seed)
    t = start + np.cumsum(rng.uniform(0.05, 1.0, 12))
    roots = rng.uniform(-1, 1, n)
    x = np.prod([t - start - root for root in roots], axis=0)
    found = Demonstration(t, x[:, None]).with_derivatives(n).data[:-n, n]
    np.testing.assert_allclose(found, [1, 2, 6][n - 1], rtol=1e-5)


def test_central_differences_of_uneven_stamps_are_exact_inside():
    t = np.cumsum(np.tile([0.008, 0.012], 20))
    motion = Motion.of(Demonstration(t, 1.5 * t[:, None] ** 2))
    np.testing.assert_allclose(motion.velocity[1:-1, 0], 3 * t[1:-1], rtol=1e-9)
    np.testing.assert_allclose(motion.acceleration[2:-2, 0], 3.0, rtol=1e-9)


@pytest.mark.parametrize(
    "fit",
    [
        lambda some: fit_tp_promp(some, 12).adapt(FRAME).distribution(201),
        lambda some: fit_promp(some, 12).distribution(201),
    ],
)
def test_primitives_take_the_phase_from_the_stamps(fit):
    for times in ([LOSSY] * 3, [EVEN, LOSSY, EVEN[::3]]):
        found = fit(shown(times)).marginal().mean
        np.testing.assert_allclose(found, movement(EVEN) + 0.01, atol=1e-2)


def test_a_gap_is_bridged_by_a_primitive():
    gap = EVEN[(EVEN < 0.8) | (EVEN > 1.2)]
    found = fit_promp([Demonstration(gap, movement(gap))], 20).distribution(201)
    np.testing.assert_allclose(found.mean, movement(EVEN), atol=0.05)


def test_distributions_bring_uneven_demonstrations_to_even_steps():
    late = 2 * (EVEN / 2) ** 2 + 1e-9 * np.arange(201)
    some = shown([EVEN, late, EVEN])
    for found in (
        fit_tp_trajectory_distribution(some, 2).adapt(FRAME).marginal(),
        fit_trajectory_distribution(some, 2).marginal(),
    ):
        np.testing.assert_allclose(found.mean, movement(EVEN) + 0.01, atol=1e-3)
        assert np.sqrt(found.covariance[:, 0, 0]).max() < 0.011


@pytest.mark.parametrize("fit", [fit_hmm, fit_hsmm])
def test_models_that_count_samples_refuse_uneven_ones_and_tell_of_other_rates(fit):
    with pytest.raises(TpsimError, match=r"demonstration 1 .*resampled"):
        fit(shown([EVEN, LOSSY]), 3)
    with pytest.warns(DataWarning, match="resampled"):
        model = fit(shown([EVEN, EVEN[::2]]), 3)
    with pytest.raises(TpsimError, match="resampled"):
        model.viterbi(shown([LOSSY])[0])


def test_a_mixture_starts_by_the_stamps():
    """A third of the time each, although most samples are of the first tenth."""
    some = [one.with_time() for one in shown([LOSSY, LOSSY])]
    model = fit_tp_gmm(some, 3, start="time", max_iterations=0)
    centres = model.frames[0].mean[:, 0]
    np.testing.assert_allclose(centres[1:], [1.0, 1.667], atol=0.06)


VIEWS = [np.column_stack([np.cos(EVEN), EVEN]), np.sin(EVEN)[:, None]]


def test_views_without_frames_are_learned_warped_and_kept(tmp_path):
    """What an observer saw that no affine frame maps to the data."""
    seen = [
        Demonstration(EVEN, movement(EVEN), None, [v + 0.01 * k for v in VIEWS]) for k in (0, 1)
    ]
    timed = [d.resampled(50).with_time().with_derivatives(1) for d in align(seen, by="frames")]
    assert [v.shape for v in timed[0].observations] == [(50, 6), (50, 4)]
    model = fit_tp_gmm([d.resampled(50).with_time() for d in seen], 4)
    assert model.dims == (3, 2)
    again = Demonstration.load(timed[0].save(tmp_path / "seen.npz"))
    assert again.frames == ()
    np.testing.assert_array_equal(again.observations[1], timed[0].observations[1])
    with pytest.raises(TpsimError, match="observations have shapes"):
        Demonstration(EVEN, movement(EVEN), None, [VIEWS[0][:5]])


def test_weights_of_samples_are_the_time_that_they_stand_for():
    assert timeline.weights(np.array([0.0, 1.0, 4.0])) @ [1, 1, 1] == 1
    np.testing.assert_allclose(timeline.weights(np.array([0.0, 1.0, 4.0])), [1 / 8, 1 / 2, 3 / 8])


def test_retrieval_over_lossy_time_follows_the_movement():
    some = [one.with_time() for one in shown([LOSSY, LOSSY, LOSSY])]
    path = gmr(fit_tp_gmm(some, 6).adapt([some[0].frames[0]]), EVEN)
    np.testing.assert_allclose(path.mean, movement(EVEN) + 0.01, atol=0.03)


def test_ends_are_held_and_jumps_are_jumps():
    time = np.array([0.0, 1.0, 1.0, 3.0])
    before, after, share = around(time, np.array([-1.0, 0.25, 1.0, 2.0, 3.0, 9.0]))
    np.testing.assert_array_equal(before, [0, 0, 2, 2, 3, 3])
    np.testing.assert_array_equal(after, [1, 1, 3, 3, 3, 3])
    np.testing.assert_array_equal(share, [0.0, 0.25, 0.0, 0.5, 0.0, 1.0])
