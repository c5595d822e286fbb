"""Objects move along their paths, and recordings keep where they were."""

import numpy as np
import pytest

from tpsim import rotation
from tpsim.controllers.renewed import FixedImpedance
from tpsim.errors import ArgumentError
from tpsim.world.object_path import BLOCK, MovingObjects, ObjectPath
from tpsim.world.rollout import rollout


def test_between_two_times_an_object_moves_straight_and_turns_evenly():
    half = tuple(rotation.to_quaternion(rotation.exp([0, 0, 1.0])))
    path = ObjectPath("puck", ((0, 1, 0), (2, 1, 0)), (1.0, 3.0), ((1, 0, 0, 0), half))
    position, quaternion = path.poses([0.0, 1.5, 9.0])
    np.testing.assert_allclose(position, [[0, 1, 0], [0.5, 1, 0], [2, 1, 0]], atol=1e-12)
    turned = rotation.log(rotation.from_quaternion(quaternion))[:, 2]
    np.testing.assert_allclose(turned, [0.0, 0.25, 1.0], atol=1e-12)


def test_two_equal_times_are_a_jump():
    path = ObjectPath("puck", ((0, 0, 0), (0, 0, 0), (1, 0, 0)), (0.0, 1.0, 1.0))
    np.testing.assert_array_equal(path.poses([0.999, 1.0])[0][:, 0], [0, 1])


def test_a_recording_keeps_where_all_objects_were(planar3_world):
    world, home = planar3_world, planar3_world.robot.home
    path = ObjectPath("first", ((0, 0.7, 0), (0.1, 0.7, 0)), (0.0, 1.0))
    controller = FixedImpedance(home, 100.0)
    trial = rollout(world, controller, home, 0.5, sites={}, objects=[path])
    expected = path.poses(trial["time"])[0]
    np.testing.assert_allclose(trial["first_position"], expected, atol=1e-12)
    assert trial["second_quaternion"].shape == (len(trial["time"]), 4)
    assert np.ptp(trial["second_position"], axis=0).max() == 0


@pytest.mark.parametrize(
    "arguments",
    [
        (((0, 0, 0),), (0.0, 1.0)),
        (((0, 0, 0), (1, 0, 0)), (1.0, 0.0)),
        (((0, 0, np.nan),), (0.0,)),
        (((0, 0, 0),), (0.0,), ((0, 0, 0, 0),)),
    ],
)
def test_paths_that_make_no_sense_are_refused(arguments):
    with pytest.raises(ArgumentError, match="puck"):
        ObjectPath("puck", *arguments)


def test_objects_that_the_scene_has_not_are_refused(planar3_world):
    with pytest.raises(ArgumentError, match="first"):
        MovingObjects([ObjectPath.at("puck", (0, 0, 0))], planar3_world.simulation())


def test_velocities_are_the_derivatives_of_the_path(planar3_world):
    half = tuple(rotation.to_quaternion(rotation.exp([0, 0, 1.0])))
    path = ObjectPath("first", ((0, 1, 0), (0.2, 1, 0)), (0.1, 0.5), ((1, 0, 0, 0), half))
    objects = MovingObjects([path], planar3_world.simulation())
    objects.act(300)
    moving = objects.now["first"]
    np.testing.assert_allclose(moving.velocity, [0.5, 0, 0], atol=1e-9)
    np.testing.assert_allclose(moving.angular_velocity, [0, 0, 2.5], atol=1e-5)
    objects.act(50)
    assert not objects.now["first"].velocity.any()


def test_a_jump_is_no_velocity_and_the_end_of_a_path_is_rest(planar3_world):
    jump = ObjectPath("first", ((0, 1, 0), (0, 1, 0), (0.2, 1, 0)), (0.0, 0.1, 0.1))
    objects = MovingObjects([jump], planar3_world.simulation())
    for step in range(200):
        objects.act(step)
        assert not objects.now["first"].velocity.any()
    np.testing.assert_allclose(objects.now["first"].position, [0.2, 1, 0])


def test_blocks_of_a_path_are_the_path_itself(planar3_world):
    end = (2 * BLOCK + 100) * planar3_world.timestep
    half = tuple(rotation.to_quaternion(rotation.exp([0, 0, 1.0])))
    path = ObjectPath("first", ((0, 1, 0), (0.3, 1, 0)), (0.0, end), ((1, 0, 0, 0), half))
    objects, steps = MovingObjects([path], planar3_world.simulation()), 2 * BLOCK + 110
    expected = path.poses(planar3_world.timestep * np.arange(steps))
    for step in range(steps):
        objects.act(step)
        now = objects.now["first"]
        np.testing.assert_allclose(now.position, expected[0][step], atol=1e-15)
        turned = rotation.from_quaternion(expected[1][step])
        np.testing.assert_allclose(now.rotation, turned, atol=1e-15)
        speed = 0.3 / end if 0 < step <= end / planar3_world.timestep else 0.0
        np.testing.assert_allclose(now.velocity, [speed, 0, 0], atol=1e-9)
