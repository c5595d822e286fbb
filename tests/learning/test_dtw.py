"""DTW: the cheapest path, the reference's figures, and several demonstrations."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import Demonstration, Frame
from tpsim.errors import ArgumentError
from tpsim.learning.dtw import align, dtw

FIGURES = np.load(Path(__file__).parents[1] / "reference" / "dtw.npz")


def cheapest(distance, width):
    """Cost by the textbook recursion."""
    n, m = distance.shape
    cost = np.full((n + 1, m + 1), np.inf)
    cost[0, 0] = 0.0
    for i in range(n):
        for j in range(m):
            if abs(i - j) <= width:
                before = min(cost[i, j], cost[i, j + 1], cost[i + 1, j])
                cost[i + 1, j + 1] = distance[i, j] + before
    return cost[-1, -1]


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 12), st.integers(0, 10**6))
def test_path_is_the_cheapest_monotone_matching(n, m, band, seed):
    rng = np.random.default_rng(seed)
    x, y = rng.normal(size=(n, 2)), rng.normal(size=(m, 2))
    warp = dtw(x, y, band=band)
    distance = np.linalg.norm(x[:, None] - y, axis=-1)
    i, j = warp.path.T
    assert np.isclose(warp.cost, distance[i, j].sum())
    assert np.isclose(warp.cost, cheapest(distance, max(band, abs(n - m))))
    assert warp.path[0].tolist() == [0, 0]
    assert warp.path[-1].tolist() == [n - 1, m - 1]
    assert {tuple(s) for s in np.diff(warp.path, axis=0)} <= {(0, 1), (1, 0), (1, 1)}
    assert np.abs(i - j).max() <= max(band, abs(n - m))


@pytest.mark.parametrize("k", range(3))
def test_path_is_the_references_which_drops_the_last_pair(k):
    band = FIGURES["bands"][k]
    path = dtw(FIGURES["x"], FIGURES["y"], band=None if np.isinf(band) else band).path
    np.testing.assert_array_equal(path[:-1], FIGURES[f"path_{k}"])


def test_sequence_matches_itself_at_no_cost():
    x = np.random.default_rng(0).normal(size=(30, 3))
    warp = dtw(x, x)
    assert warp.cost == 0.0
    np.testing.assert_array_equal(warp.timing(), np.arange(30))


def movement(phase, name):
    """One path run through with another timing, its frame moving with it."""
    data = np.column_stack([np.cos(3 * phase), np.sin(5 * phase)])
    moving = Frame(np.eye(2), 0.5 * data)
    return Demonstration(np.linspace(0, 1, len(phase)), data, [moving], name=name)


@pytest.mark.parametrize("by", ["data", "frames"])
def test_align_removes_differences_in_timing(by):
    demonstrations = [
        movement(np.linspace(0, 1, 80) ** power, name)
        for power, name in [(1.0, "even"), (1.6, "late"), (0.7, "early")]
    ]
    spread = np.std([d.data for d in demonstrations], axis=0).max()
    aligned = align(demonstrations, reference=0, by=by)
    assert [d.name for d in aligned] == ["even", "late", "early"]
    assert np.std([d.data for d in aligned], axis=0).max() < 0.1 * spread
    for d in aligned:
        np.testing.assert_array_equal(d.time, demonstrations[0].time)
        # Data, moving frame and observation were warped together.
        np.testing.assert_allclose(d.frames[0].b, 0.5 * d.data, atol=1e-12)
        np.testing.assert_allclose(d.observations[0], 0.5 * d.data, atol=1e-12)


def test_align_takes_demonstrations_of_unequal_length():
    demonstrations = [movement(np.linspace(0, 1, n), str(n)) for n in (40, 60, 90)]
    aligned = align(demonstrations)
    assert {len(d) for d in aligned} == {60}  # of equal duration: the middle one
    assert np.std([d.data for d in aligned], axis=0).max() < 0.05


@pytest.mark.parametrize(
    "arguments",
    [
        ([], [1.0]),
        ([1.0, np.nan], [1.0]),
        (np.zeros((3, 2)), np.zeros((3, 1))),
        (np.zeros((0, 2)), np.zeros((3, 2))),
    ],
)
def test_bad_sequences_are_refused(arguments):
    with pytest.raises(ArgumentError):
        dtw(*arguments)


def test_bad_choices_are_refused():
    demonstration = movement(np.linspace(0, 1, 10), "")
    plain = Demonstration(demonstration.time, demonstration.data)
    for call in (
        lambda: dtw([1.0], [1.0], band=-1),
        lambda: align([]),
        lambda: align([demonstration], rounds=0),
        lambda: align([demonstration], by="hand"),
        lambda: align([plain], by="frames"),
        lambda: align([demonstration], reference=1),
        lambda: align([plain, Demonstration(plain.time, plain.data[:, :1])]),
    ):
        with pytest.raises(ArgumentError):
            call()


def test_memory_is_that_of_the_band():
    import tracemalloc

    x = np.cumsum(np.random.default_rng(0).normal(size=(3000, 2)), 0)
    tracemalloc.start()
    warp = dtw(x, x[1:], band=10)
    used = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert used < 3e6  # the full matrix of distances takes 72e6
    assert abs(warp.path[:, 0] - warp.path[:, 1]).max() <= 10
