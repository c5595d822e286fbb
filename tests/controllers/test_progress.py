"""A hand that is held stops the movement, one that is pushed on hurries it; the clock does not."""

from functools import cache

import numpy as np
import pytest

from tpsim import Gaussian, RiemannianGaussian, SemiMarkovChain
from tpsim.controllers.finite_horizon import FiniteHorizon
from tpsim.controllers.progress import PATIENCE, AheadOfState, ByState, Patience
from tpsim.controllers.seen_poses import POSE
from tpsim.controllers.torque_cost import HELD
from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.robot.state import State
from tpsim.robot.views.view import Seen
from tpsim.timeline import rest_to_rest
from tpsim.world.people.guide import Grip
from tpsim.world.people.hold import Hold
from tpsim.world.people.push import Push
from tpsim.world.rollout import rollout

DOCK = Pose(np.eye(3), np.array([0.75, 0.0, 0.0]))
DT, STEPS, WAY = 0.03, 60, np.array([0.0, -0.15, 0.0])
CHAIN = SemiMarkovChain.along(np.repeat(np.arange(6), 10))


def controller(world, chain, **changed):
    """Move the left hand to the side within 1.8 s."""
    robot = world.robot
    R, p = robot.at_home.pose("left_gripper")
    share = rest_to_rest(np.linspace(0, 1, STEPS))[:, None]
    seen = [DOCK.inverse @ Pose(R, p + s * WAY) for s in share]
    mean = [np.append(one.position, one.quaternion) for one in seen]
    covariance = np.diag([0.01**2] * 3 + [0.05**2] * 3)
    return FiniteHorizon(
        robot,
        ["end"],
        [RiemannianGaussian(POSE, np.array(mean), covariance)],
        Gaussian(np.tile(robot.home[:7], (STEPS, 1)), 0.3 * np.eye(7)),
        joints=robot.joints[:7],
        site="left_gripper",
        dt=DT,
        effort=0.05,
        chain=chain,
    )


@pytest.fixture(scope="module")
def performed(dock_world):
    """Share of the way (T,), and the trial, with people who interfere; each once."""

    @cache
    def perform(by_state, *people, seconds=2.4):
        law = controller(dock_world, CHAIN if by_state else None)
        sites = {"left_hand": "left_gripper"}
        home = dock_world.robot.home
        trial = rollout(dock_world, law, home, seconds, sites=sites, people=people)
        moved = trial["left_hand_position"] - trial["left_hand_position"][0]
        return moved @ WAY / (WAY @ WAY), trial

    return perform


def test_by_itself_it_moves_as_by_the_clock(performed):
    share, _ = performed(True)
    by_clock, _ = performed(False)
    assert share[-1] == pytest.approx(1, abs=0.02)
    late = [np.argmax(way > 0.5) * 0.01 for way in (share, by_clock)]
    assert late[0] == pytest.approx(late[1], abs=0.15)


def test_held_it_waits_and_let_go_it_goes_on_without_a_jump(performed):
    hold = Hold("left_gripper", 0.9, 1.0)
    share, trial = performed(True, hold, seconds=3.4)
    by_clock, other = performed(False, hold, seconds=3.4)
    let_go = trial.time > 1.9
    assert share[-1] == pytest.approx(1, abs=0.02) and by_clock[-1] == pytest.approx(1, abs=0.02)
    # By the clock the hand is torn off, and much faster than it was ever asked to be.
    speeds = [np.diff(way[let_go]).max() / 0.01 for way in (share, by_clock)]
    usual = np.diff(performed(False)[0]).max() / 0.01
    assert speeds[0] < 1.3 * usual < speeds[1]
    # What was left of the movement is still left; the clock has none of it left.
    unheld = np.argmax(performed(True)[0] > 0.9)
    assert np.argmax(share > 0.9) - unheld == pytest.approx(100, abs=25)
    assert np.argmax(by_clock > 0.9) - 190 < 0.6 * (np.argmax(share > 0.9) - 190)
    rise = [np.abs(np.diff(t["torque"][187:200], axis=0)).sum(0).max() for t in (trial, other)]
    assert rise[0] < 0.75 * rise[1]


def test_springs_are_weak_where_a_movement_stands_still_before_its_end():
    springs = Patience(0.1, 0.3, end=2.0)
    assert springs.strength(1.0, 0.9, 1.0) == springs.strength(1.5, 1.0, 3.0) == pytest.approx(0.3)
    kept = np.exp(-0.5 / PATIENCE)
    assert springs.strength(2.0, 1.0, 0.0) == pytest.approx(0.1 + 0.2 * kept)
    assert springs.strength(9.0, 1.0, 0.0) == pytest.approx(0.1)
    assert springs.going == pytest.approx(0.0, abs=1e-6)
    assert springs.strength(15.0, 1.95, 0.0) == pytest.approx(0.3)
    assert springs.going == pytest.approx(1.0, abs=1e-4)


def test_who_holds_the_hand_winds_no_spring_up(performed, dock_world):
    limit = dock_world.robot.torque_limit
    _, trial = performed(True, Hold("left_gripper", 0.9, 1.5), seconds=2.8)
    torque, let_go = trial["torque"], np.searchsorted(trial.time, 2.4 + 1e-9)
    jump = np.abs(torque[let_go : let_go + 10] - torque[let_go - 1]) / limit
    assert jump.max() < (1 + np.exp(-1) / 2) * HELD


@pytest.mark.parametrize("wound", [0.5, 1.0, 1.5, 3.0, 30.0])
def test_let_go_a_bounded_spring_changes_by_a_fifth_more_than_its_bound(wound):
    """The worst is a spring that is no longer bounded where brakes have just caught up with it."""
    omega, h, changed = 20.0, 1e-4, 0.0
    left, speed = wound / omega**2, 0.0
    for _ in range(30000):
        acceleration = min(omega**2 * left, 1.0) - 2 * omega * speed
        changed = max(changed, min(wound, 1.0) - acceleration)
        speed += h * acceleration
        left -= h * speed
    assert changed < 1 + np.exp(-1) / 2 + 1e-3
    if wound > 10:
        assert changed == pytest.approx(1 + np.exp(-1) / 2, abs=2e-3)
    if wound <= 1:
        assert changed == pytest.approx((1 + np.exp(-2)) * wound, abs=2e-3)


def test_pushed_on_it_hurries(performed):
    push = Push("left_gripper", tuple(12 * WAY / np.linalg.norm(WAY)), 0.6, 0.8)
    share, _ = performed(True, push)
    alone, _ = performed(True)
    assert np.argmax(alone > 0.9) - np.argmax(share > 0.9) > 15  # by 0.15 s and more
    assert share[-1] == pytest.approx(1, abs=0.02)


def test_progress_is_led_on_from_one_observation_to_the_next_without_a_jump(dock_world):
    places = Gaussian(
        np.linspace([0.0] * 6, [0.3] * 6, STEPS), np.tile(1e-4 * np.eye(6), (60, 1, 1))
    )
    progress, speed = ByState(CHAIN, DT), np.full(6, 0.3 / (STEPS * DT))
    progress.follow(lambda state: Seen(state.time * speed, np.zeros((6, 14)), speed), places)
    times, home = np.arange(0, 1.2, 0.008), dock_world.robot.home
    states = [State(dock_world.robot, np.append(home, 0 * home), time=t) for t in times]
    found = np.array([progress.at(state, state.time)[0] for state in states])
    np.testing.assert_allclose(found, times, atol=0.06)
    assert np.abs(np.diff(found)).max() < 2 * 0.008


def let_go(dock_world, told):
    """Angle [rad] of a hand held for 1 s, then laid where its springs are at rest, over 1.5 s."""
    speed, omega, h, eye = 0.7, 40.0, 0.004, np.eye(6)
    turning = speed * eye[5]
    places = Gaussian(DT * np.arange(STEPS)[:, None] * turning, np.tile(1e-4 * eye, (STEPS, 1, 1)))
    progress, y, dy = AheadOfState(CHAIN, DT, 75.0), 0.9 * turning, 0 * turning
    progress.follow(lambda state: Seen(y, np.zeros((6, 14)), dy), places)
    state, found = dock_world.robot.at(dock_world.robot.home), []
    for k in range(round(2.5 / h)):
        asked, _ = progress.at(state, k * h)
        late, slow = asked * turning - y, turning - dy
        if told:
            progress.draw(np.array([turning, late, slow]), omega**2 * eye, 2 * omega * eye, eye)
        if k == round(1.0 / h):
            assert (
                y[5] / speed + 0.02 < asked < y[5] / speed + 0.07
            )  # held, it is asked for no more
            y = asked * turning + 2 / omega * turning
        if k >= round(1.0 / h):
            dy = dy + h * (omega**2 * late + 2 * omega * slow)
            y = y + h * dy
        found.append(y[5])
    return np.array(found[-round(1.5 / h) :])


def test_a_hand_that_does_what_is_asked_of_it_is_not_taken_for_one_that_is_held(dock_world):
    # By what it does alone nobody can tell: hardly anything is asked of it.
    moved = [
        angle[125] - angle[0] for angle in (let_go(dock_world, told) for told in (False, True))
    ]
    assert moved[0] < 0.15 * 0.7 * 0.5 < 0.8 * 0.7 * 0.5 < moved[1]


def test_stays_must_add_up_to_the_movement(dock_world):
    with pytest.raises(ArgumentError, match="add up to 50 steps and the movement has 60"):
        controller(dock_world, SemiMarkovChain.along([0] * 25 + [1] * 25))


def test_a_hold_needs_time_and_keeps_within_its_strength(performed):
    weak = Hold("left_gripper", 0.3, 0.5, Grip(3000.0, 150.0, 0.0, 0.0, 5.0))
    _, trial = performed(True, weak)
    force = np.linalg.norm(trial["hold_wrench"][:, :3], axis=1)
    assert force.max() <= 5 + 1e-9
    assert not force[(trial.time < 0.3) | (trial.time > 0.81)].any()
    with pytest.raises(ArgumentError, match="duration"):
        Hold("left_gripper", 0.3, 0.0)
