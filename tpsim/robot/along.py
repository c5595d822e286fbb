"""Kinematics along a movement: where sites are at all of its postures, and their Jacobians."""

from collections.abc import Collection, Iterator

import numpy as np
import pinocchio as pin

from tpsim.pose import Pose
from tpsim.robot.robot import Robot


def poses_along(robot: Robot, q: np.ndarray, sites: Collection[str]) -> Pose:
    """Poses of k sites in the world, rotation (k, T, 3, 3), along postures q (T, n) [rad]."""
    placed = np.empty((len(sites), len(q), 4, 4))
    for t, (data, frames) in enumerate(_placed(robot, q, sites)):
        for k, frame in enumerate(frames):
            placed[k, t] = data.oMf[frame].homogeneous
    return Pose(placed[..., :3, :3], placed[..., :3, 3])


def jacobians_along(robot: Robot, q: np.ndarray, site: str) -> np.ndarray:
    """Jacobians (T, 6, n) of a site, world-aligned, along postures q (T, n) [rad]."""
    found, model = np.empty((len(q), 6, robot.n)), robot.mechanism.model
    for J, (data, (frame,)) in zip(found, _placed(robot, q, [site]), strict=True):
        J[:] = pin.getFrameJacobian(model, data, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    return found


def _placed(
    robot: Robot, q: np.ndarray, sites: Collection[str]
) -> Iterator[tuple[pin.Data, list[int]]]:
    """Joints and frames placed at one posture after the other, and the frames of sites."""
    model, frames = robot.mechanism.model, [robot.sites[site] for site in sites]
    data = model.createData()
    for posture in q:
        pin.computeJointJacobians(model, data, posture)
        pin.updateFramePlacements(model, data)
        yield data, frames
