from pathlib import Path

import numpy as np
import pytest

from tpsim import (
    GMM,
    TPGMM,
    Frame,
    Gaussian,
    gmr,
    integrator,
    lqt,
    spring_damper,
)
from tpsim.errors import ArgumentError
from tpsim.retrieval.dmp import Motion, attractor_path, decay, forced_attractor, forcing_term

FIGURES = np.load(Path(__file__).parents[1] / "reference" / "dmp_gmr.npz")
DT, STIFFNESS, DAMPING = 0.01, 50.0, 10.0
S = decay(200, DT)
START = np.r_[FIGURES["demonstrations"][0, 0], 0, 0]


def learned(demo):
    gaussians = Gaussian(FIGURES[f"mean_{demo}"], FIGURES[f"covariance_{demo}"])
    return GMM(FIGURES[f"priors_{demo}"], gaussians)


def tracked(attractor, stiffness=STIFFNESS, damping=DAMPING):
    return spring_damper(attractor, stiffness, damping, DT, START).states[:, :2]


def same(ours, theirs):
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-8 * np.abs(theirs).max())


def test_encoding_of_the_reference():
    """What demo_DMP_GMR01 and 03 learn from: the decay with the forcing term or the attractor."""
    same(S, FIGURES["decay"])
    for path, forced, attracted in zip(
        FIGURES["demonstrations"], FIGURES["encoded_01"], FIGURES["encoded_03"], strict=True
    ):
        motion = Motion.of(path, DT)
        same(forcing_term(motion, FIGURES["goal"], S, STIFFNESS, DAMPING), forced[:, 1:])
        same(attractor_path(motion, STIFFNESS, DAMPING), attracted[:, 1:])


@pytest.mark.parametrize("demo", ["01", "02"])
def test_reference_forcing_term(demo):
    """demo_DMP_GMR01 (isotropic covariances) and 02 (full): forcing term by GMR, roll-out."""
    forcing = gmr(learned(demo), S).mean
    same(forcing, FIGURES[f"retrieved_{demo}"])
    attractor = forced_attractor(FIGURES["goal"], forcing, S, STIFFNESS)
    same(tracked(attractor), FIGURES[f"path_{demo}"])


def test_reference_attractor_path():
    """demo_DMP_GMR03: the path of the attractor by GMR."""
    attractor = gmr(learned("03"), S).mean
    same(attractor, FIGURES["retrieved_03"])
    same(tracked(attractor), FIGURES["path_03"])


def at_new_goal(demo):
    gmm = learned(demo)
    model = TPGMM(gmm.priors, [gmm.gaussians])
    return gmr(model.adapt([Frame(np.eye(2), FIGURES["new_goal"]).with_input()]), S, ridge=1e-8)


def test_reference_task_parameterized():
    """demo_DMP_GMR04: one frame at the goal, which is moved."""
    attractor = at_new_goal("04").mean
    same(attractor, FIGURES["retrieved_04"])
    same(tracked(attractor), FIGURES["path_04"])


def gains(attractor, steps):
    precisions = np.zeros((steps, 4, 4))
    positions = np.linalg.inv(attractor.covariance)
    precisions[:, :2, :2] = np.concatenate([positions[: steps - 200], positions])
    effort, means = 5e-5 * np.eye(2), np.zeros((steps, 4))
    return lqt(means, precisions, integrator(2, DT), effort).gain


def test_reference_lqr_gains():
    """demo_DMP_GMR_LQR01 takes the Riccati matrix of step t where that of t + 1 belongs.

    Its gains are therefore those of a problem that starts one step earlier, shifted by one.
    """
    attractor = at_new_goal("lqr01")
    same(attractor.mean, FIGURES["retrieved_lqr01"])
    same(attractor.covariance, FIGURES["retrieved_covariance_lqr01"])
    late = gains(attractor, 201)[:200]
    same(tracked(attractor.mean, late[..., :2], late[..., 2:]), FIGURES["path_lqr01"])
    right = gains(attractor, 200)
    ours = tracked(attractor.mean, right[..., :2], right[..., 2:])
    assert 1e-3 < np.abs(ours - FIGURES["path_lqr01"]).max() < 5e-2


def test_forcing_term_gives_the_demonstration_back():
    """Imitate one motion exactly: F from its own accelerations, then semi-implicit Euler."""
    path = FIGURES["demonstrations"][1]
    velocity = np.diff(path, axis=0, prepend=path[:1]) / DT
    acceleration = np.diff(velocity, axis=0, append=velocity[-1:]) / DT
    motion, goal = Motion(path, velocity, acceleration), path[-1]
    F = forcing_term(motion, goal, S, STIFFNESS, DAMPING)
    attractor = forced_attractor(goal, F, S, STIFFNESS)
    np.testing.assert_allclose(attractor, attractor_path(motion, STIFFNESS, DAMPING), rtol=1e-9)
    rolled = spring_damper(attractor, STIFFNESS, DAMPING, DT, np.r_[path[0], 0, 0])
    np.testing.assert_allclose(rolled.states[:-1, :2], path[1:], atol=1e-9)


def test_goal_is_reached_when_the_decay_is_over():
    s = decay(3000, DT, rate=2.0)
    forcing = np.full((3000, 2), 40.0)
    path = spring_damper(forced_attractor([1.0, 2.0], forcing, s, 50.0), 50.0, 10.0, DT)
    np.testing.assert_allclose(path.states[-1], [1, 2, 0, 0], atol=1e-6)


def test_bad_arguments():
    motion = Motion.of(np.zeros((5, 2)), 0.1)
    for wrong, message in (
        (lambda: decay(0, 0.1), "steps"),
        (lambda: decay(5, 0.1, rate=10.0), "allowed"),
        (lambda: decay(5, -0.1), "dt"),
        (lambda: Motion.of(np.zeros((1, 2)), 0.1), "2 time steps"),
        (lambda: Motion.of(np.full((5, 2), np.nan), 0.1), "NaN"),
        (lambda: forcing_term(motion, [0, 0], np.zeros(5), 50, 10), "positive"),
        (lambda: forcing_term(motion, [0, 0], np.ones(4), 50, 10), r"must be \(5,\)"),
        (lambda: attractor_path(motion, 0.0, 10), "stiffness"),
        (lambda: forced_attractor([0, 0, 0], np.zeros((5, 2)), np.ones(5), 50), "must be"),
    ):
        with pytest.raises(ArgumentError, match=message):
            wrong()


def test_a_clock_that_has_run_out_is_refused():
    time = np.linspace(0.0, 1.0, 5)
    motion = Motion(*(np.outer(time, [1.0, 2.0]) for _ in range(3)))
    with pytest.raises(ArgumentError, match=r"s falls to 1\.0e-320: .*give larger s"):
        forcing_term(motion, np.ones(2), np.full(5, 1e-320), 100.0, 20.0)
