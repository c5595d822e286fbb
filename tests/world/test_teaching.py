"""Kinesthetic teaching: scripts are smooth and seeded, hands are of limited strength."""

import numpy as np
import pytest

from tpsim import rotation
from tpsim.errors import ArgumentError, SimulationError
from tpsim.pose import Pose
from tpsim.tasks.cup_and_sugar import cup
from tpsim.tasks.cup_and_sugar.hands import Hands
from tpsim.world.course import Course
from tpsim.world.people.guide import Grip
from tpsim.world.people.script import Variation, minimum_jerk, script, straight
from tpsim.world.reach import reach
from tpsim.world.teaching import Attempt, Lesson, Refusal, at_limits, demonstrate, teach
from tpsim.world.trial import Trial

SITES = {"left_hand": "left_gripper", "cup": "cup"}

TRIAL = Trial({"time": np.zeros(1)})

STILL = Variation(0, 0, 0, 0, pace=0, warp=0)


@pytest.fixture
def world(cup_world):
    return cup_world


def vias(rng, count=4):
    turns = rotation.exp(0.3 * rng.standard_normal((count, 3)))
    return turns, 0.2 * rng.standard_normal((count, 3))


def test_a_script_passes_its_via_poses_at_rest_at_the_ends():
    rotations, positions = vias(np.random.default_rng(0))
    path = script(rotations, positions, 3.0, 1e-3, np.random.default_rng(0), STILL)
    for k, step in enumerate((0, 999, 1999, 2999)):
        np.testing.assert_allclose(path.position[step], positions[k], atol=2e-3)
        np.testing.assert_allclose(path.rotation[step], rotations[k], atol=5e-3)
    np.testing.assert_allclose(path.velocity[[0, -1]], 0, atol=1e-4)


def test_velocities_are_the_derivatives_of_the_intended_movement():
    rng = np.random.default_rng(1)
    path = script(*vias(rng), 2.0, 1e-3, rng, Variation(0, 0, 0, 0))
    np.testing.assert_allclose(
        np.gradient(path.position, 1e-3, axis=0)[5:-5], path.velocity[5:-5], atol=1e-4
    )
    steps = rotation.log(path.rotation[1:] @ np.swapaxes(path.rotation[:-1], 1, 2)) / 1e-3
    middle = (path.angular_velocity[1:] + path.angular_velocity[:-1]) / 2
    np.testing.assert_allclose(steps, middle, atol=1e-4)


def test_minimum_jerk_between_two_points_is_the_known_polynomial():
    t = np.linspace(0, 1, 11)
    curve = minimum_jerk([0, 1], [[0.0], [2.0]])
    np.testing.assert_allclose(curve(t)[:, 0], 2 * (10 * t**3 - 15 * t**4 + 6 * t**5), atol=1e-12)


def test_wandering_has_the_deviation_that_was_asked_for():
    rotations, positions = np.repeat(np.eye(3)[None], 2, 0), np.zeros((2, 3))
    variation = Variation(0.01, 0, 0, 0, drift_time=0.05)
    path = script(rotations, positions, 60.0, 1e-3, np.random.default_rng(2), variation)
    np.testing.assert_allclose(path.position[6000:-6000].std(axis=0), 0.01, rtol=0.15)


def test_a_straight_path_goes_the_way_and_stays():
    path = straight([1.0, 0, 0], [0, 0.15, 0], 2.0, 0.5, 1e-3)
    assert len(path) == 2500
    np.testing.assert_allclose(path.position[-1], [1, 0.15, 0], atol=1e-12)
    np.testing.assert_allclose(np.cumsum(path.velocity[:, 1])[-1] * 1e-3, 0.15, atol=1e-4)


def test_a_hand_is_a_spring_of_limited_strength():
    grip, still = Grip(max_force=10.0), np.zeros(6)
    pose, wanted = Pose(np.eye(3), np.zeros(3)), Pose(np.eye(3), np.array([0.002, 0, 0]))
    np.testing.assert_allclose(grip.wrench(pose, still, wanted, still), [4, 0, 0, 0, 0, 0])
    far = Pose(np.eye(3), np.array([0.0, 3.0, 0]))
    np.testing.assert_allclose(grip.wrench(pose, still, far, still)[:3], [0, 10, 0])


def test_the_hand_leads_the_weightless_arm_where_it_wants(world):
    hands, rng = Hands(world), np.random.default_rng(5)
    rotations = np.repeat(hands.cup[0][None], 3, 0)
    way = np.array([[0, 0, 0], [0.05, 0.04, 0.03], [0.0, 0.06, 0.02]])
    guide = hands.guide("cup", rotations, hands.cup[1] + way, 2.0, rng)
    lesson = Lesson(world.robot.home, (guide,), 2.0, held=hands.right)
    trial = demonstrate(world, lesson, SITES)
    assert trial.outcome in ("done", "contact")
    np.testing.assert_allclose(trial["cup_position"][-1], hands.cup[1] + way[-1], atol=0.012)
    np.testing.assert_allclose(
        trial["q"][:, 7:], np.tile(world.robot.home[7:], (200, 1)), atol=0.02
    )
    assert 0.5 < np.linalg.norm(trial["left_guide_wrench"][:, :3], axis=1).max() <= 60


def test_teaching_repeats_bit_for_bit_and_rejects_what_is_useless(world):
    def plan(world, rng):
        """A lesson that every other time asks for more than the arm can reach."""
        if rng.random() < 0.4:
            raise SimulationError("too far")
        hands = Hands(world)
        rotations = np.repeat(hands.cup[0][None], 2, 0)
        positions = hands.cup[1] + np.array([[0, 0, 0], [0.03, 0.03, 0.0]])
        guide = hands.guide("cup", rotations, positions, 0.5, rng)
        return Lesson(world.robot.home, (guide,), 0.5, held=hands.right)

    outcomes = []
    runs = [
        teach(world, plan, 3, seed=4, sites=SITES, progress=lambda i, o: outcomes.append(o))
        for _ in range(2)
    ]
    assert "unreachable: too far" in outcomes
    assert runs[0].refusals == {"unreachable": outcomes.count("unreachable: too far") // 2}
    assert runs[0].attempts == 3 + runs[0].refusals["unreachable"]
    for one, other in zip(*(run.trials for run in runs), strict=True):
        assert one.about == other.about
        for name, signal in one.arrays.items():
            assert np.array_equal(signal, other[name]), name


def test_teaching_that_never_succeeds_says_so(world):
    def plan(world, rng):
        raise SimulationError("never")

    with pytest.raises(SimulationError, match="0 of 1 demonstrations were good"):
        teach(world, plan, 1, seed=0, sites=SITES)
    with pytest.raises(ArgumentError, match="at least 1"):
        teach(world, plan, 0, seed=0, sites=SITES)


def test_reach_finds_poses_and_says_when_it_cannot(world):
    hands = Hands(world)
    R, p = hands.cup
    wanted = p + np.array([0.05, 0.1, -0.03])
    q = reach(world.robot, {"cup": Pose(R, wanted)})
    found = world.robot.at(q).pose("cup")
    np.testing.assert_allclose(found.position, wanted, atol=1e-3)
    np.testing.assert_allclose(found.rotation, R, atol=2e-3)
    with pytest.raises(SimulationError, match="cannot be reached"):
        reach(world.robot, {"cup": Pose(R, p + np.array([2.0, 0, 0]))})


def test_via_poses_are_level_unless_height_is_what_matters(world):
    hands, rng = Hands(world), np.random.default_rng(0)
    rotations, positions = cup.via_poses(hands, rng)
    np.testing.assert_allclose(rotation.tilt(rotations), 0, atol=1e-4)
    rotations, positions = cup.via_poses(hands, rng, level=0.02)
    np.testing.assert_allclose(positions[:, 2], hands.cup[1][2] + 0.02)


@pytest.mark.parametrize("fields", [{"drift": -1.0}, {"warp": 1.5}, {"pace": np.nan}])
def test_variations_are_checked(fields):
    with pytest.raises(ArgumentError, match="variation"):
        Variation(**fields)


def test_attempts_that_are_wanted_at_once_are_those_that_one_after_the_other_come_to():
    rng = np.random.default_rng(3)
    for _ in range(50):
        count, good = int(rng.integers(1, 7)), rng.random(60) < 0.6
        good[9 * count :] = True  # before it is too many
        course, done = Course(count), 0
        while wanted := course.wanted:
            assert list(wanted) == list(range(done, done + len(wanted)))
            for k in wanted:
                refusal = None if good[k] else Refusal("missed", "missed")
                course.add(Attempt(TRIAL, refusal))
            done += len(wanted)
        assert done == course.shown.attempts == np.flatnonzero(good)[count - 1] + 1


def test_joints_at_their_limits_are_named(world):
    robot = world.robot
    q = (robot.lower + robot.upper) / 2
    assert at_limits(robot, q) == ()
    near, far = q.copy(), q.copy()
    near[1], far[0] = robot.upper[1] - 0.04, robot.lower[0] + 0.06
    assert at_limits(robot, np.array([q, near, far])) == (robot.joints[1],)
    assert at_limits(robot, np.array([q, near, far]), 0.1) == robot.joints[:2]


def test_a_hand_that_brakes_damps_what_it_holds_and_no_less_than_before():
    """x'' = -(k x + d x') / m has the damping ratio d / (2 (k m)^1/2)."""
    grip = Grip(2000.0, 120.0, 60.0, 2.5)
    heavy = grip.braking(50.0, 2.0, ratio=0.7)
    for k, d, m in ((2000.0, heavy.damping, 50.0), (60.0, heavy.angular_damping, 2.0)):
        poles = np.roots([m, d, k])
        assert -poles[0].real / abs(poles[0]) == pytest.approx(0.7)
    assert grip.braking(1.0, 0.01) == grip
