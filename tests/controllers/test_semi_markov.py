"""Fig. 8 at torque level: two ways from partial demonstrations, held, led elsewhere, and a loop."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from tpsim import (
    GMM,
    HSMM,
    TPGMM,
    Constraint,
    Frame,
    Gaussian,
    SemiMarkovChain,
    fit_gmm,
    joint_speed,
)
from tpsim.controllers.semi_markov import SemiMarkovTracking
from tpsim.errors import ArgumentError
from tpsim.robot.views.sites import Site
from tpsim.timeline import rest_to_rest
from tpsim.world.people.hold import Hold
from tpsim.world.people.push import Push
from tpsim.world.rollout import rollout

DT, STEPS, STATES = 0.03, 100, 12
TIP = Site("tip").position[:2]
PARTS = (("upper", 0.7, 1.0), ("lower", 0.2, 0.85), ("upper", 0.2, 0.85), ("lower", 0.0, 0.35))


def whole(way):
    """The whole movement (T, 2) [m] by one of two ways, which nobody shows."""
    s = np.concatenate([rest_to_rest(np.linspace(0, 1, STEPS)), np.ones(15)])
    aside = 0.08 * np.sin(np.pi * np.clip(2 * s - 0.5, 0, 1)) ** 2
    return np.column_stack([0.5 * s, 0.5 + (aside if way == "upper" else -aside)])


@pytest.fixture(scope="module")
def hsmm():
    """States of [x, dx] and how they follow each other, from four parts shown in any order."""
    rng, parts = np.random.default_rng(0), []
    for way, begin, end in PARTS:
        x = whole(way) + 0.003 * rng.standard_normal(2)
        seen = np.hstack([x, np.gradient(x, DT, axis=0)])
        parts.append(seen[int(begin * STEPS) : int(end * STEPS) if end < 1 else None])
    gmm = fit_gmm(parts, STATES, start="kmeans", ridge=1e-5, rng=rng)
    chain = SemiMarkovChain.through([gmm.responsibilities(x).argmax(1) for x in parts], STATES)
    return HSMM(chain, GMM(gmm.priors, gmm.gaussians))


def posture(world, point):
    """Joint angles with the tip at a point of the plane."""
    robot = world.robot

    def missing(q):
        away = robot.at(q).pose("tip").position[:2] - point
        return np.concatenate([away, 0.01 * (q - robot.home)])

    return least_squares(missing, robot.home).x


@pytest.fixture
def perform(planar3_world, hsmm):
    def run(*people, seconds=4.0, model=None, start=(0.0, 0.5), **options):
        law = SemiMarkovTracking(TIP, model or hsmm, dt=DT, effort=0.1, **options)
        begin = posture(planar3_world, np.array(start))
        trial = rollout(planar3_world, law, begin, seconds, people=people)
        return trial["tip_position"][:, :2], trial

    return run


def way_of(path):
    return "upper" if path[np.argmin(np.abs(path[:, 0] - 0.25)), 1] > 0.5 else "lower"


def away(path):
    return np.linalg.norm(path[:, None] - whole(way_of(path)), axis=2).min(1).max()


def test_parts_are_one_movement_with_a_fork(hsmm):
    chain = hsmm.chain
    forks = np.flatnonzero((chain.transitions > 0).sum(1) > 1)
    assert np.count_nonzero(chain.initial) == 1 and len(forks) == 1
    begin = hsmm.gaussians.mean[chain.initial.argmax(), :2]
    (end,) = np.flatnonzero(~chain.transitions.any(1))
    np.testing.assert_allclose(begin, [0.0, 0.5], atol=0.03)
    np.testing.assert_allclose(hsmm.gaussians.mean[end, :2], [0.5, 0.5], atol=0.01)


def test_both_ways_are_performed_though_nobody_showed_the_whole(perform):
    found = {}
    for rng in range(6):
        path, trial = perform(rng=rng)
        found[way_of(path)] = path
        assert away(path) < 0.025
        assert np.linalg.norm(path[-1] - [0.5, 0.5]) < 0.01
        assert not trial["saturated_steps"].any()
        if len(found) == 2:
            break
    assert set(found) == {"upper", "lower"}


def test_held_it_waits_and_goes_on(perform):
    path, free = perform()
    held, trial = perform(Hold("tip", 1.5, 2.0), seconds=6.0)
    assert np.ptp(held[170:345], axis=0).max() < 0.01
    late = [np.argmax(p[:, 0] > 0.45) for p in (path, held)]
    assert late[1] - late[0] == pytest.approx(200, abs=40)
    assert way_of(held) == way_of(path) and away(held) < 0.025
    limit = np.array([30.0, 20.0, 8.0])
    held_jumps, jumps = (np.abs(np.diff(t["torque"], axis=0) / limit).max(1) for t in (trial, free))
    # Within 10 ms: letting go is nothing that the movement itself has not asked for.
    assert held_jumps[348:354].max() < 0.1
    assert held_jumps.max() < 1.1 * jumps.max()


def test_led_to_the_other_way_at_the_fork_it_goes_on_there(perform):
    alone, _ = perform()
    force = 12.0 if way_of(alone) == "lower" else -12.0
    path, _ = perform(Push("tip", (0.0, force, 0.0), 1.1, 0.6), seconds=5.0)
    assert way_of(path) != way_of(alone)
    assert np.linalg.norm(path[-1] - [0.5, 0.5]) < 0.01


def test_a_loop_goes_round_for_ever_in_its_frame(perform):
    """A circle shown once around, learned in a frame that has moved since."""
    angle = np.linspace(0, 4 * np.pi, 201)[:-1]
    x = 0.07 * np.column_stack([np.cos(angle), np.sin(angle)])
    seen = np.hstack([x, np.gradient(x, DT, axis=0)])[1:-1]
    states = np.floor(angle[1:-1] / (np.pi / 4)).astype(int) % 8
    parts = [seen[states == k] for k in range(8)]
    mean = np.array([part.mean(0) for part in parts])
    spread = np.array([np.cov(part.T) + 1e-5 * np.eye(4) for part in parts])
    chain = SemiMarkovChain.through([states], 8)
    model = HSMM(chain, TPGMM(np.full(8, 0.125), (Gaussian(mean, spread),)))
    there = Frame(np.eye(2), [0.3, 0.5])
    path, _ = perform(model=model, frames=lambda state: [there], start=(0.37, 0.5), seconds=7.0)
    radius = np.linalg.norm(path - there.b, axis=1)
    turned = np.unwrap(np.arctan2(*(path - there.b).T[::-1]))
    assert turned[-1] > 1.6 * 2 * np.pi
    np.testing.assert_allclose(radius[100:], 0.07, atol=0.015)
    with pytest.raises(ArgumentError, match="give frames"):
        perform(model=model)


def test_it_keeps_within_constraints(perform):
    """As fast as it may be, and later there; the push of its motors is limited as well."""
    slow = joint_speed([0.12, 0.12])  # of y: the states are [y, dy]
    weak = Constraint("push", [-1.5] * 2, [1.5] * 2, control=np.eye(2))
    free, _ = perform(seconds=2.5)
    path, _ = perform(seconds=2.5, slip=2.0, constraints=lambda state: [slow, weak])
    speeds = [np.abs(np.diff(p, axis=0)).max() / 0.01 for p in (free, path)]
    assert speeds[0] > 0.25 and speeds[1] < 0.15
    assert path[-1, 0] < free[-1, 0] - 0.1 and path[-1, 0] > 0.1
