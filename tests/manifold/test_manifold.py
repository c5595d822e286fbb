"""Manifolds: their maps against their axioms, finite differences and rotation matrices."""

import numpy as np
import pytest

from tpsim import ArgumentError, Frame, rotation
from tpsim.manifold.manifold import S1, S2, S3, R

EVERYTHING = R(1, "inputs") * R(3) * S3 * S2 * R(3, "vectors")
KINDS = [R(2), S1, S2, S3, R(2) * S1, EVERYTHING, S3 * S3 * S2 * S1]


def points(manifold, count, seed=0):
    rng = np.random.default_rng(seed)
    return manifold.points("points", 2 * rng.normal(size=(count, manifold.width)))


@pytest.mark.parametrize("manifold", KINDS, ids=str)
def test_exp_and_log_undo_each_other(manifold):
    x, y = points(manifold, 300), points(manifold, 300, 1)
    np.testing.assert_allclose(
        manifold.distance(manifold.exp(x, manifold.log(x, y)), y), 0, atol=1e-7
    )
    v = 0.9 * np.random.default_rng(2).uniform(-1, 1, (300, manifold.dim))
    np.testing.assert_allclose(manifold.log(x, manifold.exp(x, v)), v, atol=1e-12)
    np.testing.assert_allclose(manifold.distance(x, y), manifold.distance(y, x), atol=1e-12)
    many = manifold.work.log_of_columns(x[:2, None][:, [0, 0]], np.stack([y.T, y.T]))
    expected = manifold.log(x[:2, None], y)
    np.testing.assert_allclose(many[:, 1], expected.mT, atol=1e-12)


@pytest.mark.parametrize("manifold", KINDS, ids=str)
def test_transport_keeps_lengths_and_the_way_itself(manifold):
    x, y = points(manifold, 100), points(manifold, 100, 1)
    turn, v = manifold.transport(x, y), manifold.log(x, y)
    np.testing.assert_allclose(turn @ turn.mT - np.eye(manifold.dim), 0, atol=1e-9)
    np.testing.assert_allclose((turn @ v[..., None])[..., 0], -manifold.log(y, x), atol=1e-9)
    np.testing.assert_allclose(manifold.transport(y, x) @ turn - np.eye(manifold.dim), 0, atol=1e-9)


@pytest.mark.parametrize("manifold", [S3, S2, EVERYTHING], ids=str)
def test_transport_turns_as_the_enclosed_area_says(manifold):
    """Round a small triangle a vector turns by curvature times area: both orders of its sides."""
    x, rng = points(manifold, 1)[0], np.random.default_rng(3)
    v, w = rng.normal(size=(2, manifold.dim))

    def holonomy(h):
        y, z = manifold.exp(x, h * v), manifold.exp(x, h * w)
        round_ = manifold.transport(z, x) @ manifold.transport(y, z) @ manifold.transport(x, y)
        return np.abs(round_ - np.eye(manifold.dim)).max()

    assert holonomy(0.1) > 1e-4
    assert holonomy(0.1) / holonomy(0.05) == pytest.approx(4, rel=0.05)


@pytest.mark.parametrize("manifold", KINDS, ids=str)
def test_slope_is_the_derivative_of_log(manifold):
    x, v = points(manifold, 50), np.random.default_rng(1).normal(size=(50, manifold.dim))
    v *= 2.5 / np.maximum(2.5, np.linalg.norm(v, axis=1, keepdims=True))
    y, h = manifold.exp(x, v), 1e-5
    slope = manifold.work.slope(x, y, v)
    for k, step in enumerate(h * np.eye(manifold.dim)):
        ahead, back = (
            manifold.log(y, manifold.exp(x, s * np.ones((50, 1)))) for s in (step, -step)
        )
        np.testing.assert_allclose(slope[..., k], (ahead - back) / (2 * h), atol=1e-7)


@pytest.mark.parametrize("manifold", KINDS, ids=str)
def test_what_control_loops_ask_for_at_once_is_what_its_parts_are(manifold):
    x, v = points(manifold, 60), np.random.default_rng(1).normal(size=(60, manifold.dim))
    v[:20] *= 10.0 ** -np.arange(1, 21)[:, None]
    y, work = manifold.exp(x, v), manifold.work
    v = manifold.log(x, y)
    slope = work.slope(x, y, v)
    found = work.linearised(x, y)
    np.testing.assert_allclose(found[..., :-1], slope, atol=1e-7)
    np.testing.assert_allclose(found[..., -1], (slope @ v[..., None])[..., 0], atol=1e-7)
    way, carry = work.carrying(x, y)
    np.testing.assert_allclose(way, v, atol=1e-12)
    np.testing.assert_allclose(carry @ slope - np.eye(manifold.dim), 0, atol=1e-7)
    end, brought = work.departing(x, v)
    np.testing.assert_allclose(manifold.distance(end, y), 0, atol=1e-7)
    np.testing.assert_allclose(brought, work.carrying(y, x)[1], atol=1e-6)


@pytest.mark.parametrize("manifold", KINDS, ids=str)
def test_steps_lead_where_exp_does_to_third_order(manifold):
    x, v = points(manifold, 60), np.random.default_rng(1).normal(size=(60, manifold.dim))

    def error(h):
        return manifold.distance(manifold.work.stepped(x, h * v), manifold.exp(x, h * v)).max()

    assert error(0.1) < 1e-2 and error(0.01) < 1e-5


@pytest.mark.parametrize("manifold", KINDS[:-1], ids=str)
def test_moved_points_and_tangent_maps_are_those_of_the_lifted_frame(manifold):
    n = 2 if manifold in (R(2), S1, R(2) * S1) else 3
    rng = np.random.default_rng(0)
    A = np.linalg.qr(rng.normal(size=(n, n)))[0]
    frame, x = Frame(A * np.linalg.det(A), rng.normal(size=n)), points(manifold, 20)
    lifted = manifold.frame(frame)
    y, turn, rigid = manifold.moved(frame, x)
    assert rigid
    np.testing.assert_allclose(manifold.distance(y, lifted.to_common(x)), 0, atol=1e-7)
    expected = manifold.work.turned(lifted.A, x, y)
    np.testing.assert_allclose(turn, np.broadcast_to(expected, turn.shape), atol=1e-12)


def test_orientations_are_those_of_rotation_matrices():
    w = np.random.default_rng(0).normal(size=(20, 2, 3))
    x, y = rotation.to_quaternion(rotation.exp(w)).swapaxes(0, 1)
    R_x, R_y = rotation.from_quaternion(x), rotation.from_quaternion(y)
    np.testing.assert_allclose(S3.log(x, y), rotation.log(R_y @ R_x.mT), atol=1e-12)
    np.testing.assert_allclose(S3.log(-x, y), S3.log(x, y), atol=1e-12)
    turned = rotation.from_quaternion(S3.exp(x, w[:, 0]))
    np.testing.assert_allclose(turned, rotation.exp(w[:, 0]) @ R_x, atol=1e-12)


@pytest.mark.parametrize("mirrored", [False, True])
def test_frames_are_rigid_motions_and_keep_ways(mirrored):
    manifold = EVERYTHING.mirrored("y") if mirrored else EVERYTHING
    rng = np.random.default_rng(0)
    A, b = rotation.exp(rng.normal(size=3)), rng.normal(size=3)
    A = A @ np.diag([1.0, -1.0 if mirrored else 1.0, 1.0])
    frame = manifold.frame(Frame(A, b))
    x, y = points(manifold, 40), points(manifold, 40, 1)
    moved, other = frame.to_common(x), frame.to_common(y)
    turn = manifold.work.turned(frame.A, x, moved)
    np.testing.assert_allclose(
        manifold.log(moved, other), (turn @ manifold.log(x, y)[..., None])[..., 0], atol=1e-12
    )
    np.testing.assert_allclose(frame.to_local(moved), x, atol=1e-12)
    np.testing.assert_allclose(moved[:, 0], x[:, 0])
    np.testing.assert_allclose(moved[:, 1:4], x[:, 1:4] @ A.T + b, atol=1e-12)
    np.testing.assert_allclose(moved[:, 8:11], x[:, 8:11] @ A.T, atol=1e-12)
    np.testing.assert_allclose(moved[:, 11:], x[:, 11:] @ A.T, atol=1e-12)
    body = np.diag([1.0, -1.0 if mirrored else 1.0, 1.0])
    seen = rotation.from_quaternion(moved[:, 4:8])
    np.testing.assert_allclose(seen, A @ rotation.from_quaternion(x[:, 4:8]) @ body, atol=1e-12)


def test_frames_of_the_plane_turn_angles_and_their_own_columns_are_taken():
    manifold = R(2) * S1
    c, s = np.cos(2.5), np.sin(2.5)
    frame = manifold.frame(Frame([[c, -s], [s, c]], [1.0, 2.0]))
    assert manifold.log(
        frame.to_common([0.0, 0.0, 1.0]), np.array([1.0, 2.0, 3.5])
    ) == pytest.approx(0)
    mirror = manifold.frame(Frame([[1.0, 0.0], [0.0, -1.0]], [0.0, 0.0]))
    np.testing.assert_allclose(mirror.to_common([1.0, 2.0, 0.5]), [1.0, -2.0, -0.5])
    assert manifold.frame(frame) is frame


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda: S3.points("y", np.zeros((2, 4))),
            "quaternions of zero length, the first in row 0",
        ),
        (lambda: S2.points("y", [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]), "directions of zero length"),
        (lambda: (R(3) * S3).points("y", np.zeros((2, 6))), "R(3) * S3 has 7 columns"),
        (lambda: S1.points("y", [1e9]), "give angles in rad"),
        (lambda: R(0), "size of R is 0"),
        (lambda: S3.frame(Frame(2 * np.eye(3), np.zeros(3))), "A is no rotation"),
        (lambda: S3.frame(Frame(np.diag([1.0, -1, 1]), np.zeros(3))), r"S3.mirrored('y')"),
        (lambda: R(2).frame(Frame(np.eye(3), np.zeros(3))), "R(2)"),
        (lambda: (S3 * R(1)).frame(Frame(np.eye(3), np.zeros(3))), "R(1, 'inputs')"),
        (lambda: S1.frame(Frame(np.eye(3), np.zeros(3))), "frames of the plane"),
        (lambda: (R(3) * S3).frame(Frame(np.eye(7) + 0.1, np.zeros(7))), "lead off S3"),
        (lambda: (R(3) * S3).frame(Frame(np.eye(7) + np.eye(7, k=3), np.zeros(7))), "lead off S3"),
        (lambda: (R(3) * S3).frame(Frame(np.ones((3, 2)), np.zeros(3))), "are square"),
        (lambda: R(3) * 2, "other is a int, where a Manifold belongs"),
        (lambda: (R(3) * S3).part("dims", [3, 4]), "give those of S3, [3, 4, 5, 6], together"),
    ],
)
def test_what_does_not_fit_is_one_clear_line(call, words):
    with pytest.raises(ArgumentError) as error:
        call()
    assert words in str(error.value) and "\n" not in str(error.value)
