"""The orientation of a site as a point of S3, without any base."""

import numpy as np
import pytest

from tpsim import S3, R, rotation
from tpsim.catalogue.robots import find
from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.robot.views.observe import manifold_of, observe
from tpsim.robot.views.sites import Object, Site

HAND = Site("left_gripper")
DOCK = Pose(rotation.exp([0.3, -2.0, 1.0]), np.array([0.5, 0.1, 0.2]))


@pytest.fixture(scope="module")
def robot():
    return find("baxter")


def test_its_jacobian_is_the_slope_on_the_manifold(robot):
    h = 1e-6
    for view in (HAND.quaternion, HAND.seen_from(Object("dock")).quaternion):
        now = view(robot.at(robot.home, objects={"dock": DOCK}))
        for k, step in enumerate(h * np.eye(robot.n)):
            there = view(robot.at(robot.home + step, objects={"dock": DOCK})).value
            slope = S3.log(now.value, there) / h
            np.testing.assert_allclose(slope, now.jacobian[:, k], atol=1e-5)


def test_views_say_where_they_live_and_together_they_live_on_the_product(robot):
    views = [HAND.position, HAND.quaternion]
    assert views[0].manifold(robot) == R(3) and views[1].manifold(robot) == S3
    assert manifold_of(views, robot) == R(3) * S3
    for part in (lambda v: v[:2], lambda v: v.minus(np.zeros(4)), lambda v: v.beneath(HAND.pose)):
        with pytest.raises(ArgumentError, match="curved manifold"):
            part(HAND.quaternion)


def test_along_a_movement_signs_do_not_jump(robot):
    q = robot.home + np.linspace(0, 1, 200)[:, None] * np.eye(robot.n)[6] * 6.0
    (seen,) = observe(robot, [HAND.quaternion], q)
    assert (np.sum(seen[1:] * seen[:-1], axis=1) > 0.99).all()
