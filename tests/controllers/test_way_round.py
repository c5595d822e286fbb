"""Where claims are far apart: positions between them, and ways that arms can go."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from tpsim import rotation
from tpsim.controllers.way_round import (
    BEHIND,
    ROOM,
    STRIDE,
    _step,
    chosen,
    rehearsed,
    turned,
    ways_round,
)
from tpsim.pose import Pose
from tpsim.robot.state import State

SITE, ARM = "left_gripper", slice(0, 7)


def turning(robot, angle, steps=240):
    """The hand turns on the spot (T, 7) about its own axis, and its last quarter is at rest."""
    R, p = robot.at_home.pose(SITE)
    turn = np.clip(np.linspace(0, 4 / 3, steps), 0, 1)[:, None] * [0.0, 0.0, angle]
    return np.hstack([np.tile(p, (steps, 1)), rotation.to_quaternion(R @ rotation.exp(turn))])


def test_the_hand_goes_from_claim_to_claim_and_not_where_neither_is():
    """A product takes x of the one and y of the other claim: a corner that nobody ever saw."""
    far = rotation.to_quaternion(rotation.exp([0.0, 0.0, 2.0]))
    means = np.array([[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], [0.3, 0.2, 0.0, *far]])
    known = np.array([[1.0, 100.0, 1.0], [100.0, 1.0, 1.0]]) * 1e3
    share = np.linspace(1, 0, 50)[:, None]
    sure = np.stack([known[0] * share + 1.0, known[1] * (1 - share) + 1.0])
    precisions = np.zeros((2, 50, 6, 6))
    precisions[..., range(3), range(3)] = precisions[..., range(3, 6), range(3, 6)] = sure
    claims = np.repeat(means[:, None], 50, 1)
    corner = (sure * claims[..., :3]).sum(0) / sure.sum(0)
    found = ways_round(claims, precisions, np.hstack([corner, claims[0, :, 3:]]), 0.03)
    line = np.array([0.3, 0.2, 0.0]) / np.hypot(0.3, 0.2)
    assert len(found) == 2
    for way in found:
        along = way[:, :3] @ line
        np.testing.assert_allclose(way[:, :3], along[:, None] * line, atol=1e-12)
        assert (np.diff(along) >= 0).all()
        assert along[0] < 1e-3 and along[-1] > np.hypot(0.3, 0.2) - 1e-3
    away = np.linalg.norm(corner - (corner @ line)[:, None] * line, axis=1)
    assert away.max() > 0.1


def test_claims_that_agree_are_kept():
    claims = np.tile([0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0], (2, 20, 1))
    claims[1, :, 3:] = rotation.to_quaternion(rotation.exp([0.0, 0.0, 2.0]))
    for way in ways_round(claims, np.tile(np.eye(6), (2, 20, 1, 1)), claims[0], 0.03):
        np.testing.assert_allclose(way[:, :3], claims[0, :, :3], atol=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_a_step_of_joints_keeps_its_bounds_and_goes_as_far_as_others_can_make_up(seed):
    rng = np.random.default_rng(seed)
    J, least, most = rng.standard_normal((6, 7)), -rng.uniform(0, 0.4, 7), rng.uniform(0, 0.4, 7)
    for asked in (0.02, 0.2, 2.0):
        missing = J @ (asked * rng.standard_normal(7))
        step = _step(J, missing, least, most)
        assert (step >= least - 1e-12).all() and (step <= most + 1e-12).all()
        best = lsq_linear(J, missing, (least - 1e-9, most + 1e-9))
        left = np.linalg.norm(J @ step - missing)
        assert left <= 1.5 * np.sqrt(2 * best.cost) + 0.05 * np.linalg.norm(missing)


@pytest.mark.parametrize("asked", [0.1, -0.1])
def test_a_joint_beyond_its_bounds_only_moves_back(asked):
    step = _step(np.eye(6, 7), np.full(6, asked), np.r_[0.2, -np.ones(6)], np.ones(7))
    np.testing.assert_allclose(step, [max(asked, 0), *5 * [asked], 0], atol=1e-4)


@pytest.mark.parametrize("angle", [1.5, -1.5, 2.8, -2.8])
def test_a_rehearsed_arm_keeps_within_its_limits_and_says_what_it_misses(dock_world, angle):
    robot, way = dock_world.robot, turning(dock_world.robot, angle)
    postures, missed = rehearsed(robot, ARM, SITE, robot.home, way)
    assert (postures >= robot.lower[ARM] + ROOM - 1e-9).all()
    assert (postures <= robot.upper[ARM] - ROOM + 1e-9).all()
    q = robot.home.copy()
    q[ARM] = postures[-1]
    R, p = State(robot, np.append(q, 0 * q)).pose(SITE)
    there = Pose(rotation.from_quaternion(way[-1, 3:]), way[-1, :3])
    np.testing.assert_allclose(there.position - p, missed[-1, :3], atol=1e-12)
    np.testing.assert_allclose(rotation.log(there.rotation @ R.T), missed[-1, 3:], atol=1e-6)
    assert len(postures) == len(way) // STRIDE + 1
    if abs(angle) < 2:
        assert np.abs(missed[-1]).max() < 1e-3


def test_of_two_ways_the_one_that_the_arm_can_follow_is_gone(dock_world):
    robot = dock_world.robot
    short, long = (turning(robot, angle) for angle in (2.0, 2.0 - 2 * np.pi))
    assert np.abs(rehearsed(robot, ARM, SITE, robot.home, long)[1] / BEHIND).max() > 1
    for ways in ([short, long], [long, short]):
        way, postures = chosen(ways, robot, ARM, SITE, robot.home)
        assert way is short
        np.testing.assert_array_equal(postures, rehearsed(robot, ARM, SITE, robot.home, short)[0])
    assert turned(short) == pytest.approx(2.0, rel=1e-6)
