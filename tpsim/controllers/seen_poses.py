"""Poses of a hand as several objects see it, on their manifold: placed in the world, and fused."""

from collections.abc import Sequence

import numpy as np

from tpsim import rotation
from tpsim.frame import Frame
from tpsim.gaussian import faded, symmetric
from tpsim.learning.product_on import placed
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import S3, R
from tpsim.manifold.product import fused
from tpsim.pose import Pose

POSE = R(3) * S3
"""Where the pose of a hand lives: position [m] and unit quaternion."""

PARTS = (slice(0, 3), slice(3, 6))
"""Position and orientation among tangent coordinates: claims about them count apart."""


def placed_poses(
    movements: Sequence[RiemannianGaussian],
    objects: Sequence[Pose],
    covariances: Sequence[np.ndarray | None] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Means (P, T, 7) and precisions (P, T, 6, 6) in the world of what P objects see, Eq. (4).

    Objects that are not exactly known have ``covariances`` (6, 6) of their poses, position over a
    turn about the world's axes; these are added to the movement's own before any product.
    """
    means, precisions = placed(movements, [Frame(R, p) for R, p in objects])
    for k, covariance in enumerate(covariances or ()):
        if covariance is not None:
            lever = np.tile(np.eye(6), (means.shape[1], 1, 1))
            lever[:, :3, 3:] = -rotation.skew(means[k, :, :3] - objects[k].position)
            moved = lever @ covariance @ lever.mT
            precisions[k] = symmetric(faded(precisions[k], moved) @ precisions[k])
    return means, precisions


def common_pose(
    means: np.ndarray, precisions: np.ndarray, near: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Product over objects, Eqs (5)-(6): its means (T, 7) and covariances (T, 6, 6).

    Parameters
    ----------
    means, precisions : (P, T, 7), (P, T, 6, 6)
        Of :func:`placed_poses`.
    near : (T, 7), optional
        From where it is sought: of the two ways round, this one's.
    """
    return fused(POSE, means, precisions, near=near)


def counted(means: np.ndarray, precisions: np.ndarray, way: np.ndarray, shown: int) -> np.ndarray:
    """What claims (P, T, 6, 6) are worth that were learned from few demonstrations.

    A covariance that was found in N demonstrations is known from N - 1 differences, and what it
    says of a new place is no Gaussian but Student's t with as many degrees of freedom: far outside
    of what was shown it claims little. In the product a claim of d dimensions then counts with

        w = (nu + d) / (nu + m^2),    nu = N - 1,

    where m^2 is its squared Mahalanobis distance from the product of Gaussians. It is one step of
    iteratively reweighted least squares: more would turn the way from one claim to the other into
    a leap. Without it a dock that was never turned by more than some degrees against the other
    holds the hand back where they are turned by half a turn.

    Parameters
    ----------
    means, precisions : (P, T, 7), (P, T, 6, 6)
        Of :func:`placed_poses`.
    way : (T, 7)
        Mean of their product.
    shown : int
        N.
    """
    e, known = POSE.work.log(means, way), max(shown - 1, 1)
    share = np.empty(e.shape)
    for part in PARTS:
        pull = (precisions[..., part, part] @ e[..., part, None])[..., 0]
        squared = np.vecdot(e[..., part], pull)
        share[..., part] = np.sqrt((known + 3) / (known + squared))[..., None]
    return share[..., :, None] * precisions * share[..., None, :]


def precision_at(way: np.ndarray, means: np.ndarray, precisions: np.ndarray) -> np.ndarray:
    """Precision (T, 6, 6) of the product of claims (P, T), as it is at points (T, 7)."""
    _, slope = POSE.work.seen(way, means)
    return symmetric((slope.mT @ precisions @ slope).sum(0))
