"""Recipes: what tpsim's controllers are made from, as plain values that a file can hold."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from tpsim.controllers.finite_horizon import FiniteHorizon
from tpsim.controllers.minimal_intervention import MinimalIntervention
from tpsim.controllers.product import Skill
from tpsim.controllers.pursuit import Pursuit
from tpsim.controllers.renewed import FixedImpedance
from tpsim.controllers.timed_intervention import TimedIntervention
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.free_movement import Relevance
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.learning.tp_gmm import TPGMM
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.retrieval.tp_gmr import Order
from tpsim.robot.robot import Robot
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.view import View
from tpsim.world.impedance import Controller


@dataclass(frozen=True, eq=False)
class WrittenSkill:
    """A :class:`~tpsim.controllers.product.Skill` as far as controllers need it."""

    views: Mapping[str, View]
    priors: np.ndarray
    frames: tuple[Gaussian, ...]
    relevance: tuple[Relevance, ...]

    @classmethod
    def of(cls, skill: Skill) -> "WrittenSkill":
        """A skill without the history of its learning."""
        model = skill.model
        return cls(dict(skill.views), model.priors, model.frames, model.relevance)

    def seen(self, inputs: int = 0) -> Iterator[tuple[View, int]]:
        """Views, and the dimensions of their frames besides the inputs."""
        for view, frame in zip(self.views.values(), self.frames, strict=True):
            yield view, frame.dim - inputs

    @property
    def skill(self) -> Skill:
        """The skill."""
        return Skill(self.views, TPGMM(self.priors, self.frames, relevance=self.relevance))


@dataclass(frozen=True, eq=False)
class Recipe(ABC):
    """What a controller is made from.

    Parameters
    ----------
    lasts : float
        Time [s] for which an impedance lasts.
    """

    lasts: float

    def __post_init__(self) -> None:
        if not self.lasts > 0:
            raise ArgumentError(f"lasts is {self.lasts} s; it must be positive")

    @abstractmethod
    def controller(self, robot: Robot, start: np.ndarray) -> Controller:
        """A new controller that starts at a posture (n,) [rad]."""

    def free_of(self, start: np.ndarray) -> "Recipe":
        """The same where nothing is written down that is the start posture itself."""
        return self

    def seen(self) -> Iterator[tuple[View, int]]:
        """The views that skills observe, with the number of dimensions that models have."""
        yield from ()


@dataclass(frozen=True, eq=False)
class _Held(Recipe):
    """A controller that may have a prior on the posture.

    ``held`` says that the prior's mean is the posture in which the robot starts.
    """

    prior: Gaussian | None
    held: bool

    def seen(self) -> Iterator[tuple[View, int]]:
        """The prior sees all joints."""
        if self.prior is not None:
            yield Joints(), self.prior.dim

    def free_of(self, start: np.ndarray) -> "Recipe":
        """The same with the mean of the prior to be filled in at the start."""
        if self.prior is None or not np.array_equal(self.prior.mean, start):
            return self
        unknown = Gaussian(np.zeros(len(start)), self.prior.covariance)
        return replace(self, prior=unknown, held=True)

    def _prior(self, start: np.ndarray) -> Gaussian | None:
        if self.prior is None or not self.held:
            return self.prior
        return Gaussian(start, self.prior.covariance)


@dataclass(frozen=True, eq=False)
class InterventionRecipe(_Held):
    """Of :class:`MinimalIntervention`."""

    skills: tuple[WrittenSkill, ...]
    effort: float | None
    bandwidth: float
    friction: float

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.skills:
            raise ArgumentError("there is no skill")

    def seen(self) -> Iterator[tuple[View, int]]:
        """Views and dimensions of the prior and of all skills."""
        yield from super().seen()
        for skill in self.skills:
            yield from skill.seen()

    def controller(self, robot: Robot, start: np.ndarray) -> Controller:
        """A new controller."""
        return MinimalIntervention(
            [written.skill for written in self.skills],
            effort=self.effort,
            bandwidth=self.bandwidth,
            friction=self.friction,
            prior=self._prior(start),
            period=self.lasts,
        )


@dataclass(frozen=True, eq=False)
class PursuitRecipe(Recipe):
    """Of :class:`Pursuit`."""

    skills: tuple[WrittenSkill, ...]
    effort: float | None
    bandwidth: float

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.skills:
            raise ArgumentError("there is no skill")

    def seen(self) -> Iterator[tuple[View, int]]:
        """Views and dimensions of all skills."""
        for skill in self.skills:
            yield from skill.seen()

    def controller(self, robot: Robot, start: np.ndarray) -> Controller:
        """A new controller."""
        skills = [written.skill for written in self.skills]
        return Pursuit(skills, effort=self.effort, bandwidth=self.bandwidth, period=self.lasts)


@dataclass(frozen=True, eq=False)
class TimedRecipe(_Held):
    """Of :class:`TimedIntervention`."""

    effort: float | None
    bandwidth: float
    skill: WrittenSkill
    until: float
    order: Order

    def seen(self) -> Iterator[tuple[View, int]]:
        """Views and dimensions of the prior and of the skill, where time comes before them."""
        yield from super().seen()
        yield from self.skill.seen(inputs=1)

    def controller(self, robot: Robot, start: np.ndarray) -> Controller:
        """A new controller."""
        return TimedIntervention(
            self.skill.skill,
            effort=self.effort,
            bandwidth=self.bandwidth,
            until=self.until,
            prior=self._prior(start),
            period=self.lasts,
            order=self.order,
        )


@dataclass(frozen=True, eq=False)
class HorizonRecipe(Recipe):
    """Of :class:`FiniteHorizon`."""

    objects: tuple[str, ...]
    movements: tuple[RiemannianGaussian, ...]
    posture: Gaussian
    joints: tuple[str, ...]
    site: str
    dt: float
    effort: float
    chain: SemiMarkovChain | None = None
    shown: int | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        lengths = {len(movement.mean) for movement in self.movements} | {len(self.posture.mean)}
        if not 0 < len(self.objects) == len(self.movements) or len(lengths) > 1:
            raise ArgumentError("objects, movements and posture do not fit each other")

    def controller(self, robot: Robot, start: np.ndarray) -> Controller:
        """A new controller."""
        return FiniteHorizon(
            robot,
            self.objects,
            self.movements,
            self.posture,
            joints=self.joints,
            site=self.site,
            dt=self.dt,
            effort=self.effort,
            period=self.lasts,
            chain=self.chain,
            shown=self.shown,
        )


@dataclass(frozen=True, eq=False)
class FixedRecipe(Recipe):
    """Of :class:`FixedImpedance`; without a posture it holds the one in which the robot starts."""

    posture: np.ndarray | None
    stiffness: float

    def seen(self) -> Iterator[tuple[View, int]]:
        """The posture is one of all joints."""
        if self.posture is not None:
            yield Joints(), self.posture.size

    def controller(self, robot: Robot, start: np.ndarray) -> Controller:
        """A new controller."""
        return FixedImpedance(start if self.posture is None else self.posture, self.stiffness)

    def free_of(self, start: np.ndarray) -> Recipe:
        """The same without a posture that is the start."""
        held = self.posture is not None and np.array_equal(self.posture, start)
        return replace(self, posture=None) if held else self


def recipe_of(controller: object, period: float) -> Recipe:
    """What a controller was made from; ``period`` [s] is that of the control it was made for.

    Raises
    ------
    ArgumentError
        If it is none of tpsim's controllers.
    """
    kind = type(controller)
    if isinstance(controller, Pursuit) and kind is Pursuit:
        skills = tuple(WrittenSkill.of(skill) for skill in controller.skills)
        return PursuitRecipe(controller.period, skills, controller.effort, controller.bandwidth)
    if isinstance(controller, MinimalIntervention) and kind is MinimalIntervention:
        m = controller
        skills = tuple(WrittenSkill.of(skill) for skill in m.skills)
        rest = skills, m.effort, m.bandwidth, m.friction
        return InterventionRecipe(m.period, m.prior, False, *rest)
    if isinstance(controller, TimedIntervention) and kind is TimedIntervention:
        timed = controller
        skill = WrittenSkill.of(timed.skill)
        gains = timed.effort, timed.bandwidth
        return TimedRecipe(
            timed.period, timed.prior, False, *gains, skill, timed.until, timed.order
        )
    if isinstance(controller, FiniteHorizon) and kind is FiniteHorizon:
        f = controller
        parts = f.objects, f.movements, f.posture, f.joints, f.site, f.dt, f.effort
        return HorizonRecipe(f.period, *parts, f.chain, f.shown)
    if isinstance(controller, FixedImpedance) and kind is FixedImpedance:
        return FixedRecipe(period, controller.posture, controller.stiffness)
    raise ArgumentError(
        f"the task's controller is a {kind.__name__}; a policy can be made of MinimalIntervention, "
        "Pursuit, TimedIntervention, FiniteHorizon and FixedImpedance. Other controllers need "
        "your own code on the robot's computer: Robot, State and views run there without MuJoCo"
    )
