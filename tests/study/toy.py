"""A study that runs in seconds: a two-link arm learns to bring its tip to a mark."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tpsim.controllers.minimal_intervention import MinimalIntervention
from tpsim.controllers.product import Skill
from tpsim.controllers.renewed import FixedImpedance
from tpsim.robot.robot import Robot
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Object, Site
from tpsim.study.condition import Condition
from tpsim.study.measure import Measure
from tpsim.study.study import Study
from tpsim.task.task import Behaviour, Situation, Task
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.guide import Grip, Guide
from tpsim.world.people.script import straight
from tpsim.world.teaching import Lesson
from tpsim.world.world import World

ARM = """
<mujoco>
  <option timestep="0.002" gravity="0 0 0"/>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 0 1" range="-150 150" damping="0.2" armature="0.02"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="1" contype="0"/>
      <body name="lower" pos="0.3 0 0">
        <joint name="elbow" axis="0 0 1" range="-150 150" damping="0.2" armature="0.02"/>
        <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="1" contype="0"/>
        <site name="tip" pos="0.3 0 0"/>
      </body>
    </body>
    <body name="mark" mocap="true" pos="0.3 0.3 0">
      <geom type="mesh" mesh="mark" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
  <asset><mesh name="mark" file="mark.obj"/></asset>
  <actuator><motor joint="shoulder"/><motor joint="elbow"/></actuator>
</mujoco>"""
MARK = b"v 0 0 0\nv .02 0 0\nv 0 .02 0\nv 0 0 .02\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
HOME = (0.4, 0.9)


@dataclass(frozen=True)
class Bring(Task):
    """Bring the tip to the mark."""

    effort: float = 0.05
    reach: tuple[float, float] = (0.3, 0.4)
    grip: float | None = None

    duration: ClassVar[float] = 0.4
    demonstrations: ClassVar[int] = 3

    def world(self):
        """The arm in its plane."""
        import mujoco

        spec = mujoco.MjSpec.from_string(ARM, assets={"mark.obj": MARK})
        robot = Robot.from_mjcf(spec, {"hand": "tip"}, torque_limit=30, home=HOME)
        return World.compose(robot)

    def behaviours(self):
        """Where the mark is seen."""
        views = {
            "mark": Site("tip").seen_from(Object("mark")).position,
            "posture": Joints(),
        }
        return {"bring": Behaviour(views, self.lesson)}

    def lesson(self, world, rng):
        """Lead the tip a little."""
        start = np.array(HOME) + 0.05 * rng.normal(size=2)
        origin = world.robot.at(start).pose("tip").position
        path = straight(origin, np.array([0.0, 0.03, 0.0]), 0.2, 0.1, world.timestep)
        guide = Guide("hand", "tip", Grip(400.0, 40.0, 0.0, 0.0), path, start=0.0)
        return Lesson(start, (guide,), 0.3, objects=(ObjectPath.at("mark", origin),))

    def situation(self, world, rng):
        """A mark somewhere."""
        start = tuple((np.array(HOME) + 0.1 * rng.normal(size=2)).tolist())
        mark = (0.35, rng.uniform(*self.reach), 0.0)
        return Situation(start, (ObjectPath.at("mark", mark),))

    def controller(self, world, models, situation):
        """Minimal intervention."""
        skill = Skill(self.behaviours()["bring"].views, models["bring"])
        return MinimalIntervention([skill], effort=self.effort)


def still(world, models, situation):
    """Hold the start."""
    return FixedImpedance(np.array(situation.start), 100.0)


def show(world: World, condition: Condition, rng: np.random.Generator) -> Lesson:
    """Show a lesson in a situation."""
    return Bring().lesson(world, rng)


study = Study(
    Bring(),
    [Measure("gap", Site("tip").seen_from(Object("mark")).position, "mm")],
    controllers={"still": still, "nearby": lambda *given: still(*given)},
    show=show,
)
