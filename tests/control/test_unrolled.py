"""Tracking on manifolds: paths unrolled onto the plane and rolled back."""

import numpy as np
import pytest

from tpsim import ArgumentError, Frame, impedance, integrator, lqt, rotation
from tpsim.control.unrolled import Unrolled, lqt_on
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import S2, S3, R

POSE = R(3) * S3
DT = 0.02


def wander(manifold, steps=60, seed=0, size=0.2):
    rng = np.random.default_rng(seed)
    x = [manifold.points("start", rng.normal(size=manifold.width))]
    v = rng.normal(size=manifold.dim)
    for _ in range(steps - 1):
        v = 0.9 * v + 0.4 * rng.normal(size=manifold.dim)
        x.append(manifold.exp(x[-1], size * v / np.sqrt(manifold.dim)))
    return np.array(x)


@pytest.mark.parametrize("manifold", [R(3), S2, S3, POSE], ids=str)
def test_the_plane_has_the_lengths_of_the_path(manifold):
    path = Unrolled.of(manifold, wander(manifold))
    steps = np.linalg.norm(np.diff(path.plane, axis=0), axis=1)
    np.testing.assert_allclose(
        steps, manifold.distance(path.points[1:], path.points[:-1]), atol=1e-9
    )
    np.testing.assert_allclose(
        manifold.distance(path.rolled(path.plane), path.points), 0, atol=1e-7
    )
    off = path.plane + 0.3
    np.testing.assert_allclose(
        [path.see(t, p) for t, p in enumerate(path.rolled(off))], off, atol=1e-9
    )
    # A neighbour's point is where its own step says, to second order.
    np.testing.assert_allclose(path.see(3, path.points[4]), path.plane[4], atol=1e-9)


def test_ten_turns_are_ten_turns():
    angle = np.linspace(0, 20 * np.pi, 400)
    q = np.column_stack([np.cos(angle / 2), 0 * angle, 0 * angle, np.sin(angle / 2)])
    path = Unrolled.of(S3, q)
    np.testing.assert_allclose(path.plane[-1], [0, 0, 20 * np.pi], atol=1e-6)


def test_on_r_n_it_is_lqt():
    rng = np.random.default_rng(0)
    root = rng.normal(size=(30, 3, 3))
    g = RiemannianGaussian(R(3), rng.normal(size=(30, 3)), root @ root.mT + 0.1 * np.eye(3))
    system = integrator(3, DT)
    weights = np.pad(g.precision, ((0, 0), (0, 3), (0, 3)))
    expected = lqt(np.hstack([g.mean, 0 * g.mean]), weights, system, 1e-3)
    start = np.concatenate([g.mean[0], np.zeros(3)])
    states = expected.rollout(start).states
    plan = lqt_on(g, system, 1e-3)
    np.testing.assert_allclose(plan.rollout(g.mean[0]), states[:, :3], atol=1e-9)
    control = plan.acceleration(4, states[4, :3], states[4, 3:])
    np.testing.assert_allclose(control, expected.control(4, states[4]), rtol=1e-7)


def stepped(turn):
    """Two states, far apart in orientation, as an HSMM has them: (80,)."""
    q = rotation.to_quaternion(rotation.exp(np.array([[0.0, 0, 0], turn])))
    means = np.repeat(np.hstack([[[0, 0, 0], [0.3, 0.1, 0.2]], q]), 40, axis=0)
    return RiemannianGaussian(POSE, means, 1e-3 * np.eye(6))


@pytest.mark.parametrize("degrees", [30, 120, 179])
def test_a_step_of_up_to_179_degrees_is_made_smoothly_and_the_short_way(degrees):
    turn = np.radians(degrees) * np.array([0.0, 0.6, 0.8])
    reference = stepped(turn)
    path = lqt_on(reference, integrator(6, DT), 1e-2).rollout(reference.mean[0])
    assert POSE.distance(path[-1], reference.mean[-1]) < np.radians(2)
    plane = Unrolled.of(S3, path[:, 3:]).plane
    along = plane @ turn / np.linalg.norm(turn)
    np.testing.assert_allclose(plane, along[:, None] * turn / np.linalg.norm(turn), atol=0.01)
    assert along.max() < np.radians(degrees) * 1.2
    assert np.abs(np.diff(along, n=2)).max() < 0.2 * np.radians(degrees) * 18 * DT


def test_a_turned_world_turns_the_movement():
    reference = stepped([1.0, -2.0, 0.5])
    frame = POSE.frame(Frame(rotation.exp([2.0, 0.3, 1.0]), [1.0, 0, 2]))
    system = integrator(6, DT)
    path = lqt_on(reference, system, 1e-3).rollout(reference.mean[0])
    moved = reference.affine(frame.A, frame.b)
    other = lqt_on(moved, system, 1e-3).rollout(moved.mean[0])
    assert POSE.distance(frame.to_common(path), other).max() < 1e-6


def test_precisions_of_several_coordinate_systems_add_up():
    reference = stepped([0.3, 0.2, 0.1])
    both = RiemannianGaussian(
        POSE, np.stack([reference.mean] * 2), 2 * np.stack([reference.covariance] * 2)
    )
    system = integrator(6, DT)
    one, two = (lqt_on(g, system, 1e-3).rollout(reference.mean[0]) for g in (reference, both))
    np.testing.assert_allclose(one, two, atol=1e-9)


def test_impedance_at_the_mean_is_a_wrench_that_leads_back():
    """``J' W log``: stiffness from the precision at the mean acts on the way to it."""
    rng = np.random.default_rng(0)
    root = rng.normal(size=(6, 6))
    g = RiemannianGaussian(POSE, rng.normal(size=7), root @ root.T + np.eye(6))
    stiffness, _ = impedance(g.precision, 0.1)
    x = POSE.exp(g.mean, 0.1 * rng.normal(size=6))
    wrench = stiffness @ POSE.log(x, g.mean)
    nearer = POSE.exp(x, 1e-3 * np.linalg.solve(stiffness, wrench))
    assert POSE.distance(nearer, g.mean) < POSE.distance(x, g.mean)
    turn = POSE.frame(Frame(rotation.exp([1.0, 2.0, 3.0]), [0.0, 1, 2]))
    moved = g.affine(turn.A, turn.b)
    other, _ = impedance(moved.precision, 0.1)
    R_turn = POSE.work.turned(turn.A, x, turn.to_common(x))
    np.testing.assert_allclose(
        other @ POSE.log(turn.to_common(x), moved.mean), R_turn @ wrench, atol=1e-9
    )


def test_what_does_not_fit_is_one_clear_line():
    reference = stepped([0.3, 0.2, 0.1])
    for call, words in (
        (lambda: lqt_on(reference, integrator(7, DT), 1e-3), r"integrator\(6, dt\)"),
        (lambda: lqt_on(reference[0], integrator(6, DT), 1e-3), r"give \(T,\)"),
        (lambda: lqt_on(reference, integrator(6, DT), 1e-3, np.zeros(7)), "zero length"),
        (lambda: Unrolled.of(POSE, np.zeros(7)), "zero length"),
        (lambda: Unrolled.of(R(2), np.zeros(2)), r"give \(T, 2\)"),
    ):
        with pytest.raises(ArgumentError, match=words):
            call()
