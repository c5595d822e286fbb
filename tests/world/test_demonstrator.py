"""A human demonstrator: spectrum, steadiness, delay and stability as they are stated."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import welch

from tpsim.catalogue.ours import planar3
from tpsim.errors import ArgumentError, SimulationError
from tpsim.pose import Pose
from tpsim.world.people.care import EVERYTHING, Care
from tpsim.world.people.demonstrator import FIRM, HUMAN, Demonstrator
from tpsim.world.people.guide import Grip, Guide, HandPath
from tpsim.world.people.script import Variation, wandering
from tpsim.world.people.sight import Correction, Sight, Watched, foreseen
from tpsim.world.rehearsal import Rehearsed, hindrance
from tpsim.world.teaching import Lesson, demonstrate
from tpsim.world.world import World

H = 1e-3


def strayed(variation, care=None, seconds=200, speed=0.0, seed=0):
    twist = np.zeros((round(seconds / H), 6))
    twist[:, [0, 5]] = speed
    return wandering(twist, H, np.random.default_rng(seed), variation, care)


def test_a_hand_wanders_and_trembles_as_much_as_is_stated():
    moved, turned = strayed(replace(HUMAN.variation, drift_time=0.1))
    np.testing.assert_allclose(moved.std(), HUMAN.variation.drift, rtol=0.1)
    np.testing.assert_allclose(turned.std(), HUMAN.variation.angular_drift, rtol=0.1)
    still = replace(HUMAN.variation, drift=0, angular_drift=0)
    np.testing.assert_allclose(strayed(still, seconds=20)[0].std(), still.tremor, rtol=0.05)


def test_drift_is_slow_and_tremor_between_8_and_12_hertz():
    f, power = welch(strayed(HUMAN.variation)[0], 1 / H, nperseg=2**14, axis=0)
    power = power.sum(1)
    slow, between, tremor = (
        np.trapezoid(power[part], f[part])
        for part in (f < 1.5, (f > 4) & (f < 6), (f >= 7) & (f <= 13))
    )
    total = np.trapezoid(power, f)
    assert slow > 0.98 * total
    assert between < 1e-3 * total
    assert tremor == pytest.approx(3 * HUMAN.variation.tremor**2, rel=0.15)
    # The peak beyond 4 Hz is in the band, ten times what is beside it.
    fast = f > 4
    assert 8 <= f[fast][power[fast].argmax()] <= 12


def test_moving_hands_are_noisier_in_proportion_to_their_speed():
    quiet = replace(HUMAN.variation, drift=0, tremor=0, drift_time=0.1)
    slow, fast = (strayed(quiet, speed=v)[0].std() for v in (0.1, 0.3))
    assert slow == pytest.approx(0.1 * quiet.speed_noise, rel=0.1)
    assert fast == pytest.approx(3 * slow)


def test_attention_narrows_drift_where_it_is_and_leaves_tremor():
    free, _ = strayed(HUMAN.variation)
    when = np.zeros((len(free), 3))
    when[len(free) // 2 :, 2] = 1.0
    led, _ = strayed(HUMAN.variation, Care(position=when))
    only_drift = replace(HUMAN.variation, tremor=0)
    half, by = len(free) // 2, HUMAN.variation.attention
    np.testing.assert_array_equal(led[:half], free[:half])
    np.testing.assert_array_equal(led[:, :2], free[:, :2])
    narrowed = strayed(only_drift, EVERYTHING)[0].std() / strayed(only_drift)[0].std()
    assert narrowed == pytest.approx(by)
    # Tremor is no matter of will.
    shaken = [strayed(replace(HUMAN.variation, drift=0), care)[0] for care in (None, EVERYTHING)]
    np.testing.assert_array_equal(*shaken)


def test_an_object_is_expected_where_its_old_velocity_takes_it():
    watched, delay, a = Watched(0.2, H), 0.2, 0.4
    for k in range(1000):
        t = H * k
        pose = Pose(np.eye(3), np.array([0.3 * t, 0.5 * a * t**2, 0.0]))
        expected, twist = watched.expect(pose, np.array([0.3, a * t, 0, 0, 0, 0]))
    missing = pose.position - expected.position
    # Even motion is foreseen, acceleration is not: half of it times the delay squared.
    np.testing.assert_allclose(missing, [0, 0.5 * a * delay**2, 0], atol=1e-9)
    np.testing.assert_allclose(twist[1], a * (t - delay))
    path = np.array([0.5 * a * (H * np.arange(1000)) ** 2]).T
    late = path - foreseen(path, H, delay)
    np.testing.assert_allclose(late[500:-1], 0.5 * a * delay**2, rtol=0.01)


@pytest.mark.parametrize("delay", [0.15, 0.25])
def test_nothing_is_done_about_an_error_before_it_is_seen(delay):
    correction = Correction(Sight(delay, interval=0.05), H)
    moved = []
    for k in range(600):
        error = np.full(6, 0.01 if k >= 100 else 0.0)
        correction.act(k, lambda e=error: e, lambda: EVERYTHING.at(0), lambda: True)
        moved.append(correction.now[0])
    first = np.flatnonzero(moved)[0]
    assert 100 + round(delay / H) <= first <= 100 + round((delay + 0.05) / H)


def test_nobody_corrects_what_does_not_matter_nor_pulls_harder_when_exhausted():
    care, error = Care(position=(0, 1, 0)).at(0), np.full(6, 0.01)
    one, other = Correction(Sight(), H), Correction(Sight(), H)
    for k in range(2000):
        one.act(k, lambda: error, lambda: care, lambda: True)
        other.act(k, lambda: error, lambda: care, lambda: False)
    assert one.now[1] > 0.005
    assert not np.delete(one.now, 1).any()
    assert not other.now.any()


@pytest.fixture(scope="module")
def arm():
    return World.compose(planar3())


def held(arm, site, seconds, sight, offset=0.0, turn=True):
    """A hand that wants the site 3 cm from where it is, and holds on."""
    pose = arm.robot.at_home.pose(site)
    steps = round(seconds / arm.timestep)
    path = HandPath(
        np.tile(pose.position + np.array([0, offset, 0]), (steps, 1)),
        np.tile(pose.rotation, (steps, 1, 1)),
        np.zeros((steps, 3)),
        np.zeros((steps, 3)),
    )
    grip = HUMAN.grip if turn else replace(HUMAN.grip, angular_stiffness=0, angular_damping=0)
    return Guide("hand", site, grip, path, sight=sight, care=Care((1, 1, 0), (0, 0, 1)))


@pytest.mark.parametrize("delay", [0.0, 0.15, 0.25])
def test_a_led_arm_settles_for_all_delays_of_people(arm, delay):
    """The loop of looking and correcting is stable: no swing grows, the error goes."""
    guide = held(arm, "tip", 6.0, Sight(delay), 0.03)
    trial = demonstrate(arm, Lesson(arm.robot.home, (guide,), 6.0), {"tip": "tip"})
    error = np.linalg.norm((trial["tip_position"] - guide.path.position[0])[:, :2], axis=1)
    assert error.max() < 0.035
    assert error[-100:].max() < 0.1 * error[100:200].max() + 5e-4


def test_firm_hands_need_no_sight_and_draw_nothing():
    rng = np.random.default_rng(0)
    assert FIRM.sights(rng, 2) == (None, None)
    assert rng.random() == np.random.default_rng(0).random()


def test_two_hands_are_looked_at_in_turn_or_together():
    one, other = HUMAN.sights(np.random.default_rng(0), 2)
    assert one.delay == other.delay
    assert HUMAN.reaction[0] <= one.delay <= HUMAN.reaction[1]
    assert other.first - one.first == pytest.approx(one.interval / 2)
    together = replace(HUMAN, looks="together").sights(np.random.default_rng(0), 2)
    assert together[0] == together[1]
    assert together[0].interval == pytest.approx(one.interval / 2)


def test_what_an_arm_cannot_follow_is_not_shown(arm):
    near = Lesson(arm.robot.home, (held(arm, "tip", 1.0, None, 0.002),), 1.0)
    assert hindrance(arm, near) == ""
    far = Lesson(arm.robot.home, (held(arm, "tip", 1.0, None, 0.5),), 1.0)
    assert hindrance(arm, far) == "a hand stays behind"
    lessons = iter([far, far, near])
    rng = np.random.default_rng(0)
    assert Rehearsed(lambda world, rng: next(lessons))(arm, rng) is near
    with pytest.raises(SimulationError, match="can follow none; the last: a hand stays behind"):
        Rehearsed(lambda world, rng: far)(arm, rng)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Sight(delay=-0.1), "sight delay is -0.1"),
        (lambda: Sight(gain=0.7), "below 0.6"),
        (lambda: Demonstrator(reaction=(0.2, 0.1)), "two rising times"),
        (lambda: Demonstrator(looks="never"), "'in turn' or 'together'"),
        (lambda: Variation(tremor_band=(12.0, 8.0)), "two rising frequencies"),
        (lambda: Variation(attention=1.5), "give at most 1"),
    ],
)
def test_people_are_checked(make, words):
    with pytest.raises(ArgumentError, match=words):
        make()


def test_a_grip_knows_when_its_strength_is_spent():
    grip = Grip(max_force=10.0, max_torque=2.0)
    wrenches = np.array([[10, 0, 0, 0, 0, 0], [9.9, 0, 0, 0, 0, 0], [0, 0, 0, 0, 2, 0]])
    assert grip.spends(wrenches).tolist() == [True, False, True]
