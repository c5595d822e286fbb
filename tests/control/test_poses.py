"""Movements of poses that objects see: their product in charts of rotation vectors."""

import numpy as np
import pytest

from tpsim import rotation
from tpsim.control.poses import SeenMovement, fuse_poses
from tpsim.errors import ArgumentError
from tpsim.pose import coordinates

T = 30


def movement(rng, deviation=0.1):
    mean = np.cumsum(0.05 * rng.normal(size=(T, 6)), axis=0)
    root = np.eye(6) + 0.3 * rng.normal(size=(T, 6, 6))
    return SeenMovement(mean, root @ root.mT / deviation**2, rotation.exp(rng.normal(size=3)))


def dock(rng, spread=0.4):
    return rotation.exp(spread * rng.normal(size=3)), rng.normal(size=3)


def residual(movement, pose, y, common):
    """What one object sees of common coordinates, from its mean."""
    world = rotation.exp(y[..., 3:]) @ common, y[..., :3]
    return coordinates(world, movement.reference, seen_from=pose) - movement.mean


def test_a_single_object_gets_exactly_what_it_saw():
    rng = np.random.default_rng(0)
    seen, pose = movement(rng), dock(rng)
    common = pose[0] @ seen.reference
    *_, fused = fuse_poses([seen], [pose], common)
    np.testing.assert_allclose(residual(seen, pose, fused, common), 0, atol=1e-6)


def test_the_product_is_the_likeliest_pose_of_all_objects():
    rng = np.random.default_rng(1)
    first = movement(rng)
    seen = [first, SeenMovement(first.mean + 0.1, 3 * first.precision, first.reference)]
    turn, p = dock(rng)
    poses = [(turn, p), (rotation.exp([0.1, 0.2, -0.1]) @ turn, p + 0.1)]
    common = poses[-1][0] @ first.reference
    *_, fused = fuse_poses(seen, poses, common)

    def cost(y):
        errors = [residual(m, pose, y, common) for m, pose in zip(seen, poses, strict=True)]
        return sum(
            np.einsum("ta,tab,tb->t", e, m.precision, e) for e, m in zip(errors, seen, strict=True)
        )

    best = cost(fused)
    for step in 0.02 * np.eye(6):
        assert (cost(fused + step) > best - 1e-3).all()
        assert (cost(fused - step) > best - 1e-3).all()


def test_movements_and_objects_must_fit():
    rng = np.random.default_rng(3)
    seen, pose = movement(rng), dock(rng)
    with pytest.raises(ArgumentError, match="1 movements are seen from 2 objects"):
        fuse_poses([seen], [pose, pose], np.eye(3))
    with pytest.raises(ArgumentError, match="same length"):
        fuse_poses([seen, seen.from_step(1)], [pose, pose], np.eye(3))
