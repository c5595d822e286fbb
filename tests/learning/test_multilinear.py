"""Tucker and CP decompositions: exact where the tensor is of low rank, best where it is not."""

import numpy as np
import pytest

from tpsim.errors import ArgumentError
from tpsim.learning.multilinear import cp, tucker, unfold


def low_rank(shape, ranks, rng):
    """A tensor that has exactly these multilinear ranks."""
    x = rng.normal(size=ranks)
    for mode, length in enumerate(shape):
        x = np.moveaxis(np.tensordot(rng.normal(size=(length, ranks[mode])), x, (1, mode)), 0, mode)
    return x


@pytest.fixture
def rng():
    return np.random.default_rng(3)


def test_a_tensor_of_low_rank_is_its_own_decomposition(rng):
    x = low_rank((9, 4, 3, 6), (3, 2, 3, 4), rng)
    found = tucker(x, share=1 - 1e-12)
    assert found.ranks == (3, 2, 3, 4)
    np.testing.assert_allclose(found.full, x, atol=1e-10 * np.abs(x).max())
    for factor in found.factors:
        np.testing.assert_allclose(factor.T @ factor, np.eye(factor.shape[1]), atol=1e-12)
    assert found.numbers == 3 * 2 * 3 * 4 + 9 * 3 + 4 * 2 + 3 * 3 + 6 * 4


def test_of_two_modes_it_is_the_singular_value_decomposition(rng):
    x = rng.normal(size=(7, 5))
    U, s, Vt = np.linalg.svd(x)
    found = tucker(x, (2, 2))
    np.testing.assert_allclose(found.full, (U[:, :2] * s[:2]) @ Vt[:2], atol=1e-10)
    np.testing.assert_allclose(found.share, (s[:2] ** 2).sum() / (s**2).sum(), rtol=1e-10)
    np.testing.assert_allclose(found.values[0], s, rtol=1e-12)


def test_what_is_kept_is_what_was_asked_for_and_what_is_said(rng):
    x = low_rank((8, 5, 6), (3, 3, 3), rng) + 0.3 * rng.normal(size=(8, 5, 6))
    for share in (0.5, 0.8, 0.95):
        found = tucker(x, share=share)
        left = ((x - found.full) ** 2).sum() / (x**2).sum()
        assert 1 - left >= share
        np.testing.assert_allclose(found.share, 1 - left, atol=1e-10)


def test_iteration_keeps_no_less_than_hosvd_and_is_stationary(rng):
    x = rng.normal(size=(6, 5, 4))
    found = tucker(x, (2, 2, 2), max_iterations=400, tolerance=1e-15)
    hosvd = [np.linalg.svd(unfold(x, n), full_matrices=False)[0][:, :2] for n in range(3)]
    core = np.einsum("ijk,ia,jb,kc->abc", x, *hosvd)
    assert (found.core**2).sum() > (core**2).sum() * (1 + 1e-3)
    # Each factor spans the leading singular vectors of the tensor seen along all others.
    seen = np.einsum("ijk,jb,kc->ibc", x, *found.factors[1:]).reshape(6, -1)
    U = np.linalg.svd(seen)[0][:, :2]
    np.testing.assert_allclose(U @ U.T, found.factors[0] @ found.factors[0].T, atol=1e-5)


def test_cp_finds_the_components_again(rng):
    """Generic components of rank 3 are unique up to order and sign (Kruskal)."""
    factors = [rng.normal(size=(n, 3)) for n in (10, 6, 5)]
    factors = [f / np.linalg.norm(f, axis=0) for f in factors]
    weights = np.array([5.0, 3.0, 2.0])
    x = np.einsum("r,ir,jr,kr->ijk", weights, *factors)
    found = cp(x, 3, max_iterations=2000, tolerance=1e-14)
    assert found.share > 1 - 1e-8
    np.testing.assert_allclose(found.weights, weights, rtol=1e-3)
    for one, other in zip(found.factors, factors, strict=True):
        np.testing.assert_allclose(np.abs((one * other).sum(0)), 1, atol=1e-4)
    np.testing.assert_allclose(found.full, x, atol=1e-3)


def test_cp_is_never_better_than_tucker_of_the_same_ranks(rng):
    x = rng.normal(size=(5, 4, 6))
    assert cp(x, 2).share <= tucker(x, (2, 2, 2), max_iterations=300).share + 1e-9
    shares = [cp(x, rank, rng=1).share for rank in (1, 3, 20)]
    assert shares == sorted(shares)
    assert shares[-1] > 1 - 1e-6


def test_scale_and_signs_do_not_matter(rng):
    x = rng.normal(size=(4, 3, 5))
    one, other = tucker(x, (2, 2, 2)), tucker(-1e9 * x, (2, 2, 2))
    np.testing.assert_allclose(other.full, -1e9 * one.full, rtol=1e-8)
    for a, b in zip(one.factors, other.factors, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-9)
    nothing = tucker(np.zeros((3, 2, 2)))
    assert nothing.ranks == (1, 1, 1)
    assert not nothing.full.any()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: tucker(np.ones(3)), "two modes or more"),
        (lambda: tucker(np.ones((2, 3)), (1, 4)), r"at most \[2, 2\]"),
        (lambda: tucker(np.ones((2, 3)), (1,)), "one for each mode"),
        (lambda: tucker(np.ones((2, 3)), share=1.0), "below 1"),
        (lambda: cp(np.ones((2, 3)), 3), "at most 2 components"),
        (lambda: cp(np.full((2, 3), np.nan), 1), "NaN"),
    ],
)
def test_what_makes_no_sense_is_refused_in_words(call, words):
    with pytest.raises(ArgumentError, match=words):
        call()
