import numpy as np
import pytest
from scipy.linalg import block_diag

from tpsim import (
    Demonstration,
    Frame,
    Gaussian,
    ProMP,
    TPTrajectoryDistribution,
    fit_promp,
    fit_tp_promp,
    fit_tp_trajectory_distribution,
    fit_trajectory_distribution,
    gaussian_product,
    radial_basis,
)
from tpsim.errors import ArgumentError


def some_paths(count=6, T=15, D=2, seed=0):
    return np.cumsum(np.random.default_rng(seed).normal(size=(count, T, D)), axis=1)


def two_frames(T=None, seed=1):
    rng = np.random.default_rng(seed)
    leading = () if T is None else (T,)
    return [
        Frame(rng.normal(size=(*leading, 2, 2)), rng.normal(size=(*leading, 2))) for _ in range(2)
    ]


def two_views(count=6, T=15):
    """Demonstrations of one movement by two frames that differ from one to the next."""
    time = np.linspace(0, 1, T)
    return [
        Demonstration(time, path, two_frames(seed=n)) for n, path in enumerate(some_paths(count, T))
    ]


def test_modes_are_the_eigenvectors_of_the_covariance():
    paths = some_paths()
    full = fit_trajectory_distribution(paths, 5, noise=0.1)
    exact = np.cov(paths.reshape(6, -1).T)
    np.testing.assert_allclose(full.covariance(), exact + 0.1 * np.eye(30), atol=1e-12)
    largest = fit_trajectory_distribution(paths, 2, noise=1e-9)
    kept = np.linalg.eigvalsh(largest.covariance())[-2:]
    np.testing.assert_allclose(kept, np.linalg.eigvalsh(exact)[-2:], rtol=1e-6)


@pytest.mark.parametrize("moving", [None, 15])
def test_product_against_dense_algebra(moving):
    """Woodbury's identity on modes and noise is Eq. 6 in T*D dimensions."""
    local = [fit_trajectory_distribution(some_paths(seed=s), 3, noise=0.2) for s in range(2)]
    frames = two_frames(moving)
    ours = TPTrajectoryDistribution(tuple(local)).adapt(frames)
    dense = gaussian_product(
        [
            Gaussian(view.mean.ravel(), view.covariance()).affine(
                block_diag(*np.broadcast_to(f.A, (15, 2, 2))),
                np.broadcast_to(f.b, (15, 2)).ravel(),
            )
            for view, f in zip(local, frames, strict=True)
        ]
    )
    np.testing.assert_allclose(ours.mean.ravel(), dense.mean, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(ours.covariance(), dense.covariance, rtol=1e-8, atol=1e-9)


def test_a_frame_may_see_one_direction_only():
    """Its information counts along that direction; the other is left to its partner."""
    line = fit_trajectory_distribution(some_paths(D=1), 2, noise=0.1)
    plane = fit_trajectory_distribution(some_paths(seed=3), 2, noise=0.5)
    frames = [Frame([[2.0], [0.0]], [5.0, 7.0]), Frame(np.eye(2), [0.0, 0.0])]
    ours = TPTrajectoryDistribution((line, plane)).adapt(frames)
    see = np.kron(np.eye(15), [[0.5, 0.0]])
    along, every = np.linalg.inv(line.covariance()), np.linalg.inv(plane.covariance())
    precision = see.T @ along @ see + every
    information = see.T @ along @ (line.mean.ravel() + 2.5) + every @ plane.mean.ravel()
    np.testing.assert_allclose(ours.covariance(), np.linalg.inv(precision), atol=1e-9)
    np.testing.assert_allclose(
        ours.mean.ravel(), np.linalg.solve(precision, information), atol=1e-9
    )
    with pytest.raises(ArgumentError, match="information of the frames"):
        TPTrajectoryDistribution((line,)).adapt(frames[:1])


def test_demonstrated_frames_give_the_demonstrations_back():
    """Every frame sees the same movement, so the adapted mean must be close to it."""
    demonstrations = two_views(count=8)
    model = fit_tp_trajectory_distribution(demonstrations, 7, noise=1e-6)
    for demonstration in demonstrations[:3]:
        path = model.adapt(demonstration.frames)
        np.testing.assert_allclose(path.mean, demonstration.data, atol=1e-2)


def test_passing_a_point_against_dense_conditioning():
    model = fit_trajectory_distribution(some_paths(), 4, noise=0.3)
    through = model.through(9, [1.0, -2.0], 0.01 * np.eye(2))
    modes = model.modes.reshape(4, -1)
    smooth = Gaussian(model.mean.ravel(), modes.T @ modes)
    joint = Gaussian(
        np.r_[smooth.mean, model.mean[9]],
        np.block(
            [
                [smooth.covariance, smooth.covariance[:, 18:20]],
                [smooth.covariance[18:20], smooth.covariance[18:20, 18:20] + 0.31 * np.eye(2)],
            ]
        ),
    )
    exact = joint.condition([1.0, -2.0], given=(30, 31))
    np.testing.assert_allclose(through.mean.ravel(), exact.mean, atol=1e-9)
    np.testing.assert_allclose(through.covariance() - 0.3 * np.eye(30), exact.covariance, atol=1e-9)


def test_samples_have_the_marginals_of_the_model():
    model = fit_trajectory_distribution(some_paths(), 3, noise=0.5)
    samples = model.sample(np.random.default_rng(0), 40_000, noisy=True)
    marginal = model.marginal()
    scale = np.sqrt(np.diagonal(marginal.covariance, axis1=1, axis2=2)).max()
    np.testing.assert_allclose(samples.mean(0), marginal.mean, atol=0.03 * scale)
    at_end = np.cov(samples[:, -1].T)
    np.testing.assert_allclose(at_end, marginal.covariance[-1], atol=0.04 * scale**2)


def test_basis_functions_sum_to_one():
    basis = radial_basis(50, 7)
    np.testing.assert_allclose(basis.sum(1), 1)
    np.testing.assert_allclose(radial_basis(3, 4, width=1e-3).sum(1), 1)


def test_promp_weights_are_ridge_regression():
    """With as many demonstrations, the mean of the model is the fit of the mean."""
    paths = some_paths(T=40)
    model = fit_promp(paths, 9, ridge=1e-3)
    basis = radial_basis(40, 9)
    stacked = np.vstack([basis, np.sqrt(1e-3) * np.eye(9)])
    target = np.vstack([paths.mean(0), np.zeros((9, 2))])
    weights = np.linalg.lstsq(stacked, target)[0]
    np.testing.assert_allclose(model.weights.mean.reshape(9, 2), weights, atol=1e-9)
    np.testing.assert_allclose(model.distribution(40).mean, basis @ weights, atol=1e-9)


def test_promp_takes_demonstrations_of_any_length():
    """The same shape at two speeds gives the same movement."""

    def shape(T):
        return np.c_[np.sin(np.linspace(0, 3, T)), np.linspace(0, 1, T)]

    slow, fast = fit_promp([shape(200)], 8), fit_promp([shape(50)], 8)
    np.testing.assert_allclose(slow.distribution(80).mean, shape(80), atol=1e-2)
    np.testing.assert_allclose(fast.distribution(80).mean, shape(80), atol=1e-2)


def test_tp_promp_is_the_product_of_its_weights():
    demonstrations, frames = two_views(), two_frames(seed=9)
    model = fit_tp_promp(demonstrations, 5)
    ours = model.adapt(frames)
    exact = gaussian_product(
        [
            promp.weights.affine(np.kron(np.eye(5), f.A), np.tile(f.b, 5))
            for promp, f in zip(model.frames, frames, strict=True)
        ]
    )
    np.testing.assert_allclose(ours.weights.mean, exact.mean, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(ours.weights.covariance, exact.covariance, rtol=1e-6, atol=1e-9)


def test_promp_passes_a_point():
    model = fit_promp(some_paths(T=30), 8).distribution(30)
    np.testing.assert_allclose(model.through(12, [3.0, 4.0]).mean[12], [3, 4], atol=1e-3)


def test_bad_arguments():
    paths, views = some_paths(), two_views()
    promp = fit_tp_promp(views, 4)
    other = views[0].resampled(9)
    for wrong, message in (
        (lambda: fit_trajectory_distribution(paths, 6), "modes"),
        (lambda: fit_trajectory_distribution(paths, noise=0.0), "noise"),
        (lambda: fit_trajectory_distribution(paths[0]), "resample"),
        (lambda: fit_tp_trajectory_distribution([*views, other]), "resampled"),
        (lambda: fit_tp_trajectory_distribution(views).adapt(two_frames()[:1]), "learned"),
        (lambda: fit_trajectory_distribution(paths).through(15, [0, 0]), "steps 0 to 14"),
        (lambda: promp.adapt(two_frames(15)), "constant frames"),
        (lambda: fit_promp([], 4), "M >= 1"),
        (lambda: fit_promp(paths, 4, weight_ridge=0.0), "positive"),
        (lambda: radial_basis(0, 4), "at least 1"),
        (lambda: radial_basis(4, 4, width=-1.0), "positive"),
    ):
        with pytest.raises(ArgumentError, match=message):
            wrong()
    assert isinstance(promp.adapt(two_frames()), ProMP)
