"""Poses as several objects see them, in charts of rotation vectors: of hands that turn little."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tpsim import rotation
from tpsim.border import checked
from tpsim.errors import ArgumentError
from tpsim.gaussian import faded
from tpsim.pose import Pose, coordinates, object_frame

ROUNDS, STILL = 4, 5e-3
"""Gauss-Newton steps to the product of the frames, at most, and the step [m], [rad] after which no
other is worth while: the error that it leaves is of third order."""


@dataclass(frozen=True, eq=False)
class SeenMovement:
    """A movement of poses as one object sees it.

    Parameters
    ----------
    mean, precision : (T, 6), (T, 6, 6)
        In coordinates of the object, :func:`tpsim.pose.coordinates`.
    reference : (3, 3)
        Rotation, as seen from the object, whose vector is zero.
    """

    mean: np.ndarray
    precision: np.ndarray
    reference: np.ndarray

    def __post_init__(self) -> None:
        checked(self)

    def __len__(self) -> int:
        return len(self.mean)

    def from_step(self, first: int) -> "SeenMovement":
        """The rest of the movement."""
        return SeenMovement(self.mean[first:], self.precision[first:], self.reference)

    def seen_at(self, pose: Pose, common_reference) -> np.ndarray:
        """Mean (T, 6) in common coordinates, if the object alone is trusted."""
        (R, p), turned = pose, rotation.exp(self.mean[:, 3:]) @ self.reference
        return coordinates(Pose(R @ turned, p + self.mean[:, :3] @ R.T), common_reference)

    def placed(
        self, pose: Pose, common_reference, near, covariance: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Mean (T, 6) and precision (T, 6, 6) in common coordinates, Eq. (4), affine about near.

        The covariance (6, 6) of the object's pose is added to that of the movement.
        """
        frame = object_frame(pose, self.reference, common_reference, near)
        precision = frame.inverse.mT @ self.precision @ frame.inverse
        if covariance is not None:
            precision = faded(precision, _moved_by(pose, near, covariance)) @ precision
        return frame.to_common(self.mean), 0.5 * (precision + precision.mT)


def _moved_by(pose: Pose, near: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Covariance (T, 6, 6) of poses near (T, 6) that an object carries, from that of its own."""
    lever = np.zeros((*near.shape, 6))
    lever[..., :3, :3] = np.eye(3)
    lever[..., :3, 3:] = -rotation.skew(near[..., :3] - pose.position)
    lever[..., 3:, 3:] = rotation.left_jacobian_inverse(near[..., 3:])
    return lever @ covariance @ lever.mT


def fuse_poses(
    movements: Sequence[SeenMovement],
    objects: Sequence[Pose],
    common_reference,
    near=None,
    covariances: Sequence[np.ndarray | None] | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Means (P, T, 6) and precisions (P, T, 6, 6) in common coordinates, and their product (T, 6).

    Orientation makes the frames affine only about a pose (:mod:`tpsim.pose`): they are taken about
    the mean of their own product, Eqs (5)-(6), found by Gauss-Newton from ``near (T, 6)``, by
    default what the last object saw. Objects that are not exactly known have ``covariances``
    (6, 6) of their poses, position over a turn about the world's axes; these are added to the
    movement's own before the product.
    """
    if not movements or len(movements) != len(objects) or len({len(m) for m in movements}) > 1:
        raise ArgumentError(
            f"{len(movements)} movements are seen from {len(objects)} objects; give one for each, "
            "all of the same length"
        )
    known = [None] * len(objects) if covariances is None else covariances
    fused = movements[-1].seen_at(objects[-1], common_reference) if near is None else near
    for _ in range(ROUNDS):
        placed = [
            m.placed(o, common_reference, fused, unsure)
            for m, o, unsure in zip(movements, objects, known, strict=True)
        ]
        means, precisions = (np.array(part) for part in zip(*placed, strict=True))
        information = (precisions @ means[..., None]).sum(0)
        before, fused = fused, np.linalg.solve(precisions.sum(0), information)[..., 0]
        if np.abs(fused - before).max() < STILL:
            break
    return means, precisions, fused
