"""Table 3 entry by entry, what its frames say in the product, and the reference's movements."""

from pathlib import Path

import numpy as np
import pytest

from tpsim import TPGMM, Gaussian, PlanarChain, gmr, projection, two_armed
from tpsim.control.planar import numeric_jacobian
from tpsim.control.projection import CUTOFF, nullspace, pseudoinverse
from tpsim.errors import ArgumentError

REFERENCE = Path(__file__).parents[1] / "reference"
RNG = np.random.default_rng(0)
M, K, N = 2, 2, 7
J, J_OTHER, Q = RNG.normal(size=(M, N)), RNG.normal(size=(K, N)), RNG.normal(size=N)
X, X_OTHER, B_OBJECT = RNG.normal(size=M), RNG.normal(size=K), RNG.normal(size=M)
A_OBJECT = np.linalg.qr(RNG.normal(size=(2, 2)))[0]


def spd(n):
    root = RNG.normal(size=(n, n))
    return root @ root.T + np.eye(n)


def adapted(frames, gaussians, prior=None):
    """The Gaussian of one state seen in several frames, in joint space."""
    stacked = [Gaussian(g.mean[None], g.covariance[None]) for g in gaussians]
    return TPGMM([1.0], stacked).adapt(frames, prior=prior).gaussians[0]


@pytest.mark.parametrize("gain", [1.0, 0.15])
def test_table_3_entry_by_entry(gain):
    pinv, pinv_other, I = np.linalg.pinv(J), np.linalg.pinv(J_OTHER), np.eye(N)
    null = I - pinv @ J
    lift, error, error_other = null @ pinv_other, B_OBJECT - X, B_OBJECT - X_OTHER
    frames = {
        40: (projection.absolute(J, Q, X, gain=gain), pinv, -pinv @ X),
        41: (
            projection.relative(J, Q, X, A_OBJECT, B_OBJECT, gain=gain),
            pinv @ A_OBJECT,
            pinv @ error,
        ),
        42: (projection.nullspace_joint(J, Q, gain=gain), null, -null @ Q),
        43: (
            projection.nullspace_absolute(J, Q, J_OTHER, X_OTHER, gain=gain),
            lift,
            -lift @ X_OTHER,
        ),
        44: (
            projection.nullspace_relative(J, Q, J_OTHER, X_OTHER, A_OBJECT, B_OBJECT, gain=gain),
            lift @ A_OBJECT,
            lift @ error_other,
        ),
    }
    for frame, A, step in frames.values():
        np.testing.assert_allclose(frame.A, gain * A, atol=1e-12)
        np.testing.assert_allclose(frame.b, Q + gain * step, atol=1e-12)
    if gain == 1.0:
        np.testing.assert_allclose(frames[42][0].b, pinv @ J @ Q, atol=1e-12)
    joint = projection.joint(N)
    np.testing.assert_array_equal(joint.A, I)
    np.testing.assert_array_equal(joint.b, 0.0)


def test_relative_to_the_origin_is_absolute():
    ours = projection.relative(J, Q, X, np.eye(M), np.zeros(M))
    theirs = projection.absolute(J, Q, X)
    np.testing.assert_array_equal(ours.A, theirs.A)
    np.testing.assert_array_equal(ours.b, theirs.b)


def test_leading_axes_are_time():
    moving = np.stack([J, 2 * J, -J])
    frame = projection.nullspace_relative(moving, Q, J_OTHER, X_OTHER, A_OBJECT, B_OBJECT)
    single = projection.nullspace_relative(2 * J, Q, J_OTHER, X_OTHER, A_OBJECT, B_OBJECT)
    assert frame.shape == (3,)
    np.testing.assert_allclose(frame[1].A, single.A, atol=1e-12)
    np.testing.assert_allclose(frame[1].b, single.b, atol=1e-12)


def test_a_local_step_is_a_task_step():
    """Finite differences: q_hat moves the task by A_O d mu, and a nullspace frame not at all."""
    arm = PlanarChain((0.5, 0.4, 0.3, 0.2))
    q = np.array([0.3, 0.8, -0.5, 0.6])
    task = projection.relative(arm.jacobian(q), q, arm.position(q), A_OBJECT, arm.position(q))
    posture = projection.nullspace_joint(arm.jacobian(q), q)
    moved = numeric_jacobian(lambda mu: arm.position(task.to_common(mu)), np.zeros(2))
    np.testing.assert_allclose(moved, A_OBJECT, atol=1e-7)
    still = numeric_jacobian(lambda mu: arm.position(posture.to_common(q + mu)), np.zeros(4))
    np.testing.assert_allclose(still, 0.0, atol=1e-7)


def test_nullspace_annihilates_the_task():
    null = nullspace(J)
    np.testing.assert_allclose(null @ pseudoinverse(J), 0.0, atol=1e-12)
    np.testing.assert_allclose(J @ null, 0.0, atol=1e-12)
    np.testing.assert_allclose(null @ null, null, atol=1e-12)


def test_information_form_is_hierarchical_impedance():
    """A task frame adds J' Σ⁻¹ J, a nullspace frame N Σ⁻¹ N."""
    task = Gaussian(np.zeros(M), spd(M))
    posture = Gaussian(Q, spd(N))
    null = nullspace(J)
    product = adapted(
        [projection.absolute(J, Q, X), projection.nullspace_joint(J, Q)], [task, posture]
    )
    expected = J.T @ task.precision @ J + null @ posture.precision @ null
    np.testing.assert_allclose(product.precision, expected, atol=1e-9)
    weak = Gaussian(Q, 1e6 * np.eye(N))
    alone = adapted([projection.absolute(J, Q, X)], [task], prior=weak)
    expected = J.T @ task.precision @ J + weak.precision
    np.testing.assert_allclose(alone.precision, expected, atol=1e-8)


def test_two_levels_of_priority_are_the_classical_ones():
    """dq = J⁺ e1 + N J~⁺ e2, whatever the precisions: levels do not compete."""
    stack = [
        projection.relative(J, Q, X, np.eye(M), B_OBJECT),
        projection.nullspace_relative(J, Q, J_OTHER, X_OTHER, np.eye(K), B_OBJECT),
        projection.nullspace_joint(np.vstack([J, J_OTHER]), Q),
    ]
    null = np.eye(N) - np.linalg.pinv(J) @ J
    classical = np.linalg.pinv(J) @ (B_OBJECT - X)
    classical = classical + null @ np.linalg.pinv(J_OTHER) @ (B_OBJECT - X_OTHER)
    for first, second in ((1e-4, 1.0), (1.0, 1e-4)):
        local = [Gaussian(np.zeros(M), first * spd(M)), Gaussian(np.zeros(K), second * spd(K))]
        product = adapted(stack, [*local, Gaussian(stack[2].to_local(Q), spd(N))])
        np.testing.assert_allclose(product.mean, Q + classical, atol=1e-9)
        np.testing.assert_allclose(J @ (product.mean - Q), B_OBJECT - X, atol=1e-9)


def test_clip_shortens_the_error_and_keeps_its_direction():
    far = X + np.array([3.0, 4.0])
    frame = projection.relative(J, Q, X, np.eye(M), far, clip=0.5)
    np.testing.assert_allclose(J @ (frame.b - Q), [0.3, 0.4], atol=1e-12)
    near = projection.relative(J, Q, X, np.eye(M), X + 0.1, clip=0.5)
    np.testing.assert_allclose(J @ (near.b - Q), [0.1, 0.1], atol=1e-12)


@pytest.mark.parametrize("gap", [0.0, 1e-12, 1e-8, 1e-5, 1e-3, 1e-2])
def test_singular_postures_stay_bounded(gap):
    arm = PlanarChain((0.5, 0.5, 0.5))
    q = np.array([0.3, gap, -gap / 3])
    unreachable = 10 * arm.position(q)
    for damping, bound in ((0.0, 1 / CUTOFF), (0.05, 10.0)):
        frame = projection.relative(
            arm.jacobian(q), q, arm.position(q), np.eye(2), unreachable, clip=0.1, damping=damping
        )
        assert np.linalg.norm(frame.A, 2) <= 2 * bound
        assert np.abs(frame.b - q).max() <= 0.2 * bound
    task, posture = Gaussian(np.zeros(2), 1e-4 * np.eye(2)), Gaussian(q, 0.01 * np.eye(3))
    undamped = projection.relative(
        arm.jacobian(q), q, arm.position(q), np.eye(2), unreachable, clip=0.1
    )
    product = adapted([undamped, projection.joint(3)], [task, posture])
    bound = arm.jacobian(q).T @ task.precision @ arm.jacobian(q) + posture.precision
    np.testing.assert_allclose(product.precision, bound, atol=0.02 * np.abs(bound).max())
    assert np.abs(product.mean - q).max() < 0.2


def test_damping_is_continuous_through_the_singular_posture():
    arm = PlanarChain((0.5, 0.5))
    elbows = np.linspace(-0.2, 0.2, 2001)
    q = np.stack([np.full_like(elbows, 0.4), elbows], axis=-1)
    lift = pseudoinverse(arm.jacobian(q), damping=0.02)
    assert np.abs(np.diff(lift, axis=0)).max() < 1.0
    assert np.abs(lift).max() < 60.0


@pytest.mark.parametrize("situation", [0, 1], ids=["fixed objects", "a moving object"])
def test_reference_pointing(situation):
    """Fig. 10: product of four frames and GMR at every step, with the reference's gains."""
    data = np.load(REFERENCE / "pointing.npz")
    gaussians = [
        Gaussian(data["mean"][:d, j].T, np.moveaxis(data["covariance"][:d, :d, j], 2, 0))
        for j, d in enumerate(data["dims"])
    ]
    model, arm = TPGMM(data["priors"], gaussians), PlanarChain((0.2, 0.2, 0.2))
    objects, theirs = data["objects"][..., situation], data["q"][..., situation].T
    q = theirs[0]
    for t in range(len(theirs) - 1):
        J, x = arm.orientation_jacobian(q), arm.orientation(q)
        reach = objects[:, :, t].T - arm.position(q)
        angles = np.arctan2(reach[:, 1], reach[:, 0])
        frames = [
            projection.nullspace_joint(J, q, gain=0.15),
            *(
                projection.relative(J, q, x, np.eye(1), [angle], gain=0.15, clip=1.0)
                for angle in angles
            ),
            projection.absolute(J, q, x),
        ]
        mixture = model.adapt([frame.with_input() for frame in frames], ridge=1e-4)
        q = gmr(mixture, [[0.01 * (t + 1)]]).mean[0]
        np.testing.assert_allclose(q, theirs[t + 1], atol=1e-9)


@pytest.mark.parametrize("priority", range(3), ids=["right", "left", "compromise"])
def test_reference_bimanual_tracking(priority):
    """Fig. 11: two targets that cannot both be reached, priorities learned."""
    data = np.load(REFERENCE / "nullspace.npz")
    model = TPGMM(
        [1.0],
        [
            Gaussian(data["mean"][None, :, j, priority], data["covariance"][None, ..., j, priority])
            for j in range(4)
        ],
    )
    left, right = two_armed([0.5] * 5)
    theirs, I = data["q"][..., priority].T, np.eye(2)
    q = theirs[0]
    for t in range(len(theirs) - 1):
        J, J_other = left.jacobian(q), right.jacobian(q)
        x, x_other = left.position(q), right.position(q)
        b, b_other = data["left_target"][:, t, priority], data["right_target"][:, t, priority]
        frames = [
            projection.relative(J, q, x, I, b),
            projection.nullspace_relative(J, q, J_other, x_other, I, b_other),
            projection.nullspace_relative(J_other, q, J, x, I, b),
            projection.relative(J_other, q, x_other, I, b_other),
        ]
        for stored in np.flatnonzero(data["steps"] == t + 1):
            for j, frame in enumerate(frames):
                A, offset = data["A"][:, :, j, stored, priority], data["b"][:, j, stored, priority]
                np.testing.assert_allclose(frame.A, A, rtol=0, atol=1e-6 * np.abs(A).max())
                np.testing.assert_allclose(frame.b, offset, atol=1e-6)
        q = model.adapt(frames, ridge=1e-4).gaussians.mean[0]
        np.testing.assert_allclose(q, theirs[t + 1], atol=1e-6)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: projection.joint(0), "at least one"),
        (lambda: projection.absolute(J, Q[:3], X), "has shape"),
        (lambda: projection.absolute(J, Q, X[:1]), "x"),
        (lambda: projection.absolute(J * np.nan, Q, X), "NaN"),
        (lambda: projection.nullspace_absolute(J, Q, J_OTHER[:, :3], X), "has shape"),
        (lambda: projection.relative(J, Q, X, A_OBJECT, B_OBJECT, clip=0.0), "clip"),
        (lambda: projection.absolute(J, Q, X, damping=-1.0), "damping"),
    ],
)
def test_bad_input_is_refused(make, message):
    with pytest.raises(ArgumentError, match=message):
        make()
