"""The 1 kHz controller is the tutorial's product of projected Gaussians, made into impedance."""

import numpy as np
import pytest

from tpsim import Gaussian, impedance
from tpsim.control import projection
from tpsim.errors import ArgumentError
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim import scene
from tpsim.sim.controllers.controller import Behaviour, hand_stiffness
from tpsim.sim.controllers.minimal_intervention import MinimalIntervention
from tpsim.sim.simulation import Simulation
from tpsim.tasks.bimanual import Hands

NAMES = ("cup in base", "sugar in base", "sugar from cup", "left posture", "right posture")
EFFORT = 0.3


@pytest.fixture(scope="module")
def simulation():
    return Simulation(scene.cup_and_sugar())


def behaviour(simulation, names, seed=0, components=1, name="b"):
    """A behaviour with random precisions about home."""
    rng = np.random.default_rng(seed)
    robot, frames = simulation.robot, []
    coordinates = tuple(Hands(simulation).coordinates()[n] for n in names)
    for coordinate in coordinates:
        y = coordinate.observe(robot, simulation.home[None])[0][0]
        L = rng.standard_normal((components, y.size, y.size))
        covariance = 0.01 * (L @ np.swapaxes(L, -1, -2) + 0.5 * np.eye(y.size))
        mean = y + 0.02 * rng.standard_normal((components, y.size))
        frames.append(Gaussian(mean, covariance))
    priors = np.full(components, 1 / components)
    return Behaviour(name, coordinates, TPGMM(priors, tuple(frames)))


def command(simulation, controller, q, dq):
    simulation.robot.update(q, dq)
    return controller.feedback(), controller.impedance()


def state(simulation, seed=1):
    rng = np.random.default_rng(seed)
    n = simulation.robot.n
    return simulation.home + 0.1 * rng.standard_normal(n), 0.3 * rng.standard_normal(n)


def test_the_reference_and_gains_are_those_of_adapt_and_impedance(simulation):
    robot, taught = simulation.robot, behaviour(simulation, NAMES)
    q, dq = state(simulation)
    feedback, now = command(simulation, MinimalIntervention(robot, [taught], effort=EFFORT), q, dq)
    frames, bound = [], [coordinate.bind(robot) for coordinate in taught.coordinates]
    robot.update(q, dq)
    for evaluate in bound:
        y, J = evaluate()
        frames.append(projection.absolute(J, q, y))
    product = taught.model.adapt(frames).gaussians[0]
    np.testing.assert_allclose(now.reference, product.mean, atol=1e-7)
    K, D = impedance(product.precision, EFFORT * robot.mass)
    np.testing.assert_allclose(now.stiffness, robot.mass @ K, rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(now.damping, robot.mass @ D, rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(
        feedback, now.stiffness @ (product.mean - q) - now.damping @ dq, atol=1e-5
    )


def test_stiffness_is_a_spring(simulation):
    controller = MinimalIntervention(simulation.robot, [behaviour(simulation, NAMES)])
    _, now = command(simulation, controller, *state(simulation))
    for matrix in (now.stiffness, now.damping):
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-9 * np.abs(matrix).max())
        assert np.linalg.eigvalsh(matrix).min() > 0
    robot = simulation.robot
    felt = hand_stiffness(robot.jacobian(robot.site("left_gripper")), now.stiffness)
    assert np.linalg.eigvalsh((felt + felt.T) / 2).min() > 0


def test_behaviours_taught_apart_are_multiplied(simulation):
    """Precisions add, and information vectors add: the product of the controllers (Fig. 9)."""
    robot = simulation.robot
    both = [behaviour(simulation, NAMES, seed=k, name=str(k)) for k in (0, 1)]
    q, dq = state(simulation)
    products = []
    for group in ([both[0]], [both[1]], both):
        _, now = command(simulation, MinimalIntervention(robot, group, effort=EFFORT), q, dq)
        L = np.linalg.cholesky(robot.mass)
        root = np.linalg.solve(L, np.linalg.solve(L, now.stiffness).T)
        precision = EFFORT * L @ root @ root @ L.T
        products.append((precision, precision @ (now.reference - q)))
    for k in (0, 1):
        total = products[0][k] + products[1][k]
        np.testing.assert_allclose(products[2][k], total, rtol=1e-6, atol=1e-6 * abs(total).max())


def test_one_component_twice_is_one_component(simulation):
    robot, one = simulation.robot, behaviour(simulation, NAMES)
    frames = [
        Gaussian(np.repeat(f.mean, 2, 0), np.repeat(f.covariance, 2, 0)) for f in one.model.frames
    ]
    two = Behaviour("two", one.coordinates, TPGMM(np.array([0.3, 0.7]), tuple(frames)))
    torques = [
        command(simulation, MinimalIntervention(robot, [b]), *state(simulation))[0]
        for b in (one, two)
    ]
    np.testing.assert_allclose(*torques, atol=1e-6)


def test_the_nearest_component_decides(simulation):
    robot = simulation.robot
    far = behaviour(simulation, NAMES, seed=3)
    frames = []
    for f in far.model.frames:
        mean = np.vstack([f.mean, f.mean + 3.0])
        frames.append(Gaussian(mean, np.repeat(f.covariance, 2, 0)))
    mixed = Behaviour("mixed", far.coordinates, TPGMM(np.array([0.5, 0.5]), tuple(frames)))
    torques = [
        command(simulation, MinimalIntervention(robot, [b]), *state(simulation))[0]
        for b in (far, mixed)
    ]
    np.testing.assert_allclose(*torques, atol=1e-6)


def test_a_joint_that_no_frame_determines_is_named(simulation):
    controller = MinimalIntervention(
        simulation.robot, [behaviour(simulation, ("cup in base", "left posture"))]
    )
    with pytest.raises(ArgumentError, match=r"no frame determines .*right_.*prior"):
        command(simulation, controller, *state(simulation))


def test_bad_arguments_are_refused(simulation):
    with pytest.raises(ArgumentError, match="no behaviour"):
        MinimalIntervention(simulation.robot, [])
    with pytest.raises(ArgumentError, match="effort"):
        MinimalIntervention(simulation.robot, [behaviour(simulation, NAMES)], effort=0.0)
