"""Claims of several objects about a hand's pose: their product, their worth, and the way round."""

import numpy as np
import pytest

from tpsim import RiemannianGaussian, rotation
from tpsim.controllers.seen_poses import (
    POSE,
    common_pose,
    counted,
    placed_poses,
    precision_at,
)
from tpsim.controllers.way_round import SPEED, turned, ways_round
from tpsim.pose import Pose

T, DT, SHOWN = 200, 0.03, 12
SHARE = np.clip(np.linspace(-0.5, 1.5, T), 0, 1)


def claims(angle, axis=(0.0, 0.0, 1.0)):
    """Two docks, each sure of the hand where it is in it; taught was a turn by 0.7 rad."""
    turn, sure, vague = np.array([0.0, 0.0, 0.7]), 0.01, 0.1
    deviation = sure * (vague / sure) ** SHARE
    docks, movements = [], []
    for k, (share, spread) in enumerate(((SHARE, deviation), (SHARE - 1, deviation[::-1]))):
        way = np.hstack(
            [
                share[:, None] * [0.0, -0.3, 0.0],
                rotation.to_quaternion(rotation.exp(share[:, None] * turn)),
            ]
        )
        covariance = spread[:, None, None] ** 2 * np.eye(6)
        movements.append(RiemannianGaussian(POSE, way, covariance))
        end = rotation.exp(angle * np.array(axis))
        docks.append(Pose(end, np.array([0.0, -0.3, 0.0])) if k else Pose(np.eye(3), np.zeros(3)))
    return movements, docks


def at_the_end(way, docks):
    """Angle [rad] from the orientation in the second dock."""
    return np.linalg.norm(rotation.log(rotation.from_quaternion(way[-1, 3:]) @ docks[1].rotation.T))


def test_a_turned_world_turns_the_product_and_signs_do_not_matter():
    movements, docks = claims(2.0, (0.6, 0.0, 0.8))
    world = Pose(rotation.exp([0.3, -1.5, 2.0]), np.array([0.1, 0.5, -0.2]))
    way, covariance = common_pose(*placed_poses(movements, docks))
    other = [
        RiemannianGaussian(POSE, m.mean * [1, 1, 1, -1, -1, -1, -1], m.covariance)
        for m in movements
    ]
    again, spread = common_pose(*placed_poses(other, [world @ dock for dock in docks]))
    back = world.inverse
    np.testing.assert_allclose(
        back.rotation @ again[:, :3].T + back.position[:, None], way[:, :3].T, atol=1e-9
    )
    seen = back.rotation @ rotation.from_quaternion(again[:, 3:])
    np.testing.assert_allclose(seen, rotation.from_quaternion(way[:, 3:]), atol=1e-4)
    turn = np.kron(np.eye(2), back.rotation)
    np.testing.assert_allclose(turn @ spread @ turn.T, covariance, atol=1e-4)


def test_an_object_that_is_not_exactly_known_adds_its_covariance():
    (movement, _), (dock, _) = claims(0.5)
    unsure = np.diag([0.01**2] * 3 + [0.05**2] * 3)
    means, precisions = placed_poses([movement], [dock], [unsure])
    lever = np.eye(6)
    x, y, z = means[0, -1, :3] - dock.position
    lever[:3, 3:] = -np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    expected = movement.covariance[-1] + lever @ unsure @ lever.T
    np.testing.assert_allclose(np.linalg.inv(precisions[0, -1]), expected, rtol=1e-6, atol=1e-12)


def test_what_was_shown_counts_as_before_and_what_never_was_hardly():
    """Of Gaussians the first dock's share of the end is sigma_e^2 / sigma_s^2 = 1 %."""
    for angle in (0.0, 1.5):
        means, precisions = placed_poses(*(found := claims(0.7 + angle)))
        way, _ = common_pose(means, precisions)
        worth = counted(means, precisions, way, SHOWN)
        better, _ = common_pose(means, worth, way)
        before, now = (at_the_end(one, found[1]) for one in (way, better))
        if angle:
            assert before == pytest.approx(angle * 0.01 / 1.01, rel=0.05)
            assert now < 0.2 * before
        else:
            assert before < 1e-3
            assert now < 1e-3


@pytest.mark.parametrize("angle", [100.0, 150.0, 179.0, -100.0, -150.0, -179.0])
def test_both_ways_round_end_in_the_second_dock_without_a_leap(angle):
    movements, docks = claims(np.radians(angle), (0.2, 0.0, np.sqrt(0.96)))
    means, precisions = placed_poses(movements, docks)
    way, _ = common_pose(means, precisions)
    ways = ways_round(means, precisions, way, DT)
    if len(ways) == 1:  # as the taught turn goes, claims are 40 degrees closer
        assert abs(angle - np.degrees(0.7)) < 95
        return
    for one in ways:
        assert at_the_end(one, docks) < np.radians(0.5)
        steps = POSE.work.log(one[:-1], one[1:])[:, 3:]
        # Over the taught turn of its own, 0.7 rad within half the time.
        taught = 0.7 / (0.5 * T * DT)
        assert np.linalg.norm(steps, axis=1).max() < 1.1 * (SPEED + taught) * DT
        assert np.isfinite(precision_at(one, means, precisions)).all()
    assert sorted(map(turned, ways))[0] < np.radians(abs(angle) + 60)
