"""Scenes as they are compiled, with and without what is only seen."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim.errors import SimulationError
from tpsim.study.reference import load_study
from tpsim.tasks import STUDIES


@pytest.fixture(scope="module")
def world():
    return load_study("cup-and-sugar", STUDIES).task.stage


def test_what_is_only_seen_changes_no_bit(world):
    torque = world.robot.gravity_torque(world.robot.home)
    torque[3] += 1.0
    ends = []
    for visible in (True, False):
        simulation = world.simulation(visible=visible)
        simulation.reset(world.robot.home)
        for _ in range(200):
            simulation.step(torque)
        ends.append((simulation.model.ngeom, simulation.x))
    (more, seen), (fewer, unseen) = ends
    assert fewer < more
    np.testing.assert_array_equal(seen, unseen)
    assert np.abs(seen[: world.robot.n] - world.robot.home).max() > 1e-3


@pytest.mark.parametrize("visible", [True, False])
def test_a_scene_that_does_not_compile_says_so(world, visible):
    wrong = replace(world, xml="<mujoco><worldbody><geom/></worldbody></mujoco>")
    with pytest.raises(SimulationError, match=r"the scene does not compile: .*size"):
        wrong.simulation(visible=visible)
