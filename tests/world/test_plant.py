"""The plant where it differs from the model: what was asked for is what is simulated."""

import mujoco
import numpy as np
import pytest

from tpsim.controllers.renewed import FixedImpedance
from tpsim.errors import ArgumentError
from tpsim.world.plant import NOMINAL, Plant, Sensors
from tpsim.world.rollout import rollout


def hold(world, plant, seconds=1.0):
    home = world.robot.home
    return rollout(world, FixedImpedance(home, 200.0), home, seconds, plant=plant)


def test_the_nominal_plant_is_the_model(cup_world):
    assert NOMINAL.model(cup_world.model, cup_world.robot) is cup_world.model
    assert Plant(latency=0.001).is_nominal


def test_payload_adds_mass_at_the_hands_alone(cup_world):
    model = Plant(payload=0.3).model(cup_world.model, cup_world.robot)
    added = model.body_mass - cup_world.model.body_mass
    np.testing.assert_allclose(sorted(added)[-2:], [0.3, 0.3])
    assert added.sum() == pytest.approx(0.6)
    # Gravity of a point mass at the hand: J^T m g, exactly.
    loads = []
    for m in (cup_world.model, model):
        data = mujoco.MjData(m)
        data.qpos[cup_world.robot.simulated.qpos] = cup_world.robot.home
        mujoco.mj_forward(m, data)
        loads.append(data.qfrc_bias[cup_world.robot.simulated.dof].copy())
    weight = np.array([0, 0, 0.3 * 9.81, 0, 0, 0])
    hands = cup_world.robot.hands.values()
    expected = sum(cup_world.robot.at_home.jacobian(site).T @ weight for site in hands)
    np.testing.assert_allclose(loads[1] - loads[0], expected, atol=1e-9)


def test_masses_are_drawn_from_the_seed_within_their_range(cup_world):
    one, two, other = (
        Plant(mass=0.05, seed=seed).model(cup_world.model, cup_world.robot).body_mass
        for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(one, two)
    assert (one != other).any()
    heavy = cup_world.model.body_mass > 0
    ratio = one[heavy] / cup_world.model.body_mass[heavy]
    assert 0.95 <= ratio.min() < ratio.max() <= 1.05


def test_a_wrong_mass_makes_the_arm_sag_as_its_stiffness_says(cup_world):
    robot = cup_world.robot
    trial = hold(cup_world, Plant(payload=0.3), 3.0)
    weight = np.array([0, 0, -0.3 * 9.81, 0, 0, 0])
    load = sum(robot.at_home.jacobian(site).T @ weight for site in robot.hands.values())
    sag = np.linalg.solve(200.0 * robot.at_home.mass, load)
    np.testing.assert_allclose(trial["q"][-1] - robot.home, sag, atol=0.1 * np.abs(sag).max())


def test_latency_delays_the_torque_by_as_many_steps(planar3_world):
    home = planar3_world.robot.home

    class Step:
        def command(self, state, time):
            return np.full(3, 0.1) if time >= 0.01 else np.zeros(3)

    moved = []
    for latency in (0.0, 0.02):
        trial = rollout(planar3_world, Step(), home, 0.2, plant=Plant(latency=latency))
        moved.append(trial["q"])
    np.testing.assert_allclose(moved[1][2:], moved[0][:-2], atol=1e-12)


def test_control_at_a_lower_rate_holds_its_torque(planar3_world):
    calls = []

    class Count:
        def command(self, state, time):
            calls.append(time)
            return np.zeros(3)

    rollout(planar3_world, Count(), planar3_world.robot.home, 0.1, plant=Plant(control_period=0.01))
    np.testing.assert_allclose(calls, 0.01 * np.arange(10), atol=1e-9)


def test_encoders_have_steps_and_velocities_follow():
    sensors, h = Sensors(Plant(encoder_bits=14, velocity_cutoff=40.0), 1e-3), 1e-3
    for k in range(400):
        x = sensors.measure(np.array([0.5 * h * k, 0.5]))
    step = 2 * np.pi / 2**14
    assert x[0] / step == pytest.approx(round(x[0] / step))
    assert abs(x[0] - 0.5 * h * 399) <= step / 2 + 1e-12
    assert x[1] == pytest.approx(0.5, abs=0.06)


@pytest.mark.parametrize(
    "fields",
    [{"mass": 1.0}, {"payload": -1}, {"friction": np.nan}, {"encoder_bits": 2}, {"latency": -1}],
)
def test_plants_that_make_no_sense_are_refused(fields):
    with pytest.raises(ArgumentError, match="plant"):
        Plant(**fields)


def test_a_plant_that_cannot_hold_itself_is_refused(cup_world):
    with pytest.raises(ArgumentError, match=r"cannot hold itself up.*joint .* lacks"):
        Plant(payload=20.0).model(cup_world.model, cup_world.robot)
