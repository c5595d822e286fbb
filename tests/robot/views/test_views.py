"""Every view and composition: Jacobians against finite differences, on three robots."""

import numpy as np
import pytest

from tpsim import rotation
from tpsim.control import projection
from tpsim.control.planar import numeric_jacobian
from tpsim.errors import ArgumentError, SimulationError
from tpsim.pose import Pose
from tpsim.robot.robot import Robot
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.observe import observe
from tpsim.robot.views.sites import Object, Site

BOX = Object("box")


def views(hand, other):
    """Views without nullspaces, whose Jacobians are derivatives."""
    site, base = Site(hand), Site(other)
    turned = rotation.exp([0.2, -0.1, 0.3])
    return {
        "pose": site.pose,
        "position": site.position,
        "orientation": site.orientation,
        "orientation about": site.orientation.about(turned),
        "from site": site.seen_from(base).pose,
        "from object": site.seen_from(BOX).pose,
        "orientation from object": site.seen_from(BOX).orientation.about(turned),
        "axis": site.axis("z"),
        "one angle": site.axis("x", across="y"),
        "axis from vertical": site.axis("z", reference=np.eye(3)),
        "towards": site.axis("z").towards(BOX),
        "joints": Joints(),
        "part": site.seen_from(BOX).position[:2],
        "rows": site.pose[[0, 2, 5]],
        "offset": site.position.minus([0.1, 0.2, 0.3]),
        "offset of a part": site.seen_from(base).position[1].minus([0.1]),
    }


@pytest.fixture(scope="module")
def robots(cup_world, planar5_world, jaco_robot):
    return {
        "baxter": (cup_world.robot, "left_gripper", "sugar"),
        "planar": (planar5_world.robot, "left_hand", "right_hand"),
        "jaco": (jaco_robot, "hand/pinchsite", "wristsite"),
    }


def states(robot, count=3, spread=0.3, seed=1):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        box = Pose(rotation.exp(rng.standard_normal(3)), rng.uniform(0.3, 0.9, 3))
        yield robot.home + spread * rng.standard_normal(robot.n), {"box": box}


@pytest.mark.parametrize("which", ["baxter", "planar", "jaco"])
@pytest.mark.parametrize("name", list(views("", "")))
def test_jacobians_are_the_derivatives(robots, which, name):
    robot, hand, other = robots[which]
    view = views(hand, other)[name]
    for q, objects in states(robot):
        seen = view(robot.at(q, objects=objects))
        numeric = numeric_jacobian(lambda x, o=objects: view(robot.at(x, objects=o)).value, q)
        np.testing.assert_allclose(seen.jacobian, numeric, atol=2e-6)
        assert len(view.labels(robot)) == len(seen.value) == len(seen.drift)


@pytest.mark.parametrize("part", ["position", "orientation", "pose"])
def test_drift_is_what_a_moving_object_changes(cup_world, part):
    from tpsim.robot.objects import Objects

    robot, rng, h = cup_world.robot, np.random.default_rng(3), 1e-6
    view = getattr(Site("left_gripper").seen_from(BOX), part)
    pose = Pose(rotation.exp(rng.standard_normal(3)), np.array([0.6, 0.2, 0.1]))
    v, w = 0.3 * rng.standard_normal((2, 3))

    def at(t):
        moved = Pose(rotation.exp(t * w) @ pose.rotation, pose.position + t * v)
        twist = np.concatenate((v, w))[None]
        row = {"box": 0}
        return Objects(row, moved.position[None], moved.quaternion[None], twist)

    q = robot.home + 0.1
    drift = view(robot.at(q, objects=at(0.0))).drift
    ends = [view(robot.at(q, objects=at(t))).value for t in (-h, h)]
    np.testing.assert_allclose(drift, (ends[1] - ends[0]) / (2 * h), atol=1e-6)


def test_drift_of_a_bearing(cup_world):
    from tpsim.robot.objects import Objects

    robot, h, v = cup_world.robot, 1e-6, np.array([0.2, -0.3, 0.1])
    view, p = Site("left_gripper").axis("z").towards(BOX), np.array([0.9, 0.3, -0.1])

    def at(t):
        twist = np.concatenate((v, np.zeros(3)))[None]
        place, turned = (p + t * v)[None], np.array([[1.0, 0, 0, 0]])
        return robot.at(robot.home, objects=Objects({"box": 0}, place, turned, twist))

    numeric = (view(at(h)).value - view(at(-h)).value) / (2 * h)
    np.testing.assert_allclose(view(at(0.0)).drift, numeric, atol=1e-6)


def test_orientations_are_zero_at_home(cup_world):
    home = cup_world.robot.at_home
    for view in (Site("cup").pose, Site("sugar").pose, Site("sugar").seen_from(Site("cup")).pose):
        np.testing.assert_allclose(view(home).value[3:], 0, atol=1e-9)


def test_a_site_fixed_in_another_does_not_move_from_it(cup_world):
    view = Site("left_gripper").seen_from(Site("cup")).pose
    np.testing.assert_allclose(view(cup_world.robot.at_home).jacobian, 0, atol=1e-12)


def test_self_motion_is_the_nullspace_of_the_hand(cup_world):
    robot, rng = cup_world.robot, np.random.default_rng(2)
    view = Joints("left_.*").spare(Site("left_gripper").pose)
    state = robot.at(robot.home + 0.2 * rng.standard_normal(robot.n))
    n = view(state).jacobian[0, :7]
    J = state.jacobian("left_gripper")[:, :7]
    np.testing.assert_allclose(J @ n, 0, atol=1e-3)
    np.testing.assert_allclose(np.outer(n, n), projection.nullspace(J), atol=1e-3)


def test_self_motion_of_more_freedom_spans_the_nullspace(cup_world):
    robot = cup_world.robot
    view = Joints("left_.*").spare(Site("left_gripper").position)
    state = robot.at(robot.home + 0.1)
    B = view(state).jacobian[:, :7]
    J = state.jacobian("left_gripper")[:3, :7]
    assert B.shape == (4, 7)
    assert view.labels(robot) == tuple(f"nullspace {k} [rad]" for k in (1, 2, 3, 4))
    np.testing.assert_allclose(B @ B.T, np.eye(4), atol=1e-9)
    np.testing.assert_allclose(B.T @ B, projection.nullspace(J), atol=2e-3)


def test_an_arm_without_a_joint_to_spare_is_refused(jaco_robot):
    view = Joints().spare(Site("hand/pinchsite").pose)
    with pytest.raises(ArgumentError, match="no freedom"):
        view(jaco_robot.at_home)


def test_posture_beneath_is_equation_42(cup_world):
    robot = cup_world.robot
    state = robot.at(robot.home + 0.1)
    seen = Joints("left_.*").beneath(Site("left_gripper").position)(state)
    frame = projection.nullspace_joint(state.jacobian("left_gripper")[:3], state.q, damping=1e-2)
    np.testing.assert_array_equal(seen.value, state.q[:7])
    np.testing.assert_allclose(seen.jacobian, frame.A[:7], atol=2e-3)


def test_secondary_task_beneath_is_unseen_by_the_first(cup_world):
    robot = cup_world.robot
    first = Site("left_gripper").pose
    second = Site("left_elbow").position.beneath(first)
    state = robot.at(robot.home)
    np.testing.assert_allclose(first(state).jacobian @ second(state).jacobian.T, 0, atol=2e-3)


def test_joints_are_a_selection(cup_world):
    robot = cup_world.robot
    seen = Joints(("left_e1", "right_w2"))(robot.at_home)
    np.testing.assert_array_equal(seen.value, robot.home[[3, 13]])
    np.testing.assert_array_equal(seen.jacobian @ np.arange(14), [3, 13])
    with pytest.raises(ArgumentError, match=r"no joint matches 'leg'.*left_s0"):
        Joints("leg")(robot.at_home)


def test_a_site_or_object_that_is_not_there_is_named(cup_world):
    with pytest.raises(SimulationError, match=r"no site 'tool'.*left_gripper"):
        Site("tool").pose(cup_world.robot.at_home)
    with pytest.raises(SimulationError, match="no object 'box'"):
        Site("cup").seen_from(BOX).pose(cup_world.robot.at_home)


def test_observations_are_the_values_along_a_path(cup_world):
    robot = cup_world.robot
    q = np.linspace(robot.home, robot.home + 0.1, 4)
    box = (np.tile([0.5, 0.1, 0.0], (4, 1)), np.tile([1.0, 0, 0, 0], (4, 1)))
    pose, seen = observe(
        robot, [Site("cup").pose, Site("cup").seen_from(BOX).position], q, {"box": box}
    )
    assert pose.shape == (4, 6)
    np.testing.assert_allclose(seen, pose[:, :3] - [0.5, 0.1, 0.0], atol=1e-12)
    np.testing.assert_allclose(pose[2], Site("cup").pose(robot.at(q[2])).value, atol=1e-14)


@pytest.mark.parametrize("which", ["baxter", "planar", "jaco"])
def test_every_view_sees_along_a_movement_what_it_sees_at_its_instants(robots, which):
    robot, hand, other = robots[which]
    quaternions = {
        "quaternion": Site(hand).quaternion,
        "quaternion from object": Site(hand).seen_from(BOX).quaternion,
        "posture beneath": Joints().beneath(Site(hand).position),
    }
    known = views(hand, other) | quaternions
    moments = list(states(robot, count=5, spread=1.0))
    q = np.array([posture for posture, _ in moments])
    boxes = [objects["box"] for _, objects in moments]
    box = np.array([b.position for b in boxes]), np.array([b.quaternion for b in boxes])
    found = observe(robot, list(known.values()), q, {"box": box})
    for (name, view), values in zip(known.items(), found, strict=True):
        one = np.array([view(robot.at(posture, objects=o)).value for posture, o in moments])
        if "quaternion" in name:
            one *= np.sign(np.vecdot(one, values))[:, None]
        np.testing.assert_allclose(values, one, atol=1e-9, err_msg=name)


def test_what_is_not_there_is_named_along_a_movement_too(cup_world):
    robot = cup_world.robot
    with pytest.raises(SimulationError, match=r"no site 'tool'.*left_gripper"):
        observe(robot, [Site("tool").pose], robot.home[None])
    with pytest.raises(SimulationError, match="no object 'box'"):
        observe(robot, [Site("cup").seen_from(BOX).pose], robot.home[None])


def test_a_view_is_seen_once_at_a_state(cup_world):
    state = cup_world.robot.at(cup_world.robot.home)
    view = Site("cup").pose
    assert view(state) is view(state)
    assert Site("cup").pose == view


def test_units_that_people_read(cup_world):
    robot = cup_world.robot
    assert Site("cup").position.scale(robot, "mm") == 1e3
    assert Site("cup").orientation.scale(robot, "deg") == pytest.approx(180 / np.pi)
    with pytest.raises(ArgumentError, match="unit 'deg' does not fit"):
        Site("cup").position.scale(robot, "deg")


def test_states_do_not_change(cup_world):
    robot = cup_world.robot
    first = robot.at(robot.home)
    pose = first.pose("cup")
    kept = pose.position.copy(), first.bias.copy(), first.mass.copy()
    other = robot.at(robot.home + 0.3, np.ones(robot.n))
    other.pose("cup"), other.bias, other.mass, other.jacobian("sugar")
    for before, now in zip(kept, (first.pose("cup").position, first.bias, first.mass), strict=True):
        np.testing.assert_array_equal(before, now)
    fresh = Robot.of(robot.model, robot.description).at(robot.home)
    np.testing.assert_array_equal(first.jacobian("sugar"), fresh.jacobian("sugar"))
    with pytest.raises(ValueError, match="read-only"):
        first.q[0] = 1.0
