"""A movement retrieved from moving frames: the product and GMR of the library, as torque."""

from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from tpsim.control import projection
from tpsim.controllers.product import Skill
from tpsim.controllers.progress import PATIENCE
from tpsim.controllers.timed_intervention import FASTEST, PULL, STRENGTH, TimedIntervention
from tpsim.controllers.within_limits import nearest_within
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import TPGMM
from tpsim.pose import Pose
from tpsim.retrieval.tp_gmr import Order, tp_gmr
from tpsim.robot.objects import Objects
from tpsim.robot.robot import Robot
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Object, Site
from tpsim.world.guard import unguarded

EFFORT = 5.0  # so soft that no motor sets a limit
AXIS = Site("tip").axis("x", across="y", reference=np.eye(3))
OBJECTS = {
    "first": Pose(np.eye(3), np.array([-0.35, 0.6, 0.0])),
    "second": Pose(np.eye(3), np.array([0.35, 0.6, 0.0])),
}


def spread(rng, K, d):
    root = 0.3 * rng.standard_normal((K, d, d))
    return root @ root.mT + 0.05 * np.eye(d)


@pytest.fixture
def skill(planar3_world):
    rng = np.random.default_rng(3)
    free = planar3_world.robot.joints[:2]
    views = {
        "posture": Joints().spare(AXIS, origin=np.zeros(3), free=free, damping=1e-3),
        "direction": AXIS,
        "first": AXIS.towards(Object("first")),
        "second": AXIS.towards(Object("second")),
    }
    frames = []
    for d in (2, 1, 1, 1):
        mean = 0.5 * rng.standard_normal((3, 1 + d))
        mean[:, 0] = [0.0, 1.0, 2.0]
        frames.append(Gaussian(mean, spread(rng, 3, 1 + d)))
    return Skill(views, TPGMM(np.array([0.2, 0.5, 0.3]), tuple(frames)))


def with_speed(world, limit):
    robot = world.robot
    description = replace(robot.description, velocity_limit=(limit,) * robot.n)
    return Robot.of(robot.model, description)


def at(robot):
    return robot.at(robot.home, [0.2, -0.1, 0.3], OBJECTS)


def expected(state, skill, time, order):
    """The same Gaussian of the posture by tp_gmr over the frames of Table 3."""
    frames = []
    for view in skill.views.values():
        seen = view(state)
        frame = projection.absolute(seen.jacobian, state.q, seen.value)
        frames.append(frame)
    return tp_gmr(skill.model, frames, [time], order=order)


@pytest.mark.parametrize("order", get_args(Order))
@pytest.mark.parametrize("time", [0.0, 0.69, 1.89, 3.0])
def test_the_impedance_is_that_of_the_movement_in_the_order_named(
    planar3_world, skill, time, order
):
    state = at(with_speed(planar3_world, None))
    now = TimedIntervention(skill, effort=EFFORT, until=2.5, order=order).command(state, time)
    goal = expected(state, skill, min(time, 2.5), order)
    precision = np.linalg.inv(goal.covariance[0])
    root = np.linalg.cholesky(precision).T
    reached = nearest_within(goal.mean[0], root, *unguarded(state.robot))
    np.testing.assert_allclose(now.reference, reached, atol=1e-4)
    # K solves K M^-1 K = Lambda / r, the optimum of the double integrator with inertia M.
    K, D, inverse_mass = now.stiffness, now.damping, np.linalg.inv(state.mass)
    np.testing.assert_allclose(K @ inverse_mass @ K, precision / EFFORT, rtol=1e-4, atol=1e-3)
    np.testing.assert_allclose(D @ inverse_mass @ D, 2 * K, rtol=1e-6, atol=1e-8)


def test_precisions_are_pooled_unless_another_order_is_named(planar3_world, skill):
    state = at(with_speed(planar3_world, None))
    named = [
        TimedIntervention(skill, effort=EFFORT, until=2.5, **order).command(state, 0.7).stiffness
        for order in ({}, {"order": "pooled"}, {"order": "product"})
    ]
    np.testing.assert_array_equal(named[0], named[1])
    assert np.abs(named[2] - named[0]).max() > 0.1
    with pytest.raises(ArgumentError, match="order is 'first'"):
        TimedIntervention(skill, effort=EFFORT, until=2.5, order="first")


def test_far_from_its_reference_no_more_speed_is_asked_than_joints_have(planar3_world, skill):
    state = at(with_speed(planar3_world, 0.01))
    now = TimedIntervention(skill, effort=1e-4, until=2.5).command(state, 0.0)
    speed = np.linalg.solve(now.damping, now.stiffness @ (now.reference - state.q))
    assert np.abs(speed).max() == pytest.approx(0.01, rel=1e-6)


def test_springs_beyond_brakes_ask_for_no_more_than_their_share(planar3_world, skill):
    robot = with_speed(planar3_world, None)
    for speed in (0.0, 0.2):  # towards the goal, so that brakes relieve springs
        still = robot.at(robot.home, np.zeros(3), OBJECTS)
        law = TimedIntervention(skill, effort=1e-4, until=2.5)
        way = law.command(still, 0.0).reference - still.q
        state = robot.at(robot.home, speed * way, OBJECTS)
        now = TimedIntervention(skill, effort=1e-4, until=2.5).command(state, 0.0)
        lag = state.dq - now.velocity
        torque = now.stiffness @ (now.reference - state.q) - now.damping @ lag
        share = np.linalg.norm(torque / robot.torque_limit)
        assert share == pytest.approx(STRENGTH, rel=1e-6)


def moved(time, velocities):
    """Objects at a time, which move at even speed."""
    poses = [
        Pose(pose.rotation, pose.position + time * v)
        for pose, v in zip(OBJECTS.values(), velocities, strict=True)
    ]
    places = np.array([pose.position for pose in poses])
    turns = np.array([pose.quaternion for pose in poses])
    twists = np.hstack((velocities, np.zeros_like(velocities)))
    return Objects({name: row for row, name in enumerate(OBJECTS)}, places, turns, twists)


@pytest.mark.parametrize("order", get_args(Order))
def test_the_reference_moves_on_as_the_movement_does(planar3_world, skill, order):
    state = at(with_speed(planar3_world, None))
    settings = {"effort": EFFORT, "until": 2.5, "order": order}
    first, then = (TimedIntervention(skill, **settings).command(state, t) for t in (1.8, 1.83))
    np.testing.assert_allclose(
        first.velocity, (then.reference - first.reference) / 0.03, rtol=1e-6, atol=1e-9
    )
    ended = TimedIntervention(skill, **settings).command(state, 3.0)
    np.testing.assert_array_equal(ended.velocity, 0.0)


@pytest.mark.parametrize("order", get_args(Order))
def test_the_reference_moves_on_as_its_objects_do(planar3_world, skill, order):
    robot = with_speed(planar3_world, None)
    velocities = np.array([[0.05, -0.02, 0.0], [-0.03, 0.04, 0.0]])
    # An arm that is where all want it: how it is seen to differ matters no more.
    one = Gaussian(np.array([[0.0, 0.1]]), np.diag([1.0, 1e-4])[None])
    pointing = Skill({"first": skill.views["first"]}, TPGMM(np.ones(1), (one,)))
    q = robot.home

    def command(q, since, time=3.0):
        prior = Gaussian(rest, 25.0 * np.eye(robot.n))
        law = TimedIntervention(pointing, effort=EFFORT, until=2.5, order=order, prior=prior)
        return law.command(robot.at(q, objects=moved(since, velocities)), time)

    for _ in range(60):  # by short steps: no joint comes to its limit
        rest = q
        q = q + 0.3 * (command(q, 0.0).reference - q)
    rest = q
    for time in (3.0, 1.8):  # the claim is the same at all times
        now, h = command(q, 0.0, time), 1e-5
        drift = (command(q, h, time).reference - command(q, -h, time).reference) / (2 * h)
        np.testing.assert_allclose(now.velocity, drift, rtol=1e-3, atol=1e-6)
        assert np.abs(now.velocity).max() > 0.01


@pytest.mark.parametrize("limit", [0.01, None])
def test_the_reference_moves_no_faster_than_joints(planar3_world, skill, limit):
    robot = with_speed(planar3_world, limit)
    jump = moved(0.0, np.array([[15e3, 0.0, 0.0], [0.0, 0.0, 0.0]]))  # 15 m in a time step
    law = TimedIntervention(skill, effort=EFFORT, until=2.5)
    now = law.command(robot.at(robot.home, objects=jump), 0.3)
    assert np.abs(now.velocity).max() == pytest.approx(limit or FASTEST)


class At:
    """Progress at one place, at a rate."""

    def __init__(self, place, rate):
        self.place, self.rate = place, rate

    def at(self, state, time):
        """Where it is said to be."""
        return self.place, self.rate


def test_without_a_clock_the_reference_is_that_of_the_place_and_moves_on_at_its_rate(
    planar3_world, skill
):
    state, settings = at(with_speed(planar3_world, None)), {"effort": EFFORT, "until": 2.5}
    now = TimedIntervention(skill, **settings, progress=At(0.9, 0.5)).command(state, 7.0)
    clock = TimedIntervention(skill, **settings)
    by_clock = [clock.renew(state, t) for t in (0.9, 0.93)]
    np.testing.assert_allclose(now.reference, by_clock[0].reference, atol=1e-9)
    np.testing.assert_allclose(now.stiffness, by_clock[0].stiffness, rtol=1e-9)
    moved = by_clock[1].reference - by_clock[0].reference
    np.testing.assert_allclose(now.velocity, 0.5 * moved / 0.03, atol=1e-9)
    ended = TimedIntervention(skill, **settings, progress=At(2.5, 1.0)).command(state, 7.0)
    np.testing.assert_array_equal(ended.velocity, 0.0)


def test_where_progress_stands_still_springs_grow_weak(planar3_world, skill):
    state = at(with_speed(planar3_world, None))
    progress = At(0.9, 1.0)
    law = TimedIntervention(skill, effort=1e-4, until=2.5, progress=progress)

    def pull(time):
        now = law.renew(state, time)
        springs = now.stiffness @ (now.reference - state.q) / state.robot.torque_limit
        brakes = now.damping @ (state.dq - now.velocity) / state.robot.torque_limit
        return float(np.abs(springs).max()), np.linalg.norm(springs - brakes), now.damping

    _, going, damping = pull(0.0)
    progress.rate = 0.0
    held = [pull(t) for t in (0.5, 1.0, 5.0, 9.0)]
    assert going == pytest.approx(STRENGTH)
    assert [share for share, *_ in held[:2]] == pytest.approx(
        [PULL + (1 - PULL) * np.exp(-t / PATIENCE) for t in (0.5, 1.0)]
    )
    assert held[-1][0] == pytest.approx(PULL, rel=1e-2)
    np.testing.assert_array_equal(held[-1][2], damping)  # dampers keep their strength


def test_between_two_adaptations_the_spring_holds(planar3_world, skill):
    state = at(planar3_world.robot)
    controller = TimedIntervention(skill, effort=EFFORT, until=2.5, period=0.003)
    commands = [controller.command(state, 1e-3 * k) for k in range(4)]
    assert commands[0] is commands[1] is commands[2]
    assert commands[3] is not commands[0]


def test_a_prior_decides_what_no_frame_sees(planar3_world, skill):
    state = at(planar3_world.robot)
    model = TPGMM(skill.model.priors, skill.model.frames[1:2])
    prior = Gaussian(np.zeros(3), np.eye(3))
    only = TimedIntervention(
        Skill({"direction": AXIS}, model), effort=EFFORT, until=2.5, prior=prior
    )
    reference = only.command(state, 0.0).reference
    assert np.array([1.0, -1.0, 0.0]) @ reference == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("name", ["effort", "until", "period"])
def test_settings_without_sense_are_refused(skill, name):
    settings = {"effort": 1.0, "until": 1.0, "period": 0.01} | {name: 0.0}
    with pytest.raises(ArgumentError, match=name):
        TimedIntervention(skill, **settings)
