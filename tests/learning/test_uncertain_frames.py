"""A frame that is not exactly known counts for less in the product (Eqs 5-6)."""

import numpy as np
import pytest

from tpsim import Frame, Gaussian, gaussian_product
from tpsim.errors import ArgumentError
from tpsim.gaussian import faded
from tpsim.learning.tp_gmm import TPGMM

RNG = np.random.default_rng(6)


def spread(*shape):
    L = RNG.normal(size=(*shape, shape[-1]))
    return L @ L.mT + 0.1 * np.eye(shape[-1])


@pytest.fixture(scope="module")
def model():
    K = 3
    frames = tuple(Gaussian(RNG.normal(size=(K, 2)), spread(K, 2)) for _ in range(2))
    return TPGMM(np.full(K, 1 / K), frames)


FRAMES = [
    Frame([[0.6, -0.8], [0.8, 0.6]], [1.0, 2.0]),
    Frame([[1.0, 0.3], [0.0, 2.0]], [-1.0, 0.5]),
]


def test_it_is_the_product_of_wider_gaussians(model):
    S = [spread(2), spread(3, 2)]
    found = model.adapt(FRAMES, uncertainty=S).gaussians
    wider = []
    for local, frame, more in zip(model.frames, FRAMES, S, strict=True):
        there = local.affine(frame.A, frame.b)
        wider.append(Gaussian(there.mean, there.covariance + more))
    expected = gaussian_product(wider)
    np.testing.assert_allclose(found.mean, expected.mean, rtol=1e-9)
    np.testing.assert_allclose(found.covariance, expected.covariance, rtol=1e-9)
    ridge = model.adapt(FRAMES, ridge=1e-12, uncertainty=S).gaussians
    np.testing.assert_allclose(ridge.covariance, expected.covariance, rtol=1e-6)


def test_from_exactly_known_to_not_observed(model):
    """No uncertainty is none at all, and an endless one is a frame that is not there."""
    exact = model.adapt(FRAMES).gaussians
    none = model.adapt(FRAMES, uncertainty=[np.zeros((2, 2)), None]).gaussians
    np.testing.assert_allclose(none.covariance, exact.covariance, rtol=1e-12)
    lost = model.adapt(FRAMES, uncertainty=[None, 1e9 * np.eye(2)]).gaussians
    alone = model.adapt([FRAMES[0], None]).gaussians
    np.testing.assert_allclose(lost.mean, alone.mean, rtol=1e-6)
    np.testing.assert_allclose(lost.covariance, alone.covariance, rtol=1e-6)
    sizes = [
        np.linalg.det(model.adapt(FRAMES, uncertainty=[None, s * np.eye(2)]).gaussians.covariance)
        for s in (0.0, 0.1, 1.0, 10.0)
    ]
    assert (np.diff(sizes, axis=0) > 0).all()


def test_a_frame_that_sees_one_direction_only(model):
    narrow = TPGMM(
        np.ones(1), (Gaussian([[0.3]], [[[0.04]]]), Gaussian([[0.1, 0.2]], spread(1, 2)))
    )
    frames = [Frame([[1.0], [0.0]], [0.0, 0.0]), Frame(np.eye(2), [1.0, 1.0])]
    found = narrow.adapt(frames, uncertainty=[0.09 * np.eye(2), None]).gaussians
    precision = np.diag([1 / (0.04 + 0.09), 0.0]) + narrow.frames[1].precision[0]
    np.testing.assert_allclose(found.precision[0], precision, rtol=1e-9)


def test_faded_is_the_inverse_of_the_sum_and_takes_singular_ones():
    P, S = spread(4, 3), spread(4, 3)
    expected = np.linalg.inv(np.linalg.inv(P) + S)
    np.testing.assert_allclose(faded(P, S) @ P, expected, rtol=1e-9)
    flat = np.diag([4.0, 0.0])
    np.testing.assert_allclose(faded(flat, np.eye(2)) @ flat, np.diag([0.8, 0.0]))


@pytest.mark.parametrize("D", [2, 3])
def test_uncertainty_of_points_is_that_of_moved_and_turned_frames(D):
    """Against Monte Carlo, for a turn so small that the first order is enough."""
    from tpsim import rotation

    A = rotation.exp([0.4, -0.2, 1.0])[:D, :D]
    frame, x = Frame(A, RNG.normal(size=D)), RNG.normal(size=(2, D))
    origin, turn = 1e-6 * spread(D), 1e-6 * (spread(3) if D == 3 else np.array([[2.0]]))
    found = frame.uncertainty(x, origin, turn)
    rng, n = np.random.default_rng(0), 100_000
    db = rng.multivariate_normal(np.zeros(D), origin, n)
    dw = rng.multivariate_normal(np.zeros(len(turn)), turn, n)
    for point, covariance in zip(x, found, strict=True):
        w = dw if D == 3 else np.column_stack([np.zeros((n, 2)), dw])
        arm = np.append(A @ point, np.zeros(3 - D))
        moved = db + np.cross(w, arm)[:, :D]
        np.testing.assert_allclose(np.cov(moved.T), covariance, atol=0.03 * covariance.max())
    np.testing.assert_array_equal(frame.uncertainty(x, 0.5), np.tile(0.5 * np.eye(D), (2, 1, 1)))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([None], "one for each of 2 frames"),
        ([np.eye(3), None], r"uncertainty\[0\] has shape"),
        ([None, -np.eye(2)], r"uncertainty\[1\] is no covariance"),
        ([None, [[1.0, 0.5], [0.0, 1.0]]], "no covariance"),
    ],
)
def test_what_is_no_covariance_is_refused(model, given, words):
    with pytest.raises(ArgumentError, match=words):
        model.adapt(FRAMES, uncertainty=given)


def test_a_frame_of_four_dimensions_does_not_turn():
    with pytest.raises(ArgumentError, match="turns in the"):
        Frame(np.eye(4), np.zeros(4)).uncertainty(np.ones(4), 0.1, 0.1)
