"""Roll-outs: pushes are felt, limits hold, what goes wrong is recorded, and nothing is random."""

import numpy as np
import pytest

from tpsim.controllers.renewed import FixedImpedance
from tpsim.errors import ArgumentError, SimulationError
from tpsim.world.people.push import Push
from tpsim.world.rollout import rollout
from tpsim.world.tank import UNLIMITED
from tpsim.world.weightless import Weightless

SITES = {"left_hand": "left_gripper"}


@pytest.fixture
def world(cup_world):
    return cup_world


def held(world, stiffness=100.0):
    return FixedImpedance(world.robot.home, stiffness)


def test_an_unpushed_arm_stays_where_it_is_held(world):
    trial = rollout(world, held(world), world.robot.home, 0.3, sites=SITES)
    np.testing.assert_allclose(trial["q"], np.tile(world.robot.home, (30, 1)), atol=1e-9)
    assert trial.outcome == "done"
    assert trial["saturated_steps"][-1] == 0


def test_a_push_at_a_site_is_the_same_as_at_its_body(world):
    model = world.model
    site = model.site("left_gripper")
    body = model.body(model.site_bodyid[site.id]).name
    force = (0.0, 8.0, -5.0)
    pushes = [
        Push("left_gripper", force, start=0.05, duration=0.2),
        Push(body, force, start=0.05, duration=0.2, point=tuple(site.pos)),
    ]
    trials = [
        rollout(world, held(world), world.robot.home, 0.3, sites=SITES, people=[push])
        for push in pushes
    ]
    np.testing.assert_allclose(trials[0]["q"], trials[1]["q"], atol=1e-12)
    assert np.abs(trials[0]["q"] - world.robot.home).max() > 1e-3
    np.testing.assert_allclose(trials[0]["push_wrench"][15, :3], force)


def test_two_pushes_add_up_in_the_recording(world):
    pushes = [
        Push("left_gripper", (4.0, 0, 0), start=0.0, duration=0.3),
        Push("left_gripper", (0, 3.0, 0), start=0.1, duration=0.1),
    ]
    trial = rollout(world, held(world), world.robot.home, 0.3, sites=SITES, people=pushes)
    np.testing.assert_allclose(trial["push_wrench"][15, :3], (4, 3, 0), atol=1e-12)
    np.testing.assert_allclose(trial["push_wrench"][24, :3], (4, 0, 0), atol=1e-12)


def test_the_same_trial_twice_is_the_same_bits(world):
    push = Push("right_elbow", (15.0, 0, 0), start=0.1, duration=0.1)
    trials = [
        rollout(world, held(world), world.robot.home, 0.3, sites=SITES, people=[push])
        for _ in range(2)
    ]
    for name, signal in trials[0].arrays.items():
        assert np.array_equal(signal, trials[1][name]), name


def test_weightless_arms_float(world):
    controller = Weightless(world.robot)
    trial = rollout(world, controller, world.robot.home, 0.3, sites=SITES)
    np.testing.assert_allclose(trial["q"][-1], world.robot.home, atol=1e-9)


def test_torques_keep_to_the_motors_limits_and_saturation_is_counted(world):
    far = world.robot.home + 0.8
    controller = FixedImpedance(far, 3000.0)
    trial = rollout(world, controller, world.robot.home, 0.1, sites=SITES, tank=UNLIMITED)
    assert (np.abs(trial["torque"]) <= world.robot.torque_limit + 1e-12).all()
    assert trial["saturated_steps"][-1] > 0


def test_joint_limits_hold(world):
    robot = world.robot
    beyond = world.robot.home.copy()
    beyond[3] = robot.upper[3] + 0.5
    controller = FixedImpedance(beyond, 60.0)
    trial = rollout(world, controller, world.robot.home, 2.0, sites=SITES)
    assert trial["q"][:, 3].max() < robot.upper[3] + 1e-3


def test_a_controller_that_goes_wild_is_an_outcome_with_finite_signals(world):
    class Wild:
        def command(self, state, time):
            return 400 * state.dq + 5.0

    trial = rollout(world, Wild(), world.robot.home, 2.0, sites=SITES)
    assert trial.outcome in ("diverged", "contact")
    assert all(np.isfinite(signal).all() for signal in trial.arrays.values())


@pytest.mark.parametrize("duration", [0.0, -1.0, np.nan])
def test_durations_must_be_positive(world, duration):
    with pytest.raises(ArgumentError, match="duration"):
        rollout(world, held(world), world.robot.home, duration, sites=SITES)


def test_start_postures_are_checked(world):
    with pytest.raises(SimulationError, match="outside the limits of"):
        world.simulation().reset(world.robot.home + 5)
    with pytest.raises(SimulationError, match=r"14 finite numbers|row 0 of 14"):
        world.simulation().reset(np.full(14, np.nan))


def test_names_that_do_not_exist_are_answered_with_those_that_do(world):
    push = Push("left_knee", (1.0, 0, 0))
    with pytest.raises(SimulationError, match=r"left_knee.*left_gripper"):
        rollout(world, held(world), world.robot.home, 0.1, sites=SITES, people=[push])


@pytest.mark.parametrize(
    "fields", [{"force": (1, 2)}, {"force": (np.nan, 0, 0)}, {"duration": -1.0}, {"start": -0.1}]
)
def test_bad_pushes_are_refused(fields):
    with pytest.raises(ArgumentError, match="push"):
        Push(**({"body": "torso", "force": (1.0, 0.0, 0.0)} | fields))
