"""The filter of a pose: an average of what rests, a test that it does, and fading while unseen."""

import numpy as np
import pytest

from tpsim import rotation
from tpsim.control.pose_filter import GLANCE, PoseFilter, smoothed
from tpsim.errors import ArgumentError
from tpsim.pose import Pose

NOISE = (0.005, 0.03)


def sighting(rng, position=(0.0, 0.0, 0.0)):
    turn = rotation.exp(NOISE[1] * rng.standard_normal(3))
    return Pose(turn, np.array(position) + NOISE[0] * rng.standard_normal(3))


def test_without_wander_it_is_the_mean_of_all_sightings():
    rng, found = np.random.default_rng(0), PoseFilter(NOISE, (0.0, 0.0))
    seen = [sighting(rng) for _ in range(40)]
    for k, pose in enumerate(seen):
        found.see(pose, 0.05 * k)
    (R, p), covariance = found.at(2.0)
    np.testing.assert_allclose(p, np.mean([pose.position for pose in seen], axis=0), atol=1e-12)
    expected = np.repeat(np.square(NOISE) / 40, 3)
    np.testing.assert_allclose(covariance, np.diag(expected), rtol=1e-12)
    # The mean rotation, to second order of its small spread.
    mean = rotation.mean(np.array([pose.rotation for pose in seen]))
    assert np.linalg.norm(rotation.log(mean.T @ R)) < 0.05 * NOISE[1]


def test_it_is_as_sure_as_it_says():
    """Squared error over its variance has the mean 3 of chi squared (Monte Carlo, 80 times)."""
    places, turns = [], []
    for seed in range(80):
        rng, found = np.random.default_rng(seed), PoseFilter(NOISE, (0.0, 0.0))
        for k in range(20):
            found.see(sighting(rng), k / 20)
        (R, p), covariance = found.at(19 / 20)
        places.append(p @ p / covariance[0, 0])
        turns.append(np.sum(rotation.log(R) ** 2) / covariance[3, 3])
    for squares in (places, turns):
        assert abs(np.mean(squares) - 3) < 4 * np.sqrt(6 / 80)


def test_what_is_hidden_fades_as_a_random_walk():
    rng, wander = np.random.default_rng(1), (0.004, 0.02)
    found = PoseFilter(NOISE, wander)
    for k in range(60):
        found.see(sighting(rng), k / 20)
    last = 59 / 20
    pose, _ = found.at(last)
    grown = [found.at(last + GLANCE + s).covariance.diagonal()[[0, 3]] for s in (1.0, 3.0)]
    assert np.array_equal(found.at(last + 9).pose.position, pose.position)
    # Within the little that it wanders while it is watched.
    np.testing.assert_allclose(grown[1] - grown[0], 2 * np.square(wander), rtol=0.01)
    found.see(sighting(rng), last + 10)
    assert found.at(last + 10).covariance[0, 0] < NOISE[0] ** 2


def test_an_object_that_was_moved_is_found_again_and_rest_raises_no_alarm():
    errors = []
    for seed in range(6):
        rng, found = np.random.default_rng(seed), PoseFilter(NOISE)
        for k in range(200):
            goal = np.array([0.1 * np.clip(k / 20 - 3, 0, 2), 0.0, 0.0])  # 10 cm/s for 2 s
            found.see(sighting(rng, goal), k / 20)
            if 1.5 < k / 20 < 3:
                assert found.at(k / 20).covariance[0, 0] < NOISE[0] ** 2 / 20
        errors.append(np.linalg.norm(found.at(10).pose.position - goal))
    assert np.mean(errors) < NOISE[0] / 3


def test_it_turns_with_the_world():
    rng, R = np.random.default_rng(2), rotation.exp([2.0, -1.0, 0.7])
    seen = [sighting(rng, (0.1, 0.2, 0.3)) for _ in range(10)]
    one, other = PoseFilter(NOISE), PoseFilter(NOISE)
    for k, (turned, p) in enumerate(seen):
        one.see(Pose(turned, p), k / 10)
        other.see(Pose(R @ turned, R @ p), k / 10)
    a, b = one.at(1.0), other.at(1.0)
    np.testing.assert_allclose(b.pose.rotation, R @ a.pose.rotation, atol=1e-12)
    np.testing.assert_allclose(b.pose.position, R @ a.pose.position, atol=1e-12)


def test_before_it_was_seen_nothing_is_known_and_time_does_not_run_back():
    found = PoseFilter()
    assert found.at(3.0) is None
    found.see(sighting(np.random.default_rng(0)), 1.0)
    with pytest.raises(ArgumentError, match="before the last sighting"):
        found.see(sighting(np.random.default_rng(0)), 0.9)
    with pytest.raises(ArgumentError, match="noise"):
        PoseFilter((0.0, 0.01))


def test_what_rests_is_known_from_before_and_after_as_the_mean_of_all():
    rng = np.random.default_rng(3)
    seen = [(k / 20, sighting(rng)) for k in range(40) if not 10 <= k < 25]
    times = np.linspace(0.0, 2.0, 23)
    mean = np.mean([pose.position for _, pose in seen], axis=0)
    for (_, p), covariance in smoothed(seen, times, NOISE, (0.0, 0.0)):
        np.testing.assert_allclose(p, mean, atol=1e-12)
        np.testing.assert_allclose(covariance[0, 0], NOISE[0] ** 2 / len(seen), rtol=1e-9)


def test_in_the_middle_of_a_gap_least_is_known():
    rng = np.random.default_rng(4)
    seen = [(k / 20, sighting(rng)) for k in range(100) if not 30 <= k < 70]
    found = smoothed(seen, np.array([0.0, 1.4, 2.5, 3.5, 4.9]), NOISE, (0.01, 0.05))
    deviation = np.sqrt([covariance[0, 0] for _, covariance in found])
    assert deviation.argmax() == 2
    # Half as much variance as what one side alone would know, by symmetry.
    alone = PoseFilter(NOISE, (0.01, 0.05))
    for time, pose in seen[:30]:
        alone.see(pose, time)
    assert deviation[2] ** 2 == pytest.approx(alone.at(2.475).covariance[0, 0] / 2, rel=0.05)
