"""Directions and the postures beneath them: values, Jacobians, bounds (Eqs 40-42)."""

import numpy as np
import pytest

from tpsim import rotation
from tpsim.control.planar import numeric_jacobian
from tpsim.sim import scene
from tpsim.sim.coordinates.direction import NEAR, Direction, DirectionTo, PostureBeneath
from tpsim.sim.simulation import Simulation

ARMS = {
    "planar": (scene.planar3, "tip", (0, 1)),
    "baxter": (lambda: scene.baxter({"first": "marker"}), "left_gripper", (2, 0, 1)),
}


@pytest.fixture(scope="module", params=ARMS)
def arm(request):
    xml, site, axes = ARMS[request.param]
    simulation = Simulation(xml())
    simulation.objects["first"][0][:] = (0.3, 0.9, -0.1)
    robot = simulation.robot
    robot.update_kinematics(simulation.home)
    R = tuple(robot.placement(robot.site(site))[0].ravel())
    direction = Direction("direction", site, axes, R)
    return robot, {
        "direction": direction,
        "to": DirectionTo("to", site, "first", axes),
        "posture": PostureBeneath(
            "posture", robot.joints, direction, robot.joints, tuple(simulation.home)
        ),
    }


def value(robot, coordinate, q):
    evaluate = coordinate.bind(robot)
    robot.update_kinematics(q)
    return evaluate()


@pytest.mark.parametrize("name", ["direction", "to"])
def test_jacobians_are_derivatives(arm, name):
    robot, coordinates = arm
    rng = np.random.default_rng(1)
    for _ in range(5):
        q = rng.uniform(-0.8, 0.8, robot.n)
        _, J = value(robot, coordinates[name], q)
        numeric = numeric_jacobian(lambda x: value(robot, coordinates[name], x)[0].copy(), q)
        np.testing.assert_allclose(J, numeric, atol=1e-6)


def test_an_angle_is_the_angle_between_axis_and_sight(arm):
    robot, coordinates = arm
    to = coordinates["to"]
    y, _ = value(robot, to, np.full(robot.n, 0.4))
    R, p = robot.placement(robot.site(to.site))
    sight = R.T @ (robot.objects["first"][0] - p)
    seen = sight[list(to.axes)]
    assert np.linalg.norm(y) == pytest.approx(np.arccos(seen[0] / np.linalg.norm(seen)))


def test_the_planar_direction_is_the_sum_of_the_joints():
    simulation = Simulation(scene.planar3())
    direction = Direction("direction", "tip", (0, 1))
    y, J = value(simulation.robot, direction, np.array([0.4, 0.9, -0.2]))
    np.testing.assert_allclose(y, [1.1])
    np.testing.assert_allclose(J, np.ones((1, 3)))


def test_the_posture_beneath_moves_no_direction(arm):
    robot, coordinates = arm
    q = np.full(robot.n, 0.3)
    _, J = value(robot, coordinates["direction"], q)
    _, N = value(robot, coordinates["posture"], q)
    np.testing.assert_allclose(J @ N, 0, atol=1e-5)
    np.testing.assert_allclose(N @ N, N, atol=1e-5)


def test_free_joints_say_all_about_the_posture_beneath():
    simulation = Simulation(scene.planar3())
    robot, direction = simulation.robot, Direction("direction", "tip")
    q, origin = np.array([0.4, -0.3, 0.8]), (0.1, 0.2, 0.3)
    views = {}
    for free in (robot.joints, robot.joints[:2]):
        posture = PostureBeneath("posture", robot.joints, direction, free, origin)
        assert posture.labels == tuple(f"{joint} [rad]" for joint in free)
        views[len(free)] = value(robot, posture, q)
    (y, N), (y_free, N_free) = views[3], views[2]
    np.testing.assert_allclose(y, N @ (q - origin))
    rest = np.linalg.lstsq(N_free, y_free)[0]
    np.testing.assert_allclose(rest, y, atol=1e-6)


def test_jacobians_stay_bounded_at_the_object_and_behind(arm):
    robot, coordinates = arm
    to = coordinates["to"]
    evaluate = to.bind(robot)
    robot.update_kinematics(np.full(robot.n, 0.3))
    R, p = robot.placement(robot.site(to.site))
    ahead, across = R[:, to.axes[0]], R[:, to.axes[1]]
    for offset in (0 * ahead, 1e-9 * across, -0.5 * ahead, -0.5 * ahead + 1e-9 * across):
        robot.objects["first"][0][:] = p + offset
        y, J = evaluate()
        assert np.isfinite(y).all()
        assert np.abs(J).max() < 10 * (1 + 1 / NEAR)
    np.testing.assert_allclose(np.linalg.norm(y), np.pi, atol=1e-6)


def test_directions_fade_smoothly_close_to_the_object(arm):
    robot, coordinates = arm
    q, to = np.full(robot.n, 0.3), coordinates["to"]
    robot.update_kinematics(q)
    p = robot.placement(robot.site(to.site))[1].copy()
    for offset in ((0.03, 0.04, 0.02), (-0.05, 0.01, 0.03)):
        robot.objects["first"][0][:] = p + offset
        _, J = value(robot, to, q)
        numeric = numeric_jacobian(lambda x: value(robot, to, x)[0].copy(), q)
        np.testing.assert_allclose(J, numeric, atol=1e-5)


def test_observation_sees_objects_where_they_were(arm):
    robot, coordinates = arm
    q = np.tile(np.full(robot.n, 0.2), (3, 1))
    positions = np.array([[0.3, 0.9, 0], [0.9, 0.3, 0], [0.3, 0.9, 0]])
    upright = np.tile(rotation.to_quaternion(np.eye(3)), (3, 1))
    y, J = coordinates["to"].observe(robot, q, {"first": (positions, upright)})
    assert J.shape == (3, y.shape[1], robot.n)
    np.testing.assert_array_equal(y[0], y[2])
    assert np.abs(y[0] - y[1]).max() > 0.1
