"""What the cup and sugar behaviours share: where the hands may be, and how they are led."""

from dataclasses import dataclass, replace

import numpy as np

from tpsim import rotation
from tpsim.pose import Pose
from tpsim.tasks.workplace import size_of
from tpsim.world.people.care import Care
from tpsim.world.people.demonstrator import FIRM, HUMAN, Demonstrator, TeacherName
from tpsim.world.people.guide import Grip, Guide
from tpsim.world.people.script import Variation, script
from tpsim.world.reach import reach
from tpsim.world.world import World

LEADING = {"firm": FIRM, "human": HUMAN}
"""Who leads an arm through the workspace."""

WATCHING = {
    "firm": Demonstrator(Grip(5000.0, 200.0), Variation(drift=0.001, tremor=0.0004)),
    "human": HUMAN,
}
"""Who keeps one object at its place by another, watching; firm hands are firmer then, and finer."""


ASIDE = np.array([-0.08, -0.42, 0.12])
"""Where the right hand waits, from its home, of arms of size 1 [m]."""


@dataclass(frozen=True)
class Workspace:
    """Where a hand may be, about its home. Ranges are uniform and to both sides.

    Parameters
    ----------
    position : (3,) tuple
        Of arms of size 1, as tasks state it [m].
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

    def of_size(self, scale: float, room: float) -> "Workspace":
        """For arms of another size, and with less room, which is less to turn, too."""
        x, y, z = (scale * room * extent for extent in self.position)
        return replace(self, position=(x, y, z), yaw=room * self.yaw, tilt=room * self.tilt)

    def offset(self, rng: np.random.Generator) -> np.ndarray:
        """A displacement (3,) [m] within the range."""
        return rng.uniform(-1, 1, 3) * self.position

    def turn(self, rng: np.random.Generator) -> np.ndarray:
        """A rotation (3, 3) within the range: yaw after tilt."""
        heading = rng.uniform(0, 2 * np.pi)
        lean = self.tilt * rng.uniform(-1, 1) * np.array([np.cos(heading), np.sin(heading), 0])
        turned: np.ndarray = rotation.exp([0, 0, self.yaw * rng.uniform(-1, 1)]) @ rotation.exp(
            lean
        )
        return turned


class Hands:
    """The two hands of one world and what they hold.

    Parameters
    ----------
    world : World
    teacher : str
        Whose hands lead them.
    room : float
        Share of the workspace that arms of this length usually reach.

    Attributes
    ----------
    size, room : float
        Of the arms, and share of their workspace.
    cup, sugar : Pose
        At home.
    above : Pose
        The sugar's place above the cup, in the cup's frame, at home.
    right : tuple of str
        Joints of the right arm.
    """

    def __init__(self, world: World, teacher: TeacherName = "firm", room: float = 1.0):
        self._teacher = teacher
        self.size, self.room = size_of(world.robot), room
        self._world, robot = world, world.robot
        home = robot.at_home
        self.cup, self.sugar = home.pose("cup"), home.pose("sugar")
        self.above = self.cup.inverse @ self.sugar
        self._grasp = {
            "cup": ("left", home.pose("left_gripper").inverse @ self.cup),
            "sugar": ("right", home.pose("right_gripper").inverse @ self.sugar),
        }
        self.right = tuple(robot.joints[i] for i in robot.chain("right_gripper"))

    def level_cup(self, rng: np.random.Generator, workspace: Workspace) -> Pose:
        """A pose of the cup somewhere in a workspace, level."""
        R, p = self.cup
        within = replace(self.within(workspace), tilt=0.0)
        return Pose(within.turn(rng) @ R, p + within.offset(rng))

    def within(self, workspace: Workspace) -> Workspace:
        """A workspace of arms of size 1, for these arms in their room."""
        return workspace.of_size(self.size, self.room)

    @property
    def aside(self) -> Pose:
        """Where the sugar is while the right hand waits."""
        R, p = self.sugar
        return Pose(R, p + self.size * ASIDE)

    def reach(self, rng: np.random.Generator, elbow: float, **held: Pose) -> np.ndarray:
        """Posture (n,) that brings ``cup`` and ``sugar`` to poses, elbows drawn at random."""
        home = self._world.robot.home
        preferred = home + elbow * rng.standard_normal(home.size)
        return reach(self._world.robot, held, posture=preferred)

    def guide(
        self,
        held: str,
        rotations: np.ndarray,
        positions: np.ndarray,
        seconds: float,
        rng: np.random.Generator,
        *,
        care: Care = Care(),  # noqa: B008 - a frozen value
        relative_to: str | None = None,
    ) -> Guide:
        """A person's hand on the gripper that leads what it holds along via poses.

        Parameters
        ----------
        held : str
            ``"cup"`` or ``"sugar"``.
        rotations, positions : (V, 3, 3), (V, 3)
            Via poses of the held object [m], in the world or in the site ``relative_to``.
        seconds : float
            Time from the first to the last [s].
        care : Care
            What the person sees to while leading.
        """
        side, (R_grasp, p_grasp) = self._grasp[held]
        # From the object's pose to that of the gripper that holds it.
        rotations = np.asarray(rotations) @ R_grasp.T
        positions = np.asarray(positions) - rotations @ p_grasp
        timestep = self._world.timestep
        who = (LEADING if relative_to is None else WATCHING)[self._teacher]
        (sight,) = who.sights(rng)
        path = script(rotations, positions, seconds, timestep, rng, who.variation, care)
        return Guide(
            f"{side}_guide",
            f"{side}_gripper",
            who.grip,
            path,
            relative_to,
            sight=sight,
            care=care,
        )
