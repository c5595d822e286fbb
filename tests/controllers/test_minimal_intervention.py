"""Minimal intervention is the tutorial's product of projected Gaussians, made into impedance."""

import numpy as np
import pytest

from tpsim import Gaussian, impedance
from tpsim.control import projection
from tpsim.controllers.minimal_intervention import MinimalIntervention
from tpsim.controllers.product import Skill
from tpsim.errors import ArgumentError
from tpsim.learning.free_movement import free_share, relevance
from tpsim.learning.tp_gmm import TPGMM
from tpsim.tasks.cup_and_sugar import sugar
from tpsim.world.impedance import Drive, hand_stiffness

EFFORT = 0.3


@pytest.fixture
def robot(cup_world):
    return cup_world.robot


def skill(robot, names=tuple(sugar.VIEWS), seed=0, components=1):
    """A skill with random precisions about home."""
    rng = np.random.default_rng(seed)
    frames, views = [], {name: sugar.VIEWS[name] for name in names}
    for view in views.values():
        y = view(robot.at_home).value
        L = rng.standard_normal((components, y.size, y.size))
        covariance = 0.01 * (L @ np.swapaxes(L, -1, -2) + 0.5 * np.eye(y.size))
        mean = y + 0.02 * rng.standard_normal((components, y.size))
        frames.append(Gaussian(mean, covariance))
    return Skill(views, TPGMM(np.full(components, 1 / components), tuple(frames)))


@pytest.fixture
def state(robot):
    rng = np.random.default_rng(1)
    q = robot.home + 0.1 * rng.standard_normal(robot.n)
    return robot.at(q, 0.3 * rng.standard_normal(robot.n))


def command(state, skills, **settings):
    return MinimalIntervention(skills, **settings).command(state, 0.0)


def test_the_reference_and_gains_are_those_of_adapt_and_impedance(robot, state):
    taught = skill(robot)
    now = command(state, [taught], effort=EFFORT, friction=0.0)
    frames = []
    for view in taught.views.values():
        seen = view(state)
        frames.append(projection.absolute(seen.jacobian, state.q, seen.value))
    product = taught.model.adapt(frames).gaussians[0]
    np.testing.assert_allclose(now.reference, product.mean, atol=1e-7)
    K, D = impedance(product.precision, EFFORT * state.mass)
    np.testing.assert_allclose(now.stiffness, state.mass @ K, rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(now.damping, state.mass @ D, rtol=1e-6, atol=1e-5)


def test_the_torque_is_spring_damper_and_what_is_known(robot, state):
    now = command(state, [skill(robot)], effort=EFFORT)
    torque = Drive(robot, 1e-3).torque(now, state)
    spring = now.stiffness @ (now.reference - state.q) - now.damping @ state.dq
    known = state.bias + robot.damping * state.dq
    np.testing.assert_allclose(torque, spring + known, atol=1e-9)


def test_stiffness_is_a_spring(robot, state):
    now = command(state, [skill(robot)])
    for matrix in (now.stiffness, now.damping):
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-9 * np.abs(matrix).max())
        assert np.linalg.eigvalsh(matrix).min() > 0
    felt = hand_stiffness(state.jacobian("left_gripper"), now.stiffness)
    assert np.linalg.eigvalsh((felt + felt.T) / 2).min() > 0


def test_a_hand_feels_the_spring_on_it_while_all_else_is_free(robot, state):
    """K = J^T K_x J has no stiffness but at the hand, where it is K_x."""
    J = state.jacobian("left_gripper")
    root = np.random.default_rng(5).normal(size=(6, 6)) * [20, 20, 20, 3, 3, 3]
    spring = root.T @ root + np.diag([100.0, 100, 100, 5, 5, 5])
    felt = hand_stiffness(J, J.T @ spring @ J)
    np.testing.assert_allclose(felt, spring, rtol=1e-4, atol=1e-4 * spring.max())


def test_behaviours_taught_apart_are_multiplied(robot, state):
    """Precisions add, and information vectors add: the product of the controllers (Fig. 9)."""
    both = [skill(robot, seed=k) for k in (0, 1)]
    products = []
    for group in ([both[0]], [both[1]], both):
        now = command(state, group, effort=EFFORT)
        L = np.linalg.cholesky(state.mass)
        root = np.linalg.solve(L, np.linalg.solve(L, now.stiffness).T)
        precision = EFFORT * L @ root @ root @ L.T
        products.append((precision, precision @ (now.reference - state.q)))
    for k in (0, 1):
        total = products[0][k] + products[1][k]
        np.testing.assert_allclose(products[2][k], total, rtol=1e-6, atol=1e-6 * abs(total).max())


def test_what_matters_is_kept_in_motions_that_also_turn_what_is_free(robot, state):
    """The sugar's place matters, how it is turned does not, and was turned by 1 deg only.

    Modes of the arm that move its place turn the sugar by far more than that. They are no less
    precise for it: springs are those of the place alone, and what turns the sugar has none.
    """
    view = sugar.VIEWS["sugar from cup"]
    deviation = np.array([0.002] * 3 + [0.02] * 3)
    gaussian = Gaussian(view(robot.at_home).value[None], np.diag(deviation**2)[None])
    free = np.diag([0.05] * 3 + [0.02] * 3) ** 2
    known = relevance(gaussian, free, view.kinds(robot))
    taught = Skill({"above": view}, TPGMM(np.ones(1), (gaussian,), relevance=(known,)))
    prior = Gaussian(robot.home, np.diag(np.full(robot.n, 1e4)))
    now = command(state, [taught], bandwidth=1e3, effort=EFFORT, prior=prior)
    J = sugar.ABOVE.position(state).jacobian
    place = J.T @ J * (0.002**-2 - 0.05**-2)
    M = state.mass
    expected = M @ impedance(place + 1e-9 * M, EFFORT * M)[0]
    np.testing.assert_allclose(now.stiffness, expected, atol=2e-3 * np.abs(expected).max())
    # A mode by inertia seems free: it is not asked what of it is.
    L = np.linalg.cholesky(M)
    white = np.linalg.solve(L, np.linalg.solve(L, place).T)
    modes = np.linalg.solve(L.T, np.linalg.eigh(white)[1][:, -3:])
    turning = np.linalg.norm(view(state).jacobian[3:] @ modes, axis=0) / 0.02
    precision = (modes * (place @ modes)).sum(0)
    assert (free_share(precision, turning**2) > 0.5).any()


def same(one, other):
    np.testing.assert_allclose(one.stiffness, other.stiffness, atol=1e-6)
    np.testing.assert_allclose(one.reference, other.reference, atol=1e-8)


def test_one_component_twice_is_one_component(robot, state):
    one = skill(robot)
    frames = [
        Gaussian(np.repeat(f.mean, 2, 0), np.repeat(f.covariance, 2, 0)) for f in one.model.frames
    ]
    two = Skill(one.views, TPGMM(np.array([0.3, 0.7]), tuple(frames)))
    same(command(state, [one]), command(state, [two]))


def test_the_nearest_component_decides(robot, state):
    near = skill(robot, seed=3)
    frames = []
    for f in near.model.frames:
        mean = np.vstack([f.mean, f.mean + 3.0])
        frames.append(Gaussian(mean, np.repeat(f.covariance, 2, 0)))
    mixed = Skill(near.views, TPGMM(np.array([0.5, 0.5]), tuple(frames)))
    same(command(state, [near]), command(state, [mixed]))


def test_an_impedance_lasts_until_it_is_renewed(robot, state):
    controller = MinimalIntervention([skill(robot)], period=3e-3)
    commands = [controller.command(state, 1e-3 * k) for k in range(4)]
    assert commands[0] is commands[1] is commands[2]
    assert commands[3] is not commands[0]


def test_a_slow_loop_renews_its_impedance_as_often_in_time(robot, state):
    controller = MinimalIntervention([skill(robot)], period=0.016)
    commands = [controller.command(state, 0.01 * k) for k in range(5)]
    assert commands[0] is commands[1] and commands[2] is commands[3]
    assert commands[1] is not commands[2] and commands[3] is not commands[4]
    # A clock that starts over is another trial.
    assert controller.command(state, 0.0) is not commands[4]


def test_a_joint_that_no_frame_determines_is_named(robot, state):
    with pytest.raises(ArgumentError, match=r"no frame determines .*right_.*prior"):
        command(state, [skill(robot, ("cup in base", "left posture"))])


def test_bad_arguments_are_refused(robot, state):
    with pytest.raises(ArgumentError, match="no skill"):
        command(state, [])
    with pytest.raises(ArgumentError, match="effort"):
        MinimalIntervention([skill(robot)], effort=0.0)
    with pytest.raises(ArgumentError, match="1 views"):
        Skill({"cup": sugar.VIEWS["cup in base"]}, skill(robot).model)
