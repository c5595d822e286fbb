"""Controllers that experts set by hand: what is felt is what was set, and priorities hold."""

import numpy as np
import pytest

from tpsim.controllers.cartesian import CartesianImpedance, Spring
from tpsim.controllers.computed_torque import ComputedTorque, InverseKinematics, Motion
from tpsim.controllers.operational_space import Aim, OperationalSpace
from tpsim.errors import ArgumentError
from tpsim.robot.views.sites import Site
from tpsim.tasks.cup_and_sugar import cup, sugar
from tpsim.world.impedance import Drive
from tpsim.world.rollout import rollout

HAND, LEVEL, ABOVE = cup.CUP.position, cup.LEVEL, sugar.ABOVE.position


@pytest.fixture
def robot(cup_world):
    return cup_world.robot


@pytest.fixture
def state(robot):
    rng = np.random.default_rng(1)
    q = robot.home + 0.02 * rng.standard_normal(robot.n)
    return robot.at(q, 0.05 * rng.standard_normal(robot.n))


def springs(state, offset=0.002):
    """Springs of the hand, of its tilt, and between the hands, near their references."""
    return [
        Spring(HAND, [400.0, 300.0, 500.0], HAND(state).value + offset),
        Spring(LEVEL, np.array([[60.0, 10.0], [10.0, 80.0]]), LEVEL(state).value),
        Spring(ABOVE, 3000.0, ABOVE(state).value - offset),
    ]


def aims(state, **offsets):
    """Level first, then the sugar's place, then the hand; away from their references."""
    off = {"level": 0.01, "above": 0.004, "hand": 0.003} | offsets
    return [
        Aim(LEVEL, 400.0, LEVEL(state).value + off["level"], 0.7),
        Aim(ABOVE, [200.0, 300.0, 400.0], ABOVE(state).value + off["above"]),
        Aim(HAND, 100.0, HAND(state).value + off["hand"], 1.2),
    ]


def acceleration(controller, state):
    """Joint acceleration (n,) that a command makes, without what is known of the dynamics."""
    torque = Drive(state.robot, 1e-3).torque(controller.command(state, 0.0), state)
    return np.linalg.solve(state.mass, torque - state.bias - state.robot.damping * state.dq)


def test_what_a_push_meets_is_the_stiffness_that_was_set(robot, state):
    """(J K^-1 J^T)^-1 of the stacked views: nothing of the posture beneath is felt."""
    posture = robot.home + 0.01
    now = CartesianImpedance(springs(state), posture, posture_stiffness=1.0).command(state, 0.0)
    J = np.concatenate([spring.view(state).jacobian for spring in springs(state)])
    felt = np.linalg.inv(J @ np.linalg.solve(now.stiffness, J.T))
    wanted = np.zeros((8, 8))
    for spring, rows in zip(springs(state), (slice(0, 3), slice(3, 5), slice(5, 8)), strict=True):
        wanted[rows, rows] = spring.matrix(rows.stop - rows.start)
    np.testing.assert_allclose(felt, wanted, atol=1e-6 * 3000)


def test_the_posture_beneath_moves_no_view(robot, state):
    """Two postures far apart differ by joint accelerations that no spring feels."""
    J = np.concatenate([spring.view(state).jacobian for spring in springs(state)])
    both = [
        acceleration(
            CartesianImpedance(springs(state), robot.home + d, posture_stiffness=1.0), state
        )
        for d in (0.0, 0.05)
    ]
    assert np.abs(both[1] - both[0]).max() > 0.02
    np.testing.assert_allclose(J @ (both[1] - both[0]), 0, atol=1e-9)


@pytest.mark.parametrize("ratio", [0.4, 1.0])
def test_every_mode_is_damped_by_the_ratio(robot, state, ratio):
    now = CartesianImpedance(springs(state), robot.home, damping=ratio).command(state, 0.0)
    n, M = robot.n, state.mass
    top = np.hstack([np.zeros((n, n)), np.eye(n)])
    A = np.vstack([top, -np.linalg.solve(M, np.hstack([now.stiffness, now.damping]))])
    poles = np.linalg.eigvals(A)
    # The real part over the modulus; a double pole at ratio 1 is known to the root of rounding.
    np.testing.assert_allclose(-poles.real / np.abs(poles), ratio, atol=1e-5)
    for matrix in (now.stiffness, now.damping):
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-9 * np.abs(matrix).max())


def test_the_energy_of_springs_and_motion_only_falls(planar3_world):
    """Led 3 cm off and let go, the arm settles; springs on all of its freedom."""
    robot = planar3_world.robot
    tip = Site("tip")
    view = [tip.position[:2], tip.axis("x", across="y")]
    away = robot.at(robot.home + np.array([0.05, -0.04, 0.03]))
    found = [
        Spring(one, k, one(robot.at_home).value) for one, k in zip(view, (200.0, 8.0), strict=True)
    ]
    given = {"damping": 0.3, "posture_stiffness": 0.1, "period": 1e-3}
    controller = CartesianImpedance(found, robot.home, **given)
    trial = rollout(planar3_world, controller, away.q, 1.5)
    energy = []
    for q, dq in zip(trial["q"], trial["dq"], strict=True):
        now = robot.at(q, dq)
        stored = sum(
            0.5 * spring.stiffness * np.sum((one(now).value - spring.reference) ** 2)
            for one, spring in zip(view, found, strict=True)
        )
        energy.append(stored + 0.5 * dq @ now.mass @ dq)
    assert energy[-1] < 1e-2 * energy[0]
    assert np.diff(energy).max() < 1e-3 * energy[0]


def test_the_first_aim_gets_the_acceleration_that_it_asks_for(robot, state):
    first = aims(state)[0]
    ddq = acceleration(OperationalSpace(aims(state), robot.home + 0.1), state)
    J = LEVEL(state).jacobian
    kp, kd = 400.0, 2 * 0.7 * 20.0
    wanted = kp * (first.reference - LEVEL(state).value) - kd * J @ state.dq
    np.testing.assert_allclose(J @ ddq, wanted, rtol=1e-6, atol=1e-8)


def test_no_aim_moves_one_that_comes_before(robot, state):
    one = acceleration(OperationalSpace(aims(state), robot.home), state)
    other = acceleration(OperationalSpace(aims(state, hand=-0.01), robot.home + 0.1), state)
    J = np.concatenate([LEVEL(state).jacobian, ABOVE(state).jacobian])
    assert np.abs(HAND(state).jacobian @ (other - one)).max() > 0.5
    np.testing.assert_allclose(J @ (other - one), 0, atol=1e-8)


def test_an_aim_has_the_poles_of_a_damped_unit_mass(robot, state):
    """The closed loop about a state: s^2 + kd s + kp for every dimension and for the posture."""
    still = robot.at(state.q)
    controller = OperationalSpace(aims(still), robot.home, posture_gain=9.0, damping=0.5)
    now = controller.command(still, 0.0)
    n = robot.n
    top = np.hstack([np.zeros((n, n)), np.eye(n)])
    gains = np.linalg.solve(still.mass, np.hstack([now.stiffness, now.damping]))
    found = np.poly(np.linalg.eigvals(np.vstack([top, -gains])))
    wanted = np.ones(1)
    pairs = [(400.0, 0.7)] * 2 + [(k, 1.0) for k in (200.0, 300.0, 400.0)] + [(100.0, 1.2)] * 3
    for kp, ratio in pairs + [(9.0, 0.5)] * (n - 8):
        wanted = np.convolve(wanted, [1, 2 * ratio * kp**0.5, kp])
    np.testing.assert_allclose(found, wanted, rtol=1e-6)


def test_computed_torque_makes_the_joints_a_servo(robot, state):
    rng = np.random.default_rng(2)
    motion = Motion(state.q + 0.002, 0.01 * rng.standard_normal(14), rng.standard_normal(14))
    controller = ComputedTorque(lambda now: motion, 50.0, damping=0.8)
    kd = 2 * 0.8 * 50**0.5
    wanted = motion.acceleration + 50 * 0.002 + kd * (motion.velocity - state.dq)
    np.testing.assert_allclose(acceleration(controller, state), wanted, rtol=1e-6, atol=1e-8)


def test_inverse_kinematics_brings_views_to_their_references(robot):
    start = robot.at_home
    wanted = HAND(start).value + np.array([0.03, -0.02, 0.01])
    goals = [Aim(LEVEL, 100.0), Aim(HAND, 100.0, wanted)]
    way = InverseKinematics(goals, robot.home, robot.home, posture_gain=1.0)
    motions = [way(robot.at(robot.home, time=0.005 * k)) for k in range(400)]
    end = robot.at(motions[-1].posture)
    np.testing.assert_allclose(HAND(end).value, wanted, atol=1e-4)
    np.testing.assert_allclose(LEVEL(end).value, 0, atol=1e-4)
    q, dq = (np.array([getattr(m, part) for m in motions]) for part in ("posture", "velocity"))
    np.testing.assert_allclose(np.diff(q, axis=0) / 0.005, dq[1:], atol=1e-9)


def test_a_moving_reference_is_kept_up_with(robot):
    """A reference at even speed: the joints' reference has the speed that keeps up with it."""
    speed = np.array([0.05, -0.02, 0.03])
    place = HAND(robot.at_home).value
    following = [
        CartesianImpedance([Spring(HAND, 500.0, lambda t: (place, speed))], robot.home),
        OperationalSpace([Aim(HAND, 100.0, lambda t: (place, speed))], robot.home),
    ]
    for controller in following:
        velocity = controller.command(robot.at_home, 0.0).velocity
        np.testing.assert_allclose(HAND(robot.at_home).jacobian @ velocity, speed, atol=1e-8)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda home: CartesianImpedance([], home), "no spring"),
        (lambda home: CartesianImpedance([Spring(HAND, 10.0)], home, damping=0.0), "damping is 0"),
        (lambda home: OperationalSpace([], home), "no aim"),
        (lambda home: Aim(HAND, -1.0), "gain is -1"),
        (lambda home: ComputedTorque(home, float("nan")), "gain is nan"),
        (lambda home: InverseKinematics([], home, home), "no aim"),
    ],
)
def test_settings_without_sense_are_refused(robot, make, words):
    with pytest.raises(ArgumentError, match=words):
        make(robot.home)


@pytest.mark.parametrize(
    ("spring", "words"),
    [
        (Spring(HAND, [1.0, 2.0]), r"stiffness has shape \(2,\) for a view of 3"),
        (Spring(HAND, -np.eye(3)), "negative eigenvalues"),
        (Spring(HAND, np.triu(np.ones((3, 3)))), "symmetric"),
        (Spring(HAND, 1.0, [0.0, 0.0]), "a reference of shape"),
    ],
)
def test_springs_that_do_not_fit_their_view_are_refused(robot, spring, words):
    with pytest.raises(ArgumentError, match=words):
        CartesianImpedance([spring], robot.home).command(robot.at_home, 0.0)
