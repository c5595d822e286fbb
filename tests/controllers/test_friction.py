"""Friction where nothing is stiff: the same in all directions, and once for what moves together."""

import numpy as np
import pytest

from tpsim import Gaussian
from tpsim.controllers.friction import felt_mass
from tpsim.controllers.minimal_intervention import MinimalIntervention
from tpsim.controllers.optimal import bandwidth_for
from tpsim.controllers.product import Skill
from tpsim.errors import ArgumentError
from tpsim.learning.free_movement import relevance
from tpsim.learning.tp_gmm import TPGMM
from tpsim.tasks.cup_and_sugar import cup, sugar

FRICTION = 150.0


@pytest.fixture
def robot(cup_world):
    return cup_world.robot


def skill(robot, precise):
    """All candidate frames of the sugar, precise in some rows of some of them, else free."""
    views, frames, found = dict(sugar.VIEWS), [], []
    for name, view in views.items():
        y = view(robot.at_home).value
        deviation = np.full(y.size, 0.1)
        deviation[precise.get(name, [])] = 0.001
        gaussian = Gaussian(y[None], np.diag(deviation**2)[None])
        frames.append(gaussian)
        found.append(relevance(gaussian, 0.01 * np.eye(y.size), view.kinds(robot)))
    return Skill(views, TPGMM(np.ones(1), tuple(frames), relevance=tuple(found)))


def flow(command, state, site, force):
    """Velocity (3,) of a site that is pushed steadily where nothing is stiff."""
    values, V = np.linalg.eigh(
        np.linalg.solve(
            L := np.linalg.cholesky(state.mass), np.linalg.solve(L, command.stiffness).T
        )
    )
    free = np.linalg.solve(L.T, V[:, values < 1.0])
    J = state.jacobian(site)[:3]
    speed = np.linalg.solve(free.T @ command.damping @ free, free.T @ J.T @ force)
    return J @ free @ speed


def test_a_free_hand_is_as_hard_to_lead_in_all_directions(robot):
    controller = MinimalIntervention([skill(robot, {})], friction=FRICTION)
    state = robot.at_home
    command = controller.command(state, 0.0)
    # The right hand is free as well, and has its own.
    for site in ("left_gripper", "right_gripper"):
        for direction in np.eye(3):
            speed = flow(command, state, site, 20 * direction)
            np.testing.assert_allclose(speed, 20 / FRICTION * direction, atol=0.15 * 20 / FRICTION)


def test_hands_that_move_together_are_slowed_once(robot):
    together = {"sugar from cup": [0, 1, 2], "cup in base": [3, 4]}
    controller = MinimalIntervention([skill(robot, together)], friction=FRICTION)
    state = robot.at_home
    command = controller.command(state, 0.0)
    for direction in np.eye(3):
        speed = flow(command, state, "left_gripper", 20 * direction)
        assert direction @ speed == pytest.approx(20 / FRICTION, rel=0.3)
        other = flow(command, state, "right_gripper", 20 * direction)
        assert direction @ other == pytest.approx(20 / FRICTION, rel=0.3)


def test_where_nothing_matters_there_is_no_spring(robot):
    controller = MinimalIntervention([skill(robot, {"cup in base": [3, 4]})], friction=FRICTION)
    rng = np.random.default_rng(0)
    state = robot.at(robot.home + 0.05 * rng.standard_normal(robot.n))
    command = controller.command(state, 0.0)
    pull = command.stiffness @ (command.reference - state.q)
    J = cup.LEVEL(state).jacobian
    # All torque is that of the tilt: it lies in the rows of its Jacobian.
    residual = pull - J.T @ np.linalg.lstsq(J.T, pull, rcond=None)[0]
    assert np.linalg.norm(residual) < 0.02 * np.linalg.norm(pull)


def test_damping_never_pushes(robot):
    controller = MinimalIntervention([skill(robot, {"sugar from cup": [0, 1, 2]})])
    rng = np.random.default_rng(1)
    for _ in range(5):
        state = robot.at(robot.home + 0.2 * rng.standard_normal(robot.n))
        D = controller.renew(state, 0.0).damping
        np.testing.assert_allclose(D, D.T, atol=1e-8 * np.abs(D).max())
        assert np.linalg.eigvalsh(D)[0] > 0


def fastest(controller, state):
    """Natural frequency [Hz] of the fastest direction."""
    K = controller.command(state, 0.0).stiffness
    L = np.linalg.cholesky(state.mass)
    modes = np.linalg.eigvalsh(np.linalg.solve(L, np.linalg.solve(L, K).T))
    return np.sqrt(modes[-1]) / (2 * np.pi)


def test_no_direction_is_faster_than_the_bandwidth(robot):
    precise, state = skill(robot, {"sugar from cup": [0, 1, 2]}), robot.at_home
    for bandwidth in (4.0, 8.0):
        controller = MinimalIntervention([precise], bandwidth=bandwidth)
        assert fastest(controller, state) == pytest.approx(bandwidth, rel=1e-3)


def test_by_default_a_usual_deviation_is_worth_what_springs_may_pull(robot):
    """K_z = Lambda_z^1/2 / r^1/2 with r the mean of M_ii / (0.3 limit_i)^2."""
    usual = np.mean(np.diag(robot.at_home.mass) / (0.3 * robot.torque_limit) ** 2)
    precise, settings = skill(robot, {"sugar from cup": [0, 1, 2]}), {"bandwidth": 1e3}
    own, told = (
        fastest(MinimalIntervention([precise], effort=effort, **settings), robot.at_home)
        for effort in (None, usual)
    )
    assert own == pytest.approx(told, rel=1e-12) and own > bandwidth_for()


def test_the_default_bandwidth_keeps_half_the_delay_margin():
    """Unit mass, K = w^2, D = sqrt(2) w: the delay that makes it unstable is twice 5 ms."""
    w = 2 * np.pi * bandwidth_for(0.005)
    s = 1j * np.geomspace(0.1 * w, 10 * w, 200_000)
    loop = (np.sqrt(2) * w * s + w**2) / s**2
    crossing = np.argmin(np.abs(np.abs(loop) - 1))
    margin = (np.pi + np.angle(loop[crossing])) / s[crossing].imag
    assert margin == pytest.approx(0.010, rel=1e-3)


def test_friction_is_not_negative():
    with pytest.raises(ArgumentError, match="friction"):
        MinimalIntervention([], friction=-1.0)


def test_a_hand_without_mass_is_refused(planar3_world, monkeypatch):
    monkeypatch.setattr("tpsim.controllers.friction.felt", lambda state, site: (0.0, 0.0))
    with pytest.raises(ArgumentError, match="0 kg at the hands; give the robot inertia"):
        felt_mass(planar3_world.robot.at_home)
