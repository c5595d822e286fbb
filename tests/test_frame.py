"""Frames: Eq. (4) and its lifts (20) and (32), also where A has no inverse."""

from pathlib import Path

import numpy as np
import pytest

from tpsim import Frame
from tpsim.errors import ArgumentError

REFERENCE = np.load(Path(__file__).parent / "reference" / "affine.npz")


@pytest.fixture
def rng():
    return np.random.default_rng(1)


def test_local_views_are_those_of_the_reference():
    A, b, X = REFERENCE["A"], REFERENCE["b"], REFERENCE["X"]
    for p in range(2):
        local = [Frame(A[m, p], b[m, p]).to_local(X[m]) for m in range(len(X))]
        np.testing.assert_allclose(np.concatenate(local), REFERENCE["Xf"][p], rtol=1e-12)


@pytest.mark.parametrize("shape", [(), (6,)])
def test_there_and_back(rng, shape):
    """Scaled, reflected, constant or moving: what is seen can be put back."""
    A = rng.normal(size=(*shape, 3, 3)) * np.array([1.0, -0.1, 10.0])
    frame = Frame(A, rng.normal(size=(*shape, 3)))
    x = rng.normal(size=(6, 3))
    np.testing.assert_allclose(frame.to_common(frame.to_local(x)), x, rtol=1e-8)


def test_a_tall_frame_sees_the_closest_point(rng):
    A, b, x = rng.normal(size=(5, 2)), rng.normal(size=5), rng.normal(size=5)
    local = Frame(A, b).to_local(x)
    np.testing.assert_allclose(local, np.linalg.lstsq(A, x - b)[0])
    np.testing.assert_allclose(Frame(A, b).to_local(A @ local + b), local)


def test_a_singular_frame_answers_with_its_pseudo_inverse():
    projector = np.diag([1.0, 1.0, 0.0])
    local = Frame(projector, np.zeros(3)).to_local([1.0, 2.0, 3.0])
    np.testing.assert_allclose(local, [1, 2, 0])
    assert np.isfinite(Frame(np.zeros((2, 2)), np.zeros(2)).to_local([1.0, 1.0])).all()


def test_lift_by_an_input_leaves_the_input_alone(rng):
    frame = Frame(rng.normal(size=(4, 2, 2)), rng.normal(size=(4, 2)))
    x, s = rng.normal(size=(4, 2)), rng.normal(size=(4, 3))
    lifted = frame.with_input(3).to_local(np.hstack([s, x]))
    np.testing.assert_allclose(lifted, np.hstack([s, frame.to_local(x)]))


def test_lift_by_derivatives_commutes_with_differentiation(rng):
    """Differences of what a constant frame sees are what the lifted frame sees, Eq. (32)."""
    frame, x = Frame(rng.normal(size=(2, 2)), rng.normal(size=2)), rng.normal(size=(9, 2))
    d, dd = np.diff(x, axis=0)[:-1], np.diff(x, n=2, axis=0)
    seen = frame.with_derivatives(2).to_local(np.hstack([x[:-2], d, dd]))
    local = frame.to_local(x)
    expected = np.hstack([local[:-2], np.diff(local, axis=0)[:-1], np.diff(local, n=2, axis=0)])
    np.testing.assert_allclose(seen, expected, atol=1e-10)


def test_selection_of_a_step(rng):
    frame = Frame(np.eye(2), rng.normal(size=(5, 2)))
    assert frame.shape == (5,)
    assert frame[2].shape == ()
    np.testing.assert_array_equal(frame[2].b, frame.b[2])


@pytest.mark.parametrize(
    ("A", "b"),
    [
        (np.eye(2), np.zeros(3)),
        (np.ones(2), np.zeros(2)),
        (np.full((2, 2), np.inf), np.zeros(2)),
        (np.ones((4, 2, 2)), np.zeros((3, 2))),
        (np.ones((2, 0)), np.zeros(2)),
    ],
)
def test_bad_frames_are_refused(A, b):
    with pytest.raises(ArgumentError):
        Frame(A, b)


@pytest.mark.parametrize(
    "use",
    [
        lambda f: f.to_local([1.0]),
        lambda f: f.to_common([[1.0]]),
        lambda f: f.with_input(0),
        lambda f: f.with_derivatives(-1),
    ],
)
def test_misuse_is_refused(use):
    with pytest.raises(ArgumentError):
        use(Frame(np.eye(2), np.zeros(2)))
