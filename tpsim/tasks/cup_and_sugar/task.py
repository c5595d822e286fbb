"""Two behaviours taught apart: hold a cup level, hold a sugar cube above it (Section 6, Fig. 9).

``cup-and-sugar`` performs the product of the two learned controllers.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import ClassVar, Literal

import numpy as np

from tpsim.controllers.minimal_intervention import MinimalIntervention
from tpsim.controllers.product import Skill
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import fit_tp_gmm
from tpsim.scene.compose import Held, world
from tpsim.task.task import Behaviour, Goal, Models, Situation, Task
from tpsim.tasks.cup_and_sugar import cup, sugar
from tpsim.tasks.cup_and_sugar.hands import Hands
from tpsim.tasks.robots import CAMERAS, FLOOR, TABLE, baxter
from tpsim.world.people.demonstrator import CUTOFF, TeacherName
from tpsim.world.rehearsal import considered
from tpsim.world.world import World

HOME = (
    *(0.77643, 0.48409, -0.91141, 2.06775, -0.10938, 0.33157, -0.67192),
    *(0.49732, -0.90217, 1.1919, 1.40747, -0.61722, 1.47197, 0.00951),
)
"""Both arms before the chest, cup level, sugar 8 cm above the middle of its rim [rad]."""

HELD = {
    # By its handle: its axis is the gripper's x, its handle points along -z of the gripper.
    "cup": Held("cup", "left_gripper", (0, 0, 0.056), ((0, 0, 1), (0, -1, 0))),
    "sugar": Held("sugar", "right_gripper", (0, 0, 0.006)),
}

_ROOMS = {"cup": cup, "sugar": sugar}


@dataclass(frozen=True)
class CupAndSugar(Task):
    """One or both of the behaviours on Baxter.

    Parameters
    ----------
    taught : tuple of str
        Behaviours: ``"cup"``, ``"sugar"`` or both.
    bandwidth : float, optional
        Natural frequency [Hz] of the most precise direction; by default as fast as the control
        loop allows.
    friction : float
        What a person feels who leads a hand where it is free [Ns/m].
    components : int
        Gaussians of each behaviour.
    hold : float
        Standard deviation [rad] with which joints that no behaviour was taught hold their start.
    teacher : str
        Whose hands show it: ``"human"``, as measured in people, or ``"firm"``, firmer and finer.
    """

    taught: tuple[Literal["cup", "sugar"], ...] = ("cup", "sugar")
    bandwidth: float | None = None
    friction: float = 180.0
    components: int = 1
    hold: float = 0.1
    teacher: TeacherName = "human"

    duration: ClassVar[float] = 6.0

    @property
    def name(self) -> str:
        """``cup``, ``sugar`` or ``cup-and-sugar``."""
        return "-and-".join(self.taught)

    def world(self) -> World:
        """Baxter with a cup in its left hand and a sugar cube in its right one."""
        return world(baxter(HOME), objects=TABLE, held=HELD, floor=FLOOR, cameras=CAMERAS)

    def sites(self) -> dict[str, str]:
        """Hands, what they hold, and elbows."""
        return self.stage.robot.hands | {
            name: name for name in ("cup", "sugar", "left_elbow", "right_elbow")
        }

    def behaviours(self) -> Mapping[str, Behaviour]:
        """Candidate frames and teachers."""
        fit = partial(fit_tp_gmm, components=self.components)
        goals = {"cup": cup.GOALS, "sugar": sugar.goals(Hands(self.stage).above.position)}
        return {
            name: Behaviour(
                _ROOMS[name].VIEWS,
                considered(partial(_ROOMS[name].lesson, teacher=self.teacher), self.teacher),
                fit,
                goals[name],
                CUTOFF[self.teacher],
            )
            for name in self.taught
        }

    def situation(self, world: World, rng: np.random.Generator) -> Situation:
        """Draw a start posture: level cup, and sugar above it where that was taught."""
        return Situation(tuple(_ROOMS[self.taught[-1]].start(Hands(world), rng)))

    def controller(self, world: World, models: Models, situation: Situation) -> MinimalIntervention:
        """The product of all frames of the behaviours."""
        skills = [Skill(b.views, models[name]) for name, b in self.behaviours().items()]
        prior = None
        if self.taught == ("cup",):
            # The right arm was not taught: it holds still. 10 rad say nothing about the left one.
            right = [joint.startswith("right") for joint in world.robot.joints]
            deviation = np.where(right, self.hold, 10.0)
            prior = Gaussian(np.array(situation.start), np.diag(deviation**2))
        return MinimalIntervention(
            skills, bandwidth=self.bandwidth, friction=self.friction, prior=prior
        )

    def goals(self) -> dict[str, Goal]:
        """A level cup, and the sugar at its place above it."""
        return {
            name: goal
            for name, behaviour in self.behaviours().items()
            for goal in behaviour.goals.values()
        }
