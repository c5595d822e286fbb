"""A movement retrieved from moving frames: the product and GMR of the library, as torque."""

import numpy as np
import pytest

from tpsim.control import projection
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import TPGMM
from tpsim.retrieval.gmr import gmr
from tpsim.sim import scene
from tpsim.sim.controllers.controller import Behaviour
from tpsim.sim.controllers.timed_intervention import TimedIntervention
from tpsim.sim.coordinates.direction import Direction, DirectionTo, PostureBeneath
from tpsim.sim.simulation import Simulation

EFFORT = 0.05


def spread(rng, K, d):
    root = 0.3 * rng.standard_normal((K, d, d))
    return root @ root.mT + 0.05 * np.eye(d)


@pytest.fixture
def bench():
    rng = np.random.default_rng(3)
    simulation = Simulation(scene.planar3())
    robot = simulation.robot
    direction = Direction("direction", "tip")
    coordinates = (
        PostureBeneath("posture", robot.joints, direction, robot.joints[:2], (0.0, 0.0, 0.0)),
        direction,
        DirectionTo("first", "tip", "first"),
        DirectionTo("second", "tip", "second"),
    )
    times = np.array([0.0, 1.0, 2.0])
    frames = []
    for d in (2, 1, 1, 1):
        mean = 0.5 * rng.standard_normal((3, 1 + d))
        mean[:, 0] = times
        frames.append(Gaussian(mean, spread(rng, 3, 1 + d)))
    model = TPGMM(np.array([0.2, 0.5, 0.3]), tuple(frames))
    simulation.reset(simulation.home)
    robot.update(simulation.q.copy(), np.array([0.2, -0.1, 0.3]))
    return simulation, Behaviour("pointing", coordinates, model)


def expected(simulation, behaviour, time):
    """The same Gaussian of the posture by TPGMM.adapt over Table 3 and gmr."""
    robot, frames = simulation.robot, []
    for coordinate in behaviour.coordinates:
        y, J = coordinate.bind(robot)()
        frames.append(projection.absolute(J, robot.q, y).with_input())
    return gmr(behaviour.model.adapt(frames), [time])


@pytest.mark.parametrize("time", [0.0, 0.7, 1.9, 3.0])
def test_the_torque_is_that_of_the_adapted_mixture(bench, time):
    simulation, behaviour = bench
    robot = simulation.robot
    simulation.data.time = time
    controller = TimedIntervention(simulation, behaviour, effort=EFFORT, until=2.5)
    robot.velocity_limit = np.full(robot.n, np.inf)
    torque = controller.feedback()
    goal = expected(simulation, behaviour, min(time, 2.5))
    np.testing.assert_allclose(controller.impedance().reference, goal.mean[0], atol=1e-4)
    # K solves K M^-1 K = Lambda / r, the optimum of the double integrator with inertia M.
    K, D = controller.impedance().stiffness, controller.impedance().damping
    inverse_mass = np.linalg.inv(robot.mass)
    precision = np.linalg.inv(goal.covariance[0])
    np.testing.assert_allclose(K @ inverse_mass @ K, precision / EFFORT, rtol=1e-4, atol=1e-3)
    np.testing.assert_allclose(D @ inverse_mass @ D, 2 * K, rtol=1e-6, atol=1e-8)
    spring = K @ (controller.impedance().reference - robot.q)
    np.testing.assert_allclose(torque, spring - D @ robot.dq, atol=1e-9)


def test_far_from_its_reference_the_arm_asks_for_no_more_speed_than_its_joints_have(bench):
    simulation, behaviour = bench
    robot = simulation.robot
    robot.velocity_limit = np.full(robot.n, 0.01)
    controller = TimedIntervention(simulation, behaviour, effort=1e-4, until=2.5)
    controller.feedback()
    now = controller.impedance()
    speed = np.linalg.solve(now.damping, now.stiffness @ (now.reference - robot.q))
    assert np.abs(speed).max() == pytest.approx(0.01, rel=1e-6)


def test_between_two_adaptations_the_spring_holds(bench):
    simulation, behaviour = bench
    controller = TimedIntervention(simulation, behaviour, effort=EFFORT, until=2.5, period=0.003)
    before = []
    for _ in range(4):
        controller.feedback()
        before.append(controller.impedance())
        simulation.objects["first"][0][0] += 0.1
    assert before[0] is before[1] is before[2]
    assert before[3] is not before[0]


def test_a_prior_decides_what_no_frame_sees(bench):
    simulation, behaviour = bench
    robot = simulation.robot
    only = Behaviour(
        "direction",
        behaviour.coordinates[1:2],
        TPGMM(behaviour.model.priors, behaviour.model.frames[1:2]),
    )
    prior = Gaussian(np.zeros(robot.n), np.eye(robot.n))
    controller = TimedIntervention(simulation, only, effort=EFFORT, until=2.5, prior=prior)
    controller.feedback()
    across = np.array([1.0, -1.0, 0.0])
    reference = controller.impedance().reference
    assert across @ reference == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("name", ["effort", "until", "period"])
def test_settings_without_sense_are_refused(bench, name):
    settings = {"effort": 1.0, "until": 1.0, "period": 0.01} | {name: 0.0}
    with pytest.raises(ArgumentError, match=name):
        TimedIntervention(*bench, **settings)
