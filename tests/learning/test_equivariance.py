"""Unit, origin and clock of the data: x -> s x + c and t -> s t + c change nothing else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import (
    HDDC,
    MFA,
    MPPCA,
    Demonstration,
    Frame,
    dp_means,
    dtw,
    fit_gmm,
    fit_hmm,
    fit_hsmm,
    fit_pgmm,
    fit_tp_gmm,
    frame_report,
    gaussian_product,
    gmr,
    update_tp_gmm,
)

SCALES = st.floats(-3, 3).map(lambda x: 10.0**x)
ORIGINS = st.floats(-1e6, 1e6)
CHANGES = given(s=SCALES, c=ORIGINS, r=SCALES, d=ORIGINS)
"""x -> s (x + c) in space, t -> r (t + d) in time; both have a spread of about one."""

FEW = settings(max_examples=6, deadline=None)
WITHIN = 1e-3  # of the spread: EM ends by a tolerance


def paths(count=4, length=40, seed=0):
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 1, length)
    return t, [
        np.column_stack([t + 0.1 * rng.normal(), np.sin(4 * t + 0.1 * rng.normal())])
        + 0.02 * rng.normal(size=(length, 2))
        for _ in range(count)
    ]


def demonstrations(s=1.0, c=0.0, r=1.0, d=0.0):
    """Movements between two places; the whole world in another unit, around another origin."""
    t, found = paths()
    rng = np.random.default_rng(1)
    frames = [
        [
            Frame(np.eye(2), s * (rng.normal(size=2) + c)),
            Frame([[0.6, -0.8], [0.8, 0.6]], s * (rng.normal(size=2) + c)),
        ]
        for _ in found
    ]
    return [Demonstration(r * (t + d), s * (x + c), f) for x, f in zip(found, frames, strict=True)]


def same_gaussians(found, expected, s, c, within=WITHIN):
    np.testing.assert_allclose(found.mean / s - c, expected.mean, atol=within)
    np.testing.assert_allclose(
        found.covariance / s**2,
        expected.covariance,
        atol=within * np.abs(expected.covariance).max(),
    )


@FEW
@CHANGES
@pytest.mark.parametrize("covariance", ["full", "diagonal", "spherical", HDDC(1), MFA(1), MPPCA(1)])
def test_gmm(covariance, s, c, r, d):
    _, data = paths()
    expected = fit_gmm(data, 3, covariance=covariance)
    found = fit_gmm([s * (x + c) for x in data], 3, covariance=covariance)
    same_gaussians(found.gaussians, expected.gaussians, s, c)
    np.testing.assert_allclose(found.priors, expected.priors, atol=WITHIN)


@FEW
@CHANGES
def test_tp_gmm_over_time_adapted_and_retrieved(s, c, r, d):
    plain, changed = demonstrations(), demonstrations(s, c, r, d)
    models = [fit_tp_gmm([one.with_time() for one in some], 3) for some in (plain, changed)]
    times = np.linspace(0, 1, 9)
    new = [Frame(np.eye(2), [0.3, 0.1]), Frame(np.eye(2), [-0.2, 0.4])]
    moved = [Frame(frame.A, s * (frame.b + c)) for frame in new]
    expected = gmr(models[0].adapt([frame.with_input() for frame in new]), times)
    found = gmr(models[1].adapt([frame.with_input() for frame in moved]), r * times)
    same_gaussians(found, expected, s, c)


@FEW
@CHANGES
def test_updated_tp_gmm_and_report_of_frames(s, c, r, d):
    plain, changed = demonstrations(), demonstrations(s, c, r, d)
    models = [update_tp_gmm(fit_tp_gmm(some[:2], 2), some[2:]) for some in (plain, changed)]
    for one, other in zip(models[0].frames, models[1].frames, strict=True):
        np.testing.assert_allclose(other.mean / s, one.mean, atol=10 * WITHIN)
    reports = [
        frame_report(model, some, draws=20)
        for model, some in zip(models, (plain, changed), strict=True)
    ]
    np.testing.assert_allclose(reports[1].mean, reports[0].mean, atol=10 * WITHIN)
    np.testing.assert_array_equal(reports[1].chance, reports[0].chance)


@FEW
@CHANGES
@pytest.mark.parametrize("fit", [fit_hmm, fit_hsmm])
def test_hidden_states(fit, s, c, r, d):
    t, data = paths()
    expected = fit(data, 3)
    found = fit([Demonstration(r * (t + d), s * (x + c)) for x in data], 3)
    same_gaussians(found.gaussians, expected.gaussians, s, c)
    np.testing.assert_allclose(found.chain.transitions, expected.chain.transitions, atol=WITHIN)


@FEW
@CHANGES
def test_parametric_gmm(s, c, r, d):
    _, data = paths()
    Q = np.array([[0.0, 1.0], [1.0, 0.5], [0.3, -1.0], [-1.0, 0.2]])
    expected = fit_pgmm(data, Q, 2).adapt([0.2, 0.1]).gaussians
    model = fit_pgmm([s * (x + c) for x in data], r * (Q + d), 2)
    same_gaussians(model.adapt(r * (np.array([0.2, 0.1]) + d)).gaussians, expected, s, c)


@FEW
@CHANGES
def test_clusters_and_warps(s, c, r, d):
    _, (x, y, *_) = paths()
    np.testing.assert_array_equal(dp_means(s * (x + c), 0.5), dp_means(x, 0.5))
    warp, expected = dtw(s * (x + c), s * (y + c), band=9), dtw(x, y, band=9)
    assert np.isclose(warp.cost / s, expected.cost, rtol=1e-6)


@FEW
@CHANGES
def test_products_far_from_the_origin(s, c, r, d):
    _, data = paths()
    gaussian = fit_gmm(data, 2).gaussians
    moved = [
        type(gaussian)(s * (g.mean + c), s**2 * g.covariance) for g in (gaussian[0], gaussian[1])
    ]
    same_gaussians(
        gaussian_product(moved), gaussian_product([gaussian[0], gaussian[1]]), s, c, 1e-6
    )


def test_a_long_approach_does_not_soften_what_is_precise_at_the_end():
    """Docking with a scatter of 1 mm, after an approach of 0.3 m or of 30 m."""

    def stiffness_at_the_end(length):
        rng, t = np.random.default_rng(0), np.linspace(0, 1, 200)
        reach = np.where(t < 0.6, (0.6 - t) / 0.6, 0.0)[:, None]
        data = [
            reach * (length * np.array([1.0, 0.2]) + 0.05 * length * rng.normal(size=(200, 2)))
            + 1e-3 * rng.normal(size=(200, 2))
            for _ in range(5)
        ]
        timed = [Demonstration(t, x, [Frame(np.eye(2), np.zeros(2))]).with_time() for x in data]
        model = fit_tp_gmm(timed, 5, start="time").adapt([timed[0].frames[0]])
        return np.linalg.eigvalsh(gmr(model, [0.95]).covariance[0])

    near, far = stiffness_at_the_end(0.3), stiffness_at_the_end(30.0)
    np.testing.assert_allclose(np.sqrt(near), 1e-3, rtol=0.2)
    np.testing.assert_allclose(np.sqrt(far), 1e-3, rtol=0.2)
