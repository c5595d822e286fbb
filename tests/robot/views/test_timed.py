"""Views that change with time: Jacobian and drift by differences."""

from dataclasses import dataclass

import numpy as np
import pytest

from tpsim import rotation
from tpsim.pose import Pose
from tpsim.robot.views.sites import Object, Site
from tpsim.robot.views.timed import Handover, OnPath

H = 1e-6


@dataclass(frozen=True)
class Screw:
    """Turns about an axis and moves at even speed."""

    def __call__(self, state):
        v, w = np.array([0.1, -0.2, 0.05]), np.array([0.3, 0.5, -0.4])
        R = rotation.exp(w * state.time) @ rotation.exp([0.4, 0.1, -0.2])
        return Pose(R, np.array([0.5, 0.1, 0.2]) + v * state.time), np.concatenate([v, w])


@pytest.fixture
def robot(cup_world):
    return cup_world.robot


VIEWS = [
    OnPath("left_gripper", Screw()),
    Handover(Site("cup").pose, OnPath("left_gripper", Screw()), 1.0, 3.0),
    Handover(Site("cup").axis("z"), Site("sugar").axis("x"), 1.0, 3.0),
]


@pytest.mark.parametrize("view", VIEWS)
def test_jacobian_and_drift_are_those_of_differences(robot, view):
    rng = np.random.default_rng(0)
    q = robot.home + 0.1 * rng.standard_normal(robot.n)
    seen = view(robot.at(q, time=1.7))
    for k, step in enumerate(H * np.eye(robot.n)):
        ahead, behind = (view(robot.at(q + s, time=1.7)).value for s in (step, -step))
        np.testing.assert_allclose((ahead - behind) / (2 * H), seen.jacobian[:, k], atol=1e-6)
    ahead, behind = (view(robot.at(q, time=1.7 + s)).value for s in (H, -H))
    np.testing.assert_allclose((ahead - behind) / (2 * H), seen.drift, atol=1e-6)


def test_a_handover_begins_as_one_view_and_ends_as_the_other(robot):
    first, then = Site("cup").position, Site("sugar").position
    view = Handover(first, then, 1.0, 3.0)
    at = {time: view(robot.at(robot.home, time=time)).value for time in (0.5, 2.0, 3.5)}
    one, other = (part(robot.at_home).value for part in (first, then))
    np.testing.assert_array_equal(at[0.5], one)
    np.testing.assert_array_equal(at[3.5], other)
    np.testing.assert_allclose(at[2.0], (one + other) / 2)


def test_a_site_on_its_path_sees_zero_however_far_the_path_turns(robot):
    state = robot.at_home

    @dataclass(frozen=True)
    class Here:
        def __call__(self, now):
            return now.pose("cup"), np.zeros(6)

    np.testing.assert_allclose(OnPath("cup", Here())(state).value, 0, atol=1e-12)


def test_objects_carry_a_path_along(dock_world):
    """Of a path that an object carries the drift is what its motion does to the error."""
    robot = dock_world.robot

    @dataclass(frozen=True)
    class Carried:
        def __call__(self, state):
            R, p, v, w = state.objects["end"]
            return Pose(R, p), np.concatenate([v, w])

    view = OnPath("left_gripper", Carried())
    R, p = rotation.exp([0.2, -0.1, 0.3]), np.array([0.7, 0.1, 0.1])
    twist = np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.1])
    here = robot.at(robot.home, objects={"end": Pose(R, p)})
    moving = robot.at(robot.home, objects=here.objects.moving(twist[None]))
    there = robot.at(
        robot.home,
        objects={"end": Pose(rotation.exp(H * twist[3:]) @ R, p + H * twist[:3])},
    )
    rate = (view(there).value - view(here).value) / H
    np.testing.assert_allclose(view(moving).drift, rate, atol=1e-5)
    assert Object("end").name in moving.objects
