"""Cartesian impedances: the hands' physical stiffness, within limits, that still does the task."""

import numpy as np
import pinocchio as pin
import pytest

from tpsim.deploy.cartesian import CartesianLimits, HandFilter
from tpsim.deploy.policy import Policy
from tpsim.errors import ArgumentError
from tpsim.task.task import draw_situation
from tpsim.task.verbs import perform
from tpsim.world.impedance import Impedance, hand_stiffness
from tpsim.world.people.push import Push

OPEN = CartesianLimits(*[(1e9, 1e9)] * 5)
"""Limits that do not bind."""


def impedance(robot, seed=0, scale=1.0):
    """A random impedance of the joints about home."""
    rng = np.random.default_rng(seed)
    A, B = rng.normal(size=(2, robot.n, robot.n))
    K, D = scale * (50 * A @ A.T + 20 * np.eye(robot.n)), B @ B.T + np.eye(robot.n)
    return Impedance(K, D, robot.home + 0.01 * rng.normal(size=robot.n))


@pytest.fixture
def robot(cup_world):
    return cup_world.robot


def after_a_while(hands, now, state, seconds=2.0, period=1e-3):
    for _ in range(round(seconds / period)):
        found = hands.follow(now, state, 0.0, period)
    return found


def test_the_stiffness_is_that_of_the_hand(robot):
    """One hand alone; and each of two, while the other is held."""
    now, state = impedance(robot), robot.at(robot.home)
    J = np.concatenate([state.jacobian(site) for site in robot.hands.values()])
    together = HandFilter(robot.hands, OPEN).follow(now, state, 0.0, 1.0)
    for h, (hand, site) in enumerate(robot.hands.items()):
        rows = slice(6 * h, 6 * h + 6)
        alone = HandFilter({hand: site}, OPEN).follow(now, state, 0.0, 1.0)[hand]
        for name, joints in (("stiffness", now.stiffness), ("damping", now.damping)):
            both = np.linalg.inv(J @ np.linalg.solve(joints, J.T))[rows, rows]
            own = hand_stiffness(J[rows], joints)
            for found, wanted in ((together[hand], both), (alone, own)):
                mine = getattr(found, name)
                np.testing.assert_allclose(mine, wanted, rtol=1e-6, atol=1e-8 * wanted.max())
                np.testing.assert_array_equal(mine, mine.T)


def test_one_hand_is_drawn_to_where_its_joints_go(robot):
    """To first order, the target is the pose of the reference posture."""
    (hand, site), *_ = robot.hands.items()
    now, state = impedance(robot), robot.at(robot.home)
    target = HandFilter({hand: site}, OPEN).follow(now, state, 0.0, 1.0)[hand].target
    R, p = robot.at(now.reference).pose(site)
    np.testing.assert_allclose(target.position, p, atol=1e-3)
    assert np.linalg.norm(pin.log3(target.rotation @ R.T)) < 1e-3
    assert np.linalg.norm(p - state.pose(site).position) > 5e-3


def test_all_hands_together_make_the_wrench_of_the_joints(robot):
    """Seen at the hands, K (q_hat - q) - D dq relaxed over all else, coupling included."""
    now = impedance(robot)
    dq = 0.05 * np.random.default_rng(3).normal(size=robot.n)
    state = robot.at(robot.home, dq)
    found = HandFilter(robot.hands, OPEN).follow(now, state, 0.0, 1.0)
    J = np.concatenate([state.jacobian(site) for site in robot.hands.values()])
    for joints, change, part in (
        (now.stiffness, now.reference - state.q, "spring"),
        (now.damping, -dq, "damper"),
    ):
        wanted = np.linalg.solve(J @ np.linalg.solve(joints, J.T), J @ change)
        made = []
        for hand, site in robot.hands.items():
            each, (R, p) = found[hand], state.pose(site)
            turn = pin.log3(each.target.rotation @ R.T)
            error = np.concatenate((each.target.position - p, turn))
            lag = each.twist - state.jacobian(site) @ dq
            made.append(each.stiffness @ error if part == "spring" else each.damping @ lag)
        np.testing.assert_allclose(np.concatenate(made), wanted, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("scale", [1.0, 100.0])
def test_limits_and_rates_hold(robot, scale):
    limits = CartesianLimits((500.0, 20.0), (40.0, 2.0), (1000.0, 40.0), (80.0, 4.0), (10.0, 1.0))
    hands, state = HandFilter(robot.hands, limits), robot.at(robot.home)
    before = {hand: np.zeros((2, 6, 6)) for hand in robot.hands}
    for step in range(600):
        now = impedance(robot, seed=step // 200, scale=scale)
        for hand, each in hands.follow(now, state, 0.0, 1e-3).items():
            gains = np.array([each.stiffness, each.damping])
            change = (gains - before[hand]) / 1e-3
            most = np.array([limits.stiffness, limits.damping])
            fastest = np.array([limits.stiffness_rate, limits.damping_rate])
            for part, rows in enumerate((slice(0, 3), slice(3, 6))):
                sizes = np.linalg.eigvalsh(gains[:, rows, rows])
                assert (sizes.max(-1) <= most[:, part] * (1 + 1e-9)).all()
                rates = np.abs(np.linalg.eigvalsh(change[:, rows, rows])).max(-1)
                assert (rates <= fastest[:, part] * (1 + 1e-6)).all()
            assert np.linalg.eigvalsh(gains).min() > -1e-9 * most.max()
            R, p = state.pose(robot.hands[hand])
            error = np.append(each.target.position - p, pin.log3(each.target.rotation @ R.T))
            pull = each.stiffness @ error
            assert np.linalg.norm(pull[:3]) <= 10 * (1 + 1e-9)
            assert np.linalg.norm(pull[3:]) <= 1 + 1e-9
            before[hand] = gains
    assert np.linalg.eigvalsh(before["left_hand"][0]).max() > (250 if scale > 1 else 20)


def test_without_stiffness_nothing_pulls(robot):
    nothing = np.zeros((robot.n, robot.n))
    now = Impedance(nothing, nothing, robot.home)
    for each in HandFilter(robot.hands, OPEN).follow(now, robot.at_home, 0.0, 1.0).values():
        assert not each.stiffness.any() and not each.damping.any()


def test_a_planar_arm_is_soft_where_it_cannot_move(planar3_world):
    robot = planar3_world.robot
    q = robot.home + np.array([0.2, 0.5, -0.4])
    found = HandFilter(robot.hands, OPEN).follow(impedance(robot), robot.at(q), 0.0, 1.0)
    for each in found.values():
        np.testing.assert_allclose(each.stiffness[2:5], 0.0, atol=1e-6)
        assert np.linalg.eigvalsh(each.stiffness)[3:].min() > 1.0


class CartesianControl:
    """What runs on a real arm: J^T of a spring and a damper, and a brake in the nullspace."""

    def __init__(self, policy, brake=4.0):
        self.policy, self.brake = policy, brake

    def command(self, state, time):
        robot = self.policy.robot
        found = self.policy.cartesian(state.q, state.dq, state.objects, time)
        J = np.concatenate([state.jacobian(robot.hands[hand]) for hand in found])
        wrench = []
        for hand, each in found.items():
            R, p = state.pose(robot.hands[hand])
            error = np.append(each.target.position - p, pin.log3(each.target.rotation @ R.T))
            lag = each.twist - state.twist(robot.hands[hand])
            wrench.append(each.stiffness @ error + each.damping @ lag)
        back = np.linalg.solve(state.mass, J.T)
        rest = -self.brake * (state.dq - back @ np.linalg.solve(J @ back, J @ state.dq))
        known = state.bias + robot.damping * state.dq
        return known + J.T @ np.concatenate(wrench) + state.mass @ rest


def test_a_cartesian_controller_keeps_the_task(learned, folder_of):
    """Cup level and sugar above it while the cup is pushed: the cup as well as by joint torques.

    Separate arms carry the sugar along only as fast as their targets are renewed and within their
    limits: several times farther from its place than by joint torques, and within its goal.
    """
    task, models = learned("MinimalIntervention")
    situation = draw_situation(task, 0, 0)
    control = CartesianControl(Policy.load(folder_of("MinimalIntervention")))
    people = (Push("left_gripper", (0.0, 20.0, 0.0), 0.8, 0.8),)
    errors = {}
    for name, controller in (("joints", None), ("hands", control)):
        trial = perform(task, models, situation, controller=controller, people=people, duration=1.8)
        assert trial.outcome == "done"
        states = [task.stage.robot.at(q) for q in trial["q"][80::5]]
        for goal, wanted in task.goals().items():
            seen = [np.linalg.norm(wanted.view(state).value) for state in states]
            errors[name, goal] = np.sqrt(np.mean(np.square(seen)))
    assert errors["hands", "cup"] < 1.2 * errors["joints", "cup"]
    assert errors["hands", "sugar"] < 0.6 * task.goals()["sugar"].within
    assert errors["joints", "cup"] > np.radians(0.2)


@pytest.mark.parametrize("given", [(0.0, 1.0), (1.0,), (-1.0, 1.0)])
def test_limits_are_positive_pairs(given):
    with pytest.raises(ArgumentError, match=r"pull.* give (2|a finite, positive number)"):
        CartesianLimits(pull=given)
