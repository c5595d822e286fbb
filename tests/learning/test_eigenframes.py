"""Eigenframes and redundant frames, on movements whose structure is known."""

import numpy as np
import pytest

from tpsim import Demonstration, Frame
from tpsim.errors import ArgumentError
from tpsim.learning.eigenframes import demonstration_tensor, eigenframes
from tpsim.learning.redundancy import redundant_frames

SAMPLES = 40
S = np.linspace(0, 1, SAMPLES) ** 2


def turn(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def movements(count=8, turned=False, noise=0.0, seed=0):
    """From a start straight to a goal; the third frame is a sticker on the goal, the fourth lies
    halfway, the fifth anywhere."""
    rng, found = np.random.default_rng(seed), []
    for _ in range(count):
        start, goal, other = rng.normal([[0, 0], [4, 0], [2, 3]], 1.0)
        angle = rng.uniform(-1, 1) if turned else 0.0
        data = start + S[:, None] * (goal - start)
        sticker = goal + turn(angle) @ [0.5, 0.2] + noise * rng.normal(size=2)
        frames = [
            Frame(np.eye(2), start),
            Frame(turn(angle), goal),
            Frame(turn(angle + 2.0), sticker),
            Frame(np.eye(2), (start + goal) / 2),
            Frame(np.eye(2), other),
        ]
        found.append(Demonstration(np.linspace(0, 3, SAMPLES), data, frames))
    return found


def only(demonstrations, frames):
    return [demonstration.seen_from(frames) for demonstration in demonstrations]


def test_the_tensor_holds_what_every_frame_saw():
    demonstrations = movements(3)
    X = demonstration_tensor(demonstrations, SAMPLES)
    assert X.shape == (SAMPLES, 5, 2, 3)
    np.testing.assert_allclose(X[:, 1, :, 2], demonstrations[2].observations[1], atol=1e-12)


def test_eigentrajectories_of_a_straight_way_are_two():
    """Frame 1 sees s(t) (goal - start), frame 2 sees (s(t) - 1) (goal - start)."""
    found = eigenframes(only(movements(), [0, 1]), samples=SAMPLES, share=1 - 1e-12)
    assert found.trajectories.shape[1] == found.frames.shape[1] == found.poses.shape[1] == 2
    assert found.scores.shape[1] == 2
    basis = np.column_stack([S, np.ones(SAMPLES)])
    rest = found.trajectories - basis @ np.linalg.lstsq(basis, found.trajectories)[0]
    np.testing.assert_allclose(rest, 0, atol=1e-9)
    assert found.error < 1e-6
    np.testing.assert_allclose(
        found.full, demonstration_tensor(only(movements(), [0, 1]), SAMPLES), atol=1e-5
    )


def test_what_is_left_out_is_what_is_said():
    X = demonstration_tensor(movements(), 100)
    found = eigenframes(movements(), share=0.9)
    np.testing.assert_allclose(np.sqrt(((X - found.full) ** 2).mean()), found.error, rtol=1e-6)
    assert found.error**2 < 0.1 * found.spread**2
    assert found.compression > 5
    assert str(found).count("\n") == 4


def test_a_sticker_adds_no_eigenframe_however_it_is_turned():
    demonstrations = movements(turned=True)
    without = eigenframes(only(demonstrations, [0, 1, 4]), samples=SAMPLES)
    with_it = eigenframes(only(demonstrations, [0, 1, 2, 4]), samples=SAMPLES)
    values = with_it.decomposition.values[1]
    assert values[-1] < 1e-4 * values[0]
    assert without.decomposition.values[1][-1] > 0.05 * values[0]


def test_redundant_is_what_sees_the_same_and_nothing_else():
    for turned in (False, True):
        found = redundant_frames(movements(turned=turned))
        assert found.kept == (0, 1, 3, 4)
        assert found.instead == {2: 1}
        assert max(found.unexplained[2, 1], found.unexplained[1, 2]) < 1e-9
    assert "sees what 1 sees" in str(found)


def test_halfway_follows_from_both_but_from_neither_alone():
    found = redundant_frames(movements(12))
    assert found.together[3] < 1e-6
    assert found.unexplained[3, [0, 1, 2, 4]].min() > 0.2
    assert found.together[4] > 0.5


def test_a_sticker_that_shakes_by_what_matters_is_no_twin():
    """A shake of 1 cm, while all frames see the movement vary by far more."""
    assert redundant_frames(movements(noise=0.01)).kept == (0, 1, 2, 3, 4)


def test_units_and_axes_of_the_world_change_nothing():
    demonstrations = movements(turned=True)
    R, c = 1000 * turn(0.7), np.array([5e3, -2e3])
    moved = [
        Demonstration(
            d.time, d.data @ R.T + c, [Frame(R @ f.A / 1000, R @ f.b + c) for f in d.frames]
        )
        for d in demonstrations
    ]
    one, other = redundant_frames(demonstrations), redundant_frames(moved)
    assert one.kept == other.kept
    np.testing.assert_allclose(one.together, other.together, rtol=1e-4, atol=1e-9)
    a, b = eigenframes(demonstrations), eigenframes(moved)
    np.testing.assert_allclose(b.spread, 1000 * a.spread, rtol=1e-9)
    np.testing.assert_allclose(b.decomposition.share, a.decomposition.share, rtol=1e-6)


def test_what_makes_no_sense_is_refused_in_words():
    with pytest.raises(ArgumentError, match="two or more"):
        eigenframes(movements(1))
    with pytest.raises(ArgumentError, match="same frames"):
        redundant_frames([movements()[0], movements()[1].seen_from([0])])
    mixed = Demonstration(
        S + np.arange(SAMPLES),
        np.ones((SAMPLES, 2)),
        observations=[np.ones((SAMPLES, 2)), np.ones((SAMPLES, 3))],
    )
    with pytest.raises(ArgumentError, match=r"\[2, 3\] dimensions"):
        eigenframes([mixed, mixed])
    with pytest.raises(ArgumentError, match="frame 7"):
        movements(1)[0].seen_from([7])
