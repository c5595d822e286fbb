"""EM where not every frame saw every sample: against brute force, and against complete data."""

import warnings

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from tpsim import (
    TPGMM,
    ArgumentError,
    DataWarning,
    Gaussian,
    fit_hmm,
    fit_hsmm,
    fit_tp_gmm,
    update_tp_gmm,
)
from tpsim.bench.poses import POSES, movements
from tpsim.examples import u_demonstrations
from tpsim.learning.hidden import filled

K, DIMS = 2, (2, 1, 2)
OPTIONS = {"start": "time", "tolerance": 1e-9, "max_iterations": 200}


@pytest.fixture(scope="module")
def truth():
    rng = np.random.default_rng(3)
    roots = [0.3 * rng.normal(size=(K, d, d)) + 0.4 * np.eye(d) for d in DIMS]
    frames = [
        Gaussian(4 * rng.normal(size=(K, d)), root @ root.mT)
        for d, root in zip(DIMS, roots, strict=True)
    ]
    return TPGMM([0.4, 0.6], frames)


def drawn(model, count, seed=0):
    rng = np.random.default_rng(seed)
    k = np.sort(rng.choice(K, count, p=model.priors))
    views = [frame[k].sample(rng) for frame in model.frames]
    return views, rng.random((count, len(DIMS))) > 0.35


def with_nan(views, seen):
    return [np.where(seen[:, j, None], view, np.nan) for j, view in enumerate(views)]


def brute_joint(model, views, seen):
    """Log of prior times density of the blocks that were seen, one sample after the other."""
    joint = np.log(model.priors) * np.ones((len(seen), 1))
    for n, row in enumerate(seen):
        for k in range(K):
            for j in np.flatnonzero(row):
                frame = model.frames[j]
                density = multivariate_normal(frame.mean[k], frame.covariance[k])
                joint[n, k] += density.logpdf(views[j][n])
    return joint


def test_the_likelihood_is_the_marginal_one_of_the_blocks_that_were_seen(truth):
    views, seen = drawn(truth, 40)
    seen[5] = False  # nobody saw it: it says nothing
    joint = brute_joint(truth, views, seen)
    found = truth.log_likelihood(with_nan(views, seen), seen)
    np.testing.assert_allclose(found, np.log(np.exp(joint).sum(1)), atol=1e-10)
    h = truth.responsibilities(views, seen)
    np.testing.assert_allclose(h, np.exp(joint) / np.exp(joint).sum(1, keepdims=True), atol=1e-10)
    np.testing.assert_allclose(h[5], truth.priors)


def test_one_step_of_em_is_that_of_the_equations_over_what_was_seen(truth):
    views, seen = drawn(truth, 60)
    start = fit_tp_gmm(views, K, start="time", max_iterations=0)
    found = fit_tp_gmm(
        with_nan(views, seen), K, start=start, observed=seen, ridge=0.0, max_iterations=1
    )
    joint = brute_joint(start, views, seen)
    h = np.exp(joint) / np.exp(joint).sum(1, keepdims=True)
    np.testing.assert_allclose(found.priors, h.mean(0), atol=1e-10)
    assert found.history[0] == pytest.approx(np.log(np.exp(joint).sum(1)).mean(), abs=1e-10)
    for j, (frame, view) in enumerate(zip(found.frames, views, strict=True)):
        for k in range(K):
            w = h[:, k] * seen[:, j]
            mean = w @ view / w.sum()
            np.testing.assert_allclose(frame.mean[k], mean, atol=1e-10)
            spread = (w[:, None] * (view - mean)).T @ (view - mean) / w.sum()
            np.testing.assert_allclose(frame.covariance[k], spread, atol=1e-10)


def test_where_nothing_is_hidden_the_answer_has_the_same_bits(truth):
    views, seen = drawn(truth, 200)
    whole, again = (fit_tp_gmm(views, K, observed=o) for o in (None, np.ones_like(seen)))
    assert np.array_equal(whole.history, again.history)
    for one, other in zip(whole.frames, again.frames, strict=True):
        assert np.array_equal(one.covariance, other.covariance)
    demonstrations = u_demonstrations(2)
    masks = [np.ones((len(d), len(d.frames)), bool) for d in demonstrations]
    whole, again = (fit_tp_gmm(demonstrations, 3, observed=o) for o in (None, masks))
    assert np.array_equal(whole.frames[1].mean, again.frames[1].mean)


def test_masked_entries_count_as_missing_and_are_refused_where_they_are_said_to_be_seen(truth):
    views, seen = drawn(truth, 50)
    hidden = [np.ma.masked_array(v, np.zeros(v.shape, bool)) for v in views]
    for view, told in zip(hidden, seen.T, strict=True):
        view[~told] = np.ma.masked
    plain, masked = (fit_tp_gmm(some, K, observed=seen) for some in (views, hidden))
    assert np.array_equal(plain.history, masked.history)
    first = int(seen[:, 1].argmax())
    hidden[1][first] = np.ma.masked
    with pytest.raises(ArgumentError, match=r"observations\[1\] has masked entries"):
        fit_tp_gmm(hidden, K, observed=seen)


@pytest.mark.parametrize("covariance", ["full", "diagonal", "spherical"])
@pytest.mark.parametrize("seed", [0, 1])
def test_the_likelihood_never_falls(truth, covariance, seed):
    views, seen = drawn(truth, 150, seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)
        found = fit_tp_gmm(views, 3, observed=seen, covariance=covariance, **OPTIONS)
    assert (np.diff(found.history) > -1e-9).all()
    mean = found.log_likelihood(views, seen).mean()
    assert mean == pytest.approx(found.history[-1], abs=1e-9)


def test_parameters_are_recovered_from_samples_that_are_hidden_at_random(truth):
    views, seen = drawn(truth, 4000)
    found = fit_tp_gmm(with_nan(views, seen), K, observed=seen, **OPTIONS)
    order = np.argsort(found.priors)
    np.testing.assert_allclose(found.priors[order], truth.priors, atol=0.02)
    for one, other in zip(found.frames, truth.frames, strict=True):
        np.testing.assert_allclose(one.mean[order], other.mean, atol=0.06)
        np.testing.assert_allclose(one.covariance[order], other.covariance, atol=0.06)


def test_a_component_that_a_frame_never_saw_is_said_and_wide_there(truth):
    views, seen = drawn(truth, 300)
    split = round(300 * 0.4)
    seen[:] = True
    seen[:split, 0] = False
    with pytest.warns(DataWarning, match="frame 0 of component 0"):
        found = fit_tp_gmm(with_nan(views, seen), K, observed=seen, **OPTIONS)
    assert (np.diff(found.history) > -1e-9).all()
    shown = views[0][split:]
    np.testing.assert_allclose(found.frames[0].mean[0], shown.mean(0), atol=0.5)
    assert np.trace(found.frames[0].covariance[0]) > 0.5 * np.trace(np.cov(shown.T))


@pytest.fixture(scope="module")
def poses():
    views = [view[::10] for view in movements(np.random.default_rng(0))]
    seen = np.ones((len(views[0]), len(views)), bool)
    seen[40:90, 1] = seen[120:150, 2] = False
    return views, seen


def test_poses_are_learned_by_the_frames_that_saw_them(poses):
    views, seen = poses
    options = {"manifold": POSES, "start": "time", "tolerance": 1e-7}
    found = fit_tp_gmm(with_nan(views, seen), 3, observed=seen, **options)
    assert (np.diff(found.history) > -1e-9).all()
    each = zip(found.frames, views, seen.T[..., None], strict=True)
    parts = [gaussian.log_density(view[:, None]) * o for gaussian, view, o in each]
    expected = np.log((found.priors * np.exp(sum(parts))).sum(1))
    np.testing.assert_allclose(found.log_likelihood(views, seen), expected, atol=1e-9)
    assert expected.mean() == pytest.approx(found.history[-1], abs=1e-9)
    other = [np.where(seen[:, j, None], v, v[::-1]) for j, v in enumerate(views)]
    again = fit_tp_gmm(other, 3, observed=seen, **options)
    assert np.abs(again.history[-1] - found.history[-1]) < 1e-9
    whole = fit_tp_gmm(views, 3, observed=np.ones_like(seen), **options)
    plain = fit_tp_gmm(views, 3, **options)
    assert np.array_equal(whole.frames[2].covariance, plain.frames[2].covariance)
    # At rest the tangent vectors of what each frame saw cancel, and spread as the covariance says.
    h = found.responsibilities(views, seen)
    for gaussian, view, o in zip(found.frames, views, seen.T, strict=True):
        weights, v = (h * o[:, None]).T, gaussian.log(view[:, None]).swapaxes(0, 1)
        total = weights.sum(1)
        np.testing.assert_allclose((weights[:, None] @ v)[:, 0] / total[:, None], 0, atol=2e-3)
        spread = (weights[..., None] * v).mT @ v / total[:, None, None]
        np.testing.assert_allclose(spread, gaussian.covariance, atol=2e-3)


def test_what_hidden_samples_hold_is_a_point(truth):
    views, seen = drawn(truth, 20)
    for view, mine, o in zip(views, filled(views, seen), seen.T, strict=True):
        assert np.array_equal(view[o], mine[o])
        assert all(row in view[o] for row in mine)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda v, o: (v, o[:, :2]), "bool of shape (60, 2); give True or False"),
        (lambda v, o: (v, o.astype(float)), "float64"),
        (lambda v, o: (v, o & [True, False, True]), "frame 1 saw 0 of 60 samples"),
        (lambda v, o: (with_nan(v, o), None), "NaN"),
        (lambda v, o: (with_nan(v, ~o), o), "NaN"),
    ],
)
def test_what_does_not_fit_is_one_clear_line(truth, change, words):
    views, observed = change(*drawn(truth, 60))
    with pytest.raises(ArgumentError) as error:
        fit_tp_gmm(views, K, observed=observed)
    assert words in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("fit", [fit_hmm, fit_hsmm])
def test_hidden_states_are_learned_from_what_was_seen(fit):
    shown = u_demonstrations(3)
    rng = np.random.default_rng(0)
    masks = [rng.random((len(d), len(d.frames))) > 0.2 for d in shown]
    options = {"start": "time", "tolerance": 1e-8, "max_iterations": 30}
    found = fit(shown, 3, observed=masks, **options)
    assert (np.diff(found.history) > -1e-9).all()
    whole = fit(shown, 3, **options)
    again = fit(shown, 3, observed=[np.ones_like(m) for m in masks], **options)
    assert np.array_equal(whole.history, again.history)
    for one, other in zip(found.emissions.frames, whole.emissions.frames, strict=True):
        np.testing.assert_allclose(one.mean, other.mean, atol=0.25)
    with pytest.raises(ArgumentError, match="have no frames"):
        fit([d.data for d in shown], 3, observed=masks)


def test_a_model_of_hidden_samples_has_no_memory(truth):
    views, seen = drawn(truth, 60)
    model = fit_tp_gmm(views, K, observed=seen, start="time")
    with pytest.raises(ArgumentError, match="no memory"):
        update_tp_gmm(model, views)
