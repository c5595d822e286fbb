"""Arms that carry out what methods retrieve: where they are taught, where they are asked."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from tpsim import rotation
from tpsim.catalogue.ours import planar3
from tpsim.demonstration import Demonstration
from tpsim.frame import Frame
from tpsim.learning.dtw import align
from tpsim.retrieval.clock import on_one_clock
from tpsim.robot.views.sites import Site
from tpsim.section8.families import FAMILIES, Situation
from tpsim.task.task import Situation as TaskSituation
from tpsim.task.task import draw_situation
from tpsim.task.verbs import teach
from tpsim.tasks.planar import on_the_floor
from tpsim.tasks.transfer import docks
from tpsim.tasks.transfer.task import Transfer
from tpsim.tasks.transfer.teacher import arm, lesson_between
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.push import Push
from tpsim.world.reach import satisfy
from tpsim.world.teaching import demonstrate
from tpsim.world.trial import Trial
from tpsim.world.world import World

SCALE = 0.1
"""Size [m] on an arm of one unit of the data: methods have lengths, which fit the tutorial's."""

HOME = (0.6, 1.4, -0.4)
"""Posture [rad] of the planar arm from which it is put at a start: far from its joints' limits."""

AHEAD = rotation.exp([0.0, 0.0, np.pi / 2])
"""Rotation of its hand: ahead, so that the wrist reaches wherever the hand has to be."""

PUSHED = (0.2, 0.4)
"""Share of the movement after which a push begins, drawn from this range."""

LASTING = 0.3
"""Share of the movement for which a push lasts."""


@dataclass(frozen=True, eq=False)
class ArmSituation(Situation):
    """A situation on an arm.

    Parameters
    ----------
    start : (n,) tuple
        Posture with the hand where the teacher starts [rad].
    objects : tuple of ObjectPath
        What the frames belong to.
    push : Push
        What disturbs the second trial.
    """

    start: tuple[float, ...]
    objects: tuple[ObjectPath, ...]
    push: Push


class Arm(ABC):
    """An arm and a task for it, drawn and taught like a family of situations.

    Attributes
    ----------
    title : str
    site : str
        The hand.
    joints : tuple of str
        That move it.
    force : float
        Of a push [N].
    effort : float
        Cost of torque [1/(Nm)^2], against the log-likelihood of the movement.
    held : float
        Standard deviation [rad] with which the hand holds the orientation in which it started.
    """

    title: str
    site: str
    force: float
    effort: float
    held: float

    @property
    @abstractmethod
    def world(self) -> World:
        """The scene."""

    @property
    @abstractmethod
    def joints(self) -> tuple[str, ...]:
        """Names of the joints that carry the hand."""

    @property
    @abstractmethod
    def place(self) -> Frame:
        """From data (d,) to the world (3,) [m]."""

    @abstractmethod
    def demonstrations(self, count: int, samples: int, seed: int) -> list[Demonstration]:
        """Demonstrations of one teacher, in step and on one clock."""

    @abstractmethod
    def situations(self, count: int, spread: float, samples: int, seed: int) -> list[ArmSituation]:
        """Situations for the learners of one teacher, with the teacher's own movement."""

    def push(self, rng: np.random.Generator, seconds: float) -> Push:
        """Draw a push at the hand while the arm moves, along what the data span."""
        force = self.place.A @ rng.standard_normal(self.place.local_dim)
        force *= self.force / np.linalg.norm(force)
        begin = seconds * float(rng.uniform(*PUSHED))
        return Push(self.site, tuple(force.tolist()), start=begin, duration=LASTING * seconds)


class PlanarArm(Arm):
    """Three links in the plane, between two U (Figs 1, 2, 12) laid into its workspace."""

    title = "an arm of three links in the plane, between the two U"
    site = "tip"
    force = 5.0
    effort = 0.05
    held = 0.1
    middle = (0.0, 0.55)
    """Where the origin of the data is [m]."""

    @cached_property
    def world(self) -> World:
        """The arm and a puck in each U."""
        return on_the_floor(planar3(home=HOME), docks.NAMES, fovy=27)

    @property
    def joints(self) -> tuple[str, ...]:
        """All three."""
        return tuple(self.world.robot.joints)

    @property
    def place(self) -> Frame:
        """The plane of the data on the floor of the arm."""
        return Frame(SCALE * np.eye(3)[:, :2], np.array([*self.middle, 0.0]))

    def demonstrations(self, count: int, samples: int, seed: int) -> list[Demonstration]:
        """Those of the family ``transfer``."""
        return FAMILIES["transfer"].demonstrations(count, samples, seed)

    def situations(self, count: int, spread: float, samples: int, seed: int) -> list[ArmSituation]:
        """Those of the family ``transfer``."""
        drawn = FAMILIES["transfer"].situations(count, spread, samples, seed)
        return [self._on_the_arm(s, seed, k) for k, s in enumerate(drawn)]

    def _on_the_arm(self, drawn: Situation, seed: int, index: int) -> ArmSituation:
        robot, truth = self.world.robot, drawn.truth
        start = self.place.to_common(truth.data[0])
        hand = Site(self.site).pose.about(AHEAD).minus([*start, 0.0, 0.0, 0.0])
        posture = satisfy(robot, [hand], robot.home)
        origins = [self.place.to_common(frame.b) for frame in truth.frames]
        objects = [ObjectPath.at(name, at) for name, at in zip(docks.NAMES, origins, strict=True)]
        push = self.push(_stream(seed, index), float(truth.time[-1]))
        return ArmSituation(drawn.frames, truth, drawn.drawn, tuple(posture), tuple(objects), push)


class BaxterArm(Arm):
    """Baxter's left arm between two docks: positions are learned, the orientation is held."""

    title = "Baxter's left arm, between two docks"
    site = docks.GRIPPER
    force = 10.0
    effort = 0.05  # as in the task transfer
    held = 0.1

    def __init__(self) -> None:
        self._task = Transfer()

    @property
    def world(self) -> World:
        """That of the task ``transfer``."""
        return self._task.stage

    @property
    def joints(self) -> tuple[str, ...]:
        """The left arm."""
        return arm(self.world.robot, self.site)

    @property
    def place(self) -> Frame:
        """Decimetres."""
        return Frame(SCALE * np.eye(3), np.zeros(3))

    def demonstrations(self, count: int, samples: int, seed: int) -> list[Demonstration]:
        """The weightless arm is led, as in the task ``transfer``."""
        (taught,) = teach(self._task, count, seed).values()
        seen = on_one_clock([self._seen(trial) for trial in taught], samples)
        return align(seen, by="frames", band=self._task.warp * samples)

    def situations(self, count: int, spread: float, samples: int, seed: int) -> list[ArmSituation]:
        """Docks that were never taught; ``spread`` above 1 is twice as far as taught."""
        draw = partial(self._task.situation, far=spread > 1)
        found = [draw_situation(self._task, seed, index, draw) for index in range(count)]
        return [self._shown(situation, samples) for situation in found]

    def _shown(self, found: TaskSituation, samples: int) -> ArmSituation:
        """A situation with the movement that the teacher shows there."""
        rng = _stream(found.seed, found.index)
        placed = docks.at_start(found.objects)
        lesson = lesson_between(self.world, placed, np.array(found.start), rng)
        shown = demonstrate(self.world, lesson, self._task.sites())
        (truth,) = on_one_clock([self._seen(shown)], samples)
        push = self.push(rng, float(truth.time[-1]))
        return ArmSituation(truth.frames, truth, truth, found.start, found.objects, push)

    def _seen(self, trial: Trial) -> Demonstration:
        """Positions of the hand, and the docks as frames, in the unit of the data."""
        data = self.place.to_local(trial["left_hand_position"])
        poses = [trial.pose(name) for name in docks.NAMES]
        frames = [Frame(R[0], self.place.to_local(p[0])) for R, p in poses]
        return Demonstration(trial.time, data, frames)


def _stream(seed: int, index: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(3, index)))


ARMS: dict[str, Arm] = {"planar arm": PlanarArm(), "Baxter": BaxterArm()}
"""Arms of the closed loop, by name; scenes are made when they are asked for."""
