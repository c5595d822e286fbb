"""Objects move along their paths, and recordings keep where they were."""

import numpy as np
import pytest

from tpsim import rotation
from tpsim.errors import ArgumentError
from tpsim.sim import scene
from tpsim.sim.controllers.controller import FixedImpedance
from tpsim.sim.objects import MovingObjects, ObjectPath
from tpsim.sim.rollout import rollout
from tpsim.sim.simulation import Simulation


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


def test_a_recording_keeps_where_all_objects_were():
    simulation = Simulation(scene.planar3())
    path = ObjectPath("first", ((0, 0.7, 0), (0.1, 0.7, 0)), (0.0, 1.0))
    controller = FixedImpedance(simulation.robot, simulation.home, 100.0)
    trial = rollout(simulation, controller, simulation.home, 0.5, sites={}, objects=[path])
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


def test_objects_that_the_scene_has_not_are_refused():
    with pytest.raises(ArgumentError, match="first"):
        MovingObjects([ObjectPath.at("puck", (0, 0, 0))], Simulation(scene.planar3()))
