"""What the cup and sugar behaviours share: the two hands, their frames, where they may be."""

from dataclasses import dataclass, replace

import numpy as np

from tpsim import rotation
from tpsim.sim.coordinates.coordinate import HandPose, RelativePose, SelfMotion
from tpsim.sim.hand import Guide, Hand
from tpsim.sim.reach import reach
from tpsim.sim.script import Variation, script
from tpsim.sim.simulation import Simulation

SITES = {
    "left_hand": "left_gripper",
    "right_hand": "right_gripper",
    "cup": "cup",
    "sugar": "sugar",
    "left_elbow": "left_elbow",
    "right_elbow": "right_elbow",
}
"""Sites that recordings keep, by the name they have there."""

LEADING = Hand(), Variation()
"""A hand that leads an arm through the workspace."""

WATCHING = Hand(5000.0, 200.0), Variation(drift=0.001, tremor=0.0004)
"""A hand that keeps one object at its place by another, watching: firmer and finer."""

Pose = tuple[np.ndarray, np.ndarray]
"""Rotation (3, 3) and position (3,) [m] in the world."""


@dataclass(frozen=True)
class Workspace:
    """Where a hand may be, about its home. Ranges are uniform and to both sides.

    Parameters
    ----------
    position : (3,) tuple
        m.
    yaw, tilt : float
        About the vertical, and about any horizontal axis [rad].
    elbow : float
        Standard deviation of the posture [rad] that inverse kinematics prefers, so that elbows
        vary as a person's starting posture does.
    """

    position: tuple[float, float, float] = (0.14, 0.17, 0.13)
    yaw: float = 0.6
    tilt: float = 0.0
    elbow: float = 0.35

    def offset(self, rng) -> np.ndarray:
        """A displacement (3,) [m] within the range."""
        return rng.uniform(-1, 1, 3) * self.position

    def turn(self, rng) -> np.ndarray:
        """A rotation (3, 3) within the range: yaw after tilt."""
        heading = rng.uniform(0, 2 * np.pi)
        lean = self.tilt * rng.uniform(-1, 1) * np.array([np.cos(heading), np.sin(heading), 0])
        return rotation.exp([0, 0, self.yaw * rng.uniform(-1, 1)]) @ rotation.exp(lean)


class Hands:
    """The two hands of one simulation and what they hold.

    Parameters
    ----------
    simulation : Simulation
        Of :func:`tpsim.sim.scene.cup_and_sugar`.

    Attributes
    ----------
    cup, sugar : Pose
        At home.
    left, right : tuple of str
        Joints of each arm.
    """

    def __init__(self, simulation: Simulation):
        self.simulation = simulation
        robot = simulation.robot
        robot.update_kinematics(simulation.home)
        self.cup, self.sugar = self._pose("cup"), self._pose("sugar")
        self._grasp = {
            "cup": ("left", _relative(self._pose("left_gripper"), self.cup)),
            "sugar": ("right", _relative(self._pose("right_gripper"), self.sugar)),
        }
        self.left = tuple(j for j in robot.joints if j.startswith("left_"))
        self.right = tuple(j for j in robot.joints if j.startswith("right_"))

    def _pose(self, site) -> Pose:
        R, p = self.simulation.robot.placement(self.simulation.robot.site(site))
        return R.copy(), p.copy()

    @property
    def above(self) -> Pose:
        """The sugar's pose in the cup's frame, at home: its place above the cup."""
        return _relative(self.cup, self.sugar)

    def coordinates(self) -> dict:
        """Candidate frames by name: hands in the robot's base, one from the other, postures."""
        cup, sugar, above = (tuple(R.ravel()) for R, _ in (self.cup, self.sugar, self.above))
        home = self.simulation.home.tolist()
        frames = (
            HandPose("cup in base", "cup", cup),
            HandPose("sugar in base", "sugar", sugar),
            RelativePose("sugar from cup", "sugar", "cup", above),
            SelfMotion("left posture", self.left, "left_gripper", tuple(home[:7])),
            SelfMotion("right posture", self.right, "right_gripper", tuple(home[7:])),
        )
        return {frame.name: frame for frame in frames}

    def level_cup(self, rng, workspace) -> Pose:
        """A pose of the cup somewhere in a workspace, level."""
        R, p = self.cup
        turn = replace(workspace, tilt=0.0).turn(rng)
        return turn @ R, p + workspace.offset(rng)

    def reach(self, rng, elbow, **objects: Pose) -> np.ndarray:
        """Posture (n,) that brings ``cup`` and ``sugar`` to poses, elbows drawn at random."""
        home = self.simulation.home
        preferred = home + elbow * rng.standard_normal(home.size)
        return reach(self.simulation, objects, posture=preferred)

    def guide(self, held, rotations, positions, seconds, rng, *, relative_to=None) -> Guide:
        """A person's hand on the gripper that leads what it holds along via poses.

        Parameters
        ----------
        held : str
            ``"cup"`` or ``"sugar"``.
        rotations, positions : (V, 3, 3), (V, 3)
            Via poses of the held object, in the world or in the site ``relative_to``.
        """
        side, (R_grasp, p_grasp) = self._grasp[held]
        # From the object's pose to that of the gripper that holds it.
        rotations = np.asarray(rotations) @ R_grasp.T
        positions = np.asarray(positions) - rotations @ p_grasp
        timestep = self.simulation.timestep
        hand, variation = LEADING if relative_to is None else WATCHING
        path = script(rotations, positions, seconds, timestep, rng, variation)
        return Guide(f"{side}_guide", f"{side}_gripper", hand, path, relative_to)


def compose(first: Pose, second: Pose) -> Pose:
    """The pose ``second``, given in ``first``, in the world."""
    (R, p), (R_local, p_local) = first, second
    return R @ R_local, p + R @ p_local


def _relative(frame: Pose, pose: Pose) -> Pose:
    (R, p), (R_world, p_world) = frame, pose
    return R.T @ R_world, R.T @ (p_world - p)
