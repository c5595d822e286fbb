"""TP-GMM: adaptation to new frames (Eqs 5-6), invariances of the fit, cost and memory."""

import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sklearn.mixture import GaussianMixture

from tpsim import MFA, TPGMM, Demonstration, Frame, Gaussian, fit_gmm, fit_tp_gmm
from tpsim.errors import ArgumentError, TpsimError
from tpsim.examples import u_demonstrations, u_frames
from tpsim.world.threads import one_thread

PRODUCT = np.load(Path(__file__).parents[1] / "reference" / "product.npz")


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.fixture(scope="module")
def demonstrations():
    return [d.with_time() for d in u_demonstrations(4)]


@pytest.fixture(scope="module")
def model(demonstrations):
    return fit_tp_gmm(demonstrations, 4)


def spd(rng, *shape):
    root = rng.normal(size=(*shape, shape[-1]))
    return root @ root.mT + 0.1 * np.eye(shape[-1])


def random_model(rng, K, dims):
    frames = tuple(Gaussian(rng.normal(size=(K, d)), spd(rng, K, d)) for d in dims)
    return TPGMM(np.full(K, 1 / K), frames)


def test_product_is_the_references():
    frames = [Gaussian(m, S) for m, S in zip(PRODUCT["mean"], PRODUCT["covariance"], strict=True)]
    model = TPGMM(PRODUCT["priors"], frames)
    for n, (A, b) in enumerate(zip(PRODUCT["A"], PRODUCT["b"], strict=True)):
        situation = [Frame(*frame) for frame in zip(A, b, strict=True)]
        for ridge, name in ((None, "product"), (1e-4, "ridge")):
            found = model.adapt(situation, ridge=ridge).gaussians
            np.testing.assert_allclose(found.mean, PRODUCT[f"{name}_mean"][n], rtol=1e-8, atol=1e-9)
            expected = PRODUCT[f"{name}_covariance"][n]
            np.testing.assert_allclose(found.covariance, expected, rtol=1e-8, atol=1e-9)


def test_invertible_frames_give_the_product_of_mapped_gaussians(rng):
    """Eq. (5) then Eq. (6), for scaled and reflected frames of equal dimension."""
    model = random_model(rng, 3, (2, 2))
    frames = [Frame(rng.normal(size=(2, 2)) * [1.0, -3.0], rng.normal(size=2)) for _ in range(2)]
    found = model.adapt(frames).gaussians
    mapped = [g.affine(f.A, f.b) for g, f in zip(model.frames, frames, strict=True)]
    precision = sum(np.linalg.inv(g.covariance) for g in mapped)
    information = sum(np.linalg.inv(g.covariance) @ g.mean[..., None] for g in mapped)
    np.testing.assert_allclose(found.covariance, np.linalg.inv(precision))
    np.testing.assert_allclose(found.mean[..., None], np.linalg.solve(precision, information))


def test_a_task_space_frame_adds_its_jacobian_form(rng):
    """A = J^+: its precision in joint space is J' Sigma^-1 J, and a posture frame does the rest."""
    J, q = rng.normal(size=(3, 7)), rng.normal(size=7)
    model = random_model(rng, 2, (3, 7))
    inverse = np.linalg.pinv(J)
    x = rng.normal(size=3)
    frames = [Frame(inverse, q - inverse @ x), Frame(np.eye(7), np.zeros(7))]
    precision = model.adapt(frames).gaussians.precision
    hand, posture = (frame.precision for frame in model.frames)
    np.testing.assert_allclose(precision, J.T @ hand @ J + posture, rtol=1e-7, atol=1e-8)


def test_a_nullspace_frame_leaves_the_task_alone(rng):
    """With N = I - J^+ J the task's mean is reached whatever the posture frame wants."""
    J = rng.normal(size=(2, 5))
    inverse = np.linalg.pinv(J)
    N = np.eye(5) - inverse @ J
    model = random_model(rng, 1, (2, 5))
    found = model.adapt([Frame(inverse, np.zeros(5)), Frame(N, np.zeros(5))]).gaussians
    np.testing.assert_allclose(J @ found.mean[0], model.frames[0].mean[0], atol=1e-8)


def test_frames_of_many_dimensions_move_together(rng):
    """Hands (6-D), posture (14-D), one of them moving: every step is what that step gives alone."""
    model = random_model(rng, 1, (6, 14, 6))
    A = rng.normal(size=(20, 14, 6))
    frames = [
        Frame(A, rng.normal(size=(20, 14))),
        Frame(np.eye(14), np.zeros(14)),
        Frame(rng.normal(size=(14, 6)), rng.normal(size=14)),
    ]
    moving = model.adapt(frames)
    assert moving.gaussians.mean.shape == (20, 1, 14)
    alone = model.adapt([frames[0][7], *frames[1:]])
    np.testing.assert_allclose(moving[7].gaussians.mean, alone.gaussians.mean, rtol=1e-8)
    np.testing.assert_allclose(
        moving[7].gaussians.covariance, alone.gaussians.covariance, rtol=1e-8
    )
    ridged = model.adapt(frames, ridge=1e-4)
    expected = model.adapt([frames[0][7], *frames[1:]], ridge=1e-4)
    np.testing.assert_allclose(ridged[7].gaussians.mean, expected.gaussians.mean, rtol=1e-6)


def test_a_missing_frame_is_left_out(model):
    frames = [frame.with_input() for frame in u_frames(np.random.default_rng(5))]
    only = model.adapt([frames[0], None]).gaussians
    mapped = model.frames[0].affine(frames[0].A, frames[0].b)
    np.testing.assert_allclose(only.mean, mapped.mean)
    np.testing.assert_allclose(only.covariance, mapped.covariance, atol=1e-12)
    assert model.adapt([frames[0], None], ridge=1e-4).gaussians.mean.shape == (4, 3)


def test_missing_and_narrow_frames_need_a_prior_for_what_they_do_not_see(rng):
    model = random_model(rng, 2, (1, 3))
    narrow = Frame([[0.0], [0.0], [2.0]], np.zeros(3))
    with pytest.raises(ArgumentError, match=r"no frame determines the direction .*prior"):
        model.adapt([narrow, None])
    prior = Gaussian(np.array([1.0, 2.0, 3.0]), 1e6 * np.eye(3))
    found = model.adapt([narrow, None], prior=prior).gaussians
    np.testing.assert_allclose(found.mean[:, :2], [[1, 2], [1, 2]])
    np.testing.assert_allclose(found.mean[:, 2], 2 * model.frames[0].mean[:, 0], rtol=1e-3)
    everywhere = model.adapt([None, None], prior=prior).gaussians
    np.testing.assert_allclose(np.broadcast_to(everywhere.mean, (2, 3)), [[1, 2, 3]] * 2)


def test_the_unseen_direction_is_named_at_its_step(rng):
    model = random_model(rng, 1, (1, 1))
    A = np.repeat([[[1.0], [0.0]]], 5, axis=0)
    B = np.repeat([[[0.0], [1.0]]], 5, axis=0)
    B[3] = [[1.0], [0.0]]
    with pytest.raises(ArgumentError, match=r"\[-?0\.0, -?1\.0\] at step 3"):
        model.adapt([Frame(A, np.zeros(2)), Frame(B, np.zeros(2))])


def test_adaptation_passes_where_frames_are_precise(demonstrations, model):
    """In a new situation the mixture begins in the first object and ends in the second."""
    frames = u_frames(np.random.default_rng(11))
    gaussians = model.adapt([frame.with_input() for frame in frames]).gaussians
    order = np.argsort(gaussians.mean[:, 0])
    for k, frame in ((order[0], frames[0]), (order[-1], frames[1])):
        local = frame.to_local(gaussians.mean[k, 1:])
        assert abs(local[0]) < 0.05
        assert 0 <= local[1] < 0.4


def test_frames_of_wrong_number_or_shape_are_refused(model):
    good = Frame(np.eye(3), np.zeros(3))
    for frames in (
        [good],
        [good, good, good],
        [None, None],
        [good, Frame(np.eye(2), np.zeros(2))],
        [good, Frame(np.ones((4, 3)), np.zeros(4))],
    ):
        with pytest.raises(ArgumentError):
            model.adapt(frames)
    for ridge in (0.0, -1.0, np.nan):
        with pytest.raises(ArgumentError, match="ridge"):
            model.adapt([good, good], ridge=ridge)
    with pytest.raises(ArgumentError):
        TPGMM([1.0], [])


@settings(max_examples=300, deadline=None)
@example(seed=507, D=1, dims=[4, 4, 4], steps=(), kinds=[1, 1, 1], ridge=None, weak=False)
@given(
    seed=st.integers(0, 2**31),
    D=st.integers(1, 4),
    dims=st.lists(st.integers(1, 5), min_size=1, max_size=3),
    steps=st.sampled_from([(), (3,)]),
    kinds=st.lists(st.integers(0, 7), min_size=3, max_size=3),
    ridge=st.sampled_from([None, 1e-4]),
    weak=st.booleans(),
)
def test_hostile_frames_end_in_an_error_or_a_finite_mixture(
    seed, D, dims, steps, kinds, ridge, weak
):
    rng = np.random.default_rng(seed)
    model = random_model(rng, 2, dims)
    frames = []
    for d, kind in zip(dims, kinds, strict=False):
        A = rng.normal(size=(*steps, D, d))
        if kind == 0:
            A[..., 0, :] = 0
        elif kind == 1:
            A *= 10.0 ** rng.uniform(-150, 150)
        elif kind == 2:
            A[..., :, 0] = A[..., :, -1]
        elif kind == 3:
            A *= 0
        elif kind == 4:
            A *= 10.0 ** rng.uniform(-9, 9, size=(D, 1))
        frames.append(Frame(A, rng.normal(size=D)) if kind != 5 else None)
    prior = Gaussian(np.zeros(D), 1e6 * np.eye(D)) if weak else None
    try:
        gaussians = model.adapt(frames, ridge=ridge, prior=prior).gaussians
    except TpsimError:
        return
    assert np.isfinite(gaussians.mean).all()
    assert np.isfinite(gaussians.covariance).all()
    np.testing.assert_array_equal(gaussians.covariance, gaussians.covariance.mT)


def test_demonstrations_and_their_views_give_the_same_model(demonstrations):
    views = [np.concatenate(v) for v in zip(*(d.observations for d in demonstrations), strict=True)]
    one = fit_tp_gmm(demonstrations, 3, start="time")
    other = fit_tp_gmm(views, 3, start="time")
    np.testing.assert_allclose(one.history, other.history, rtol=1e-9)
    np.testing.assert_allclose(
        one.log_likelihood(demonstrations), other.log_likelihood(views), rtol=1e-6, atol=1e-6
    )


def test_one_frame_is_a_gmm(demonstrations):
    data = demonstrations[0].observations[0]
    one, other = fit_tp_gmm([data], 3), fit_gmm(data, 3)
    np.testing.assert_array_equal(one.frames[0].covariance, other.gaussians.covariance)
    assert one.free_parameters == other.free_parameters


def test_the_order_of_frames_does_not_matter(demonstrations):
    turned = [Demonstration(d.time, d.data, d.frames[::-1]) for d in demonstrations]
    one, other = (fit_tp_gmm(data, 4) for data in (demonstrations, turned))
    for left, right in zip(one.frames, other.frames[::-1], strict=True):
        np.testing.assert_allclose(left.mean, right.mean, rtol=1e-7, atol=1e-9)
        np.testing.assert_allclose(left.covariance, right.covariance, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("scale", [1.0, 1e-4, 1e5])
def test_common_rotation_and_scaling_do_not_change_the_answer(scale, rng):
    views = [
        np.concatenate(v) for v in zip(*(d.observations for d in u_demonstrations(4)), strict=True)
    ]
    R = np.linalg.qr(rng.normal(size=(2, 2)))[0]
    one = fit_tp_gmm(views, 4, start="time")
    other = fit_tp_gmm([scale * view @ R.T for view in views], 4, start="time")
    assert len(one.history) == len(other.history)
    for left, right in zip(one.frames, other.frames, strict=True):
        np.testing.assert_allclose(right.mean, scale * left.mean @ R.T, atol=1e-7 * scale)
        expected = scale**2 * R @ left.covariance @ R.T
        np.testing.assert_allclose(right.covariance, expected, atol=1e-7 * scale**2)


def test_units_of_single_variables_do_not_change_the_answer(demonstrations):
    views = [np.concatenate(v) for v in zip(*(d.observations for d in demonstrations), strict=True)]
    units = np.array([1e3, 1e-3, 7.0])
    one = fit_tp_gmm(views, 4)
    other = fit_tp_gmm([view * units for view in views], 4)
    for left, right in zip(one.frames, other.frames, strict=True):
        expected = left.covariance * np.outer(units, units)
        np.testing.assert_allclose(right.covariance, expected, rtol=1e-6)


def test_unequal_lengths_and_single_demonstrations(demonstrations):
    cut = [demonstrations[0].resampled(50), demonstrations[1].resampled(333), demonstrations[2]]
    model = fit_tp_gmm(cut, 4)
    assert model.samples == 50 + 333 + 200
    assert fit_tp_gmm(cut[:1], 4).responsibilities(cut[0:1]).shape == (50, 4)


def test_one_component_has_the_moments_of_the_data(demonstrations):
    model = fit_tp_gmm(demonstrations, 1)
    seen = np.concatenate([d.observations[1] for d in demonstrations])
    np.testing.assert_allclose(model.frames[1].mean[0], seen.mean(0), atol=1e-10)
    np.testing.assert_allclose(model.frames[1].covariance[0], np.cov(seen.T, ddof=0), atol=1e-10)


def test_a_frame_in_which_nothing_moves_is_precise_and_finite(rng):
    """The hand seen from itself: the floor comes from the frames that do move."""
    time = np.linspace(0, 1, 60)
    data = np.column_stack([time, np.sin(6 * time)]) + 0.01 * rng.normal(size=(60, 2))
    demonstration = Demonstration(
        time, data, [Frame(np.eye(2), np.zeros(2)), Frame(np.eye(2), data)]
    )
    model = fit_tp_gmm([demonstration], 2)
    np.testing.assert_allclose(model.frames[1].mean, 0, atol=1e-12)
    deviations = np.sqrt(np.linalg.eigvalsh(model.frames[1].covariance))
    assert deviations.max() < 0.01
    assert deviations.min() > 1e-6


def test_archive_returns_the_same_bits(model, tmp_path):
    again = TPGMM.load(model.save(tmp_path / "model.npz"))
    for one, other in zip(again.frames, model.frames, strict=True):
        np.testing.assert_array_equal(one.covariance, other.covariance)
    np.testing.assert_array_equal(again.memory.time, model.memory.time)
    assert again.samples == model.samples


@pytest.mark.parametrize(
    "data",
    [
        [],
        [np.zeros((5, 2)), np.zeros((4, 2))],
        [np.zeros((0, 2))],
        [np.zeros(5)],
        [Demonstration([0.0, 1.0], np.eye(2))],
        [*u_demonstrations(1), u_demonstrations(1)[0].with_time()],
    ],
)
def test_bad_data_are_refused(data):
    with pytest.raises(ArgumentError):
        fit_tp_gmm(data, 1)


def test_views_of_another_shape_are_refused(model):
    with pytest.raises(ArgumentError, match="observations"):
        model.log_likelihood([np.zeros((5, 3)), np.zeros((5, 2))])


def movements(count):
    """Samples of three frames with time, as in the speed requirement: D = 4 each."""
    rng, time_ = np.random.default_rng(0), np.linspace(0, 2, count)
    return [
        np.column_stack(
            [time_]
            + [np.sin((i + 1) * (j + 1) * time_) + 0.05 * rng.normal(size=count) for i in range(3)]
        )
        for j in range(3)
    ]


def least_seconds(run, repeat):
    def once():
        start = time.process_time()
        run()
        return time.process_time() - start

    with one_thread():
        return min(once() for _ in range(repeat))


def seconds_per_iteration(fit, few, many, repeat=3):
    return (least_seconds(lambda: fit(many), repeat) - least_seconds(lambda: fit(few), repeat)) / (
        many - few
    )


@pytest.mark.filterwarnings("ignore::sklearn.exceptions.ConvergenceWarning")
def test_an_iteration_is_at_least_twice_as_fast_as_scikit_learns():
    views = movements(2000)
    stacked = np.hstack(views)

    def ours(n):
        fit_tp_gmm(views, 5, start="time", tolerance=-np.inf, max_iterations=n)

    def theirs(n):
        mixture = GaussianMixture(
            5, max_iter=n, tol=0, init_params="random_from_data", random_state=0
        )
        mixture.fit(stacked)

    assert 2 * seconds_per_iteration(ours, 5, 45) < seconds_per_iteration(theirs, 2, 42)


def test_cost_is_linear_and_memory_small():
    views, small = movements(200_000), movements(2000)

    def fit(data):
        fit_tp_gmm(data, 5, start="time", tolerance=-np.inf, max_iterations=6)

    fit(small)
    assert least_seconds(lambda: fit(views), 2) < 100 * 1.3 * least_seconds(lambda: fit(small), 9)
    tracemalloc.start()
    fit(views)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2**30


def test_a_wide_mixture_of_factor_analysers_fits():
    """D = 94, K = 12, d = 2 (Fig. 6), with few samples: finite, and ever more likely."""
    rng = np.random.default_rng(0)
    latent = np.sin(np.linspace(0, 6, 300)[:, None] * np.arange(1, 4))
    data = latent @ rng.normal(size=(3, 94)) + 0.1 * rng.normal(size=(300, 94))
    model = fit_gmm(data, 12, covariance=MFA(2), start="time", max_iterations=5)
    assert model.free_parameters == 4511
    assert np.diff(model.history).min() > -1e-9
