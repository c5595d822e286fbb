import itertools
from pathlib import Path

import numpy as np
import pytest

from tpsim import (
    GMM,
    Frame,
    Gaussian,
    SquaredExponential,
    fit_gp,
    fit_gp_gmm,
    floor_eigenvalues,
    fuse_frames,
    gaussian_product,
    gmr,
    spring_damper,
)
from tpsim.errors import ArgumentError

REFERENCE = Path(__file__).parents[1] / "reference"
GPR, TP_GP, GPR_TP = (np.load(REFERENCE / f"{name}.npz") for name in ("gpr", "tp_gp", "gpr_tp"))


def kernel_of(variance, rate, noise):
    """Kernel in the reference's parameters: variance exp(-rate d^2)."""
    return SquaredExponential(variance, np.sqrt(0.5 / rate), noise)


def local_covariance(outputs, mean, weights, ridge=1e-4):
    """The reference's 'GMR-like' covariance, from weights that may be negative."""
    apart = outputs - mean[:, None]
    return np.einsum("tn,tna,tnb->tab", weights, apart, apart) + ridge * np.eye(outputs.shape[1])


def test_reference_figures():
    gp = fit_gp(GPR["inputs"], GPR["outputs"], kernel_of(*GPR["parameters"]), center=False)
    path = gp(GPR["queries"])
    np.testing.assert_allclose(path.mean, GPR["mean"], rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(path.covariance, GPR["covariance"], rtol=1e-8, atol=1e-12)


def test_reference_local_covariance_is_not_always_a_covariance():
    """Its eigenvalues go negative with the weights; ours are floored."""
    gp = fit_gp(GPR["inputs"], GPR["outputs"], kernel_of(*GPR["parameters"]), center=False)
    theirs = local_covariance(GPR["outputs"], GPR["local_mean"], gp.weights(GPR["inputs"]))
    np.testing.assert_allclose(theirs, GPR["local_covariance"], rtol=1e-8, atol=1e-10)
    assert np.linalg.eigvalsh(theirs).min() < -1e-5
    ours = gp.spread(GPR["inputs"], ridge=1e-4)
    np.testing.assert_allclose(ours.mean, GPR["local_mean"], rtol=1e-8, atol=1e-9)
    assert np.linalg.eigvalsh(ours.covariance).min() > 0.99e-4


def test_reference_tp_gp():
    """demo_TPGP01: a process in each frame with the spread of the data, then the product.

    The reference weighs with rows of the training kernel, right for its queries, which are the
    first training inputs.
    """
    gp = fit_gp(TP_GP["inputs"], np.hstack(TP_GP["views"]), kernel_of(1.0, 10.0, 0.1), center=False)
    both = gp.spread(TP_GP["inputs"][:200], ridge=1e-4)
    views = [both.marginal(dims) for dims in ([0, 1], [2, 3])]
    for local, mean, covariance in zip(views, TP_GP["mean"], TP_GP["covariance"], strict=True):
        np.testing.assert_allclose(local.mean, mean, rtol=1e-8, atol=1e-9)
        np.testing.assert_allclose(local.covariance, covariance, rtol=1e-7, atol=1e-10)
    for A, b, path in zip(TP_GP["A"], TP_GP["b"], TP_GP["path"], strict=True):
        frames = [Frame(*pair) for pair in zip(A, b, strict=True)]
        np.testing.assert_allclose(fuse_frames(views, frames).mean, path, rtol=1e-7, atol=1e-8)


def test_reference_gmm_from_task_parameters():
    """demo_GPR_TP01 clamps whole matrices of eigenvalues; put in on purpose, its figures appear."""
    gp = fit_gp(GPR_TP["tasks"], GPR_TP["theta"], kernel_of(1.0, 0.1, 1e-3), center=False)
    predicted = gp(GPR_TP["new_tasks"]).mean
    means, covariances = predicted[:, :9].reshape(-1, 3, 3), predicted[:, 9:].reshape(-1, 3, 3, 3)
    np.testing.assert_allclose(means, GPR_TP["mean"], rtol=1e-7, atol=1e-9)
    eigenvalues, V = np.linalg.eigh(covariances)
    clamped = np.maximum(eigenvalues[..., None] * np.eye(3), 1e-3)
    signed = [V * signs for signs in itertools.product([-1, 1], repeat=3)]
    faulty = np.array([U @ clamped @ U.mT for U in signed])  # signs of eigenvectors are free
    closest = np.abs(faulty - GPR_TP["covariance"]).max((-2, -1)).min(0)
    np.testing.assert_allclose(closest, 0, atol=1e-9)
    right = floor_eigenvalues(covariances, 1e-3)
    assert 1e-4 < np.abs(right - GPR_TP["covariance"]).max() < 4e-3
    dt, stiffness, damping = GPR_TP["constants"]
    for mean, covariance, start, path in zip(
        GPR_TP["mean"], GPR_TP["covariance"], GPR_TP["start"], GPR_TP["path"], strict=True
    ):
        target = gmr(GMM(GPR_TP["priors"], Gaussian(mean, covariance)), GPR_TP["inputs"]).mean
        ours = spring_damper(target, stiffness, damping, dt, np.r_[start, 0, 0])
        np.testing.assert_allclose(ours.states[:, :2], path, rtol=1e-7, atol=1e-9)


def test_is_conditioning_of_the_joint_gaussian():
    """Eqs 46-47 from Eq. 45 by the algebra of Gaussians."""
    rng = np.random.default_rng(0)
    inputs, queries, outputs = rng.normal(size=(9, 2)), rng.normal(size=(4, 2)), rng.normal(size=9)
    kernel = SquaredExponential(2.0, 0.8, 0.1)
    every = np.concatenate([inputs, queries])
    covariance = kernel(every, every) + np.diag([0.1] * 9 + [0] * 4)
    exact = Gaussian(np.zeros(13), covariance).condition(outputs, given=range(9))
    gp = fit_gp(inputs, outputs, kernel, center=False)
    ours = gp(queries)
    np.testing.assert_allclose(ours.mean[:, 0], exact.mean)
    np.testing.assert_allclose(gp.joint_covariance(queries), exact.covariance, atol=1e-12)
    np.testing.assert_allclose(ours.covariance[:, 0, 0], np.diagonal(exact.covariance))
    np.testing.assert_allclose(gp.weights(queries) @ outputs, exact.mean)
    density = Gaussian(np.zeros(9), covariance[:9, :9]).log_density(outputs)
    np.testing.assert_allclose(gp.log_likelihood, density)


def test_likeliest_kernel_is_no_worse_than_its_neighbours():
    x = np.linspace(0, 4, 30)
    y = np.c_[np.sin(2 * x), np.cos(2 * x)] + 0.05 * np.random.default_rng(0).normal(size=(30, 2))
    best = fit_gp(x, y)
    k = best.kernel
    for other in (
        SquaredExponential(k.variance, k.length * 1.2, k.noise),
        SquaredExponential(k.variance, k.length / 1.2, k.noise),
        SquaredExponential(k.variance, k.length, k.noise * 2),
    ):
        assert fit_gp(x, y, other).log_likelihood <= best.log_likelihood + 1e-3
    np.testing.assert_allclose(best([2.05]).mean[0], [np.sin(4.1), np.cos(4.1)], atol=0.1)


def test_far_away_it_collapses_to_the_average():
    """Section 8.1: beyond the demonstrations GPR answers with the mean of the models."""
    gp = fit_gp([0.0, 1.0], [[1.0], [3.0]], SquaredExponential(1.0, 0.5, 1e-6))
    far = gp([100.0])
    np.testing.assert_allclose(far.mean, [[2.0]])
    np.testing.assert_allclose(far.covariance, [[[1.0]]])


def some_mixtures(count, seed=0):
    rng = np.random.default_rng(seed)
    tasks = np.linspace(-1, 1, count)[:, None]
    root = rng.normal(size=(2, 3, 3))
    gmms = [
        GMM(
            [0.5 + 0.2 * q, 0.5 - 0.2 * q],
            Gaussian(
                np.outer([1.0, 2.0], [q, -q, 1.0]), np.exp(q) * (root @ root.mT) + 0.01 * np.eye(3)
            ),
        )
        for q in tasks[:, 0]
    ]
    return tasks, gmms


@pytest.mark.parametrize("encoding", ["logarithm", "entries"])
def test_mixtures_are_found_again_and_in_between(encoding):
    tasks, gmms = some_mixtures(7)
    model = fit_gp_gmm(tasks, gmms, SquaredExponential(10.0, 1.5, 1e-8), encoding=encoding)
    for task, gmm in zip(tasks, gmms, strict=True):
        again = model(task)
        np.testing.assert_allclose(again.priors, gmm.priors, atol=1e-4)
        np.testing.assert_allclose(again.gaussians.mean, gmm.gaussians.mean, atol=1e-4)
        np.testing.assert_allclose(again.gaussians.covariance, gmm.gaussians.covariance, rtol=1e-2)
    between = model([0.15])
    np.testing.assert_allclose(between.gaussians.mean[0], [0.15, -0.15, 1.0], atol=1e-2)


@pytest.mark.parametrize("encoding", ["logarithm", "entries"])
def test_mixtures_far_away_are_still_mixtures(encoding):
    tasks, gmms = some_mixtures(4)
    far = fit_gp_gmm(tasks, gmms, SquaredExponential(5.0, 0.3, 1e-6), encoding=encoding)([40.0])
    assert np.linalg.eigvalsh(far.gaussians.covariance).min() > 0
    np.testing.assert_allclose(far.priors.sum(), 1)


def test_fused_frames_are_the_product_at_every_step():
    rng = np.random.default_rng(0)
    T = 6
    root = rng.normal(size=(2, T, 2, 2))
    views = [
        Gaussian(m, r @ r.mT + 0.1 * np.eye(2))
        for m, r in zip(rng.normal(size=(2, T, 2)), root, strict=True)
    ]
    frames = [
        Frame(rng.normal(size=(2, 2)), rng.normal(size=2)),
        Frame(rng.normal(size=(T, 2, 2)), rng.normal(size=(T, 2))),
    ]
    ours = fuse_frames(views, frames)
    exact = gaussian_product([v.affine(f.A, f.b) for v, f in zip(views, frames, strict=True)])
    np.testing.assert_allclose(ours.mean, exact.mean, rtol=1e-9)
    np.testing.assert_allclose(ours.covariance, exact.covariance, rtol=1e-9)


def test_bad_arguments():
    tasks, gmms = some_mixtures(3)
    gp = fit_gp([0.0, 1.0], [0.0, 1.0], SquaredExponential())
    for wrong, message in (
        (lambda: SquaredExponential(length=0.0), "positive"),
        (lambda: SquaredExponential(noise=-1.0), "negative"),
        (lambda: fit_gp([0.0, 0.0], [0.0, 1.0], SquaredExponential(noise=0.0)), "repeated"),
        (lambda: fit_gp([0.0, 1.0], [0.0]), "length"),
        (lambda: fit_gp([np.nan], [0.0]), "NaN"),
        (lambda: gp(np.zeros((2, 3))), "1 columns"),
        (lambda: fit_gp_gmm(tasks, [*gmms[:2], GMM([1.0], gmms[0].gaussians[:1])]), "one shape"),
        (lambda: fit_gp_gmm(tasks[:2], gmms), "length"),
        (lambda: fit_gp_gmm(tasks, gmms, encoding="square"), "allowed"),
    ):
        with pytest.raises(ArgumentError, match=message):
            wrong()
