"""A policy out of its folder commands what the simulation commanded, with no simulator."""

import subprocess
import sys
from dataclasses import replace

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from tpsim.controllers.renewed import FixedImpedance
from tpsim.deploy.policy import Policy
from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.task.task import draw_situation
from tpsim.task.verbs import perform
from tpsim.tasks.cup_and_sugar.task import CupAndSugar
from tpsim.world.people.push import Push
from tpsim.world.tank import Tank
from tpsim.world.weightless import Weightless

KINDS = [
    "MinimalIntervention",
    "MinimalIntervention that holds its start",
    "TimedIntervention",
    "Pursuit",
    "FiniteHorizon",
]

PUSH = Push("left_gripper", (0.0, 20.0, 0.0), 0.2, 0.3)


class Watched:
    """A controller that remembers the states it was asked at."""

    def __init__(self, controller):
        self.controller, self.states = controller, []

    def command(self, state, time):
        self.states.append(state)
        return self.controller.command(state, time)


def watched(task, models, duration, situation=None, people=()):
    situation = situation or draw_situation(task, 5, 2)
    watch = Watched(task.controller(task.stage, models, situation))
    trial = perform(task, models, situation, controller=watch, duration=duration, people=people)
    return trial, watch.states


def commands(policy, states):
    return np.array([policy.command(s.q, s.dq, s.objects, s.time) for s in states])


@pytest.mark.parametrize("kind", KINDS)
def test_torques_are_those_of_the_simulation_bit_for_bit(kind, learned, folder_of):
    task, models = learned(kind)
    people = (PUSH,) if kind.startswith("Minimal") else ()
    trial, states = watched(task, models, 0.8, people=people)
    policy = Policy.load(folder_of(kind))
    torques = commands(policy, states)
    np.testing.assert_array_equal(torques[::10], trial["torque"])
    assert np.ptp(torques, axis=0).max() > 0.1
    policy.reset()
    np.testing.assert_array_equal(commands(policy, states[:50]), torques[:50])


@pytest.mark.parametrize("kind", ["MinimalIntervention", "Pursuit"])
def test_torques_are_the_same_bits_where_the_tank_is_short(kind, learned, folder_of):
    task, models = learned(kind)
    situation, small = draw_situation(task, 5, 2), Tank(0.05)
    # Off its place in every direction, so that springs ask for more than there is.
    shift = 0.05 * np.random.default_rng(0).standard_normal(len(situation.start))
    situation = replace(situation, start=tuple((np.array(situation.start) + shift).tolist()))
    trials, watches = [], []
    for tank in (None, small):
        watch = Watched(task.controller(task.stage, models, situation))
        given = {"controller": watch, "duration": 0.5, "tank": tank}
        trials.append(perform(task, models, situation, **given))
        watches.append(watch)
    policy = Policy.load(folder_of(kind), tank=small)
    torques = commands(policy, watches[1].states)
    np.testing.assert_array_equal(torques[::10], trials[1]["torque"])
    assert np.abs(trials[1]["torque"] - trials[0]["torque"]).max() > 0.1
    assert policy.energies.injected - policy.energies.dissipated <= 0.05 + 1e-6


@pytest.mark.parametrize("kind", ["TimedIntervention", "FiniteHorizon"])
def test_objects_as_a_camera_gives_them(kind, learned, folder_of):
    task, models = learned(kind)
    _, states = watched(task, models, 0.05)
    policy = Policy.load(folder_of(kind))
    expected = commands(policy, states)
    for form in (
        lambda thing: thing.pose,
        lambda thing: (thing.position.tolist(), Pose(*thing[:2]).quaternion.tolist()),
        lambda thing: (thing.position, -2 * thing.pose.quaternion / 2, np.zeros(6)),
    ):
        policy.reset()
        seen = [{name: form(s.objects[name]) for name in policy.objects} for s in states]
        given = [policy.command(s.q, s.dq, o, s.time) for s, o in zip(states, seen, strict=True)]
        np.testing.assert_allclose(given, expected, atol=1e-8)


def test_the_velocity_of_objects_is_used(learned, folder_of):
    task, models = learned("Pursuit")
    _, states = watched(task, models, 1.0)
    moving = next(
        s for s in states[::-1] if s.objects.twists is not None and s.objects.twists.any()
    )
    policy = Policy.load(folder_of("Pursuit"))
    resting = {name: moving.objects[name].pose for name in policy.objects}
    with_velocity = policy.command(moving.q, moving.dq, moving.objects, 0.0)
    policy.reset()
    assert np.abs(policy.command(moving.q, moving.dq, resting, 0.0) - with_velocity).max() > 1e-3


def test_the_robot_out_of_the_folder_is_exact(learned, folder_of):
    for kind in ("FiniteHorizon", "Pursuit"):
        robot, read = learned(kind)[0].stage.robot, Policy.load(folder_of(kind)).robot
        rng = np.random.default_rng(0)
        for _ in range(5):
            q, dq = rng.normal(size=(2, robot.n))
            one, other = robot.at(q, dq), read.at(q, dq)
            np.testing.assert_array_equal(one.mass, other.mass)
            np.testing.assert_array_equal(one.bias, other.bias)
            assert set(robot.sites) == set(read.sites)
            for site in robot.sites:
                np.testing.assert_array_equal(one.jacobian(site), other.jacobian(site))
                np.testing.assert_array_equal(one.pose(site).position, other.pose(site).position)
        for name in ("lower", "upper", "velocity_limit", "torque_limit", "home", "damping"):
            np.testing.assert_array_equal(getattr(robot, name), getattr(read, name))
        assert (robot.joints, robot.hands) == (read.joints, read.hands)


SCRIPT = """
import sys
ALONE = {"numpy", "scipy", "pinocchio", "msgspec", "tpsim"}
class Nothing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("mujoco", "dm_control", "mink", "tyro", "matplotlib", "tqdm",
                                      "cloudpickle", "imageio"):
            raise ImportError(name + " is not on the robot's computer")
sys.meta_path.insert(0, Nothing())
import numpy as np
from tpsim.deploy import Policy
policy = Policy.load(sys.argv[1])
q = policy.robot.home
print(policy.command(q, 0 * q).tobytes().hex())
print(sorted(policy.cartesian(q, 0 * q)))
"""


def test_the_runtime_needs_no_simulator(folder_of):
    folder = folder_of("MinimalIntervention")
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(folder)], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    torque, hands = done.stdout.split("\n")[:2]
    policy = Policy.load(folder)
    q = policy.robot.home
    assert torque == policy.command(q, 0 * q).tobytes().hex()
    assert hands == "['left_hand', 'right_hand']"


def integrated(policy, start, duration, h=1e-3):
    """Postures (T, n) by Pinocchio's forward dynamics, classical Runge-Kutta, torque held."""
    robot, model = policy.robot, policy.robot.mechanism.model
    data = model.createData()

    def change(x, torque):
        q, dq = np.split(x, 2)
        return np.append(dq, pin.aba(model, data, q, dq, torque - robot.damping * dq))

    x, way = np.append(start, np.zeros(robot.n)), []
    for step in range(round(duration / h)):
        way.append(x[: robot.n])
        torque = policy.command(*np.split(x, 2), time=step * h)
        a = change(x, torque)
        b = change(x + h / 2 * a, torque)
        c = change(x + h / 2 * b, torque)
        d = change(x + h * c, torque)
        x = x + h / 6 * (a + 2 * b + 2 * c + d)
    return np.array(way)


def test_a_second_engine_goes_the_same_way(learned, tmp_path):
    """Pinocchio instead of MuJoCo: a millimetre apart on the way, a tenth of that at the end."""
    task, models = learned("MinimalIntervention")
    # Stiffer, steps of a millisecond alone make more of a difference.
    task = replace(task, effort=64.0)
    policy = Policy.load(Policy(task, models).save(tmp_path / "policy"))
    situation = draw_situation(task, 0, 0)
    # Off its place in every direction, so that cup and sugar have a way to go.
    shift = 0.05 * np.random.default_rng(0).standard_normal(policy.robot.n)
    start = tuple((np.array(situation.start) + shift).tolist())
    trial = perform(task, models, replace(situation, start=start), duration=2.0)
    way = integrated(policy, start, 2.0)[::10]
    for site in ("cup", "sugar"):
        there = np.array([policy.robot.at(q).pose(site).position for q in way])
        apart = np.linalg.norm(there - trial[f"{site}_position"], axis=1)
        travelled = np.linalg.norm(there - there[0], axis=1).max()
        assert travelled > 0.01 and apart.max() < 1e-3 and apart[-1] < 1e-4


def test_another_period_renews_as_often(learned, folder_of):
    """At 500 Hz the impedance lasts as long in time, and torques hardly differ."""
    task, models = learned("MinimalIntervention")
    _, states = watched(task, models, 0.2)
    fast, slow = (Policy.load(folder_of("MinimalIntervention"), period=p) for p in (None, 0.002))
    expected = commands(fast, states)[::32]
    np.testing.assert_allclose(commands(slow, states[::2])[::16], expected, rtol=1e-12)


def test_one_moment_is_asked_once(folder_of):
    one, two = (Policy.load(folder_of("MinimalIntervention")) for _ in range(2))
    q = one.robot.home
    for step in range(40):
        at = q + 0.001 * step
        one.cartesian(at, 0 * q, time=step * 1e-3)
        torque = one.command(at, 0 * q, time=step * 1e-3)
        np.testing.assert_array_equal(torque, two.command(at, 0 * q, time=step * 1e-3))


def test_torques_stay_within_the_motors(folder_of):
    policy = Policy.load(folder_of("MinimalIntervention"))
    q = policy.robot.home
    torque = policy.command(q + 1.5, 3 + 0 * q)
    limit = policy.robot.torque_limit
    assert (np.abs(torque) <= limit).all() and (np.abs(torque) == limit).any()


def test_the_scene_in_the_folder_opens_in_mujoco(learned, folder_of):
    model = mujoco.MjModel.from_xml_path(str(folder_of("FiniteHorizon") / "scene.xml"))
    assert model.nq == learned("FiniteHorizon")[0].stage.model.nq


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"q": np.zeros(2)}, "q has shape (2,); the robot has 3 joints"),
        ({"dq": [0, np.nan, 0]}, "the state of joint 'joint2' is nan, not finite"),
        ({"q": [np.inf, 0, 0]}, "the state of joint 'joint1' is inf, not finite"),
        ({"dq": [1e160, 0, 0]}, "joint 'joint1' is 1e+160, not finite or beyond all measure"),
        ({"time": np.nan}, "time is nan"),
        ({"objects": {}}, "object 'first' is missing; the policy needs the poses of first, second"),
        ({"second": ((0, 1), (1, 0, 0, 0))}, "object 'second' has parts of shapes"),
        ({"second": ((0, 1, np.nan), (1, 0, 0, 0))}, "objects['second'] is not finite"),
        ({"second": ((0, 1, 0), (0, 0, 0, 0))}, "no unit quaternion"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(change, words, folder_of):
    policy = Policy.load(folder_of("TimedIntervention"))
    seen = {"first": ((0.3, 0.6, 0), (1, 0, 0, 0)), "second": ((0.0, 0.7, 0), (1, 0, 0, 0))}
    given = {"q": np.zeros(3), "dq": np.zeros(3), "objects": seen, "time": 0.0}
    policy.command(**given)
    if "second" in change:
        change = {"objects": seen | change}
    with pytest.raises(ArgumentError) as error:
        policy.command(**given | change)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_time_does_not_run_backwards(folder_of):
    policy = Policy.load(folder_of("MinimalIntervention"))
    q = policy.robot.home
    policy.command(q, 0 * q, time=1.0)
    with pytest.raises(ArgumentError, match=r"call reset\(\) first"):
        policy.command(q, 0 * q, time=0.5)


class Mine(CupAndSugar):
    """A user's task with a controller of its own."""

    make = None

    def controller(self, world, models, situation):
        return type(self).make(world, situation)


def mine(make):
    return type("Mine", (Mine,), {"make": staticmethod(make)})()


def test_fixed_gains_hold_where_the_robot_starts(tmp_path):
    task = mine(lambda world, situation: FixedImpedance(np.array(situation.start), 100.0))
    policy = Policy.load(Policy(task, {}).save(tmp_path / "policy"))
    robot, start = policy.robot, policy.robot.home + 0.1
    np.testing.assert_allclose(policy.command(start, 0 * start), robot.at(start).bias, atol=1e-9)
    state = robot.at(start + 0.01)
    pulled = policy.command(state.q, state.dq, time=1e-3)
    np.testing.assert_allclose(pulled, state.bias - 100.0 * state.mass @ (0.01 + 0 * start))


def test_a_controller_of_the_users_own_is_refused():
    task = mine(lambda world, situation: Weightless(world.robot))
    with pytest.raises(ArgumentError, match="the task's controller is a Weightless"):
        Policy(task, {})


def test_a_controller_that_depends_on_the_situation_is_for_one(learned):
    _, models = learned("MinimalIntervention")

    class Moody(CupAndSugar):
        def controller(self, world, models, situation):
            task = replace(CupAndSugar(), friction=100 + abs(situation.start[0]))
            return task.controller(world, models, situation)

    task = Moody()
    with pytest.raises(ArgumentError, match=r"depends on the situation \(friction\)"):
        Policy(task, models)
    assert Policy(task, models, draw_situation(task, 0, 0)).objects == ()
