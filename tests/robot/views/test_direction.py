"""Directions and the posture that they leave free: values and bounds (Eqs 40-42)."""

import numpy as np
import pytest

from tpsim.control.planar import numeric_jacobian
from tpsim.pose import Pose
from tpsim.robot.views.direction import NEAR
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Object, Site

FIRST = Object("first")


def at(robot, q, place):
    return robot.at(q, objects={"first": Pose(np.eye(3), np.asarray(place, float))})


@pytest.fixture(params=["planar", "baxter"])
def arm(request, planar3_world, dock_world):
    """Robot, direction, and the axes of the site: that which points, and those across."""
    if request.param == "planar":
        return planar3_world.robot, Site("tip").axis("x", across="y"), (0, 1)
    return dock_world.robot, Site("left_gripper").axis("z"), (2, 0, 1)


def test_an_angle_is_the_angle_between_axis_and_sight(arm):
    robot, direction, axes = arm
    state = at(robot, np.full(robot.n, 0.4), (0.3, 0.9, -0.1))
    R, p = state.pose(direction.site)
    sight = (R.T @ (state.objects["first"].position - p))[list(axes)]
    y = direction.towards(FIRST)(state).value
    assert np.linalg.norm(y) == pytest.approx(np.arccos(sight[0] / np.linalg.norm(sight)))


def test_the_planar_direction_is_the_sum_of_the_joints(planar3_world):
    direction = Site("tip").axis("x", across="y", reference=np.eye(3))
    seen = direction(planar3_world.robot.at([0.4, 0.9, -0.2]))
    np.testing.assert_allclose(seen.value, [1.1])
    np.testing.assert_allclose(seen.jacobian, np.ones((1, 3)))


def test_what_is_left_of_the_posture_moves_no_direction(arm):
    robot, direction, _ = arm
    state = robot.at(np.full(robot.n, 0.3))
    spare = Joints().spare(direction, free=robot.joints, damping=1e-3)
    J, N = direction(state).jacobian, spare(state).jacobian
    np.testing.assert_allclose(J @ N, 0, atol=1e-5)
    np.testing.assert_allclose(N @ N, N, atol=1e-5)


def test_free_joints_say_all_about_what_is_left(planar3_world):
    robot, direction = planar3_world.robot, Site("tip").axis("x", across="y")
    q, origin = np.array([0.4, -0.3, 0.8]), (0.1, 0.2, 0.3)
    seen = {}
    for free in (robot.joints, robot.joints[:2]):
        spare = Joints().spare(direction, origin=origin, free=free, damping=1e-3)
        assert spare.labels(robot) == tuple(f"{joint} [rad]" for joint in free)
        seen[len(free)] = spare(robot.at(q))
    np.testing.assert_allclose(seen[3].value, seen[3].jacobian @ (q - origin))
    rest = np.linalg.lstsq(seen[2].jacobian, seen[2].value)[0]
    np.testing.assert_allclose(rest, seen[3].value, atol=1e-6)


def test_jacobians_stay_bounded_at_the_object_and_behind(arm):
    robot, direction, axes = arm
    q = np.full(robot.n, 0.3)
    R, p = robot.at(q).pose(direction.site)
    ahead, across = R[:, axes[0]], R[:, axes[1]]
    for offset in (0 * ahead, 1e-9 * across, -0.5 * ahead, -0.5 * ahead + 1e-9 * across):
        y, J, *_ = direction.towards(FIRST)(at(robot, q, p + offset))
        assert np.isfinite(y).all()
        assert np.abs(J).max() < 10 * (1 + 1 / NEAR)
    np.testing.assert_allclose(np.linalg.norm(y), np.pi, atol=1e-6)


def test_directions_fade_smoothly_close_to_the_object(arm):
    robot, direction, _ = arm
    q, towards = np.full(robot.n, 0.3), direction.towards(FIRST)
    p = robot.at(q).pose(direction.site).position
    for offset in ((0.03, 0.04, 0.02), (-0.05, 0.01, 0.03)):
        J = towards(at(robot, q, p + offset)).jacobian
        numeric = numeric_jacobian(lambda x, o=offset: towards(at(robot, x, p + o)).value, q)
        np.testing.assert_allclose(J, numeric, atol=1e-5)
