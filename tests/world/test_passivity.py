"""Who pushes or leads the robot gets back what they gave and what was in the tank, no more."""

import mujoco
import numpy as np
import pytest

from tpsim.catalogue.ours import planar3
from tpsim.controllers.renewed import FixedImpedance
from tpsim.errors import ArgumentError
from tpsim.world.episode import Episode
from tpsim.world.impedance import Drive, Impedance
from tpsim.world.people.push import Push
from tpsim.world.plant import Plant
from tpsim.world.rollout import rollout
from tpsim.world.tank import UNLIMITED, Tank
from tpsim.world.world import World


class Hostile:
    """Stiffness, reference and velocity at random at every renewal."""

    def __init__(self, seed, every=1, jump=0.4):
        self.rng, self.every, self.jump, self.calls = np.random.default_rng(seed), every, jump, 0

    def command(self, state, time):
        if self.calls % self.every == 0:
            n, draw = state.robot.n, self.rng
            away = state.q + self.jump * draw.standard_normal(n)
            stiffness = draw.uniform(10, 400) * state.mass
            damping = draw.uniform(0, 8) * state.mass
            self.now = Impedance(stiffness, damping, away, draw.standard_normal(n))
        self.calls += 1
        return self.now


class Watch:
    """One trial with its true energies: kinetic, and what a force at the tip put in."""

    def __init__(self, world, controller, tank, seconds, force=None, start=None, holds=None):
        robot, simulation = world.robot, world.simulation()
        self.site = next(iter(robot.hands.values()))
        body = simulation.attachment(self.site)[0]
        episode = Episode(simulation)
        episode.reset(robot.home if start is None else start)
        drive = Drive(robot, simulation.timestep, tank)
        self.kinetic, self.given, self.energies, self.contacts = [], [], [], 0
        self.q = []
        given = 0.0
        for _ in range(round(seconds / simulation.timestep)):
            state = episode.sense()
            simulation.clear_wrenches()
            twist = state.twist(self.site)
            push = np.zeros(6)
            if force is not None:
                push[:3] = force(state.time, state.pose(self.site).position, twist[:3])
                simulation.apply_wrench(body, push, state.pose(self.site).position)
            torque = drive.torque(controller.command(state, state.time), state)
            self.kinetic.append(state.dq @ state.mass @ state.dq / 2)
            self.given.append(given)
            self.q.append(state.q)
            self.energies.append(drive.energies)
            episode.advance(episode.act(torque))
            # Force along the way: exact for a force that is held over a step.
            after = robot.at(simulation.q).pose(self.site).position
            given += push[:3] @ (after - state.pose(self.site).position)
        self.diverged = episode.diverged
        self.contacts, self.kinetic = episode.contacts, np.array(self.kinetic)
        self.given, self.energies = np.array(self.given), np.array(self.energies)

    @property
    def net(self):
        """Injected beyond dissipated (T,) [J]."""
        return self.energies[:, 2] - self.energies[:, 1]


def test_energies_balance_with_kinetic_energy(planar3_world):
    """Nobody pushes: what the motors did is kinetic energy, to the error of the integration."""
    robot = planar3_world.robot
    controller = FixedImpedance(robot.home + np.array([0.3, -0.2, 0.3]), 60.0)
    watch = Watch(planar3_world, controller, UNLIMITED, 0.6)
    stored, dissipated, injected, _ = watch.energies[::10].T
    kinetic = watch.kinetic[::10]
    assert kinetic.max() > 0.1
    np.testing.assert_allclose(injected - dissipated - stored, kinetic, atol=0.02 * injected.max())
    assert (np.diff(dissipated) >= 0).all()


def test_a_spring_holds_what_its_stiffness_and_its_way_say(planar3_world):
    robot, away = planar3_world.robot, np.array([0.1, 0.0, -0.05])
    held = FixedImpedance(robot.home + away, 50.0)
    trial = rollout(planar3_world, held, robot.home, 0.1, tank=Tank(20.0))
    expected = 0.5 * away @ (50.0 * robot.at_home.mass) @ away
    assert trial["energy_stored"][0] == pytest.approx(expected)
    assert trial["energy_injected"][0] == pytest.approx(expected)
    assert trial["energy_tank"][0] == pytest.approx(20.0 - expected)


@pytest.mark.parametrize(("every", "seed"), [(1, 0), (16, 1)])
def test_a_hostile_controller_gets_no_more_than_the_tank(planar3_world, every, seed):
    wild = Watch(planar3_world, Hostile(seed, every), UNLIMITED, 1.0)
    assert wild.net.max() > 10.0
    for size in (0.0, 1.0):
        tame = Watch(planar3_world, Hostile(seed, every), Tank(size), 1.0)
        assert tame.net.max() <= size + 1e-3
        assert tame.kinetic.max() <= size + 1e-3


def test_a_tank_that_is_not_short_changes_no_bit(planar3_world):
    robot = planar3_world.robot
    trials = [
        rollout(planar3_world, FixedImpedance(robot.home + 0.05, 80.0), robot.home, 0.3, tank=tank)
        for tank in (None, UNLIMITED)
    ]
    for name in ("q", "dq", "torque"):
        np.testing.assert_array_equal(trials[0][name], trials[1][name])


def test_a_reference_beyond_the_tank_is_reached_all_the_same(planar3_world):
    """The spring pulls less, and what dampers take is paid out again."""
    robot = planar3_world.robot
    goal = robot.home + np.array([0.5, 0.3, -0.3])
    held = FixedImpedance(goal, 200.0)
    trial = rollout(planar3_world, held, robot.home, 3.0, tank=Tank(2.0))
    np.testing.assert_allclose(trial["q"][-1], goal, atol=0.02)
    net = trial["energy_injected"] - trial["energy_dissipated"]
    assert net.max() <= 2.0 + 1e-6
    assert trial["energy_injected"].max() > 3.0


def test_shaken_at_any_frequency_it_gives_back_no_more(planar3_world):
    """A sweep from 0.5 to 12 Hz, through every resonance."""
    robot, size, seconds = planar3_world.robot, 0.5, 2.5

    def shake(t, p, v):
        phase = 2 * np.pi * (0.5 * t + 11.5 * t**2 / (2 * seconds))
        return 4.0 * np.sin(phase) * np.array([1.0, 0.5, 0.0])

    held = FixedImpedance(robot.home, 100.0)
    watch = Watch(planar3_world, held, Tank(size), seconds, shake)
    assert (watch.kinetic <= size + watch.given + 1e-3).all()
    assert watch.given.max() > 0.05


def test_the_worst_person_takes_no_more_than_the_tank(planar3_world):
    """A brake at the tip takes all that it can from a hostile controller."""

    def brake(t, p, v):
        return -3.0 * v * [1, 1, 0]

    for size in (0.0, 0.5):
        watch = Watch(planar3_world, Hostile(3, 16), Tank(size), 1.0, brake)
        assert watch.given.min() >= -size - 1e-3
    free = Watch(planar3_world, Hostile(3, 16), UNLIMITED, 1.0, brake)
    assert free.given.min() < -1.0


class Swaying:
    """A reference that goes to and fro once a second, between two renewals at rest."""

    def __init__(self, home, way=0.15):
        self.home, self.way = home, way

    def command(self, state, time):
        if round(1000 * time) % 20 == 0:
            mass, away = state.mass, self.way * np.sin(2 * np.pi * time)
            self.now = Impedance(400.0 * mass, 40.0 * mass, self.home + away)
        return self.now


def test_friction_that_is_allowed_for_does_not_empty_the_tank(planar3_world):
    """An arm that rubs goes on as long as it likes; without the allowance it goes soft."""
    robot, share = planar3_world.robot, 0.02
    plant, levels = Plant(friction=share * float(robot.torque_limit.min())), {}
    for name, friction in (("none", 0.0), ("known", share)):
        tank = Tank(3.0, friction=friction)
        sways = Swaying(robot.home)
        trial = rollout(planar3_world, sways, robot.home, 6.0, plant=plant, tank=tank)
        second = np.floor(trial["time"])
        levels[name] = [trial["energy_tank"][second == k].max() for k in (1, 5)]
    assert levels["none"][1] < 0.7 * levels["none"][0]
    assert levels["known"][1] > 0.98 * levels["known"][0]


@pytest.fixture(scope="module")
def walled():
    """The arm of three links with a ball at its tip, 2 cm before a stiff wall."""
    robot = planar3()
    x, y, z = robot.at_home.pose("tip").position
    spec = robot.source.spec.copy()
    tip, stiff = spec.site("tip"), [-5e4, -100.0]
    ball = {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": [0.01, 0, 0], "pos": tip.pos, "mass": 0}
    tip.parent.add_geom(contype=2, conaffinity=4, solref=stiff, **ball)
    box = {"type": mujoco.mjtGeom.mjGEOM_BOX, "size": [0.05, 0.5, 0.2], "pos": [x + 0.08, y, z]}
    spec.worldbody.add_geom(contype=4, conaffinity=2, solref=stiff, **box)
    return World.compose(robot, spec)


@pytest.mark.parametrize("size", [0.0, 1.0])
def test_pressed_on_a_stiff_wall_it_comes_to_rest(walled, size):
    """The reference is 20 cm behind the wall; contact takes energy, and never makes any."""
    robot = walled.robot
    goal = robot.home + np.linalg.pinv(robot.at_home.jacobian("tip")[:2]) @ [0.2, 0.0]
    watch = Watch(walled, FixedImpedance(goal, 300.0), Tank(size), 1.5)
    assert watch.kinetic.max() <= size + 1e-3
    assert watch.kinetic[-100:].max() < 5e-4
    assert (watch.contacts > 500) == (size > 0)


class Circulating:
    """A spring with an antisymmetric part: work round every loop, in one sense."""

    def __init__(self, home, turn):
        self.home, self.turn = home, turn

    def command(self, state, time):
        if time == 0.0:
            skew = np.zeros((3, 3))
            skew[0, 1], skew[1, 0] = self.turn, -self.turn
            self.now = Impedance(8 * np.eye(3) + skew, 0.3 * np.eye(3), self.home)
        return self.now


def circle(centre, sense):
    """A strong hand that leads the tip round a circle of 6 cm, once a second."""

    def force(t, p, v):
        angle, radius = sense * 2 * np.pi * t, 0.06 * min(t, 1.0)
        at = centre + radius * np.array([np.cos(angle), np.sin(angle), 0.0])
        along = radius * sense * 2 * np.pi * np.array([-np.sin(angle), np.cos(angle), 0.0])
        return (400.0 * (at - p) + 20.0 * (along - v)) * [1, 1, 0]

    return force


def test_loops_give_no_energy_beyond_the_tank(planar3_world):
    robot = planar3_world.robot
    centre = robot.at_home.pose(next(iter(robot.hands.values()))).position
    taken = {}
    for name, tank, sense in (
        ("free", UNLIMITED, 1),
        ("there", Tank(0.2), 1),
        ("back", Tank(0.2), -1),
    ):
        spring = Circulating(robot.home, 60.0)
        taken[name] = -Watch(planar3_world, spring, tank, 1.6, circle(centre, sense)).given.min()
    assert taken["free"] > 0.3
    assert max(taken["there"], taken["back"]) <= 0.2 + 1e-3


def test_tanks_that_make_no_sense_are_refused():
    with pytest.raises(ArgumentError, match="tank initial is -1"):
        Tank(-1.0)
    with pytest.raises(ArgumentError, match=r"tank capacity is 1\.0 J; give at least"):
        Tank(2.0, 1.0)


class Driving:
    """No spring at all, and a damper that pushes on."""

    def command(self, state, time):
        n = len(state.q)
        return Impedance(np.zeros((n, n)), -4.0 * np.eye(n), state.q.copy())


def test_without_a_spring_an_empty_tank_holds_nothing_back_but_the_damper(planar3_world):
    """What is owned may be a rounding below zero, while the spring holds exactly nothing."""
    push = Push("tip", (0.0, 3.0, 0.0), 0.02, 0.1)
    home = planar3_world.robot.home
    trial = rollout(planar3_world, Driving(), home, 0.6, people=[push], tank=Tank(0.02))
    assert trial.outcome == "done"
    assert trial["energy_injected"].max() <= 0.02 + 1e-9


def test_what_is_allowed_for_friction_is_all_that_comes_beside_the_tank(planar3_world):
    """A damper that pushes on gets what the tank has, what was given, and friction's share."""
    robot, share, size = planar3_world.robot, 0.03, 0.02

    def flick(t, p, v):
        return np.array([0.0, 3.0, 0.0]) * (t < 0.1)

    watch = Watch(planar3_world, Driving(), Tank(size, friction=share), 0.6, flick)
    rubbed = np.abs(np.diff(watch.q, axis=0)) @ (share * robot.torque_limit)
    own = size + watch.given
    assert (watch.kinetic <= own + np.append(0.0, np.cumsum(rubbed)) + 1e-3).all()
    assert watch.kinetic.max() > 2 * own.max()
