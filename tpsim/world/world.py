"""A world: a scene with a robot in it, compiled once, from which simulations are made."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property

import mujoco
import numpy as np

from tpsim.border import border, checked
from tpsim.errors import ArgumentError, SimulationError
from tpsim.robot.description import Description
from tpsim.robot.robot import Robot
from tpsim.world.grasp import read_grasps
from tpsim.world.plant import NOMINAL, Plant
from tpsim.world.simulation import Simulation


@dataclass(frozen=True, eq=False)
class World:
    """Robot, objects and scene: everything that is there before a trial begins.

    Made by :meth:`compose`, or by :func:`tpsim.scene.compose.world`. What is simulated is compiled
    from the text and the files in here and from nothing else, so that a run folder repeats
    anywhere.

    Parameters
    ----------
    xml : str
        MJCF text of the scene.
    description : Description
        Of the robot in it.
    assets : mapping of str to bytes
        Meshes and other files, by the names that the text uses.
    """

    xml: str
    description: Description
    assets: Mapping[str, bytes] = field(default_factory=dict)

    def __post_init__(self) -> None:
        checked(self)

    @classmethod
    @border
    def compose(cls, robot: Robot, spec: mujoco.MjSpec | None = None) -> "World":
        """World of a robot and a scene that contains it, by default of the robot alone.

        Parameters
        ----------
        robot : Robot
        spec : MjSpec, optional
            A copy of ``robot.source.spec`` to which things were added.

        Raises
        ------
        SimulationError
            If the scene does not compile.
        """
        spec = robot.source.spec.copy() if spec is None else spec
        with _compiling():
            spec.compile()
        return cls(spec.to_xml(), robot.description, dict(robot.source.assets))

    def __getstate__(self) -> dict[str, object]:
        """Text and files travel to other processes; each compiles for itself."""
        kept = ("xml", "description", "assets")
        return {name: self.__dict__[name] for name in kept}

    @cached_property
    def model(self) -> mujoco.MjModel:
        """The compiled scene; nobody may change it."""
        with _compiling():
            return mujoco.MjModel.from_xml_string(self.xml, dict(self.assets))

    @cached_property
    def _unseen(self) -> mujoco.MjModel:
        """The same scene without what is only seen: the same bits, a fifth less time."""
        with _compiling():
            spec = mujoco.MjSpec.from_string(self.xml, assets=dict(self.assets))
            spec.compiler.discardvisual = True
            return spec.compile()

    @cached_property
    def robot(self) -> Robot:
        """The controller's model of the robot, with what it holds."""
        return Robot.of(self.model, self.description)

    @border
    def with_home(self, home: np.ndarray) -> "World":
        """The same world with another home posture (n,) [rad] of the robot.

        Raises
        ------
        ArgumentError
            If it is outside the joint limits, or the motors cannot hold the robot there.
        """
        home = self.robot.posture("home", home)
        outside = (home < self.robot.lower) | (home > self.robot.upper)
        if outside.any():
            joint = self.robot.joints[int(outside.argmax())]
            raise ArgumentError(f"home puts joint '{joint}' outside its range")
        lacking = np.abs(self.robot.gravity_torque(home)) - self.robot.torque_limit
        if lacking.max() > 0:
            joint = self.robot.joints[int(lacking.argmax())]
            raise ArgumentError(
                f"the robot cannot hold itself up at home: joint '{joint}' lacks "
                f"{lacking.max():.1f} Nm; give it another home, or stronger motors"
            )
        there = replace(self.description, home=tuple(home.tolist()))
        made = replace(self, description=there)
        # No fields of the value; compiling again would give the same.
        compiled = ("model", "_unseen")
        made.__dict__.update(
            {name: self.__dict__[name] for name in compiled if name in self.__dict__}
        )
        return made

    @property
    def timestep(self) -> float:
        """Time step of the physics [s]."""
        return float(self.model.opt.timestep)

    @property
    def objects(self) -> tuple[str, ...]:
        """Names of the objects that can be moved (mocap bodies), and of things that hands take."""
        moved = tuple(
            self.model.body(body).name
            for body in range(self.model.nbody)
            if self.model.body_mocapid[body] >= 0
        )
        return moved + tuple(read_grasps(self.model))

    @border
    def simulation(self, plant: Plant = NOMINAL, *, visible: bool = False) -> Simulation:
        """A new simulation of this world on a plant.

        Parameters
        ----------
        plant : Plant
        visible : bool
            Whether it has geoms that nothing touches, for pictures of its data.
        """
        scene = self.model if visible else self._unseen
        return Simulation(plant.model(scene, self.robot), self.robot)


@contextmanager
def _compiling() -> Iterator[None]:
    """Say with MuJoCo's reason where a scene does not compile."""
    try:
        yield
    except ValueError as error:
        raise SimulationError(f"the scene does not compile: {error}") from None
