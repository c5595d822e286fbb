"""Kinematics along a movement: where sites are at all of its postures, and their Jacobians."""

from collections.abc import Collection

import numpy as np
import pinocchio as pin

from tpsim.pose import Pose
from tpsim.robot.robot import Robot


def poses_along(robot: Robot, q: np.ndarray, sites: Collection[str]) -> Pose:
    """Poses of k sites in the world, rotation (k, T, 3, 3), along postures q (T, n) [rad]."""
    model, frames = robot.mechanism.model, [robot.sites[site] for site in sites]
    data = model.createData()
    found, placed = np.empty((len(q), len(frames), 4, 4)), data.oMf
    for row, posture in zip(found, q, strict=True):
        pin.framesForwardKinematics(model, data, posture)
        for k, frame in enumerate(frames):
            row[k] = placed[frame].homogeneous
    found = found.swapaxes(0, 1)
    return Pose(found[..., :3, :3], found[..., :3, 3])


def jacobians_along(robot: Robot, q: np.ndarray, site: str) -> np.ndarray:
    """Jacobians (T, 6, n) of a site, world-aligned, along postures q (T, n) [rad]."""
    model, aligned = robot.mechanism.model, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    data, frame = model.createData(), robot.sites[site]
    found = np.empty((len(q), 6, robot.n))
    for J, posture in zip(found, q, strict=True):
        pin.computeJointJacobians(model, data, posture)
        pin.updateFramePlacement(model, data, frame)
        J[:] = pin.getFrameJacobian(model, data, frame, aligned)
    return found
