"""What matters is what varies less than free movement, direction by direction."""

import numpy as np
import pytest

from tpsim import Gaussian
from tpsim.errors import ArgumentError
from tpsim.learning.free_movement import (
    BOUNDARY,
    against_free,
    chance_of,
    free_share,
    relevance,
)

KINDS = ("position",) * 3


def frame(*deviations, turned=None):
    covariance = np.diag(np.square(deviations))
    if turned is not None:
        covariance = turned @ covariance @ turned.T
    return Gaussian(np.zeros((1, len(deviations))), covariance[None])


def rotation(seed=0):
    Q, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    return Q


def test_precision_is_that_of_the_ratio_of_densities():
    found = relevance(frame(0.001, 0.08, 0.1), 0.01 * np.eye(3), KINDS)
    np.testing.assert_array_equal(found.matters, [[True, False, False]])
    np.testing.assert_allclose(found.precision[0], np.diag([1e6 - 100, 0, 0]), rtol=1e-9, atol=1e-6)


def test_directions_turn_with_the_data():
    Q = rotation()
    one = relevance(frame(0.001, 0.08, 0.1), 0.01 * np.eye(3), KINDS).precision[0]
    other = relevance(frame(0.001, 0.08, 0.1, turned=Q), 0.01 * np.eye(3), KINDS).precision[0]
    np.testing.assert_allclose(other, Q @ one @ Q.T, rtol=1e-6, atol=1e-4)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_units_do_not_decide(scale):
    found = relevance(
        frame(*scale * np.array([0.01, 0.05, 0.1])), (0.1 * scale) ** 2 * np.eye(3), KINDS
    )
    np.testing.assert_allclose(found.ratio, [[0.1, 0.5, 1.0]])
    expected = np.diag([1e4 - 100, 0, 0]) / scale**2
    np.testing.assert_allclose(found.precision[0], expected, rtol=1e-9, atol=1e-9 / scale**2)


def test_free_movement_that_is_not_isotropic():
    """Less variation than free movement in that direction, not less than in the widest one."""
    free = np.diag([0.01, 0.2, 0.2]) ** 2
    found = relevance(frame(0.009, 0.01, 0.2), free, KINDS)
    np.testing.assert_allclose(np.diag(found.precision[0]) > 0, [False, True, False])


def test_kinds_are_not_mixed():
    """A correlation of metres and radians makes no precise direction of two free ones."""
    covariance = np.array([[0.01, 0.0999], [0.0999, 1.0]])
    found = relevance(
        Gaussian(np.zeros((1, 2)), covariance[None]), np.diag([0.01, 1.0]), ("position", "angle")
    )
    assert not found.matters.any()
    np.testing.assert_array_equal(found.precision, 0)


def test_the_marginal_of_what_matters_keeps_its_correlation():
    S = np.array([[1e-6, 5e-7, 0], [5e-7, 1e-6, 0], [0, 0, 0.01]])
    found = relevance(Gaussian(np.zeros((1, 3)), S[None]), 0.01 * np.eye(3), KINDS)
    np.testing.assert_allclose(
        found.precision[0, :2, :2], np.linalg.inv(S[:2, :2]) - 100 * np.eye(2), rtol=1e-9
    )
    np.testing.assert_allclose(found.precision[0, 2], 0, atol=1e-6)


def test_the_boundary_is_where_both_hypotheses_are_as_probable():
    """log ratio ~ N(0, log(3)^2) against uniform over three decades: equal near 0.226."""
    ratios = np.geomspace(0.01, 0.99, 2000)
    chance = chance_of(ratios)
    boundary = ratios[np.argmin(np.abs(chance - 0.5))]
    s = np.log(3)
    z = s * np.sqrt(-2 * np.log(np.sqrt(2 * np.pi) * s / np.log(1e3)))
    assert boundary == pytest.approx(np.exp(-z), rel=5e-3)
    assert chance_of(BOUNDARY) == pytest.approx(0.5, abs=1e-12)
    assert (np.diff(chance) < 0).all()
    assert (chance_of(ratios, 10.0)[:500] < chance[:500]).all()  # fewer samples, weaker evidence


def test_random_free_directions_are_rarely_taken_for_precise():
    """A sample covariance of isotropic free movement from 20 independent samples: no direction."""
    rng = np.random.default_rng(3)
    wrong = 0
    for _ in range(300):
        x = rng.standard_normal((20, 3))
        found = relevance(Gaussian(np.zeros((1, 3)), np.cov(x.T)[None]), np.eye(3), KINDS, 20)
        wrong += found.matters.any()
    assert wrong <= 3


def test_a_direction_of_the_product_is_free_up_to_the_same_boundary():
    precision = np.array([0.0, 1.0, BOUNDARY**-2, 1e4])
    share = free_share(precision, np.ones(4))
    np.testing.assert_allclose(share[:3], [1.0, 1 / (1 + BOUNDARY**8), 0.5])
    assert share[3] < 1e-4
    np.testing.assert_array_equal(free_share(precision, np.zeros(4)), 0)


def test_two_estimates_of_one_frame_leave_what_was_free_free():
    """Both say level, each a little beside the other: heading becomes precise in their product."""
    rng, shares, wrong = np.random.default_rng(4), [], 0
    free = 0.35**2 * np.eye(3)
    for _ in range(200):
        W = np.zeros((3, 3))
        for _ in range(2):
            x = rng.standard_normal((20, 3)) * [0.02, 0.02, 0.35]
            found = relevance(Gaussian(np.zeros((1, 3)), np.cov(x.T)[None]), free, KINDS, 20)
            wrong += found.matters.sum() != 2
            W += found.precision[0]
        X, _ = against_free(W, np.linalg.inv(free))
        shares.append(free_share(np.diag(X.T @ W @ X), np.diag(X.T @ np.linalg.inv(free) @ X)))
    assert wrong <= 4
    assert np.max(shares, axis=0)[1] < 0.01 and np.quantile(shares, 0.05, axis=0)[2] > 0.9


def random_precisions(n=6, known=3):
    """A precision of some rank, and one of free movement."""
    rng = np.random.default_rng(7)
    rows, all_rows = rng.standard_normal((known, n)), rng.standard_normal((n, n))
    return 1e4 * rows.T @ rows, all_rows.T @ all_rows


def test_directions_of_a_product_are_independent_in_it_and_in_free_movement():
    precision, free = random_precisions()
    X, Y = against_free(precision, free)
    np.testing.assert_allclose(X.T @ Y, np.eye(6), atol=1e-9)
    for known in (precision, free):
        diagonal = np.diag(np.diag(X.T @ known @ X))
        np.testing.assert_allclose(Y @ diagonal @ Y.T, known, atol=1e-8 * np.abs(known).max())


def test_directions_of_a_product_are_the_same_in_all_coordinates():
    precision, free = random_precisions()
    T = np.random.default_rng(8).standard_normal((6, 6)) * np.geomspace(0.1, 10, 6)
    ratios = []
    for change in (np.eye(6), T):
        X, _ = against_free(change.T @ precision @ change, change.T @ free @ change)
        ratios.append(np.diag(X.T @ (change.T @ precision @ change) @ X))
    np.testing.assert_allclose(ratios[1], ratios[0], rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("reach", [0.1, 0.3, 1.0])
def test_an_arm_that_turns_what_it_moves_aside_is_as_precise_as_its_hand(reach):
    """A shoulder moves the hand aside, and turns it; a wrist turns it back.

    Its place is known to 5 mm of 3 cm, its heading is as free as any. The shoulder alone, which is
    the mode of an arm with a light wrist, turns so much that it seems to be free if it is short.
    """
    aside, heading = np.array([[reach, 0.0]]), np.array([[1.0, 1.0]])
    precision = aside.T @ aside * (0.005**-2 - 0.03**-2)
    free = aside.T @ aside / 0.03**2 + heading.T @ heading / 0.15**2
    X, _ = against_free(precision, free)
    share = free_share(np.diag(X.T @ precision @ X), np.diag(X.T @ free @ X))
    assert share[0] < 0.2 and share[1] == pytest.approx(1.0)
    np.testing.assert_allclose(heading @ X[:, 0], 0, atol=1e-9)
    np.testing.assert_allclose(aside @ X[:, 1], 0, atol=1e-9)
    shoulder = free_share(precision[0, 0], free[0, 0])
    assert (shoulder > 0.9) == (reach < 0.15)


def test_with_too_few_samples_everything_counts():
    found = relevance(frame(0.05, 0.08, 0.09), 0.01 * np.eye(3), KINDS, samples=4)
    assert found.matters.all()


def test_bad_arguments_are_refused():
    with pytest.raises(ArgumentError, match=r"shape \(2, 2\)"):
        relevance(frame(1, 1, 1), np.eye(2), KINDS)
    with pytest.raises(ArgumentError, match="positive definite"):
        relevance(frame(1, 1, 1), np.zeros((3, 3)), KINDS)
    with pytest.raises(ArgumentError, match="samples is 0"):
        relevance(frame(1, 1, 1), np.eye(3), KINDS, samples=0)
