"""Kinematics along a movement: where sites are at all of its postures, and their Jacobians."""

from collections.abc import Collection, Mapping
from functools import cached_property

import numpy as np
import pinocchio as pin

from tpsim import rotation
from tpsim.pose import Pose
from tpsim.robot.objects import Objects
from tpsim.robot.robot import Robot
from tpsim.robot.state import State


class Along:
    """A movement of a robot and the objects around it: what a state answers, of all its instants.

    Parameters
    ----------
    robot : Robot
    q : (T, n)
        [rad]
    objects : mapping of str to (positions (T, 3) [m], quaternions (T, 4))
    """

    def __init__(
        self, robot: Robot, q: np.ndarray, objects: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ):
        self.robot, self.q, self._objects = robot, q, objects
        self._poses: dict[str, Pose] = {}

    def pose(self, site: str) -> Pose:
        """Poses (T) of a site in the world."""
        if site not in self._poses:
            R, p = poses_along(self.robot, self.q, [site])
            self._poses[site] = Pose(R[0], p[0])
        return self._poses[site]

    def object(self, name: str) -> Pose:
        """Poses (T) of an object."""
        if name not in self._objects:
            self.states[0].objects.row(name)  # which says why not
        positions, quaternions = self._objects[name]
        return Pose(rotation.from_quaternion(quaternions), positions)

    @cached_property
    def states(self) -> list[State]:
        """The robot at rest in every instant (T)."""
        rows = {name: row for row, name in enumerate(self._objects)}
        at_rest = np.hstack((self.q, np.zeros_like(self.q)))
        at_rest.flags.writeable = False
        places, turns = self._beside(0, 3), self._beside(1, 4)
        return [
            State(self.robot, x, Objects(rows, p, r))
            for x, p, r in zip(at_rest, places, turns, strict=True)
        ]

    def _beside(self, part: int, size: int) -> np.ndarray:
        """Positions or quaternions (T, k, size) of all objects."""
        found = [places[part] for places in self._objects.values()]
        return np.stack(found, axis=1).astype(float) if found else np.zeros((len(self.q), 0, size))


def poses_along(robot: Robot, q: np.ndarray, sites: Collection[str]) -> Pose:
    """Poses of k sites in the world, rotation (k, T, 3, 3), along postures q (T, n) [rad]."""
    model, frames = robot.mechanism.model, [robot.frame_of(site) for site in sites]
    data = model.createData()
    found, placed = np.empty((len(q), len(frames), 4, 4)), data.oMf
    for row, posture in zip(found, q, strict=True):
        pin.framesForwardKinematics(model, data, posture)
        for k, frame in enumerate(frames):
            row[k] = placed[frame].homogeneous
    found = found.swapaxes(0, 1)
    return Pose(found[..., :3, :3], found[..., :3, 3])


def jacobians_along(robot: Robot, q: np.ndarray, sites: Collection[str]) -> np.ndarray:
    """Jacobians (k, T, 6, n) of k sites, world-aligned, along postures q (T, n) [rad]."""
    model, aligned = robot.mechanism.model, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    data, frames = model.createData(), [robot.frame_of(site) for site in sites]
    found = np.empty((len(q), len(frames), 6, robot.n))
    for row, posture in zip(found, q, strict=True):
        pin.computeJointJacobians(model, data, posture)
        for J, frame in zip(row, frames, strict=True):
            pin.updateFramePlacement(model, data, frame)
            J[:] = pin.getFrameJacobian(model, data, frame, aligned)
    return found.swapaxes(0, 1)
